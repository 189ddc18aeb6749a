//! Bodies that scatter inside: KHR_materials_volume_scatter and KHR_materials_scatter.

use super::Reader;
use super::extensions::Scatter;
use super::material::{Base, Extensions, is_zero};
use super::volume::{ScatterDraft, extinction, mean_free_path};
use crate::radiometry::Rgb;
use crate::scene::{ColorInput, ScatteringInput, SceneError, Surface};

impl Reader<'_> {
    /// What scatters inside; `None` (with a warning where it surprises) if nothing does or no light
    /// gets in.
    ///
    /// A constant colour becomes coefficients by the draft's own formula. A textured one is handed on
    /// as the wanted reflectance, which is what the formula approximates, and inverted by the
    /// renderer.
    pub(super) fn scattering(
        &mut self,
        draft: ScatterDraft,
        scatter: &Scatter,
        base: &Base,
        extensions: &Extensions,
        place: &str,
    ) -> Result<Option<ScatteringInput>, SceneError> {
        let name = match draft {
            ScatterDraft::VolumeScatter => "KHR_materials_volume_scatter",
            ScatterDraft::Scatter => "KHR_materials_scatter",
        };
        let place = format!("{place}/extensions/{name}");
        let color =
            self.color_factor(scatter.color(draft.default_color()), &place, "multiscatterColorFactor");
        let strength = scatter.strength(draft.default_strength());
        let multiscatter = color * self.factor(strength, &place, "scatterStrengthFactor");
        if multiscatter.is_black() {
            return Ok(None);
        }
        let sigma_t = extinction(&extensions.volume);
        let light_enters = extensions.transmission.transmission_factor > 0.0
            || extensions.diffuse_transmission.diffuse_transmission_factor > 0.0;
        let obstacle = if !light_enters {
            Some("scattering without transmission or diffuse transmission has no effect")
        } else if base.metallic.factor == 1.0 && base.metallic.texture.is_none() {
            Some("scattering inside a metal (metallicFactor is 1 by default) has no effect")
        } else if extensions.volume.thickness_factor <= 0.0 {
            Some("scattering in a thin wall is left out: set thicknessFactor above 0")
        } else if sigma_t.is_black() {
            Some("scattering without attenuation (attenuationDistance, attenuationColor) has no effect")
        } else {
            None
        };
        if let Some(obstacle) = obstacle {
            self.warnings.add(obstacle, &place);
            return Ok(None);
        }
        if scatter.scatter_strength_texture.is_some() {
            self.warnings.add("scatterStrengthTexture is ignored: the strength is taken as constant", &place);
        }
        let g = self.finite(scatter.scatter_anisotropy, &place, "scatterAnisotropy")?;
        if g.abs() >= 1.0 {
            self.warnings.add("scatterAnisotropy outside (−1, 1) is clamped to ±0.99", &place);
        }
        let g = if g.abs() >= 1.0 { 0.99 * g.signum() } else { g };
        let info = scatter.multiscatter_color_texture.as_ref();
        Ok(Some(match self.color_texture(info, &place, "multiscatterColorTexture")? {
            Some(texture) => ScatteringInput::Albedo {
                albedo: ColorInput { factor: multiscatter, texture: Some(texture), vertex_color: false },
                mean_free_path: mean_free_path(sigma_t),
                g,
            },
            None => {
                let sigma_s = sigma_t * multiscatter.map(|rho| draft.single_scattering_albedo(rho, g));
                ScatteringInput::Coefficients { sigma_a: sigma_t - sigma_s, sigma_s, g }
            }
        }))
    }

    /// A body is wholly translucent or not at all; what the file mixes in besides is warned of.
    pub(super) fn translucent(
        &mut self,
        medium: ScatteringInput,
        base: &Base,
        extensions: &Extensions,
        place: &str,
    ) -> Surface {
        let transmission = extensions
            .transmission
            .transmission_factor
            .max(extensions.diffuse_transmission.diffuse_transmission_factor);
        if transmission < 1.0
            || extensions.transmission.transmission_texture.is_some()
            || !is_zero(base.metallic)
        {
            self.warnings.add(
                "a partly opaque or metallic translucent material is rendered as wholly translucent",
                place,
            );
        }
        if base.color.texture.is_some() || base.color.factor != Rgb::ONE {
            self.warnings.add(
                "the base colour of a translucent material is ignored: its multi-scatter colour counts",
                place,
            );
        }
        if base.roughness.texture.is_some() {
            self.warnings
                .add("the roughness texture of a translucent material is ignored: its factor counts", place);
        }
        if extensions.dispersion.is_some() {
            self.warnings.add("the dispersion of a translucent material is ignored", place);
        }
        Surface::Translucent { ior: extensions.ior, roughness: base.roughness.factor, medium }
    }
}

//! Numbers out of buffers (glTF 2.0, section 3.6.2): strided, sparse, normalised.

use ::gltf::json::accessor::{ComponentType, Type};
use ::gltf::json::validation::{Checked, USize64};

use super::document::Document;
use crate::scene::SceneError;

/// The largest magnitude that a coordinate may have: beyond it, squares overflow.
pub(super) const MAX_MAGNITUDE: f32 = 1e30;

/// What an accessor is used for; decides which component types are allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Usage {
    Position,
    Normal,
    Tangent,
    TextureCoordinate,
    Color,
    Rotation,
    FloatOnly,
}

impl Usage {
    /// Core glTF 2.0 (section 3.7.2.1, EXT_mesh_gpu_instancing), and KHR_mesh_quantization if `quantized`.
    fn allows(self, component: ComponentType, normalized: bool, quantized: bool) -> bool {
        use ComponentType::{F32, I8, I16, U8, U16, U32};
        let core = match self {
            Self::TextureCoordinate | Self::Color => normalized && matches!(component, U8 | U16),
            Self::Rotation => normalized && matches!(component, I8 | I16),
            _ => false,
        };
        let extended = quantized
            && match self {
                Self::Position | Self::TextureCoordinate => !matches!(component, U32 | F32),
                Self::Normal | Self::Tangent => normalized && matches!(component, I8 | I16),
                _ => false,
            };
        component == F32 || core || extended
    }
}

/// Size of one component, bytes.
fn component_size(component: ComponentType) -> usize {
    match component {
        ComponentType::I8 | ComponentType::U8 => 1,
        ComponentType::I16 | ComponentType::U16 => 2,
        ComponentType::U32 | ComponentType::F32 => 4,
    }
}

/// One component as a number; normalised integers by the equations of section 3.6.2.2.
///
/// `bytes` holds at least the size of the component.
fn decode(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
    let (value, scale) = match component {
        ComponentType::I8 => (f32::from(bytes[0] as i8), 127.0),
        ComponentType::U8 => (f32::from(bytes[0]), 255.0),
        ComponentType::I16 => (f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
        ComponentType::U16 => (f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
        ComponentType::U32 => (decode_index(bytes, component) as f32, u32::MAX as f32),
        ComponentType::F32 => return f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
    };
    if normalized { (value / scale).max(-1.0) } else { value }
}

fn decode_index(bytes: &[u8], component: ComponentType) -> u32 {
    match component {
        ComponentType::U8 => u32::from(bytes[0]),
        ComponentType::U16 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
        _ => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
    }
}

/// An accessor whose declaration has been checked.
#[derive(Clone, Copy)]
struct Declared {
    component: ComponentType,
    normalized: bool,
    element_size: usize,
    count: usize,
}

impl Document {
    /// Number of components of accessor `index`, which `place` refers to.
    pub fn components(&self, index: usize, place: &str) -> Result<usize, SceneError> {
        match self.get(&self.accessors, "accessor", index, place)?.type_ {
            Checked::Valid(Type::Scalar) => Ok(1),
            Checked::Valid(Type::Vec2) => Ok(2),
            Checked::Valid(Type::Vec3) => Ok(3),
            Checked::Valid(Type::Vec4 | Type::Mat2) => Ok(4),
            Checked::Valid(Type::Mat3) => Ok(9),
            Checked::Valid(Type::Mat4) => Ok(16),
            Checked::Invalid => Err(self.error(
                format!("/accessors/{index}/type"),
                "unknown type; it must be SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4",
            )),
        }
    }

    /// The elements of accessor `index`: finite and at most [`MAX_MAGNITUDE`] in size.
    pub fn vectors<const N: usize>(
        &self,
        index: usize,
        usage: Usage,
        place: &str,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        let declared = self.declared(index, N, place)?;
        if !usage.allows(declared.component, declared.normalized, self.quantized) {
            let quantized = if self.quantized { "" } else { " without KHR_mesh_quantization" };
            return Err(self.error(
                format!("/accessors/{index}/componentType"),
                format!(
                    "{usage:?} cannot be of type {:?} (normalized: {}){quantized}, as {place} asks for; export as 32-bit float",
                    declared.component, declared.normalized
                ),
            ));
        }
        let bytes = self.gather(index, declared, place)?;
        let size = component_size(declared.component);
        let element = |bytes: &[u8]| {
            std::array::from_fn(|c| decode(&bytes[c * size..], declared.component, declared.normalized))
        };
        let elements: Vec<[f32; N]> = bytes.chunks_exact(declared.element_size).map(element).collect();
        self.check_magnitudes(index, &elements)?;
        Ok(elements)
    }

    /// The elements of accessor `index` as vertex indices.
    pub fn indices(&self, index: usize, place: &str) -> Result<Vec<u32>, SceneError> {
        let declared = self.declared(index, 1, place)?;
        use ComponentType::{U8, U16, U32};
        if declared.normalized || !matches!(declared.component, U8 | U16 | U32) {
            return Err(self.error(
                format!("/accessors/{index}/componentType"),
                format!("{place} must be unsigned integers that are not normalized; export it again"),
            ));
        }
        let bytes = self.gather(index, declared, place)?;
        let element = |bytes: &[u8]| decode_index(bytes, declared.component);
        Ok(bytes.chunks_exact(declared.element_size).map(element).collect())
    }

    fn declared(&self, index: usize, components: usize, place: &str) -> Result<Declared, SceneError> {
        let accessor = self.get(&self.accessors, "accessor", index, place)?;
        let found = self.components(index, place)?;
        if found != components {
            return Err(self.error(
                format!("/accessors/{index}/type"),
                format!("{place} must have {components} components, not {found}; export it again"),
            ));
        }
        let Checked::Valid(component) = accessor.component_type else {
            return Err(self.error(
                format!("/accessors/{index}/componentType"),
                "unknown component type; it must be 5120, 5121, 5122, 5123, 5125 or 5126",
            ));
        };
        let place = format!("/accessors/{index}/count");
        let count = self.size(accessor.count, &place)?;
        if count == 0 {
            return Err(self.error(place, "must be at least 1"));
        }
        self.charge_elements(count, &place)?;
        Ok(Declared {
            component: component.0,
            normalized: accessor.normalized,
            element_size: components * component_size(component.0),
            count,
        })
    }

    /// The elements without gaps: those of the buffer view (else zeros), then the sparse ones over them.
    fn gather(&self, index: usize, declared: Declared, place: &str) -> Result<Vec<u8>, SceneError> {
        let accessor = self.get(&self.accessors, "accessor", index, place)?;
        let place = format!("/accessors/{index}");
        let Declared { element_size, count, .. } = declared;
        let mut bytes = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or_default();
                self.strided(view.value(), offset, element_size, count, &place)?
            }
            None => vec![0; count.saturating_mul(element_size)],
        };
        if let Some(sparse) = &accessor.sparse {
            self.overlay(sparse, declared, &mut bytes, &format!("{place}/sparse"))?;
        }
        Ok(bytes)
    }

    fn overlay(
        &self,
        sparse: &::gltf::json::accessor::sparse::Sparse,
        declared: Declared,
        bytes: &mut [u8],
        place: &str,
    ) -> Result<(), SceneError> {
        let count = self.size(sparse.count, &format!("{place}/count"))?;
        if count > declared.count {
            return Err(self.error(
                format!("{place}/count"),
                format!("{count} replaced elements of only {}; export it again", declared.count),
            ));
        }
        let Checked::Valid(index_type) = sparse.indices.component_type else {
            return Err(self.error(
                format!("{place}/indices/componentType"),
                "unknown component type; it must be 5121, 5123 or 5125",
            ));
        };
        let index_size = component_size(index_type.0);
        let view = sparse.indices.buffer_view.value();
        let place_indices = format!("{place}/indices");
        let indices = self.strided(view, sparse.indices.byte_offset, index_size, count, &place_indices)?;
        let view = sparse.values.buffer_view.value();
        let place_values = format!("{place}/values");
        let values =
            self.strided(view, sparse.values.byte_offset, declared.element_size, count, &place_values)?;

        let targets = indices.chunks_exact(index_size).map(|b| decode_index(b, index_type.0) as usize);
        for (target, value) in targets.zip(values.chunks_exact(declared.element_size)) {
            if target >= declared.count {
                return Err(self.error(
                    place_indices,
                    format!("index {target} of only {} elements; export it again", declared.count),
                ));
            }
            let start = target * declared.element_size;
            bytes[start..start + declared.element_size].copy_from_slice(value);
        }
        Ok(())
    }

    /// `count` elements of `size` bytes from a buffer view, without gaps.
    fn strided(
        &self,
        view: usize,
        offset: USize64,
        size: usize,
        count: usize,
        place: &str,
    ) -> Result<Vec<u8>, SceneError> {
        let bytes = self.view(view, place)?;
        let stride = self.buffer_views[view].byte_stride.map_or(size, |stride| stride.0);
        if stride < size {
            return Err(self.error(
                format!("/bufferViews/{view}/byteStride"),
                format!("{stride} is less than the {size} bytes of an element of {place}; export it again"),
            ));
        }
        let offset = self.size(offset, &format!("{place}/byteOffset"))?;
        let end = count
            .checked_sub(1)
            .map_or(Some(0), |last| last.checked_mul(stride).and_then(|n| n.checked_add(size)))
            .and_then(|length| length.checked_add(offset));
        match end {
            Some(end) if end <= bytes.len() => {}
            _ => {
                return Err(self.error(
                    place,
                    format!(
                        "{count} elements of {size} bytes at offset {offset} and stride {stride} do not fit into the {} bytes of bufferView {view}; the file is damaged, export it again",
                        bytes.len()
                    ),
                ));
            }
        }
        if stride == size {
            return Ok(bytes[offset..offset + count * size].to_vec());
        }
        let mut packed = Vec::with_capacity(count * size);
        for element in 0..count {
            let start = offset + element * stride;
            packed.extend_from_slice(&bytes[start..start + size]);
        }
        Ok(packed)
    }

    /// The bytes of buffer view `index`, which `place` refers to.
    pub fn view(&self, index: usize, place: &str) -> Result<&[u8], SceneError> {
        let view = self.get(&self.buffer_views, "bufferView", index, place)?;
        let place = format!("/bufferViews/{index}");
        let buffer = self.get(&self.buffers, "buffer", view.buffer.value(), &place)?;
        let offset = self.size(view.byte_offset.unwrap_or_default(), &place)?;
        let length = self.size(view.byte_length, &place)?;
        offset.checked_add(length).and_then(|end| buffer.get(offset..end)).ok_or_else(|| {
            self.error(
                place,
                format!(
                    "{length} bytes at offset {offset} lie outside the {} bytes of buffer {}; the file is damaged, export it again",
                    buffer.len(),
                    view.buffer.value()
                ),
            )
        })
    }

    fn size(&self, value: USize64, place: &str) -> Result<usize, SceneError> {
        usize::try_from(value.0).map_err(|_| {
            self.error(place, format!("{} does not fit into the memory of this machine", value.0))
        })
    }

    fn check_magnitudes<const N: usize>(
        &self,
        index: usize,
        elements: &[[f32; N]],
    ) -> Result<(), SceneError> {
        // NaN fails the comparison too.
        let bad = |element: &[f32; N]| !element.iter().all(|x| x.abs() <= MAX_MAGNITUDE);
        match elements.iter().position(bad) {
            None => Ok(()),
            Some(position) => Err(self.error(
                format!("/accessors/{index}"),
                format!(
                    "element {position} is {:?}: not finite, or larger than {MAX_MAGNITUDE:e}; mend the geometry and export it again",
                    elements[position]
                ),
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normalised_integers_reach_their_ends_exactly() {
        use ComponentType::{I8, I16, U8, U16};
        assert_eq!(decode(&[255], U8, true), 1.0);
        assert_eq!(decode(&[51], U8, true), 0.2);
        assert_eq!(decode(&[127], I8, true), 1.0);
        assert_eq!(decode(&[0x80], I8, true), -1.0);
        assert_eq!(decode(&[0x81], I8, true), -1.0);
        assert_eq!(decode(&[0xff, 0xff], U16, true), 1.0);
        assert_eq!(decode(&[0x00, 0x80], I16, true), -1.0);
        assert_eq!(decode(&[0x00, 0x80], I16, false), -32768.0);
        assert_eq!(decode(&[200], U8, false), 200.0);
    }

    #[test]
    fn component_types_follow_the_standard() {
        use ComponentType::{F32, I8, I16, U8, U16, U32};
        let all = [I8, U8, I16, U16, U32, F32];
        let allowed = |usage: Usage, normalized, quantized| {
            all.into_iter().filter(|&c| usage.allows(c, normalized, quantized)).collect::<Vec<_>>()
        };
        assert_eq!(allowed(Usage::Position, false, false), [F32]);
        assert_eq!(allowed(Usage::Position, false, true), [I8, U8, I16, U16, F32]);
        assert_eq!(allowed(Usage::Normal, true, true), [I8, I16, F32]);
        assert_eq!(allowed(Usage::Normal, false, true), [F32]);
        assert_eq!(allowed(Usage::TextureCoordinate, true, false), [U8, U16, F32]);
        assert_eq!(allowed(Usage::TextureCoordinate, false, false), [F32]);
        assert_eq!(allowed(Usage::Color, true, false), [U8, U16, F32]);
        assert_eq!(allowed(Usage::Rotation, true, false), [I8, I16, F32]);
    }
}

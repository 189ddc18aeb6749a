//! Kernels: the path tracer compiled several times, each time with the code for some effects only.

/// What a path may need code for beyond light between constant, opaque surfaces: a set.
///
/// A kernel has its set as a const parameter, so that what is not in it costs nothing, not even a question. Such parameters are integers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Abilities(u32);

impl Abilities {
    /// Nothing more.
    pub const NONE: Self = Self(0);
    /// Inputs that vary over a surface: textures, vertex colours, normal maps.
    pub const TEXTURES: Self = Self(1);
    /// Surfaces that are there in part only.
    pub const COVERAGE: Self = Self(1 << 1);
    /// Bodies that paths go inside of.
    pub const INTERIORS: Self = Self(1 << 2);
    /// Light from under a surface, taken where it leaves: the area integral.
    pub const SUBSURFACE: Self = Self(1 << 3);
    /// Walks inside of bodies that scatter.
    pub const WALKS: Self = Self(1 << 4);
    /// Light by wavelength.
    pub const SPECTRAL: Self = Self(1 << 5);
    /// Everything.
    pub const ALL: Self = Self((1 << 6) - 1);

    /// What this build has code for: everything, but for measurements of what the presence of code costs (`scripts/cost_of_absence.sh`).
    pub const COMPILED: Self = if cfg!(alabaster_without = "subsurface") {
        Self::ALL.without(Self::SUBSURFACE).without(Self::WALKS)
    } else if cfg!(alabaster_without = "refraction") {
        Self::ALL.without(Self::INTERIORS).without(Self::WALKS)
    } else if cfg!(alabaster_without = "textures") {
        Self::ALL.without(Self::TEXTURES).without(Self::COVERAGE)
    } else {
        Self::ALL
    };

    /// As a const parameter.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// True if all of this is in the set of a const parameter.
    pub const fn are_in(self, bits: u32) -> bool {
        self.0 & !bits == 0
    }

    /// Both sets together.
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    const fn both(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

/// A kernel. All that suit a scene give the same bits; the fewer abilities, the faster.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kernel {
    /// Opaque surfaces of constant colours.
    Surfaces,
    /// Surfaces with textures, and such as are there in part.
    Textures,
    /// Clear bodies of constant colours.
    Glass,
    /// Scattering bodies by the area integral, of constant colours.
    Subsurface,
    /// The same with textures.
    TexturedSubsurface,
    /// All there is by red, green and blue. Walks are always its: they cost so much themselves that a kernel for them alone gains half a per cent.
    #[default]
    Generic,
    /// The same by wavelength.
    Spectral,
}

impl Kernel {
    /// From few abilities to many: of two that suit, the first is the faster.
    pub const ALL: [Self; 7] = [
        Self::Surfaces,
        Self::Textures,
        Self::Glass,
        Self::Subsurface,
        Self::TexturedSubsurface,
        Self::Generic,
        Self::Spectral,
    ];

    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Surfaces => "surfaces",
            Self::Textures => "textures",
            Self::Glass => "glass",
            Self::Subsurface => "subsurface",
            Self::TexturedSubsurface => "textured subsurface",
            Self::Generic => "generic",
            Self::Spectral => "spectral",
        }
    }

    /// What it has code for.
    pub const fn abilities(self) -> Abilities {
        const TEXTURES: Abilities = Abilities::TEXTURES.and(Abilities::COVERAGE);
        let wanted = match self {
            Self::Surfaces => Abilities::NONE,
            Self::Textures => TEXTURES,
            Self::Glass => Abilities::INTERIORS,
            Self::Subsurface => Abilities::SUBSURFACE,
            Self::TexturedSubsurface => Abilities::SUBSURFACE.and(TEXTURES),
            Self::Generic => Abilities::ALL.without(Abilities::SPECTRAL),
            Self::Spectral => Abilities::ALL,
        };
        wanted.both(Abilities::COMPILED)
    }

    /// True if it can render what needs `needed`: by wavelength only what is to be rendered so, which is another picture.
    pub fn suits(self, needed: Abilities) -> bool {
        let is_spectral = |abilities: Abilities| Abilities::SPECTRAL.are_in(abilities.bits());
        needed.are_in(self.abilities().bits()) && is_spectral(needed) == is_spectral(self.abilities())
    }

    /// The smallest one that suits; `None` if this build has none.
    pub fn smallest(needed: Abilities) -> Option<Self> {
        Self::ALL.into_iter().find(|kernel| kernel.suits(needed))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_kernel_that_suits_is_taken() {
        use Abilities as A;
        for (needed, kernel) in [
            (A::NONE, Kernel::Surfaces),
            (A::TEXTURES, Kernel::Textures),
            (A::COVERAGE, Kernel::Textures),
            (A::INTERIORS, Kernel::Glass),
            (A::SUBSURFACE, Kernel::Subsurface),
            (A::SUBSURFACE.and(A::TEXTURES), Kernel::TexturedSubsurface),
            (A::WALKS.and(A::INTERIORS), Kernel::Generic),
            (A::SUBSURFACE.and(A::INTERIORS), Kernel::Generic),
            (A::ALL.without(A::SPECTRAL), Kernel::Generic),
            (A::SPECTRAL, Kernel::Spectral),
            (A::SPECTRAL.and(A::WALKS), Kernel::Spectral),
            (A::ALL, Kernel::Spectral),
        ] {
            assert_eq!(Kernel::smallest(needed), Some(kernel), "{needed:?}");
        }
    }

    #[test]
    fn three_channels_and_wavelengths_do_not_mix() {
        for kernel in Kernel::ALL {
            let is_spectral = kernel == Kernel::Spectral;
            assert_eq!(kernel.suits(Abilities::SPECTRAL), is_spectral, "{kernel:?}");
            assert_eq!(kernel.suits(Abilities::NONE), !is_spectral, "{kernel:?}");
        }
    }

    #[test]
    fn kernels_stand_from_small_to_large() {
        for (place, kernel) in Kernel::ALL.into_iter().enumerate() {
            for later in &Kernel::ALL[place + 1..] {
                assert!(!later.abilities().are_in(kernel.abilities().bits()), "{later:?} in {kernel:?}");
            }
        }
    }
}

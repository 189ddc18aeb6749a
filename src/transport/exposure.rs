//! Taking samples by the kernel of a scene: the one place where the code of one is told from that of another.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use super::counters::Counters;
use super::renderer::Renderer;
use crate::film::Film;
use crate::plan::Kernel;
use crate::raycast::RayCaster;

impl<C: RayCaster> Renderer<C> {
    /// Adds to every pixel of `film` the samples with indices `samples`, on all threads of the current pool. The kernel is chosen once for
    /// all of them; `stop` and `advance` are those of [`Film::accumulate`].
    pub fn expose(
        &self,
        film: &mut Film,
        samples: Range<u64>,
        stop: &AtomicBool,
        advance: &(dyn Fn(u64) + Sync),
    ) -> Counters {
        const SURFACES: u32 = Kernel::Surfaces.abilities().bits();
        const TEXTURES: u32 = Kernel::Textures.abilities().bits();
        const GLASS: u32 = Kernel::Glass.abilities().bits();
        const SUBSURFACE: u32 = Kernel::Subsurface.abilities().bits();
        const TEXTURED_SUBSURFACE: u32 = Kernel::TexturedSubsurface.abilities().bits();
        const GENERIC: u32 = Kernel::Generic.abilities().bits();
        match self.kernel() {
            Kernel::Surfaces => self.expose_by::<SURFACES>(film, samples, stop, advance),
            Kernel::Textures => self.expose_by::<TEXTURES>(film, samples, stop, advance),
            Kernel::Glass => self.expose_by::<GLASS>(film, samples, stop, advance),
            Kernel::Subsurface => self.expose_by::<SUBSURFACE>(film, samples, stop, advance),
            Kernel::TexturedSubsurface => self.expose_by::<TEXTURED_SUBSURFACE>(film, samples, stop, advance),
            Kernel::Generic | Kernel::Spectral => self.expose_by::<GENERIC>(film, samples, stop, advance),
        }
    }

    /// The same by the kernel with the abilities `CAN`.
    fn expose_by<const CAN: u32>(
        &self,
        film: &mut Film,
        samples: Range<u64>,
        stop: &AtomicBool,
        advance: &(dyn Fn(u64) + Sync),
    ) -> Counters {
        film.accumulate(
            samples,
            |x, y, sample, counters: &mut Counters| self.sample_by::<CAN>(x, y, sample, counters),
            |total, counters| total.merge(&counters),
            stop,
            advance,
        )
    }
}

//! The random walk: transport inside a scattering body without approximation, collision by collision.
//!
//! **Distance.** Channels scatter at different rates, and a path carries all of them. The distance to the next collision
//! is drawn with the coefficient σ_t of one channel, taken in proportion to the light it carries, and weighted by the
//! mean of the three densities in that proportion (one-sample multiple importance sampling by the balance
//! heuristic, Veach 1997, section 9.2.4):
//!
//! w_c = σ_s,c e^(−σ_t,c t) / Σ_k q_k σ_t,k e^(−σ_t,k t),  q_c = L_c / Σ_k L_k.
//!
//! Then Σ_c L_c w_c ≤ Σ_c L_c: the light carried by all channels together never grows, so no channel
//! ever weighs more than all together did at the start, however long the walk and however unequal the channels.
//!
//! **Absorption** is by weight, which roulette turns into an end where little is left.
//!
//! **Boundary.** The body's surface is that of [`crate::optics::Dielectric`]: reflection, refraction, total
//! reflection; nested bodies are those of [`crate::transport::interiors`].
//!
//! **Free space.** A flight that ends nearer than any surface is known to be ([`crate::transport::clearance`]) needs no ray; where scattering is
//! isotropic and the surface many free paths away, one step on a sphere takes the place of many flights
//! ([`super::sphere_walk`]).
//!
//! **Similarity**, if wanted, the only approximation here: once |g|ⁿ has fallen below a hundredth, flights that begin far from any surface
//! are in the isotropic medium of reduced coefficients ([`crate::transport::spheres::Similarity`]), in which there are steps on spheres.
//!
//! **Direct light** is drawn at collisions where it can arrive: through a boundary that bends nothing, or from a
//! light inside the body. Through a rough boundary it is drawn at the boundary. Through a smooth one that refracts a
//! straight ray never arrives, and a walk finds a light only by leaving towards it. Light that has far to come through the
//! medium is looked for seldom, and weighs the more where it is: shadow rays from the depth of a body bring next to nothing.

use glam::Vec3;

use super::guiding::Course;
use super::{Entrance, Next, Origin, Path, leave};
use crate::math::Frame;
use crate::math::sampler::HashGenerator;
use crate::medium::Medium;
use crate::optics::phase::HenyeyGreenstein;
use crate::radiometry::Spectrum;
use crate::raycast::{Hit, Ray, RayCaster};
use crate::transport::basis::Basis;
use crate::transport::entry::Response;
use crate::transport::interiors::Interior;
use crate::transport::light_choice::Receiver;
use crate::transport::spread::Channels;
use crate::transport::world::SurfacePoint;

/// Flights in scattering bodies after which a path is given up and counted. Roulette or the way out end it long
/// before in any body that either absorbs or is less than a thousand free paths thick.
const LONGEST_WALK: u32 = 1 << 22;

/// Collisions of a walk before roulette may end it.
const ROULETTE_START: u32 = 4;

/// Transmittance from which a shadow ray is always cast; below, in proportion to it. The less, the fewer rays, and the more
/// noise.
const SURE_TRANSMITTANCE: f32 = 0.125;

/// The least probability of a shadow ray: what it costs then no longer counts, and random numbers still resolve it.
const LEAST_CHANCE: f32 = 1.0 / 1024.0;

/// The least cosine at which a flight is followed back to a surface: none is flat for long, and what grazes more carries little.
const LEAST_COSINE: f32 = 1.0 / 16.0;

/// How a walk ended.
pub(super) enum Walked {
    /// The flight that began at `from` met a surface.
    Met { from: Next, hit: Hit },
    /// The body has no surface where the path left it.
    Escaped(Next),
}

/// The extinction of a medium, by which flights are drawn.
struct Extinction<const N: usize> {
    sigma_t: Spectrum<N>,
    /// All channels have the same.
    gray: bool,
}

/// A flight: how far it goes if nothing is in the way, and by which channels that was drawn.
struct Flight<const N: usize> {
    distance: f32,
    drawn_by: usize,
    channels: Channels<N>,
}

/// A direction taken at a collision.
#[derive(Clone, Copy)]
pub(super) struct Turn {
    pub direction: Vec3,
    /// Per solid angle, 1/sr.
    pub density: f32,
}

impl<const N: usize> Extinction<N> {
    fn of(medium: &Medium<N>) -> Self {
        let sigma_t = medium.sigma_t();
        Self { sigma_t, gray: sigma_t.is_gray() }
    }

    /// Draws how far light that is `throughput` goes.
    fn draw(&self, throughput: Spectrum<N>, random: &mut HashGenerator) -> Flight<N> {
        let channels = Channels::of(throughput);
        let drawn_by = if self.gray { 0 } else { channels.draw(Spectrum::ONE, random.next_f32()) };
        Flight { distance: random.next_exponential() / self.sigma_t[drawn_by], drawn_by, channels }
    }

    /// Draws how far light that is `throughput` goes on its `course`.
    fn draw_on(&self, course: &Course<N>, throughput: Spectrum<N>, random: &mut HashGenerator) -> Flight<N> {
        match course.layer.coefficient(course.lobe, &course.heading) {
            Some((drawn_by, coefficient)) => {
                let distance = random.next_exponential() / coefficient;
                Flight { distance, drawn_by, channels: Channels::of(throughput) }
            }
            None => self.draw(throughput, random),
        }
    }

    /// Attenuation over `distance` in units of that of the channel that the flight was drawn by, which neither
    /// underflows nor, as that channel's flights go, overflows.
    fn attenuation(&self, flight: &Flight<N>, distance: f32) -> Spectrum<N> {
        let drawn_by = self.sigma_t[flight.drawn_by];
        self.sigma_t.map(|s| if s == drawn_by { 1.0 } else { ((drawn_by - s) * distance).exp() })
    }

    /// Weight of a collision at the end of `flight`.
    fn collision(&self, flight: &Flight<N>, sigma_s: Spectrum<N>) -> Spectrum<N> {
        if self.gray {
            return sigma_s / self.sigma_t[0];
        }
        let attenuation = self.attenuation(flight, flight.distance);
        sigma_s * attenuation / flight.channels.mean(self.sigma_t * attenuation)
    }

    /// Weight of a flight that goes on at least to `distance`.
    fn passage(&self, flight: &Flight<N>, distance: f32) -> Spectrum<N> {
        if self.gray {
            return Spectrum::ONE;
        }
        let attenuation = self.attenuation(flight, distance);
        attenuation / flight.channels.mean(attenuation)
    }
}

/// A surface that a flight begins nearer to than rays can be told from it. The ray of the flight has its origin deeper in the body, where it does not meet the
/// surface by rounding, and what lies between is accounted for as if the surface were flat. In bodies of 10⁵ free paths it is a good part of one.
#[derive(Clone, Copy)]
struct Near {
    /// Unit normal of the surface, into the body.
    inward: Vec3,
    /// How much deeper than the flight the ray begins, m.
    lift: f32,
}

impl Near {
    /// The way of a flight in `direction` before the origin of its ray; negative if it goes back to the surface, to which the ray has farther.
    fn skipped(&self, direction: Vec3) -> f32 {
        let cosine = direction.dot(self.inward);
        self.lift / cosine.abs().max(LEAST_COSINE).copysign(cosine)
    }

    /// The surface that a path has left as `entrance` says, in `direction`.
    fn left(entrance: Entrance, direction: Vec3) -> Self {
        let inward = entrance.normal * 1.0_f32.copysign(entrance.normal.dot(direction));
        Self { inward, lift: entrance.offset }
    }

    /// That which a flight in `direction` ends `rest` short of, if that is so near.
    fn ahead(surface: &SurfacePoint, direction: Vec3, rest: f32) -> Option<Self> {
        let Entrance { normal, offset } = Entrance::new(surface, leave(surface, -direction));
        let cosine = normal.dot(direction);
        let lift = offset - rest * cosine.abs();
        (lift > 0.0).then(|| Self { inward: normal * -1.0_f32.copysign(cosine), lift })
    }
}

impl<C: RayCaster, B: Basis<N>, const N: usize, const CAN: u32> Path<'_, C, B, N, CAN> {
    /// Walks from `from` in `body` until a flight meets a surface; `None` if the path ends before.
    pub(super) fn walk(&mut self, mut from: Next, body: &Interior<N>) -> Option<Walked> {
        let world = &self.renderer.world;
        let bounds = self.bounds(body);
        let draws_light = self.draws_light_in(body);
        let space = self.free_space(body);
        let mut clear = self.clear_distance(space, from.origin);
        let own = (body.medium, Extinction::of(&body.medium));
        let similarity = space.similarity().map(|s| (s, (s.medium, Extinction::of(&s.medium))));
        let mut near = self.entrance.map(|entrance| Near::left(entrance, from.direction));
        let guide = self.guide(&from, body);
        let mut course = guide.map(|layer| self.set_out(layer, &from));
        for collision in 0.. {
            self.counts_flight()?;
            let (medium, extinction) = match &similarity {
                Some((at, similar)) if collision >= at.least_collisions && clear >= at.least_depth => similar,
                _ => &own,
            };
            let flight = match &course {
                Some(course) => extinction.draw_on(course, self.throughput, &mut self.random),
                None => extinction.draw(self.throughput, &mut self.random),
            };
            let skipped = near.map_or(0.0, |near| near.skipped(from.direction));
            let ahead = flight.distance - skipped;
            let end = from.origin + from.direction * ahead;
            let around_end = self.clear_distance(space, end);
            // Within the spheres around its ends a flight meets nothing, nor where it ends before its ray begins.
            let is_free = ahead <= 0.0 || ahead < clear + around_end.max(0.0) && bounds.contains(end);
            let hit = if is_free { None } else { self.meets(&from, ahead + bounds.margin()) };
            near = match hit {
                Some(hit) if hit.t <= ahead => {
                    self.passes_over(extinction, &flight, course.as_ref(), hit.t + skipped);
                    return Some(Walked::Met { from, hit });
                }
                Some(hit) => Near::ahead(&world.surface::<CAN>(&hit), from.direction, hit.t - ahead),
                None if ahead < 0.0 => near.map(|near| Near { lift: near.lift * (-ahead / skipped), ..near }),
                None => None,
            };
            let position = near.map_or(end, |near| end + near.inward * near.lift);
            if hit.is_none() && !bounds.contains(position) {
                let distance = bounds.exit(from.origin, from.direction);
                self.passes_over(extinction, &flight, course.as_ref(), distance + skipped);
                return Some(Walked::Escaped(self.escape(&from, body, distance)));
            }
            self.counters.collisions += 1;
            self.throughput *= extinction.collision(&flight, medium.sigma_s);
            if let Some(Course { layer, heading, .. }) = &course {
                let attenuation = extinction.attenuation(&flight, flight.distance);
                self.weigh(layer.collision_ratio(heading, flight.distance, attenuation));
            }
            if !self.plays(collision < ROULETTE_START, |path| path.random.next_f32()) {
                return None;
            }
            clear = around_end;
            let beyond = match medium.g {
                0.0 => self.cross_sphere(space, position, clear, draws_light),
                _ => None,
            };
            from = match beyond {
                Some(beyond) => {
                    near = None;
                    clear = self.clear_distance(space, beyond.origin);
                    course = guide.map(|layer| self.set_out(layer, &beyond));
                    beyond
                }
                None => {
                    let lit = draws_light.then_some(clear);
                    self.scatter(medium, position, from.direction, lit, &mut course)
                }
            };
        }
        None
    }

    /// What a flight meets before it has gone as far as `reach`: farther than it goes by the rounding of its end, so that no collision comes to
    /// lie behind a surface.
    fn meets(&mut self, from: &Next, reach: f32) -> Option<Hit> {
        self.counters.rays += 1;
        let ray = Ray { origin: from.origin, direction: from.direction, t_max: reach };
        self.renderer.world.caster().closest(&ray)
    }

    /// Counts a flight; `None`, counted, if the path has had too many.
    pub(super) fn counts_flight(&mut self) -> Option<()> {
        self.flights += 1;
        if self.flights > LONGEST_WALK {
            self.counters.capped_paths += 1;
            return None;
        }
        Some(())
    }

    /// Leaves `body` where it has no surface: as power is neither made nor lost there, radiance changes by the squared
    /// ratio of indices.
    fn escape(&mut self, from: &Next, body: &Interior<N>, distance: f32) -> Next {
        self.counters.open_walks += 1;
        self.interiors.leave(body.instance);
        self.throughput *= (body.ior / self.interiors.ior()).powi(2);
        Next { origin: from.origin + from.direction * distance, direction: from.direction }
    }

    /// True if light drawn at a collision in `body` may arrive there.
    pub(super) fn draws_light_in(&self, body: &Interior<N>) -> bool {
        body.ior == self.interiors.ior_around(body.instance) || self.renderer.is_lit_inside(body.instance)
    }

    /// Weighs a flight that goes on at least to `distance`.
    fn passes_over(
        &mut self,
        extinction: &Extinction<N>,
        flight: &Flight<N>,
        course: Option<&Course<N>>,
        distance: f32,
    ) {
        self.throughput *= extinction.passage(flight, distance);
        if let Some(Course { layer, heading, .. }) = course {
            self.weigh(layer.passage_ratio(heading, distance, extinction.attenuation(flight, distance)));
        }
    }

    /// Takes a new direction, from the phase function or a guide, and direct light if it can arrive; then `lit` is how far away any surface
    /// is at least. The `course`, if there is one, becomes that of the next flight.
    fn scatter(
        &mut self,
        medium: &Medium<N>,
        position: Vec3,
        direction: Vec3,
        lit: Option<f32>,
        course: &mut Option<Course<N>>,
    ) -> Next {
        let phase = HenyeyGreenstein { g: f64::from(medium.g) };
        let receiver = Receiver { position, normal: None };
        let layer = course.map(|course| course.layer);
        if let Some(clear) = lit {
            let technique = self.technique;
            let channels = Channels::of(self.throughput);
            self.add_direct_inside(&receiver, clear, |wi| {
                let value = phase.density(f64::from(wi.dot(direction))) as f32;
                let density = layer
                    .map_or(value, |layer| technique.density_towards(&layer, position, wi, value, channels));
                Response { value: Spectrum::splat(value), density }
            });
        }
        let turn = match layer {
            Some(layer) => {
                let (turn, next) = self.turn_guided(layer, phase, position, direction);
                *course = Some(next);
                turn
            }
            None => self.turn(phase, direction),
        };
        self.scattered_from = lit.map(|_| Origin { receiver, density: turn.density });
        Next { origin: position, direction: turn.direction }
    }

    /// Draws a direction by the phase function.
    pub(super) fn turn(&mut self, phase: HenyeyGreenstein, direction: Vec3) -> Turn {
        let deflection = phase.sample(f64::from(self.random.next_f32()));
        let (sin, cos) = (std::f32::consts::TAU * self.random.next_f32()).sin_cos();
        let across = deflection.sin as f32;
        let local = Vec3::new(across * cos, across * sin, deflection.cos as f32);
        Turn {
            direction: Frame::from_normal(direction).to_world(local).normalize(),
            density: phase.density(deflection.cos) as f32,
        }
    }

    /// Light drawn directly for light that is at `receiver` in the body, `clear` away from any surface, and would go on as
    /// `response` says.
    pub(super) fn add_direct_inside(
        &mut self,
        receiver: &Receiver,
        clear: f32,
        response: impl Fn(Vec3) -> Response<N>,
    ) {
        let renderer = self.renderer;
        let u = [self.random.next_f32(), self.random.next_f32(), self.random.next_f32()];
        let Some(light) = renderer.lights.sample::<_, _, N, CAN>(&self.basis, &renderer.world, receiver, u)
        else {
            return;
        };
        let Response { value, density } = response(light.direction);
        if value.is_black() {
            return;
        }
        let chance = self.chance_of_light(clear.min(light.distance));
        if chance < 1.0 && self.random.next_f32() >= chance {
            return;
        }
        let weight = light.density.map_or(1.0, |d| d / (d + density)) / chance;
        let contribution = self.throughput * light.value * value * weight;
        if !contribution.is_finite() {
            self.counters.rejected += 1;
            return;
        }
        let arrives = self.transmittance(receiver.position, light.direction, light.distance);
        self.radiance += contribution * arrives;
    }

    /// With which probability to look for light that comes through at least `distance` of the medium.
    fn chance_of_light(&self, distance: f32) -> f32 {
        let Some(body) = self.interiors.current().filter(|_| distance > 0.0) else { return 1.0 };
        let transmittance = (-body.medium.sigma_t().min_component() * distance).exp();
        (transmittance / SURE_TRANSMITTANCE).clamp(LEAST_CHANCE, 1.0)
    }
}

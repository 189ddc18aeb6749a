//! Which of several emitters to draw light from, by how much each could bring to a point.

use std::f32::consts::PI;

use glam::Vec3;

use crate::math::distribution::Discrete;

/// Where an emitter is and what it sends, as far as the choice needs it.
#[derive(Clone, Copy, Debug)]
pub enum Reach {
    /// Something with a bounding sphere.
    Near {
        /// Centre of the sphere, m.
        center: Vec3,
        /// Radius of the sphere, m.
        radius: f32,
        /// Normal of what emits to one side only.
        normal: Option<Vec3>,
        /// Radiant intensity along the normal (or to all sides), channels averaged, W/sr.
        intensity: f32,
    },
    /// Something infinitely far away.
    Far {
        /// Unit direction to it; `None`: all directions.
        direction: Option<Vec3>,
        /// Irradiance on a surface that faces it, channels averaged, W/m².
        irradiance: f32,
    },
}

/// Share of the choice that goes to all emitters alike that can reach the point: what occludes them is
/// not known, so a weaker one may be the one that counts.
const ALIKE: f32 = 0.2;

/// Emitters beyond this number are chosen by power alone, at a cost that does not grow with it.
const MOST_COMPARED: usize = 32;

impl Reach {
    /// Estimate of the irradiance at `point` on a surface with `normal` (`None`: on both sides), without
    /// occlusion, W/m². Zero only where none can arrive.
    fn irradiance(&self, point: Vec3, normal: Option<Vec3>) -> f32 {
        match *self {
            Self::Near { center, radius, normal: emitting, intensity } => {
                let offset = center - point;
                let squared = offset.length_squared().max(radius * radius).max(f32::MIN_POSITIVE);
                let distance = squared.sqrt();
                let direction = offset / distance;
                // The cosine at the centre, plus what the emitter's extent can add to it.
                let cos = |n: Vec3, d: Vec3| (n.dot(d) + radius / distance).clamp(0.0, 1.0);
                let received = normal.map_or(1.0, |n| cos(n, direction));
                let emitted = emitting.map_or(1.0, |n| cos(n, -direction));
                intensity * received * emitted / squared
            }
            Self::Far { direction, irradiance } => {
                irradiance * direction.zip(normal).map_or(1.0, |(d, n)| n.dot(d).max(0.0))
            }
        }
    }

    fn power(&self, world_radius: f32) -> f32 {
        match *self {
            Self::Near { intensity, normal, .. } => intensity * if normal.is_some() { PI } else { 4.0 * PI },
            Self::Far { irradiance, .. } => irradiance * PI * world_radius * world_radius,
        }
    }
}

/// A point that light is drawn for.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    /// Position, m.
    pub position: Vec3,
    /// Normal of the side that receives; `None`: both sides.
    pub normal: Option<Vec3>,
}

/// Chooses between emitters.
#[derive(Clone, Debug, Default)]
pub struct LightChoice {
    reaches: Vec<Reach>,
    by_power: Discrete,
}

impl LightChoice {
    /// From the reach of every emitter, in a world of the given radius.
    pub fn new(reaches: Vec<Reach>, world_radius: f32) -> Self {
        let powers: Vec<f32> = reaches.iter().map(|r| r.power(world_radius)).collect();
        let (total, count) = (powers.iter().sum::<f32>(), powers.len() as f32);
        let by_power = Discrete::new(powers.iter().map(|p| (1.0 - ALIKE) * p / total + ALIKE / count));
        Self { reaches, by_power }
    }

    /// Draws an emitter for `receiver` with `u` in [0, 1); also returns its probability.
    pub fn sample(&self, receiver: &Receiver, u: f32) -> Option<(usize, f32)> {
        if self.reaches.len() > MOST_COMPARED {
            return self.by_power.sample(u).map(|(index, probability, _)| (index, probability));
        }
        let weights = self.weights(receiver);
        let total: f32 = weights.iter().sum();
        let mut rest = u * total;
        let mut chosen = None;
        for (index, &weight) in weights[..self.reaches.len()].iter().enumerate() {
            if weight > 0.0 {
                chosen = Some((index, weight / total));
                rest -= weight;
                if rest < 0.0 {
                    break;
                }
            }
        }
        chosen
    }

    /// Probability with which [`Self::sample`] draws emitter `index`.
    pub fn probability(&self, receiver: &Receiver, index: usize) -> f32 {
        if self.reaches.len() > MOST_COMPARED {
            return self.by_power.probability(index);
        }
        let weights = self.weights(receiver);
        let total: f32 = weights.iter().sum();
        if total > 0.0 { weights[index] / total } else { 0.0 }
    }

    fn weights(&self, receiver: &Receiver) -> [f32; MOST_COMPARED] {
        let mut weights = [0.0; MOST_COMPARED];
        let (mut total, mut reaching) = (0.0, 0.0);
        for (weight, reach) in weights.iter_mut().zip(&self.reaches) {
            *weight = reach.irradiance(receiver.position, receiver.normal);
            if *weight > 0.0 {
                total += *weight;
                reaching += 1.0;
            }
        }
        let alike = if reaching > 0.0 { ALIKE / (1.0 - ALIKE) * total / reaching } else { 0.0 };
        for weight in &mut weights[..self.reaches.len()] {
            if *weight > 0.0 {
                *weight += alike;
            }
        }
        weights
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_those_of_the_draws() {
        let near = |x: f32, intensity| Reach::Near {
            center: Vec3::new(x, 1.0, 0.0),
            radius: 0.2,
            normal: Some(Vec3::NEG_Y),
            intensity,
        };
        let below = Reach::Near { center: Vec3::NEG_Y * 5.0, radius: 0.1, normal: None, intensity: 9.0 };
        let far = Reach::Far { direction: Some(Vec3::Y), irradiance: 0.5 };
        let choice = LightChoice::new(vec![near(0.0, 1.0), near(3.0, 2.0), below, far], 4.0);
        let receiver = Receiver { position: Vec3::ZERO, normal: Some(Vec3::Y) };
        let n = 10_000;
        let mut counts = [0.0; 4];
        for i in 0..n {
            let (index, probability) = choice.sample(&receiver, (i as f32 + 0.5) / n as f32).unwrap();
            assert_eq!(probability, choice.probability(&receiver, index));
            counts[index] += 1.0 / n as f32;
        }
        for (index, count) in counts.into_iter().enumerate() {
            // An even comb counts each share to one tooth at either end.
            assert!((count - choice.probability(&receiver, index)).abs() < 2.0 / n as f32);
        }
        assert_eq!(counts[2], 0.0, "below the horizon");
    }
}

//! Which method a body gets.

use super::effect_kind::EffectKind;
use super::force::Forces;
use super::object::Expected;
use crate::scene::{Method, ProfileChoice, SubsurfaceSettings};

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// The method; `Auto` leaves it open for each body.
    pub method: Method,
    /// The diffusion profile; one that is asked for is used, by the area integral.
    pub profile: ProfileChoice,
    /// The largest relative error that an approximation may be expected to have.
    pub accuracy: f32,
    /// Effects that are switched on or off; methods are effects, too.
    pub forces: Forces,
}

impl From<&SubsurfaceSettings> for Request {
    fn from(settings: &SubsurfaceSettings) -> Self {
        Self {
            method: settings.method,
            profile: settings.profile,
            accuracy: settings.accuracy,
            forces: Forces::default(),
        }
    }
}

/// The method that is switched on; else the one chosen, or what takes its place where that is switched off. And why, in a sentence.
pub fn decide(expected: &Expected, request: &Request) -> (Method, String) {
    let forces = &request.forces;
    let switched_off = |kind: EffectKind| format!("{} is switched off", kind.name());
    if forces.is_off(EffectKind::SubsurfaceScattering) {
        return (Method::Diffuse, switched_off(EffectKind::SubsurfaceScattering));
    }
    for (kind, method) in METHODS {
        if forces.is_on(kind) {
            return (method, format!("{} is switched on", kind.name()));
        }
    }
    let (method, reason) = choose(expected, request);
    let Some((kind, _)) = METHODS.into_iter().find(|&(kind, m)| m == method && forces.is_off(kind)) else {
        return (method, reason);
    };
    let instead = match method {
        Method::Walk if !forces.is_off(EffectKind::AreaIntegral) => Method::Bssrdf,
        Method::Bssrdf if !forces.is_off(EffectKind::RandomWalk) && expected.walk.is_ok() => Method::Walk,
        _ => Method::Diffuse,
    };
    (instead, format!("{} in place of {}: {reason}", switched_off(kind), method.name()))
}

/// The effects that are methods.
const METHODS: [(EffectKind, Method); 2] =
    [(EffectKind::AreaIntegral, Method::Bssrdf), (EffectKind::RandomWalk, Method::Walk)];

/// The cheapest method within the accuracy asked for, and why, in a sentence.
fn choose(expected: &Expected, request: &Request) -> (Method, String) {
    if request.method != Method::Auto {
        return (request.method, "asked for".into());
    }
    if request.profile != ProfileChoice::Auto {
        return (Method::Bssrdf, format!("the profile {} is asked for", request.profile.name()));
    }
    let accuracy = f64::from(request.accuracy);
    let limit = percent(accuracy);
    let suits = |error: Option<f64>| error.is_some_and(|error| error <= accuracy);
    let diffuse = expectation(Method::Diffuse, expected.diffuse);
    let bssrdf = expectation(Method::Bssrdf, expected.bssrdf);
    if suits(expected.diffuse) {
        return (Method::Diffuse, format!("{diffuse}; {limit} is asked for"));
    }
    if suits(expected.bssrdf) {
        return (Method::Bssrdf, format!("{bssrdf}, {diffuse}; {limit} is asked for"));
    }
    match expected.walk {
        Ok(_) => (Method::Walk, format!("{bssrdf}; {limit} is asked for")),
        Err(obstacle) => {
            let reason =
                format!("{bssrdf}; {limit} is asked for, but the object cannot be walked in: {obstacle}");
            (Method::Bssrdf, reason)
        }
    }
}

fn expectation(method: Method, error: Option<f64>) -> String {
    let name = method.name();
    match error {
        Some(error) => format!("{name} is expected within {}", percent(error)),
        None => format!("no error of {name} is known here"),
    }
}

/// For people, to a tenth below ten per cent.
fn percent(share: f64) -> String {
    let digits = if share < 0.0995 { 1 } else { 0 };
    format!("{:.digits$} %", 100.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(method: Method, forces: &[(EffectKind, bool)]) -> Request {
        let forces = Forces::new(forces.iter().copied()).unwrap();
        Request { method, profile: ProfileChoice::Auto, accuracy: 0.02, forces }
    }

    fn decided(
        diffuse: Option<f64>,
        bssrdf: Option<f64>,
        walk: Result<f64, &'static str>,
    ) -> (Method, String) {
        let request = request(Method::Auto, &[]);
        decide(&Expected { diffuse, bssrdf, walk }, &request)
    }

    #[test]
    fn the_cheapest_that_suits_is_taken() {
        let walk = Ok(0.0);
        for (diffuse, bssrdf, method) in [
            (Some(0.01), Some(0.01), Method::Diffuse),
            (Some(0.03), Some(0.01), Method::Bssrdf),
            (Some(0.03), Some(0.03), Method::Walk),
            (None, None, Method::Walk),
            (None, Some(0.01), Method::Bssrdf),
            (Some(f64::NAN), Some(f64::NAN), Method::Walk),
        ] {
            assert_eq!(decided(diffuse, bssrdf, walk).0, method);
        }
    }

    #[test]
    fn where_nothing_suits_the_reason_says_so() {
        let (method, reason) = decided(None, Some(0.1234), Err("it is open"));
        assert_eq!(method, Method::Bssrdf);
        assert!(
            reason.contains("12 %") && reason.contains("2.0 %") && reason.contains("it is open"),
            "{reason}"
        );
    }

    #[test]
    fn a_method_that_is_switched_off_is_replaced() {
        use EffectKind::{AreaIntegral, RandomWalk, SubsurfaceScattering};
        let (closed, open) = (Ok(0.0), Err("it is open"));
        for (asked, walk, forces, method) in [
            (Method::Walk, closed, vec![(RandomWalk, false)], Method::Bssrdf),
            (Method::Walk, closed, vec![(RandomWalk, false), (AreaIntegral, false)], Method::Diffuse),
            (Method::Bssrdf, closed, vec![(AreaIntegral, false)], Method::Walk),
            (Method::Bssrdf, open, vec![(AreaIntegral, false)], Method::Diffuse),
            (Method::Bssrdf, closed, vec![(RandomWalk, false)], Method::Bssrdf),
            (Method::Auto, closed, vec![(RandomWalk, false)], Method::Bssrdf),
            (Method::Auto, closed, vec![(SubsurfaceScattering, false)], Method::Diffuse),
            (Method::Diffuse, open, vec![(RandomWalk, true)], Method::Walk),
            (Method::Walk, closed, vec![(AreaIntegral, true)], Method::Bssrdf),
        ] {
            let expected = Expected { diffuse: None, bssrdf: None, walk };
            let (found, reason) = decide(&expected, &request(asked, &forces));
            assert_eq!(found, method, "{asked:?} {forces:?}: {reason}");
        }
    }

    #[test]
    fn what_is_asked_for_is_done() {
        for (_, method) in Method::NAMES.into_iter().filter(|(_, method)| *method != Method::Auto) {
            let request = request(method, &[]);
            let expected = Expected { diffuse: None, bssrdf: None, walk: Err("") };
            assert_eq!(decide(&expected, &request).0, method);
        }
    }
}

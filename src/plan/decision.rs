//! Which method a body gets.

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
}

impl From<&SubsurfaceSettings> for Request {
    fn from(settings: &SubsurfaceSettings) -> Self {
        Self { method: settings.method, profile: settings.profile, accuracy: settings.accuracy }
    }
}

/// The cheapest method within the accuracy asked for, and why, in a sentence.
pub fn decide(expected: &Expected, request: &Request) -> (Method, String) {
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

    fn decided(
        diffuse: Option<f64>,
        bssrdf: Option<f64>,
        walk: Result<f64, &'static str>,
    ) -> (Method, String) {
        let request = Request { method: Method::Auto, profile: ProfileChoice::Auto, accuracy: 0.02 };
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
    fn what_is_asked_for_is_done() {
        for (_, method) in Method::NAMES.into_iter().filter(|(_, method)| *method != Method::Auto) {
            let request = Request { method, profile: ProfileChoice::Auto, accuracy: 0.02 };
            let expected = Expected { diffuse: None, bssrdf: None, walk: Err("") };
            assert_eq!(decide(&expected, &request).0, method);
        }
    }
}

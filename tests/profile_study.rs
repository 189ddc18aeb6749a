//! Studies of profiles: models beside Monte Carlo, slabs, sweeps and fits.

#[path = "common/csv.rs"]
mod csv;

use std::sync::atomic::AtomicBool;

use alabaster::diffusion::integrate::energy_between;
use alabaster::diffusion::{DiffusionModel, HalfSpace, Multipole, PhotonBeam};
use alabaster::medium::{Entry, PlaneParallel};
use alabaster::slab::{Layer, LayerStack};
use alabaster::study::profile::fit::{FitError, FitModel, Fitted, fit};
use alabaster::study::profile::measured::MeasuredPoint;
use alabaster::study::profile::models::TabulatedModel;
use alabaster::study::profile::sweep::{self, Parameter};
use alabaster::study::profile::{
    ChannelResult, Coefficients, Effort, FitProblem, Material, MaterialError, MeasuredProfile, ModelChoice,
    Settings, Sweep, Watch, compare, figures, tables,
};
use csv::fields;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

/// One row a configuration and model; lengths in mean free paths, four digits of errors.
const ERRORS: &str = include_str!("data/model_vs_mc_searchlight.csv");

fn never() -> &'static AtomicBool {
    static NEVER: AtomicBool = AtomicBool::new(false);
    &NEVER
}

fn watch() -> Watch<'static> {
    Watch { advance: &|_| {}, stop: never() }
}

fn settings(entry: Entry, photons: u64) -> Settings {
    Settings { entry, models: None, effort: Effort { photons, seed: 7 } }
}

fn half_space(sigma_a: f64, sigma_s: f64, g: f64, eta: f64) -> Material {
    let list = |value| vec![value];
    let coefficients =
        Coefficients { sigma_a: list(sigma_a), sigma_s: list(sigma_s), g: list(g), eta: list(eta) };
    Material::of_coefficients("test", &coefficients).unwrap()
}

fn study(material: &Material, settings: &Settings) -> Vec<ChannelResult> {
    compare(material, settings, watch()).unwrap().unwrap()
}

/// The published errors are against another Monte Carlo. The noise of ours adds Σ|noise|/Σ truth at most, in the mean
/// what `noise` says; the sum of 60 terms stays below twice that. The error of Σ truth counts as often as the L1 error
/// does. Published digits end at 10⁻⁴, their rule at 2·10⁻⁴.
#[test]
fn l1_errors_are_the_published_ones() {
    let names = [
        ("classic dipole", "dipole"),
        ("better dipole", "better-dipole"),
        ("directional dipole (normal inc.)", "directional-dipole"),
        ("PBD MS (kappa) + SS", "photon-beam"),
        ("Burley searchlight (A=exact, mfp)", "normalized-diffusion-searchlight"),
        ("Burley diffuse-surface", "normalized-diffusion-diffuse"),
    ];
    let rows: Vec<Vec<String>> = ERRORS.lines().skip(2).map(fields).collect();
    let number = |text: &str| text.parse::<f64>().unwrap();
    let mut checked = 0;
    for (configuration, entry) in
        [("A", Entry::Normal), ("D", Entry::Normal), ("B", Entry::Normal), ("E", Entry::Diffuse)]
    {
        let rows: Vec<_> = rows.iter().filter(|row| row[0] == configuration).collect();
        let (omega, eta) = (number(&rows[0][1]), number(&rows[0][3]));
        // In 1/m of a thing of millimetres, so that a unit that is lost shows.
        let material = half_space(1e3 * (1.0 - omega), 1e3 * omega, 0.0, eta);
        let settings = Settings { models: Some(ModelChoice::ALL.to_vec()), ..settings(entry, 200_000) };
        let result = study(&material, &settings).remove(0);
        let total = result.truth.total();
        for row in rows {
            let known = names.iter().find(|(published, _)| *published == row[5]);
            // The published dipole has a fit of the boundary in it, unless indices match.
            let Some((_, name)) = known.filter(|(_, name)| *name != "dipole" || eta == 1.0) else { continue };
            let l1 = result.models.iter().find(|model| model.choice.name() == *name).unwrap().l1;
            let tolerance = 2.0 * result.noise + 3.0 * l1 * total.standard_error / total.value + 3e-4;
            assert!((l1 - number(&row[8])).abs() < tolerance, "{row:?}: {l1} ± {tolerance}");
            checked += 1;
        }
    }
    assert_eq!(checked, 6 + 6 + 5 + 2);
}

#[test]
fn truth_has_the_exact_albedo() {
    for entry in [Entry::Normal, Entry::Diffuse] {
        for (sigma_a, sigma_s, g, eta) in [(0.1, 0.9, 0.0, 1.5), (1.0, 1.0, 0.8, 1.33), (0.3, 0.7, 0.0, 0.8)]
        {
            let material = half_space(sigma_a, sigma_s, g, eta);
            let result = study(&material, &settings(entry, 100_000)).remove(0);
            let (total, exact) = (result.truth.total(), result.exact_albedo.unwrap());
            let error = total.value - exact;
            // 10⁻⁵: the accuracy of the exact one.
            assert!(error.abs() < 3.0 * total.standard_error + 1e-5, "{entry:?} {material:?}: {error}");
            assert!(total.standard_error < 0.02 * exact);
        }
    }
}

/// Distance of both distributions: interpolation between six knots a decade was seen to leave 4·10⁻⁵ at most.
#[test]
fn what_is_drawn_is_distributed_as_the_model() {
    let material = half_space(20.0, 1000.0, 0.0, 1.4);
    let all = Settings { models: Some(ModelChoice::ALL.to_vec()), ..settings(Entry::Diffuse, 2_000) };
    for model in &study(&material, &all)[0].models {
        assert!(model.cost.sampling_error < 1e-4, "{}: {}", model.choice.name(), model.cost.sampling_error);
        assert!(model.cost.seconds_per_evaluation > 0.0 && model.cost.seconds_per_sample > 0.0);
    }
}

#[test]
fn photons_are_the_same_on_any_number_of_threads() {
    let material = Material::measured("marble", 1.0, &[0.0], None).unwrap();
    let settings = Settings { models: Some(vec![]), ..settings(Entry::Normal, 3_000) };
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| study(&material, &settings))
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn nothing_comes_of_a_study_that_is_stopped_at_once() {
    let watch = Watch { advance: &|_| {}, stop: &AtomicBool::new(true) };
    let settings = settings(Entry::Normal, 1_000);
    assert_eq!(compare(&half_space(1.0, 9.0, 0.0, 1.4), &settings, watch).unwrap(), None);
}

fn slab_of(thickness: f64, ior_below: f64) -> Result<Material, MaterialError> {
    let layer = Layer { ior: 1.4, sigma_a: 0.2, sigma_s: 10.0, g: 0.3, thickness };
    Material::of_layer("slab", &LayerStack::new(1.0, vec![layer], ior_below).unwrap(), 1e-2)
}

#[test]
fn slabs_reflect_and_transmit_the_exact_shares() {
    let material = slab_of(0.5, 1.0).unwrap();
    assert_eq!(material.thickness, Some(0.005));
    for entry in [Entry::Normal, Entry::Diffuse] {
        let results = study(&material, &settings(entry, 40_000));
        assert_eq!(results.len(), 2);
        let layer = PlaneParallel::new(1.4, 0.3);
        let (reflected, transmitted) = layer.slab(0.2 / 10.2, 5.1).reflectance_and_transmittance(entry);
        let exact: Vec<f64> = results.iter().map(|result| result.exact_albedo.unwrap()).collect();
        // Both are shares of what entered: their ratio is that of the shares on the surface, without what is
        // reflected there.
        assert!((exact[1] / transmitted - (1.0 - exact[0]) / (1.0 - reflected)).abs() < 1e-12);
        for (result, exact) in results.iter().zip(&exact) {
            let total = result.truth.total();
            let error = total.value - exact;
            // 10⁻⁵: the accuracy of the exact one.
            assert!(
                error.abs() < 3.0 * total.standard_error + 1e-5,
                "{entry:?} {:?}: {error}",
                result.quantity
            );
        }
        let multipole = Multipole::new(&HalfSpace::new(20.0, 1000.0, 0.3, 1.4).unwrap(), 0.005).unwrap();
        for (result, albedo) in results.iter().zip([multipole.albedo(), multipole.total_transmittance()]) {
            // A dozen roundings.
            assert!((result.models[0].albedo / albedo - 1.0).abs() < 1e-13);
        }
    }
}

#[test]
fn layers_are_taken_for_what_they_are() {
    let thick = slab_of(1e8, 1.4).unwrap();
    assert_eq!((thick.thickness, thick.notes.len()), (None, 1));
    let medium = thick.channels[0].medium;
    assert!((medium.sigma_s / 1000.0 - 1.0).abs() < 1e-15 && (medium.sigma_a / 20.0 - 1.0).abs() < 1e-15);
    assert!(matches!(slab_of(0.5, 1.4), Err(MaterialError::Surroundings { .. })));
    let layer = Layer { ior: 1.4, sigma_a: 0.2, sigma_s: 10.0, g: 0.3, thickness: 1.0 };
    let two = LayerStack::new(1.0, vec![layer; 2], 1.0).unwrap();
    assert_eq!(Material::of_layer("two", &two, 1e-2), Err(MaterialError::Layers(2)));
    // A slab thinner than a reduced mean free path: the multipole says why it is left out.
    let thin = study(&slab_of(0.05, 1.0).unwrap(), &settings(Entry::Normal, 1_000));
    assert!(
        thin[0].models.is_empty() && thin[0].left_out[0].1.to_string().contains("diffusion does not hold")
    );
}

#[test]
fn impossible_materials_are_refused_by_field() {
    let coefficients = |sigma_a: &[f64], g: f64| {
        let (g, eta) = (vec![g], vec![1.4]);
        Material::of_coefficients(
            "test",
            &Coefficients { sigma_a: sigma_a.to_vec(), sigma_s: vec![1.0], g, eta },
        )
    };
    let albedo = |albedo, length| Material::of_albedo(&[albedo], &[length], &[0.0], &[1.4], Entry::Normal);
    let cases = [
        (coefficients(&[-1.0], 0.0), "channel all: sigma_a is -1"),
        (coefficients(&[1.0, f64::NAN, 1.0], 0.0), "channel green: sigma_a is NaN"),
        (coefficients(&[1.0, 2.0], 0.0), "sigma_a has 2 values"),
        (coefficients(&[1.0], 1.0), "channel all: g is 1"),
        (albedo(1.5, 1e-3), "albedo is 1.5"),
        (albedo(f64::NAN, 1e-3), "albedo is NaN"),
        (albedo(0.5, 0.0), "mean_free_path is 0"),
        (albedo(0.0, 1e-3), "sigma_s is 0 in every channel"),
        (
            Material::measured("marbel", 1.0, &[0.0], None),
            "there is no measured material `marbel`; did you mean `Marble`?",
        ),
        (Material::measured("marble", -1.0, &[0.0], None), "density is -1"),
        (Material::measured("marble", 1.0, &[1.0], None), "channel red: g is 1"),
    ];
    for (result, message) in cases {
        let error = result.unwrap_err().to_string();
        assert!(error.starts_with(message), "{error}");
    }
    let merlot = Material::measured("merlot", 1.0, &[0.0], None).unwrap();
    assert_eq!((merlot.channels.len(), merlot.notes.len()), (1, 2));
}

#[test]
fn a_wanted_albedo_is_met() {
    for entry in [Entry::Normal, Entry::Diffuse] {
        let material = Material::of_albedo(&[0.3, 0.7, 1.0], &[1e-3], &[0.5], &[1.4], entry).unwrap();
        for (channel, albedo) in material.channels.iter().zip([0.3, 0.7, 1.0]) {
            let medium = channel.medium;
            // A few roundings; the inversion states 10⁻⁹.
            assert!((medium.sigma_t() * 1e-3 - 1.0).abs() < 1e-15);
            let found =
                PlaneParallel::new(1.4, 0.5).half_space(medium.sigma_a / medium.sigma_t()).albedo(entry);
            assert!((found - albedo).abs() < 1e-9, "{found}");
        }
    }
}

#[test]
fn a_sweep_of_albedos_is_many_studies_in_one_walk() {
    let base = HalfSpace::new(0.5, 0.5, 0.0, 1.3).unwrap();
    let sweep: Sweep = "albedo=0.5:0.9:3".parse().unwrap();
    assert_eq!((sweep.parameter, sweep.values()), (Parameter::Albedo, vec![0.5, 0.7, 0.9]));
    let settings = settings(Entry::Normal, 4_000);
    let points = sweep::run(&sweep, &base, &settings, watch()).unwrap();
    for point in &points {
        let alone = &study(&half_space(1.0 - point.value, point.value, 0.0, 1.3), &settings)[0];
        // The same photons; the share absorbed is rounded in another way.
        for (a, b) in point.result.truth.flux.iter().zip(&alone.truth.flux) {
            assert!((a.value - b.value).abs() <= 1e-12 * b.value, "{a:?} {b:?}");
        }
    }
    let csv = sweep::csv(&sweep, &points);
    assert_eq!(csv.lines().count(), 1 + 3 * ModelChoice::USUAL.len());
    assert!(sweep::figure(&sweep, &points).unwrap().contains("reduced single-scattering albedo"));
}

#[test]
fn sweeps_that_cannot_be_are_refused() {
    let cases = [
        ("roughness=0:1:3", "`roughness=0:1:3` is no sweep; write albedo=0.5:1:11"),
        ("albedo=0:1", "`albedo=0:1` is no sweep"),
        ("albedo=0:1:3", "albedo from 0 to 1: values must be above 0"),
        ("albedo=0.5:1.1:3", "albedo from 0.5 to 1.1"),
        ("g=0:1:3", "g from 0 to 1: values must be between -1 and 1"),
        ("g=NaN:0.5:3", "g from NaN to 0.5"),
        ("ior=0:2:3", "ior from 0 to 2: values must be above 0"),
        ("ior=1:2:1", "1 values; give 2 to"),
    ];
    for (text, message) in cases {
        let error = text.parse::<Sweep>().unwrap_err().to_string();
        assert!(error.starts_with(message), "{error}");
    }
}

/// A measurement of `model` at 24 radii, with a relative error of `noise`, in units of `unit`.
fn measurement(model: &dyn DiffusionModel, noise: f64, unit: f64, random: &mut Pcg64) -> MeasuredProfile {
    let points = (0..24).map(|i| {
        let radius = 1e-4 * 10.0_f64.powf(f64::from(i) / 11.0);
        let value = model.reflectance(radius) * unit;
        let normal: f64 = random.sample(StandardNormal);
        MeasuredPoint { radius, reflectance: value * (noise * normal).exp(), sigma: Some(noise * value) }
    });
    MeasuredProfile { points: points.collect(), absolute: unit == 1.0 }
}

/// Known coefficients with noise come back within their errors: of 2 · 8 · 2 · 2 values and more, none is farther off than
/// 4σ (the chance of which is below 1 %), and χ² over all is within 4σ of its degrees of freedom.
#[test]
fn fits_recover_coefficients_within_their_errors() {
    let (g, eta, entry) = (0.0, 1.4, Entry::Normal);
    let medium = HalfSpace::new(20.0, 1500.0, g, eta).unwrap();
    let albedo = PlaneParallel::new(eta, g).half_space(medium.sigma_a / medium.sigma_t()).albedo(entry);
    let models: [(FitModel, Box<dyn DiffusionModel>); 2] = [
        (FitModel::PhotonBeam, Box::new(PhotonBeam::new(&medium))),
        (FitModel::Tabulated, Box::new(TabulatedModel::new(&medium, entry, albedo).unwrap())),
    ];
    let mut random = Pcg64::seed_from_u64(5);
    for (model, curve) in models {
        let problem = FitProblem { entry, eta, g, model };
        for unit in [1.0, 1e-4] {
            let (mut chi_squared, mut degrees) = (0.0, 0);
            for _ in 0..8 {
                let measured = measurement(&*curve, 0.02, unit, &mut random);
                let found = fit(&problem, &measured).unwrap();
                let near = |fitted: Fitted, truth: f64| (fitted.value - truth).abs() < 4.0 * fitted.stderr;
                assert!(near(found.sigma_s_reduced, 1500.0) && near(found.sigma_a, 20.0), "{found:?}");
                assert!(found.sigma_s_reduced.stderr < 200.0 && found.correlation.abs() < 1.0);
                assert_eq!(found.scale.is_some(), unit != 1.0);
                assert!(found.scale.is_none_or(|scale| near(scale, unit)), "{found:?}");
                chi_squared += found.chi_squared;
                degrees += found.degrees;
            }
            let degrees = degrees as f64;
            assert!(
                (chi_squared - degrees).abs() < 4.0 * (2.0 * degrees).sqrt(),
                "{model:?} {unit}: {chi_squared}"
            );
        }
    }
}

#[test]
fn fits_without_errors_take_them_from_the_scatter() {
    let problem = FitProblem { entry: Entry::Normal, eta: 1.4, g: 0.0, model: FitModel::PhotonBeam };
    let medium = HalfSpace::new(20.0, 1500.0, 0.0, 1.4).unwrap();
    let mut random = Pcg64::seed_from_u64(6);
    let mut measured = measurement(&PhotonBeam::new(&medium), 0.02, 1.0, &mut random);
    let known = fit(&problem, &measured).unwrap();
    measured.points.iter_mut().for_each(|point| point.sigma = None);
    let found = fit(&problem, &measured).unwrap();
    assert!(!found.weighted && known.weighted);
    // The scatter of 22 degrees of freedom is known to 1/√44 = 15 %.
    let ratio = found.sigma_a.stderr / known.sigma_a.stderr;
    assert!((0.5..1.5).contains(&ratio), "{ratio}");
    measured.points.truncate(2);
    assert_eq!(fit(&problem, &measured), Err(FitError::TooFew { points: 2, parameters: 2 }));
}

#[test]
fn tables_hold_what_the_models_say() {
    let material = Material::measured("marble", 1.0, &[0.0], None).unwrap();
    let results = study(&material, &settings(Entry::Normal, 2_000));
    let csv = tables::profiles(&results);
    let heading: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let column = |name: &str| heading.iter().position(|field| *field == name).unwrap();
    let beam = PhotonBeam::new(&material.channels[1].medium);
    let mut rows = 0;
    for line in csv.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), heading.len());
        let number = |name| fields[column(name)].parse::<f64>().unwrap();
        if (fields[0], fields[column("model")]) != ("green", "photon-beam") {
            continue;
        }
        rows += 1;
        // In metres, by an integral of its own.
        let (from, to) = (1e-3 * number("radius_from_mm"), 1e-3 * number("radius_to_mm"));
        let area = std::f64::consts::PI * (to - from) * (to + from);
        let expected = 1e-6 * energy_between(&beam, from, to) / area;
        // Seven digits of both radii, of which a ring of a twelfth of a decade is a fifth.
        assert!((number("r_per_mm2") / expected - 1.0).abs() < 4e-6, "{line}");
        let product = number("radius_mm") * number("r_per_mm2");
        assert!((number("radius_times_r_per_mm") / product - 1.0).abs() < 1e-6);
    }
    assert_eq!(rows, 60);
    assert_eq!(tables::errors(&results).lines().count(), 1 + 3 * ModelChoice::USUAL.len());
    for (name, svg) in figures::figures(&results).unwrap() {
        assert!(svg.contains("radius r [mm]") && svg.contains("red: mean free path"), "{name}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name}");
    }
}

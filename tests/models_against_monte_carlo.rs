//! x
use alabaster::diffusion::integrate::*;
use alabaster::diffusion::photon_beam::*;
use alabaster::diffusion::*;

fn fields(line: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut q = false;
    for c in line.chars() {
        match c {
            '"' => q = !q,
            ',' if !q => out.push(String::new()),
            c => out.last_mut().unwrap().push(c),
        }
    }
    out
}

#[test]
fn explore() {
    let table = include_str!("data/model_vs_mc_searchlight.csv");
    let radial = include_str!("data/radial_searchlight_mc.csv");
    for line in table.lines().skip(2) {
        let f = fields(line);
        let n = |i: usize| f[i].parse::<f64>().unwrap();
        let (omega, eta) = (n(1), n(3));
        let hs = HalfSpace::new(1.0 - omega, omega, 0.0, eta).unwrap();
        let exact = match f[0].as_str() { "A" => 0.41495, "D" => 0.11523, "B" => 0.22908, _ => 0.4780262 };
        let model: Box<dyn DiffusionModel> = match f[5].as_str() {
            "classic dipole" => Box::new(Dipole::new(&hs)),
            "better dipole" => Box::new(BetterDipole::new(&hs)),
            "directional dipole (normal inc.)" => Box::new(DirectionalDipole::new(&hs)),
            "PBD MS (kappa) + SS" => Box::new(PhotonBeam::new(&hs)),
            "PBD MS only" => Box::new(BeamMultipleScattering::new(&hs)),
            "Burley searchlight (A=exact, mfp)" => Box::new(NormalizedDiffusionModel::new(Fit::Searchlight, exact, 1.0)),
            _ => Box::new(NormalizedDiffusionModel::new(Fit::DiffuseTransmission, exact, 1.0)),
        };
        let norm = if f[0] == "B" { 0.96 } else { 1.0 };
        let (mut l1, mut total, mut mt) = (0.0, 0.0, 0.0);
        let mut band = [[0.0; 2]; 4];
        for row in radial.lines().filter(|l| l.starts_with(&f[0]) && !l.contains('#')) {
            let r = fields(row);
            let (r0, r1, flux) = (r[2].parse::<f64>().unwrap(), r[3].parse::<f64>().unwrap(), r[4].parse::<f64>().unwrap() / norm);
            if r0 < 1e-3 || r0 >= 100.0 { continue; }
            let h = (r1 - r0) / 8.0;
            let m: f64 = (0..=8).map(|i| { let r = r0 + h * i as f64; (if i == 0 || i == 8 { 0.5 } else { 1.0 }) * h * 2.0 * 3.141592653589793 * r * model.reflectance(r) }).sum();
            l1 += (m - flux).abs();
            total += flux;
            mt += m;
            let b = if r1 < 0.0999 { 0 } else if r1 < 0.1001 {3} else if r1 < 1.001 { 1 } else if r1 < 10.01 { 2 } else { 3 };
            band[b][0] += m;
            band[b][1] += flux;
        }
        let e: Vec<f64> = band.iter().map(|b| b[0] / b[1] - 1.0).collect();
        println!("{} {}: albedo {:.5} sum {:.5} table {} | L1 {:.4} {} | {:.4} {} {:.4} {} {:.4} {}", f[0], f[5], model.albedo(), mt, f[6], l1 / total, f[8], e[0], f[10], e[1], f[11], e[2], f[12]);
    }
    for line in include_str!("data/model_albedo_vs_exact.csv").lines().skip(2) {
        let f = fields(line);
        let n = |i: usize| f[i].parse::<f64>().unwrap();
        let hs = HalfSpace::new(1.0 - n(0), n(0), 0.0, n(1)).unwrap();
        let v = [Dipole::new(&hs).albedo(), BetterDipole::new(&hs).albedo(), BeamMultipleScattering::new(&hs).albedo(), BeamSingleScattering::new(&hs).albedo(), PhotonBeam::new(&hs).albedo(), DirectionalDipole::new(&hs).albedo()];
        let s: Vec<String> = v.iter().enumerate().map(|(i, v)| format!("{:+.1}", (v - n(3 + i)) * 1e5)).collect();
        println!("{} {} {:?}", n(0), n(1), s);
    }
    let hs = HalfSpace::new(0.1, 0.9, 0.0, 1.5).unwrap();
    let pb = PhotonBeam::new(&hs);
    let t = std::time::Instant::now();
    let s: f64 = (0..100000).map(|i| pb.reflectance(1e-3 * 1.0001f64.powi(i))).sum();
    println!("{s} {:?}", t.elapsed() / 100000);
    let t = std::time::Instant::now();
    let s: f64 = (0..100000).map(|i| pb.multiple.reflectance(1e-3 * 1.0001f64.powi(i))).sum();
    println!("{s} {:?}", t.elapsed() / 100000);
}

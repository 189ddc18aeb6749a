//! The committed meshes of `scenes/`: made by the committed generator, closed, oriented, shaded alike.

#[path = "../examples/make_scenes/candle.rs"]
mod candle;
#[path = "../examples/make_scenes/distance.rs"]
mod distance;
#[path = "../examples/make_scenes/glb.rs"]
mod glb;
#[path = "../examples/make_scenes/models.rs"]
mod models;
#[path = "../examples/make_scenes/polygonise.rs"]
mod polygonise;
#[path = "../examples/make_scenes/remesh.rs"]
mod remesh;
#[path = "../examples/make_scenes/revolve.rs"]
mod revolve;
#[path = "../examples/make_scenes/soap.rs"]
mod soap;
#[path = "../examples/make_scenes/swan.rs"]
mod swan;
#[path = "../examples/make_scenes/turned.rs"]
mod turned;
#[path = "../examples/make_scenes/wood.rs"]
mod wood;

use std::collections::HashSet;
use std::path::PathBuf;

use alabaster::scene::{Mesh, read_scene};
use glam::{DVec3, Vec3};

fn scenes() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

/// The mesh of a committed file.
fn committed(name: &str) -> Mesh {
    let mut scene = read_scene(&scenes().join(name)).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(scene.meshes.len(), 1, "{name}");
    scene.meshes.remove(0)
}

/// Every mesh but the table, which is a sheet.
fn bodies() -> impl Iterator<Item = (&'static str, Mesh)> {
    let names = models::RECIPES.iter().map(|&(name, _)| name).filter(|&name| name != "table.glb");
    names.map(|name| (name, committed(name)))
}

fn corners(mesh: &Mesh, triangle: [u32; 3]) -> [DVec3; 3] {
    triangle.map(|v| mesh.positions[v as usize].as_dvec3())
}

#[test]
fn the_generator_makes_the_committed_files() {
    for (name, make) in models::RECIPES {
        let made = make().unwrap_or_else(|e| panic!("{name}: {e}"));
        let kept = std::fs::read(scenes().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(made == kept, "{name}: run `cargo run --release --example make_scenes -- scenes/`");
    }
}

#[test]
fn all_files_together_stay_under_four_megabytes() {
    let files = std::fs::read_dir(scenes()).unwrap_or_else(|e| panic!("{e}"));
    let total: u64 = files.flatten().filter_map(|file| file.metadata().ok()).map(|data| data.len()).sum();
    assert!(total > 1_000_000 && total <= 4_000_000, "{total} bytes");
}

/// Each directed edge belongs to exactly one triangle, and its reverse to another: the surface is
/// closed, oriented alike everywhere, and no edge has more than two triangles.
#[test]
fn bodies_are_closed_manifolds() {
    for (name, mesh) in bodies() {
        let mut directed = HashSet::new();
        for [a, b, c] in &mesh.triangles {
            for edge in [(a, b), (b, c), (c, a)] {
                assert!(directed.insert(edge), "{name}: edge {edge:?} twice in the same direction");
            }
        }
        let open = directed.iter().filter(|(a, b)| !directed.contains(&(b, a))).count();
        assert_eq!(open, 0, "{name}: open edges");
    }
}

/// A vertex's triangles form a single fan: walking from triangle to triangle around it meets all.
#[test]
fn vertices_have_a_single_fan() {
    for (name, mesh) in bodies() {
        let mut next = vec![Vec::new(); mesh.positions.len()];
        for &[a, b, c] in &mesh.triangles {
            for [v, from, to] in [[a, b, c], [b, c, a], [c, a, b]] {
                next[v as usize].push((from, to));
            }
        }
        for (v, links) in next.iter().enumerate() {
            let Some(&(start, mut at)) = links.first() else { panic!("{name}: vertex {v} is unused") };
            let mut steps = 1;
            while at != start && steps <= links.len() {
                let Some(link) = links.iter().find(|link| link.0 == at) else { break };
                at = link.1;
                steps += 1;
            }
            assert_eq!(steps, links.len(), "{name}: triangles around vertex {v}");
        }
    }
}

#[test]
fn bodies_are_oriented_outwards() {
    for (name, mesh) in bodies() {
        let volume = |&triangle: &[u32; 3]| {
            let [a, b, c] = corners(&mesh, triangle);
            a.dot(b.cross(c)) / 6.0
        };
        let volume: f64 = mesh.triangles.iter().map(volume).sum();
        // From the wick's 0.05 cm³ to the milk's 300 cm³.
        assert!(volume > 1e-8 && volume < 1e-3, "{name}: {volume} m³");
    }
}

/// No triangle is so thin that its plane is lost in the rounding of its corners: its height over
/// its longest edge is at least 1 µm, against f32 steps of 15 nm at 20 cm from the origin.
#[test]
fn triangles_have_a_plane() {
    for (name, mesh) in bodies() {
        for &triangle in &mesh.triangles {
            let [a, b, c] = corners(&mesh, triangle);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            let height = (b - a).cross(c - a).length() / longest;
            assert!(height > 1e-6, "{name}: {triangle:?} is {height} m high at {a}");
        }
    }
}

/// Vertex normals are unit vectors to the rounding of three squares (4 ulps), and on the outer side
/// of every triangle they shade.
#[test]
fn normals_are_unit_and_outward() {
    for (name, mesh) in bodies() {
        let unit = |n: &Vec3| (n.as_dvec3().length() - 1.0).abs() < 4.0 * f64::from(f32::EPSILON);
        assert!(mesh.normals.iter().all(unit), "{name}");
        for &triangle in &mesh.triangles {
            let [a, b, c] = corners(&mesh, triangle);
            let geometric = (b - a).cross(c - a);
            for v in triangle {
                let normal = mesh.normals[v as usize].as_dvec3();
                assert!(normal.dot(geometric) > 0.0, "{name}: vertex {v} of {triangle:?} at {a}");
            }
        }
    }
}

#[test]
fn every_scene_file_is_read_without_warning() {
    let files = std::fs::read_dir(scenes()).unwrap_or_else(|e| panic!("{e}"));
    let scenes =
        files.flatten().map(|file| file.path()).filter(|path| path.extension().is_some_and(|e| e == "toml"));
    let mut count = 0;
    for path in scenes {
        let scene = read_scene(&path).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(scene.warnings, Vec::<String>::new(), "{}", path.display());
        count += 1;
    }
    assert!(count >= 4, "{count} scenes");
}

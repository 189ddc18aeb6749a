//! Real files, where they are at hand.

use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::time::Duration;

use alabaster::scene::{GltfScene, ScatteringInput, SceneError, Surface, read_gltf};

use crate::common_assets::{assets, files};

/// Every `.gltf` and `.glb` in `folder` and below, in a fixed order.
fn scenes(folder: &Path) -> Vec<PathBuf> {
    files(folder, &["gltf", "glb"])
}

/// Reads in a thread of its own, which must come back within ten seconds.
fn read_in_time(path: &Path) -> Result<GltfScene, SceneError> {
    let (sender, receiver) = mpsc::channel();
    let owned = path.to_path_buf();
    std::thread::spawn(move || {
        // Nobody listens any more only if the test has failed by then.
        let _ = sender.send(read_gltf(&owned));
    });
    receiver
        .recv_timeout(Duration::from_secs(10))
        .unwrap_or_else(|error| panic!("{}: {error}: hung or panicked", path.display()))
}

fn triangles(read: &GltfScene) -> usize {
    read.scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum()
}

#[test]
fn scans_have_their_triangles() {
    let Some(assets) = assets() else { return };
    let counts = [
        ("skull-100k.glb", 100_002, 0),
        ("leeperrysmith-head-textured.glb", 70_736, 2),
        ("nefertiti-70k.glb", 70_000, 0),
        ("UtahTeapot.glb", 992, 0),
    ];
    for (name, count, images) in counts {
        let read = read_in_time(&assets.join("meshes").join(name)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((triangles(&read), read.scene.images.len()), (count, images), "{name}");
        assert_eq!(read.scene.meshes.len(), 1, "{name}");
        assert_eq!(read.scene.warnings, [""; 0], "{name}");
        assert!(read.scene.meshes[0].normals.iter().all(|normal| normal.is_normalized()), "{name}");
    }
}

#[test]
fn khronos_samples_are_read() {
    let Some(assets) = assets() else { return };
    for path in scenes(&assets.join("khronos")) {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let read = read_in_time(&path);
        if name == "IridescenceSuzanne.glb" {
            // It requires an extension that is not supported, so it must be refused by name.
            let error = read.expect_err("requires iridescence");
            assert!(error.problem.contains("KHR_materials_iridescence"), "{error}");
            continue;
        }
        let read = read.unwrap_or_else(|error| panic!("{error}"));
        let count = match name.as_str() {
            "BoxInterleaved.glb" | "SimpleSparseAccessor.gltf" => 12,
            "AttenuationTest.glb" => 232,
            "GlassHurricaneCandleHolder.glb" => 4_126,
            "TransmissionTest.glb" => 128_775,
            other => panic!("{other}: how many triangles should it have?"),
        };
        assert_eq!(triangles(&read), count, "{name}");
        let camera = name == "TransmissionTest.glb";
        assert_eq!(read.camera.is_some(), camera, "{name}");
    }
}

#[test]
fn samples_of_scattering_are_translucent() {
    let Some(assets) = assets() else { return };
    let read = read_in_time(&assets.join("gltf-scatter/ExtVolumeScatterDiffuseTransmission.gltf"));
    let read = read.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(triangles(&read), 12);
    let medium = match &read.scene.materials[0].surface {
        Surface::Translucent { medium: ScatteringInput::Albedo { albedo, mean_free_path, .. }, .. } => {
            (albedo.factor.0, albedo.texture, mean_free_path[0])
        }
        other => panic!("{other:?}"),
    };
    assert_eq!(medium, ([0.5, 0.7, 0.9], Some(0), -1.0 / 0.8f32.ln()));
}

#[test]
fn broken_files_come_back_with_a_scene_or_one_message() {
    let Some(assets) = assets() else { return };
    for path in scenes(&assets.join("bad")) {
        match read_in_time(&path) {
            Ok(read) => {
                println!("{}: {} triangles", path.display(), triangles(&read));
                assert!(triangles(&read) > 0);
            }
            Err(error) => {
                println!("{error}");
                assert_eq!(error.file, path);
            }
        }
    }
}

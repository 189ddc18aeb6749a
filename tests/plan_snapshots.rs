//! The plan of every scene in `scenes/`, as `alabaster plan` prints it, is the one in `tests/data/plans/`.
//!
//! After a change that is meant to change plans: `ALABASTER_WRITE_SNAPSHOTS=1 cargo test --release --test plan_snapshots` writes them anew, and the
//! difference shows what has changed.

#[path = "common/program.rs"]
#[allow(dead_code)]
mod program;

use std::fs;
use std::path::Path;
use std::time::Duration;

use program::run_within;

/// As the scene says, and what the program would choose.
const ARGUMENTS: [&[&str]; 2] = [&[], &["--method", "auto"]];

#[test]
fn plans_are_those_that_were_kept() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let names = program::names(&root.join("scenes"));
    let scenes: Vec<&String> = names.iter().filter(|name| name.ends_with(".toml")).collect();
    assert!(scenes.len() >= 7, "{scenes:?}");
    let mut different = Vec::new();
    for scene in scenes {
        let mut plans = String::new();
        for more in ARGUMENTS {
            let arguments = [&["plan", scene.as_str()], more].concat();
            let made =
                || run_within(Duration::from_secs(60), &root.join("scenes"), &arguments).ends_with(0).0;
            let plan = made();
            assert_eq!(plan, made(), "{arguments:?} is not the same twice");
            plans += &format!("$ alabaster {}\n{plan}\n", arguments.join(" "));
        }
        let kept = root.join("tests/data/plans").join(scene.replace(".toml", ".txt"));
        if std::env::var_os("ALABASTER_WRITE_SNAPSHOTS").is_some() {
            fs::create_dir_all(kept.parent().unwrap()).unwrap();
            fs::write(&kept, &plans).unwrap();
        }
        if fs::read_to_string(&kept).unwrap_or_default() != plans {
            different.push(plans);
        }
    }
    assert!(different.is_empty(), "not as kept:\n{}", different.join("\n"));
}

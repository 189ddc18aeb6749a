//! Output files are checked before the work and replaced whole or not at all.

#[path = "common/program.rs"]
#[allow(dead_code)]
mod program;

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use alabaster::film::output::{Format, OutputError, check_writable, replace};
use program::names;

#[test]
fn a_failed_write_leaves_the_old_file_whole_and_nothing_else() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("old.exr");
    fs::write(&path, "old").unwrap();
    let result = replace(&path, |file| {
        file.write_all(&vec![7; 1 << 20])?;
        Err(io::Error::new(io::ErrorKind::StorageFull, "no space left"))
    });
    assert!(matches!(result, Err(OutputError::Unwritable { .. })));
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(directory.path()), ["old.exr"]);
}

#[test]
fn a_write_that_panics_leaves_the_old_file_whole_and_nothing_else() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("old.exr");
    fs::write(&path, "old").unwrap();
    let result = std::panic::catch_unwind(|| replace(&path, |_| panic!("in the middle of the write")));
    assert!(result.is_err());
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(directory.path()), ["old.exr"]);
}

#[test]
fn a_write_replaces_the_whole_file() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("picture.png");
    fs::write(&path, "something longer than what comes").unwrap();
    replace(&path, |file| file.write_all(b"new")).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(names(directory.path()), ["picture.png"]);
}

#[test]
fn a_check_leaves_no_trace() {
    let directory = tempfile::tempdir().unwrap();
    let (old, new) = (directory.path().join("old.exr"), directory.path().join("new.exr"));
    fs::write(&old, "old").unwrap();
    check_writable(&old).unwrap();
    check_writable(&new).unwrap();
    assert_eq!(fs::read(&old).unwrap(), b"old");
    assert_eq!(names(directory.path()), ["old.exr"]);
}

#[test]
fn what_cannot_be_written_is_found_before() {
    let directory = tempfile::tempdir().unwrap();
    fs::write(directory.path().join("file"), "").unwrap();
    fs::create_dir(directory.path().join("directory.exr")).unwrap();
    for name in ["missing/out.exr", "file/out.exr", "directory.exr"] {
        let error = check_writable(&directory.path().join(name)).unwrap_err();
        assert!(matches!(&error, OutputError::Unwritable { path, .. } if path.ends_with(name)), "{error}");
    }
    assert_eq!(names(directory.path()), ["directory.exr", "file"]);
}

#[test]
fn endings_are_formats() {
    assert_eq!(Format::of(Path::new("a.b/c.EXR")).unwrap(), Format::Exr);
    assert_eq!(Format::of(Path::new("c.png")).unwrap(), Format::Png);
    for name in ["a.jpg", "exr", "a.exr.", "", ".png"] {
        assert!(matches!(Format::of(Path::new(name)), Err(OutputError::UnknownEnding(_))), "{name}");
    }
}

#[cfg(unix)]
mod unix {
    use std::os::unix::fs::{PermissionsExt, symlink};

    use super::*;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn permissions_are_those_of_any_new_file_or_of_the_file_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let (ordinary, written) = (directory.path().join("ordinary"), directory.path().join("a.exr"));
        fs::write(&ordinary, "").unwrap();
        replace(&written, |file| file.write_all(b"new")).unwrap();
        assert_eq!(mode(&written), mode(&ordinary));
        fs::set_permissions(&written, fs::Permissions::from_mode(0o640)).unwrap();
        replace(&written, |file| file.write_all(b"newer")).unwrap();
        assert_eq!(mode(&written), 0o640);
    }

    #[test]
    fn a_symbolic_link_stays_and_its_target_is_replaced() {
        let directory = tempfile::tempdir().unwrap();
        fs::create_dir(directory.path().join("store")).unwrap();
        let (target, link) = (directory.path().join("store/real.exr"), directory.path().join("link.exr"));
        fs::write(&target, "old").unwrap();
        symlink(&target, &link).unwrap();
        check_writable(&link).unwrap();
        replace(&link, |file| file.write_all(b"new")).unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read(&target).unwrap(), b"new");
        assert_eq!(names(&directory.path().join("store")), ["real.exr"]);
    }

    /// The superuser may write everywhere, so for him there is nothing to see; what he is refused
    /// (a directory that is none) is covered above.
    #[test]
    fn protection_against_writing_is_respected() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("kept.exr");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
        let superuser = fs::OpenOptions::new().write(true).open(&path).is_ok();
        assert_eq!(check_writable(&path).is_ok(), superuser);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o644)).unwrap();
        fs::set_permissions(directory.path(), fs::Permissions::from_mode(0o555)).unwrap();
        let superuser = fs::write(directory.path().join("probe"), "").is_ok();
        assert_eq!(check_writable(&path).is_ok(), superuser);
        fs::set_permissions(directory.path(), fs::Permissions::from_mode(0o755)).unwrap();
    }
}

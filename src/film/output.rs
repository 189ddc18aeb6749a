//! Output files: checked before the work, replaced whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use thiserror::Error;

/// Picture formats that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR, `.exr`.
    Exr,
    /// PNG, `.png`.
    Png,
}

/// Why a file cannot be written.
#[derive(Debug, Error)]
pub enum OutputError {
    /// The ending of the name is not that of a format.
    #[error("{}: pictures are written as .exr or .png; choose one of these endings", .0.display())]
    UnknownEnding(PathBuf),
    /// The machine refuses.
    #[error("{}: cannot be written: {problem}", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What is in the way.
        problem: io::Error,
    },
}

impl Format {
    /// The format that the ending of `path` stands for.
    pub fn of(path: &Path) -> Result<Self, OutputError> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match ending.as_str() {
            "exr" => Ok(Self::Exr),
            "png" => Ok(Self::Png),
            _ => Err(OutputError::UnknownEnding(path.to_path_buf())),
        }
    }
}

/// Finds out whether [`replace`] can be expected to succeed, by making a file in the same directory
/// and removing it. `path` itself is not touched.
pub fn check_writable(path: &Path) -> Result<(), OutputError> {
    let check = || {
        let target = resolve_links(path)?;
        if target.is_dir() {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a directory"));
        }
        let directory = directory_of(&target);
        if !directory.is_dir() {
            let problem = format!("there is no directory {}", directory.display());
            return Err(io::Error::new(io::ErrorKind::NotFound, problem));
        }
        // A file that is write-protected is not to be replaced either.
        if target.exists() {
            OpenOptions::new().write(true).open(&target)?;
        }
        temporary_beside(&target).map(drop)
    };
    check().map_err(|problem| OutputError::Unwritable { path: path.to_path_buf(), problem })
}

/// Replaces `path` by what `write` writes.
///
/// It is written to a temporary file in the same directory, brought to the disk, and renamed, so
/// that at every moment the old or the new file is there whole; on failure the old one stays. A file
/// that is replaced hands on its permissions; where `path` is a symbolic link, its target is replaced.
pub fn replace(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> Result<(), OutputError> {
    let replace = || {
        let target = resolve_links(path)?;
        let mut temporary = temporary_beside(&target)?;
        let mut buffered = BufWriter::new(temporary.as_file_mut());
        write(&mut buffered)?;
        buffered.into_inner().map_err(|error| error.into_error())?;
        if let Ok(old) = fs::metadata(&target) {
            temporary.as_file().set_permissions(old.permissions())?;
        }
        temporary.as_file().sync_all()?;
        temporary.persist(&target).map_err(|error| error.error)?;
        // The new name is on the disk once the directory is. Not every file system can do this, and
        // the file is whole either way.
        let _ = File::open(directory_of(&target)).and_then(|directory| directory.sync_all());
        Ok(())
    };
    replace().map_err(|problem| OutputError::Unwritable { path: path.to_path_buf(), problem })
}

fn resolve_links(path: &Path) -> io::Result<PathBuf> {
    if path.is_symlink() { fs::canonicalize(path) } else { Ok(path.to_path_buf()) }
}

fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(directory) if !directory.as_os_str().is_empty() => directory,
        _ => Path::new("."),
    }
}

fn temporary_beside(path: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".alabaster-").suffix(".tmp");
    #[cfg(unix)]
    {
        // What any new file gets: everybody, less the umask. (The default is the owner alone.)
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(directory_of(path))
}

//! What a URI of a glTF file names: bytes inside the URI itself, or a file beside the scene.

use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::percent_decode_str;

/// Exporters differ in whether they pad.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// The bytes that `uri` names, at most `limit` of them; a file must lie in `folder` or below.
///
/// The error says what is wrong and how to mend it, without the place.
pub(super) fn read_uri(folder: &Path, uri: &str, limit: u64) -> Result<Vec<u8>, String> {
    match uri.get(..5) {
        Some(scheme) if scheme.eq_ignore_ascii_case("data:") => decode_data_uri(&uri[5..]),
        _ => read_file(&locate(folder, uri)?, limit),
    }
}

/// `[<media type>][;base64],<data>` (RFC 2397).
fn decode_data_uri(content: &str) -> Result<Vec<u8>, String> {
    let (head, data) =
        content.split_once(',').ok_or("the data URI has no comma before its data; export it again")?;
    let bytes: Vec<u8> = percent_decode_str(data).collect();
    if !head.to_ascii_lowercase().ends_with(";base64") {
        return Ok(bytes);
    }
    BASE64.decode(bytes).map_err(|error| format!("the data URI is not base64 ({error}); export it again"))
}

/// The path of a relative URI, refused where it could leave `folder`.
fn locate(folder: &Path, uri: &str) -> Result<PathBuf, String> {
    let decoded = percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| format!("the URI \"{}\" is not UTF-8 once percent-decoded", shown(uri)))?;
    check_relative(&decoded)
        .map_err(|why| format!("the URI \"{}\" {why}: only files in the scene's own folder are read; copy the file there and name it relative to the scene", shown(uri)))?;

    // A file may really be named "100%25.png": then the URI as it stands is the name.
    let path = [decoded.as_ref(), uri]
        .into_iter()
        .filter(|name| check_relative(name).is_ok())
        .map(|name| folder.join(name))
        .find(|path| path.exists())
        .ok_or_else(|| {
            format!(
                "the file \"{}\" does not exist; put it beside the scene or export with embedded data (.glb)",
                shown(&decoded)
            )
        })?;

    // A link inside the folder may still point out of it.
    let inside = match (path.canonicalize(), folder.canonicalize()) {
        (Ok(path), Ok(folder)) => path.starts_with(folder),
        _ => false,
    };
    if inside {
        Ok(path)
    } else {
        Err(format!("\"{}\" is a link out of the scene's folder; copy the file there instead", shown(uri)))
    }
}

fn check_relative(name: &str) -> Result<(), &'static str> {
    if name.is_empty() {
        return Err("is empty");
    }
    if name.contains('\0') {
        return Err("holds a NUL character");
    }
    if has_scheme(name) {
        return Err("has a scheme or drive");
    }
    if name.starts_with(['/', '\\']) {
        return Err("is an absolute path");
    }
    // Both separators, so that a scene is refused or read alike on every system.
    let leaves = name.split(['/', '\\']).any(|part| part == "..");
    let odd = Path::new(name).components().any(|c| !matches!(c, Component::Normal(_) | Component::CurDir));
    if leaves || odd { Err("leaves the folder of the scene") } else { Ok(()) }
}

/// True for `http:…`, `file:…`, `C:…` (RFC 3986, section 3.1).
fn has_scheme(name: &str) -> bool {
    name.split_once(':').is_some_and(|(scheme, _)| {
        scheme.starts_with(|c: char| c.is_ascii_alphabetic())
            && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    })
}

/// The bytes of a regular file, at most `limit`.
///
/// Pipes and devices are refused: reading them could wait for ever.
pub(super) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, String> {
    let explain = |error: std::io::Error| format!("\"{}\" cannot be read: {error}", path.display());
    let metadata = path.metadata().map_err(explain)?;
    if !metadata.is_file() {
        return Err(format!("\"{}\" is not a regular file", path.display()));
    }
    let mut bytes = Vec::new();
    File::open(path).map_err(explain)?.take(limit).read_to_end(&mut bytes).map_err(explain)?;
    Ok(bytes)
}

/// A URI short enough for a message.
fn shown(uri: &str) -> String {
    const LENGTH: usize = 120;
    let mut text: String = uri.chars().take(LENGTH).collect();
    if text.len() < uri.len() {
        text.push('…');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_uris_decode_with_and_without_padding() {
        let folder = Path::new(".");
        for uri in
            ["data:application/octet-stream;base64,AQID/w==", "data:;base64,AQID/w", "DATA:;BASE64,AQID%2Fw"]
        {
            assert_eq!(read_uri(folder, uri, 0).as_deref(), Ok(&[1, 2, 3, 255][..]), "{uri}");
        }
        assert_eq!(read_uri(folder, "data:,a%20b", 0).as_deref(), Ok(&b"a b"[..]));
        assert!(read_uri(folder, "data:;base64,!!!!", 0).is_err());
        assert!(read_uri(folder, "data:;base64", 0).is_err());
    }

    #[test]
    fn uris_that_leave_the_folder_are_refused() {
        for uri in [
            "../../etc/passwd",
            "a/../../b",
            "%2e%2e/secret",
            "..%2fsecret",
            "..\\secret",
            "/etc/passwd",
            "%2fetc/passwd",
            "file:///etc/passwd",
            "file:a.bin",
            "http://example.com/a.bin",
            "C:\\a.bin",
            "",
            "a%00.bin",
            "%ff%fe.bin",
        ] {
            let problem = locate(Path::new("."), uri).expect_err(uri);
            assert!(!problem.contains("does not exist"), "{uri}: {problem}");
        }
    }

    #[test]
    fn names_with_spaces_and_percent_signs_are_found() -> std::io::Result<()> {
        let folder = tempfile::tempdir()?;
        for name in ["two words.bin", "100%.bin", "50%25.bin"] {
            std::fs::write(folder.path().join(name), name)?;
            assert_eq!(read_uri(folder.path(), name, 100).as_deref(), Ok(name.as_bytes()));
        }
        assert_eq!(read_uri(folder.path(), "two%20words.bin", 100).as_deref(), Ok(&b"two words.bin"[..]));
        assert_eq!(read_uri(folder.path(), "100%25.bin", 100).as_deref(), Ok(&b"100%.bin"[..]));
        Ok(())
    }

    #[cfg(unix)]
    #[test]
    fn a_link_out_of_the_folder_is_refused() -> std::io::Result<()> {
        let outside = tempfile::NamedTempFile::new()?;
        let folder = tempfile::tempdir()?;
        std::os::unix::fs::symlink(outside.path(), folder.path().join("link.bin"))?;
        let problem = read_uri(folder.path(), "link.bin", 100).expect_err("a link out");
        assert!(problem.contains("link out"), "{problem}");
        Ok(())
    }
}

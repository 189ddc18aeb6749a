//! Mutations of bytes, of a format or none.

use rand::RngExt;
use rand_pcg::Pcg64;

/// Numbers at the ends of types, as text.
pub const NUMBERS: &[&str] = &[
    "0",
    "-0.0",
    "-1",
    "0.5",
    "1e-45",
    "1e-320",
    "1e38",
    "1e39",
    "1e308",
    "-1e308",
    "1e999",
    "nan",
    "inf",
    "-inf",
    "255",
    "256",
    "32768",
    "65536",
    "2147483647",
    "2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "18446744073709551616",
    "99999999999999999999999999",
    "0x7fffffff",
    "1_000_000",
];

/// Words that matter to the formats.
const WORDS: &[&str] = &[
    // Text of any kind.
    "\n",
    "\r\n",
    "\t",
    "\0",
    "\u{1b}[31m",
    "\u{feff}",
    "é",
    "\"",
    "'",
    "[",
    "]",
    "{",
    "}",
    ",",
    "=",
    "#",
    "..",
    "../",
    "/etc/passwd",
    "%00",
    "%ff",
    ":",
    // glTF.
    "\"byteStride\":1",
    "\"byteOffset\":4294967295",
    "\"componentType\":5125",
    "\"type\":\"MAT4\"",
    "\"count\":0",
    "\"mode\":5",
    "\"sparse\":{",
    "\"normalized\":true",
    "\"bufferView\":0",
    "\"uri\":\"sky.hdr\"",
    "data:application/octet-stream;base64,",
    "\"extensionsRequired\":[\"KHR_texture_transform\"]",
    "\"children\":[0]",
    "\"scale\":[0,0,0]",
    "KHR_materials_volume",
    // Scene files.
    "[[object]]\n",
    "[[light]]\n",
    "[material.wax]\n",
    "[film]\n",
    "[camera]\n",
    "gltf = \"box.glb\"\n",
    "image = \"sky.hdr\"\n",
    "image = \"sky.exr\"\n",
    "preset = \"marble\"\n",
    "shape = \"disk\"\n",
    "radius = 0\n",
    "size = [0, 0]\n",
    "material = \"\"\n",
    "transform = { scale = 0 }\n",
    "x.y.z = 1\n",
    // Radiance and OpenEXR.
    "#?RADIANCE\n",
    "FORMAT=32-bit_rle_rgbe\n",
    "EXPOSURE=1e38\n",
    "-Y 2 +X 8\n",
    "-Y 65536 +X 65536\n",
    "\u{2}\u{2}",
    "\u{1}\u{1}\u{1}",
    "dataWindow\0box2i\0",
    "compression\0",
    "channels\0chlist\0",
    "tiles\0tiledesc\0",
    "type\0string\0",
    "deepscanline",
    // MCML.
    "1e8",
    "A\n",
    "1000000000000\n",
    "# ",
];

/// Bits of numbers at the ends of types.
const BITS: &[u32] = &[
    0,
    1,
    0x7f,
    0x80,
    0xff,
    0x100,
    0x7fff,
    0xffff,
    0x1_0000,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7f80_0000,
    0x7fc0_0000,
    0xff80_0000,
    0x7f7f_ffff,
    0x0080_0000,
    0x3f80_0000,
];

fn pick<T: Copy>(of: &[T], random: &mut Pcg64) -> T {
    of[random.random_range(0..of.len())]
}

/// A place in or at the end of `length` bytes.
fn place(length: usize, random: &mut Pcg64) -> usize {
    random.random_range(0..=length)
}

/// A stretch of `length` bytes: short, more often than not.
fn stretch(length: usize, random: &mut Pcg64) -> std::ops::Range<usize> {
    let start = place(length, random);
    let longest = if random.random_bool(0.8) { 32 } else { length };
    start..(start + random.random_range(0..=longest)).min(length)
}

/// Changes `bytes` in one way; `other` are those of another file.
pub fn mutate(bytes: &mut Vec<u8>, other: &[u8], random: &mut Pcg64) {
    let length = bytes.len();
    match random.random_range(0..11) {
        0 if length > 0 => bytes[random.random_range(0..length)] ^= 1 << random.random_range(0..8),
        1 if length > 0 => bytes[random.random_range(0..length)] = random.random(),
        2 => bytes.truncate(place(length, random)),
        3 => drop(bytes.drain(stretch(length, random))),
        4 => insert(bytes, pick(WORDS, random).as_bytes(), random),
        5 => {
            let copied = bytes[stretch(length, random)].to_vec();
            insert(bytes, &copied, random);
        }
        6 => {
            let spliced = &other[stretch(other.len(), random)];
            bytes.splice(stretch(length, random), spliced.iter().copied());
        }
        7 | 8 => replace_number(bytes, random),
        9 => replace_bits(bytes, random),
        _ => {
            let line = pick(WORDS, random).as_bytes();
            bytes.splice(stretch(length, random), line.iter().copied());
        }
    }
}

fn insert(bytes: &mut Vec<u8>, piece: &[u8], random: &mut Pcg64) {
    let at = place(bytes.len(), random);
    bytes.splice(at..at, piece.iter().copied());
}

/// Puts an extreme in the place of a number written out.
fn replace_number(bytes: &mut Vec<u8>, random: &mut Pcg64) {
    let is_part = |byte: &u8| byte.is_ascii_digit() || b".eE+-".contains(byte);
    let from = place(bytes.len(), random);
    let Some(start) = bytes[from..].iter().position(u8::is_ascii_digit).map(|offset| from + offset) else {
        return;
    };
    let end =
        bytes[start..].iter().position(|byte| !is_part(byte)).map_or(bytes.len(), |offset| start + offset);
    bytes.splice(start..end, pick(NUMBERS, random).bytes());
}

/// Puts an extreme in the place of one, two or four bytes, aligned as most formats do.
fn replace_bits(bytes: &mut [u8], random: &mut Pcg64) {
    let width = pick(&[1, 2, 4, 4], random);
    let count = bytes.len() / width;
    if count > 0 {
        let start = random.random_range(0..count) * width;
        let value = pick(BITS, random).to_le_bytes();
        bytes[start..start + width].copy_from_slice(&value[..width]);
    }
}

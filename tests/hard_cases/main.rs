//! Hard cases stay numerically stable: what makes renderers give pixels that are not numbers, hang, lose or make energy. One test a case,
//! listed with its figures in docs/stability.md.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/csv.rs"]
mod csv;

mod cases;
mod fresnel;
mod geometry;
mod lights;
mod media;
mod probes;
mod record;
mod samples;
mod sampling;
mod scale;
mod table;
mod walks;
mod wavelengths;

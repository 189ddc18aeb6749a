//! What the tests share, and the examples that print the figures which the tests hold.
#![allow(dead_code)]

pub mod assets;
pub mod backends;
pub mod bodies;
pub mod bsdfs;
pub mod cpu_time;
pub mod method_error;
pub mod probes;
pub mod scenes;
pub mod volumetric;
pub mod walks;

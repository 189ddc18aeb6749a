//! Studies: how far models and pictures are from the truth, and what they cost. Plain data in, plain data out.

pub mod accuracy;
pub mod image;
pub mod laws;
pub mod numbers;
pub mod plot;
pub mod profile;
pub mod race;

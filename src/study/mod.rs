//! Studies: how far models and pictures are from the truth, and what they cost. Plain data in, plain data out.

pub mod image;
pub mod profile;

//! Studies: how far models are from the truth, and what they cost. Plain data in, plain data out.

pub mod profile;

//! What the tests share.
#![allow(dead_code)]

pub mod assets;
pub mod bsdfs;
pub mod program;
pub mod scenes;

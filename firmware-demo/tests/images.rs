//! The images of emulated chips, and what starts them.

mod support;

mod emulated;
mod robot;

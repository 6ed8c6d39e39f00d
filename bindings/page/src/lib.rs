//! The base and its simulator for one HTML page.
//!
//! | module | what |
//! | --- | --- |
//! | [`session`] | robots in a world, driven by [`input`]s, which are all that a run depends on |
//! | [`input`] | what somebody does on the page, as bytes: they go into the link that shares a run |
//! | [`drawn`] | a line drawn by hand becomes a trajectory file |
//! | [`watch`] | a real board: the frames that it sends |
//! | `exports` | what the page calls: numbers and bytes, no other types |
//!
//! Nothing is computed here that the simulator does not compute: loop, world, base, files and frames are those of `sim-host`
//! and `protocol`. `docs/browser.md` says how to build and use the page.

pub mod drawn;
// Clippy runs for the host alone, and reads this too.
#[cfg(any(target_family = "wasm", clippy))]
mod exports;
pub mod input;
pub mod session;
pub mod watch;

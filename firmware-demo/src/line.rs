//! Frames onto a byte link.

use embedded_io::Write;

use protocol::{Frame, MAX_FRAME, encode};
use serde::Serialize;

/// Sends one frame and says whether the link took it all.
pub fn send<L: Write, M: Serialize>(link: &mut L, frame: &Frame<M>) -> bool {
    let mut bytes = [0; MAX_FRAME];
    let Ok(mut rest) = encode(frame.sequence, &frame.message, &mut bytes) else {
        return false;
    };
    // Not `write_all`, which panics when a link takes nothing. Each turn takes at least one byte.
    while !rest.is_empty() {
        match link.write(rest) {
            Ok(taken @ 1..) => rest = rest.get(taken..).unwrap_or_default(),
            _ => return false,
        }
    }
    link.flush().is_ok()
}

//! The end of a panic, for images in an emulator and on boards.

#[cfg(feature = "panic-proof")]
#[allow(unsafe_code)]
// SAFETY: nobody defines it, so what could call it does not link.
unsafe extern "C" {
    safe fn a_panic_is_reachable() -> !;
}

/// What a panic handler does: with `panic-proof` an image in which it can be reached does not link, else it halts.
pub fn panicked(halt: fn() -> !) -> ! {
    #[cfg(feature = "panic-proof")]
    {
        let _ = halt;
        a_panic_is_reachable()
    }
    #[cfg(not(feature = "panic-proof"))]
    halt()
}

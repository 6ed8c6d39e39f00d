//! How a binary begins and how a panic ends it.

/// Makes `$main`, a `fn()`, the program of an emulated board: entry, painted stack, exit code 0 at its end,
/// and the panic handler.
#[macro_export]
macro_rules! firmware {
    ($main:path) => {
        /// Where the run-time crate jumps to.
        #[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
        #[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
        fn start() -> ! {
            $crate::board::paint();
            $main();
            $crate::board::semihosting::exit(0)
        }

        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
            $crate::board::panicked()
        }
    };
}

#[cfg(feature = "panic-proof")]
unsafe extern "C" {
    /// Defined nowhere: an image in which a panic is reachable does not link.
    safe fn a_panic_is_reachable() -> !;
}

/// What the panic handler does: with `panic-proof` it does not link, else it ends the emulator.
pub fn panicked() -> ! {
    #[cfg(feature = "panic-proof")]
    a_panic_is_reachable();
    #[cfg(not(feature = "panic-proof"))]
    super::semihosting::exit(super::EXIT_PANIC)
}

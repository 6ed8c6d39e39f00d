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
            $crate::panicked($crate::board::end_of_panic)
        }
    };
}

/// Ends the emulator.
pub fn end_of_panic() -> ! {
    super::semihosting::exit(super::EXIT_PANIC)
}

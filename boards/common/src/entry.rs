//! How a board ends, whatever went wrong.

/// Makes `$halt`, a `fn() -> !` that switches the bridges off, what faults, interrupts that nobody awaits and panics of a Cortex-M
/// end in. With the board's feature `panic-proof` an image in which a panic is reachable does not link.
#[macro_export]
macro_rules! ends_in {
    ($halt:path) => {
        #[cortex_m_rt::exception]
        #[allow(unsafe_code)]
        unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
            $halt()
        }

        #[cortex_m_rt::exception]
        #[allow(unsafe_code)]
        unsafe fn DefaultHandler(_: i16) {
            $halt()
        }

        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
            $crate::panicked($halt)
        }
    };
}

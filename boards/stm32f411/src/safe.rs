//! The safe state, whatever happened: bridges off, PWM off, and the watchdog brings a fresh start.

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use stm32f4xx_hal::pac;

/// Switches the bridges off and stops. A running watchdog then resets the chip, and pins are inputs from reset on.
pub fn halt() -> ! {
    cortex_m::interrupt::disable();
    off();
    loop {
        cortex_m::asm::nop();
    }
}

/// Enable low, and TIM1's outputs off by their master switch.
#[allow(unsafe_code)]
fn off() {
    // SAFETY: interrupts are off and nobody goes on after this; both are plain register writes that are harmless on
    // peripherals which have no clock yet.
    unsafe {
        (*pac::GPIOB::ptr()).bsrr().write(|w| w.br10().set_bit());
        (*pac::TIM1::ptr())
            .bdtr()
            .modify(|_, w| w.moe().clear_bit());
    }
}

#[exception]
#[allow(unsafe_code)]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    halt()
}

#[exception]
#[allow(unsafe_code)]
unsafe fn DefaultHandler(_: i16) {
    halt()
}

#[cfg(feature = "panic-proof")]
#[allow(unsafe_code)]
unsafe extern "C" {
    /// Defined nowhere: an image in which a panic is reachable does not link.
    safe fn a_panic_is_reachable() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    #[cfg(feature = "panic-proof")]
    a_panic_is_reachable();
    #[cfg(not(feature = "panic-proof"))]
    halt()
}

//! The safe state, whatever happened: bridges off, PWM off, and the watchdog brings a fresh start.

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
        // The library lets every period switch them on again.
        (*pac::TIM1::ptr()).bdtr().modify(|_, w| {
            w.aoe().clear_bit();
            w.moe().clear_bit()
        });
    }
}

board_common::ends_in!(halt);

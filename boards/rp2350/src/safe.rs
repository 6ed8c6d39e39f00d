//! The safe state, whatever happened: bridges off, and the watchdog brings a fresh start.

use rp_pac as pac;

use crate::pins::SLICE;

/// Enable, GPIO 6, and the directions beside it: GPIO 4 to 6.
const OUTPUTS: u32 = 0b111_0000;

/// Switches the bridges off and stops. A running watchdog then resets the chip, and pins are inputs from reset on.
pub fn halt() -> ! {
    cortex_m::interrupt::disable();
    pac::SIO.gpio_out(0).value_clr().write_value(OUTPUTS);
    // The output stays where it is when its slice stops, so the duty goes first.
    pac::PWM.ch(SLICE).cc().write(|w| {
        w.set_a(0);
        w.set_b(0);
    });
    loop {
        cortex_m::asm::nop();
    }
}

board_common::ends_in!(halt);

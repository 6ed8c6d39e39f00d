//! The crystal instead of the chip's own oscillator, which is off by up to 1 % and every speed with it.
//!
//! The library's own clock set-up searches for divisors and can panic in doing so, which an image with the panic proof
//! must not. After reset the library takes the chip to run at 16 MHz. So do these registers: 25 MHz / 25 · 128 / 8, and
//! it stays right whether the crystal starts or not. 16 MHz is plenty: a tick of the controller takes 300 instructions.

use stm32f4xx_hal::pac::RCC;

/// Longest wait for an oscillator, in turns of a loop: some 10 ms.
const PATIENCE: u32 = 20_000;

/// Runs the chip from its crystal at 16 MHz; whether that was possible.
pub fn start(rcc: &RCC) -> bool {
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    if !within_patience(|| rcc.cr().read().hserdy().bit_is_set()) {
        return false;
    }
    rcc.pllcfgr().write(dividers);
    rcc.cr().modify(|_, w| w.pllon().set_bit());
    if !within_patience(|| rcc.cr().read().pllrdy().bit_is_set()) {
        return false;
    }
    rcc.cfgr().modify(|_, w| w.sw().pll());
    within_patience(|| rcc.cfgr().read().sws().is_pll())
}

/// M = 25, N = 128, P = 8, from the crystal.
#[allow(unsafe_code)]
fn dividers(
    w: &mut stm32f4xx_hal::pac::rcc::pllcfgr::W,
) -> &mut stm32f4xx_hal::pac::rcc::pllcfgr::W {
    // SAFETY: M and N are in their ranges (2 to 63, 50 to 432) and make 128 MHz, in the range of the oscillator (100 to
    // 432 MHz). Q, for a port that is not used, is at its least.
    unsafe {
        w.pllsrc()
            .hse()
            .pllm()
            .bits(25)
            .plln()
            .bits(128)
            .pllp()
            .div8()
            .pllq()
            .bits(4)
    }
}

fn within_patience(mut done: impl FnMut() -> bool) -> bool {
    (0..PATIENCE).any(|_| done())
}

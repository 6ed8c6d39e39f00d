//! The motor supply, behind a divider on PA1: channel 1 of ADC1, which converts all the time.

use board_common::Supply;
use stm32f4xx_hal::gpio::PA1;
use stm32f4xx_hal::pac::{ADC_COMMON, ADC1};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// What the board's regulator makes, which is the converter's reference \[V\].
const REFERENCE_V: f32 = 3.3;
/// Steps of the converter.
const STEPS: f32 = 4096.0;
/// The channel of PA1 (DS10314, pin definitions).
const CHANNEL: u8 = 1;

/// ADC1, for a converter that is read only.
pub struct Adc {
    adc: ADC1,
    /// Volts for each step.
    step_v: f32,
}

impl Adc {
    /// Begins to convert; `divider` is what the supply is divided by.
    pub fn start(adc: ADC1, common: &ADC_COMMON, pin: PA1, divider: f32, rcc: &mut Rcc) -> Self {
        pin.into_analog();
        ADC1::enable(rcc);
        ADC1::reset(rcc);
        // A quarter of APB2: 25 MHz, of 36 at most from 2.4 V on (DS10314, ADC characteristics).
        common.ccr().modify(|_, w| w.adcpre().div4());
        // 20 us for each, of which the divider's resistors have nearly all to charge the input.
        adc.smpr2().write(|w| w.smp1().cycles480());
        #[allow(unsafe_code)]
        // SAFETY: a channel of this chip, the first of one.
        adc.sqr3().write(|w| unsafe { w.sq1().bits(CHANNEL) });
        adc.cr2().write(|w| {
            w.cont().continuous();
            w.adon().enabled()
        });
        // Until the converter has settled: 3 us at the most (DS10314, ADC characteristics).
        cortex_m::asm::delay(1_000);
        adc.cr2().modify(|_, w| w.swstart().start());
        Self {
            adc,
            step_v: divider * REFERENCE_V / STEPS,
        }
    }
}

impl Supply for Adc {
    /// A converter that stands still has nothing to say: reading a value takes back that there is one.
    fn volts(&mut self) -> Option<f32> {
        let there = self.adc.sr().read().eoc().bit_is_set();
        there.then(|| f32::from(self.adc.dr().read().data().bits()) * self.step_v)
    }
}

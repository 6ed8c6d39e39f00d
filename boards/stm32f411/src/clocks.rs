//! From reset to 100 MHz from the crystal. Where that does not start, the same PLL makes 96 MHz of the chip's own
//! oscillator; where the PLL does not either, that oscillator's 16 MHz are all there is.
//!
//! Register by register: the set-up of the library (`Rcc::freeze`) searches for dividers and can panic in doing so, waits
//! without end, and leaves the core's voltage at scale 2, which is for 84 MHz at most. So the library believes that the
//! chip runs as it does after a reset, at 16 MHz: **`Rcc::clocks` is wrong from here on, and [`Clocks`] is right.** What
//! the library sets up by it, [`Clocks::correct`] sets right.
//!
//! RM0383 is the chip's reference manual, DS10314 its data sheet.

use board_common::{BAUD, config};
use stm32f4xx_hal::pac::{FLASH, PWR, RCC, TIM1, TIM5, USART2, rcc};

/// The crystal of the board \[Hz\]; the chip takes 4 to 26 MHz (DS10314, HSE oscillator characteristics).
const CRYSTAL_HZ: u32 = 25_000_000;
/// The chip's own oscillator \[Hz\]: off by up to 1 % at 25 °C and 4 % from -10 to 85 °C (DS10314, HSI characteristics).
const OWN_HZ: u32 = 16_000_000;

/// What multiplies one of them; all divide by two behind it, P = 2.
#[derive(Clone, Copy)]
struct Pll {
    from_crystal: bool,
    m: u8,
    n: u16,
}

const FROM_CRYSTAL: Pll = Pll {
    from_crystal: true,
    m: 25,
    n: 200,
};
/// Slower, so that 4 % more are no more than 100 MHz either.
const FROM_OWN: Pll = Pll {
    from_crystal: false,
    m: 16,
    n: 192,
};
const P: u32 = 2;
/// Divides for the 48 MHz port, which nothing uses: no more than that.
const Q: u8 = 5;
/// Divides for APB1; AHB and APB2 are as fast as the core.
const APB1: u32 = 2;

impl Pll {
    const fn source_hz(self) -> u32 {
        if self.from_crystal {
            CRYSTAL_HZ
        } else {
            OWN_HZ
        }
    }

    /// What the core gets, if all dividers and frequencies are within their ranges; else nothing is built.
    const fn core_hz(self) -> u32 {
        let Self { m, n, .. } = self;
        // RM0383, 6.3.2.
        assert!(m >= 2 && m <= 63 && n >= 50 && n <= 432);
        // In and out of the PLL's oscillator (DS10314, main PLL characteristics).
        let into = self.source_hz() / m as u32;
        assert!(into * m as u32 == self.source_hz() && into >= 1_000_000 && into <= 2_000_000);
        let out = into * n as u32;
        assert!(out >= 100_000_000 && out <= 432_000_000 && out / Q as u32 <= 48_000_000);
        let core = out / P;
        // Core and APB2 100 MHz at most, APB1 50 MHz (DS10314, general operating conditions, scale 1). Three wait states
        // are for more than 90 and up to 100 MHz at 2.7 to 3.6 V (RM0383, 3.4.1).
        assert!(core > 90_000_000 && core <= 100_000_000 && core / APB1 <= 50_000_000);
        core
    }
}

/// How fast the chip is.
#[derive(Clone, Copy)]
pub struct Clocks {
    /// Of core and timers \[Hz\], a multiple of 1 MHz. Timers on a divided bus run twice as fast as it (RM0383, 6.2, with
    /// TIMPRE = 0): as fast as the core all of them, with a bus divided by two or not at all.
    pub core_hz: u32,
    /// Of APB1, which the port is on \[Hz\].
    apb1_hz: u32,
    /// As precise as a crystal.
    pub from_crystal: bool,
}

impl Clocks {
    const OWN: Self = Self {
        core_hz: OWN_HZ,
        apb1_hz: OWN_HZ,
        from_crystal: false,
    };

    const fn multiplied(pll: Pll) -> Self {
        let core_hz = pll.core_hz();
        let from_crystal = pll.from_crystal;
        Self {
            core_hz,
            apb1_hz: core_hz / APB1,
            from_crystal,
        }
    }

    /// All there can be.
    const ALL: [Self; 3] = [
        Self::multiplied(FROM_CRYSTAL),
        Self::multiplied(FROM_OWN),
        Self::OWN,
    ];

    /// Starts the clock, the best that there is. `None` if not even the chip's own oscillator answers.
    pub fn start(rcc: &RCC, pwr: &PWR, flash: &FLASH) -> Option<Self> {
        let [crystal, own, slow] = Self::ALL;
        for (pll, clocks) in [(FROM_CRYSTAL, crystal), (FROM_OWN, own)] {
            // Not only as it is after a reset: the boot loader jumps here from its PLL.
            as_after_reset(rcc, flash)?;
            if multiply(pll, rcc, pwr, flash).is_some() {
                return Some(clocks);
            }
        }
        as_after_reset(rcc, flash)?;
        Some(slow)
    }

    /// Makes right what the library has set up for [`OWN_HZ`]: the period of the PWM, the tick's timer before it is
    /// started, the port before it is used.
    #[allow(unsafe_code)]
    pub fn correct(self) {
        // SAFETY: register by register, each one written here only once the library is done with it.
        let (pwm, tick, port) = unsafe { (TIM1::steal(), TIM5::steal(), USART2::steal()) };
        pwm.psc().write(|w| w.psc().set(0));
        pwm.arr()
            .write(|w| w.arr().set(self.pwm_steps().wrapping_sub(1)));
        pwm.egr().write(|w| w.ug().set_bit());
        tick.psc()
            .write(|w| w.psc().set(self.per_us().wrapping_sub(1)));
        // Whole and sixteenths of its divider (RM0383, 19.3.4): with 16 samples a bit, as the library has it at 16 MHz,
        // that is the number itself.
        let divider = self.port_divider();
        port.brr().write(|w| {
            w.div_mantissa().set(divider >> 4);
            w.div_fraction().set((divider & 0xf) as u8)
        });
    }

    /// Turns of a timer in a period of the PWM.
    const fn pwm_steps(self) -> u16 {
        (self.core_hz / config::PWM_HZ) as u16
    }

    /// Turns of a timer in a microsecond.
    pub const fn per_us(self) -> u16 {
        (self.core_hz / 1_000_000) as u16
    }

    /// Turns of APB1 in a bit of the port, the nearest.
    const fn port_divider(self) -> u16 {
        ((self.apb1_hz + BAUD / 2) / BAUD) as u16
    }
}

// What depends on the clock is right with each of them; else nothing is built.
const _: () = {
    assert!(APB1 == 2 && P == 2 && Q >= 2 && Q <= 15);
    let mut at = 0;
    while at < Clocks::ALL.len() {
        let clocks = Clocks::ALL[at];
        assert!(clocks.core_hz == clocks.per_us() as u32 * 1_000_000);
        assert!(clocks.core_hz == clocks.pwm_steps() as u32 * config::PWM_HZ);
        // 16 samples a bit need 16 turns; 2.2 % more or less than the host's rate is within the receiver's 3.3 % (RM0383,
        // 19.3.5), and is so at 16 MHz only: 0.5 % with the PLL.
        let divider = clocks.port_divider() as u32;
        let off = clocks.apb1_hz.abs_diff(divider * BAUD);
        let per_mille = if clocks.core_hz == OWN_HZ { 22 } else { 5 };
        assert!(divider >= 16 && off / 100 * 1000 <= divider * (BAUD / 100) * per_mille);
        at += 1;
    }
};

/// Turns of a loop before something that does not get ready is given up: a tenth of a second or more at 16 MHz. A crystal
/// takes 2 ms, the PLL up to 0.3 ms (DS10314), everything else some cycles.
const PATIENCE: u32 = 200_000;

/// The chip's own oscillator, no bus divided, PLL and crystal off, no wait states, which 16 MHz do without (RM0383, 3.4.1).
fn as_after_reset(rcc: &RCC, flash: &FLASH) -> Option<()> {
    rcc.cr().modify(|_, w| w.hsion().set_bit());
    until(|| rcc.cr().read().hsirdy().bit_is_set())?;
    rcc.cfgr().modify(|_, w| w.sw().hsi());
    until(|| rcc.cfgr().read().sws().is_hsi())?;
    rcc.cfgr()
        .modify(|_, w| w.hpre().div1().ppre1().div1().ppre2().div1());
    rcc.cr().modify(|_, w| {
        w.csson().clear_bit();
        w.pllon().clear_bit();
        w.hseon().clear_bit()
    });
    until(|| rcc.cr().read().pllrdy().bit_is_clear())?;
    flash.acr().modify(|_, w| w.latency().ws0());
    until(|| flash.acr().read().latency().is_ws0())
}

/// From there to the PLL.
fn multiply(pll: Pll, rcc: &RCC, pwr: &PWR, flash: &FLASH) -> Option<()> {
    if pll.from_crystal {
        rcc.cr().modify(|_, w| w.hseon().set_bit());
        until(|| rcc.cr().read().hserdy().bit_is_set())?;
    }
    rcc.apb1enr().modify(|_, w| w.pwren().set_bit());
    // A peripheral is there two cycles after its clock; reading back takes them.
    until(|| rcc.apb1enr().read().pwren().bit_is_set())?;
    // 100 MHz takes scale 1; it is written while the PLL is off and holds while the PLL is on (RM0383, 5.4.1).
    pwr.cr().modify(|_, w| w.vos().scale1());
    until(|| pwr.cr().read().vos().is_scale1())?;
    // The dividers as well are written while the PLL is off (RM0383, 6.3.2).
    rcc.pllcfgr().write(|w| dividers(pll, w));
    rcc.cr().modify(|_, w| w.pllon().set_bit());
    until(|| rcc.cr().read().pllrdy().bit_is_set())?;
    until(|| pwr.csr().read().vosrdy().is_ready())?;
    // Before the clock rises, and read back (RM0383, 3.4.1): a fetch that comes too early reads anything. Prefetch and
    // caches hide most of the waiting.
    flash.acr().modify(|_, w| {
        w.prften().set_bit();
        w.icen().set_bit();
        w.dcen().set_bit();
        w.latency().ws3()
    });
    until(|| flash.acr().read().latency().is_ws3())?;
    // Before the clock rises, for the same reason.
    rcc.dckcfgr().modify(|_, w| w.timpre().mul1or2());
    rcc.cfgr().modify(|_, w| w.ppre1().div2());
    until(|| rcc.cfgr().read().ppre1().is_div2())?;
    rcc.cfgr().modify(|_, w| w.sw().pll());
    until(|| rcc.cfgr().read().sws().is_pll())?;
    if pll.from_crystal {
        // A crystal that fails from now on is an interrupt that nobody awaits (RM0383, 6.2.7): bridges off, and the
        // watchdog's reset leads here again, and to the other oscillator.
        rcc.cr().modify(|_, w| w.csson().set_bit());
    }
    Some(())
}

#[allow(unsafe_code)]
fn dividers(Pll { from_crystal, m, n }: Pll, w: &mut rcc::pllcfgr::W) -> &mut rcc::pllcfgr::W {
    // SAFETY: they are in their ranges: `Pll::core_hz` has been asked of both.
    unsafe {
        w.pllm().bits(m);
        w.plln().bits(n);
        w.pllq().bits(Q);
    }
    w.pllp().div2();
    w.pllsrc().bit(from_crystal)
}

fn until(mut ready: impl FnMut() -> bool) -> Option<()> {
    (0..PATIENCE).any(|_| ready()).then_some(())
}

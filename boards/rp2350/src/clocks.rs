//! From reset to 150 MHz from the crystal, in the order of the datasheet (sections 7.5 resets, 8.1 clocks, 8.2 crystal,
//! 8.6 PLL): the registers themselves, because the set-up of a HAL can panic. What does not get ready is `None`.

use rp_pac as pac;
use rp_pac::clocks::vals::{ClkPeriCtrlAuxsrc, ClkRefCtrlSrc, ClkSysCtrlAuxsrc, ClkSysCtrlSrc};
use rp_pac::resets::regs::Peripherals;
use rp_pac::xosc::vals::{CtrlFreqRange, Enable};

/// The crystal of the board \[Hz\].
const CRYSTAL_HZ: u32 = 12_000_000;
/// Of the PLL: the crystal times this, which has to be within 750 and 1600 MHz, over both post dividers.
const FEEDBACK: u16 = 125;
const POST: (u8, u8) = (5, 2);
/// Of cores, peripherals and PWM \[Hz\].
pub const SYSTEM_HZ: u32 = CRYSTAL_HZ * FEEDBACK as u32 / (POST.0 as u32 * POST.1 as u32);
/// Start-up time of the crystal in 256 of its periods: 1 ms, 128 times over for those that start slowly.
const START_UP: u16 = (CRYSTAL_HZ / 1000 * 128).div_ceil(256) as u16;
/// Looks at a status before it is given up: some seconds, the crystal takes 0.13 s.
const PATIENCE: u32 = 10_000_000;

/// Starts crystal, PLL, clocks, and every peripheral that the board has.
pub fn start() -> Option<()> {
    let clocks = pac::CLOCKS;
    clocks.clk_sys_resus_ctrl().write(|w| w.set_enable(false));
    // Away from PLL and crystal, wherever a debugger left them.
    clocks
        .clk_sys_ctrl()
        .modify(|w| w.set_src(ClkSysCtrlSrc::CLK_REF));
    system_from(ClkSysCtrlSrc::CLK_REF)?;
    clocks
        .clk_ref_ctrl()
        .modify(|w| w.set_src(ClkRefCtrlSrc::ROSC_CLKSRC_PH));
    reference_from(ClkRefCtrlSrc::ROSC_CLKSRC_PH)?;
    let mut pll = Peripherals::default();
    pll.set_pll_sys(true);
    let used = used();
    pac::RESETS.reset().modify(|w| w.0 |= pll.0 | used.0);
    release(pll)?;

    pac::XOSC.startup().write(|w| w.set_delay(START_UP));
    pac::XOSC.ctrl().write(|w| {
        w.set_freq_range(CtrlFreqRange::_1_15MHZ);
        w.set_enable(Enable::ENABLE);
    });
    until(|| pac::XOSC.status().read().stable())?;
    start_pll()?;

    clocks
        .clk_ref_ctrl()
        .write(|w| w.set_src(ClkRefCtrlSrc::XOSC_CLKSRC));
    reference_from(ClkRefCtrlSrc::XOSC_CLKSRC)?;
    clocks.clk_ref_div().write(|w| w.set_int(1));
    // Timer and watchdog count microseconds.
    let cycles = CRYSTAL_HZ / 1_000_000;
    pac::TICKS.timer0_cycles().write(|w| w.0 = cycles);
    pac::TICKS.timer0_ctrl().write(|w| w.set_enable(true));
    pac::TICKS.watchdog_cycles().write(|w| w.0 = cycles);
    pac::TICKS.watchdog_ctrl().write(|w| w.set_enable(true));

    // The source beside first, the switch to it second: only the switch is free of glitches.
    clocks
        .clk_sys_ctrl()
        .modify(|w| w.set_auxsrc(ClkSysCtrlAuxsrc::CLKSRC_PLL_SYS));
    clocks
        .clk_sys_ctrl()
        .modify(|w| w.set_src(ClkSysCtrlSrc::CLKSRC_CLK_SYS_AUX));
    system_from(ClkSysCtrlSrc::CLKSRC_CLK_SYS_AUX)?;
    clocks.clk_sys_div().write(|w| {
        w.set_int(1);
        w.set_frac(0);
    });
    clocks.clk_peri_ctrl().write(|w| {
        w.set_auxsrc(ClkPeriCtrlAuxsrc::CLK_SYS);
        w.set_enable(true);
    });
    release(used)
}

/// Peripherals of the table in `main`.
fn used() -> Peripherals {
    let mut used = Peripherals::default();
    used.set_io_bank0(true);
    used.set_pads_bank0(true);
    used.set_pio0(true);
    used.set_pwm(true);
    used.set_timer0(true);
    used.set_uart0(true);
    used
}

fn start_pll() -> Option<()> {
    let pll = pac::PLL_SYS;
    // After its reset it is powered down; divided by one is its reference.
    pll.cs().write(|w| w.set_refdiv(1));
    pll.fbdiv_int().write(|w| w.set_fbdiv_int(FEEDBACK));
    pll.pwr().modify(|w| {
        w.set_pd(false);
        w.set_vcopd(false);
    });
    until(|| pll.cs().read().lock())?;
    pll.prim().write(|w| {
        w.set_postdiv1(POST.0);
        w.set_postdiv2(POST.1);
    });
    pll.pwr().modify(|w| w.set_postdivpd(false));
    Some(())
}

/// Takes peripherals out of reset.
fn release(peripherals: Peripherals) -> Option<()> {
    pac::RESETS.reset().modify(|w| w.0 &= !peripherals.0);
    until(|| !pac::RESETS.reset_done().read().0 & peripherals.0 == 0)
}

fn reference_from(source: ClkRefCtrlSrc) -> Option<()> {
    let selected = 1 << source as u8;
    until(|| pac::CLOCKS.clk_ref_selected().read().0 == selected)
}

fn system_from(source: ClkSysCtrlSrc) -> Option<()> {
    let selected = 1 << source as u8;
    until(|| pac::CLOCKS.clk_sys_selected().read().0 == selected)
}

fn until(ready: impl Fn() -> bool) -> Option<()> {
    (0..PATIENCE).any(|_| ready()).then_some(())
}

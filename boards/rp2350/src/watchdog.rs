//! The watchdog: without food for long enough the chip begins anew, but for its oscillators.

use rp_pac as pac;

/// Runs from [`Watchdog::start`] on; nothing stops it.
pub struct Watchdog {
    patience_us: u32,
}

impl Watchdog {
    /// Starts it. Its counter has 24 bits.
    pub fn start<const PATIENCE_MS: u32>() -> Self {
        const { assert!(PATIENCE_MS > 0 && PATIENCE_MS < (1 << 24) / 1000) };
        let mut watchdog = Self {
            patience_us: PATIENCE_MS * 1000,
        };
        pac::WATCHDOG.ctrl().modify(|w| w.set_enable(false));
        // Everything but what the clocks come from, as Raspberry Pi's SDK has it.
        pac::PSM.wdsel().write(|w| {
            w.0 = 0x01ff_ffff;
            w.set_rosc(false);
            w.set_xosc(false);
        });
        watchdog.feed();
        pac::WATCHDOG.ctrl().modify(|w| w.set_enable(true));
        watchdog
    }

    /// Another while.
    pub fn feed(&mut self) {
        pac::WATCHDOG.load().write(|w| w.0 = self.patience_us);
    }
}

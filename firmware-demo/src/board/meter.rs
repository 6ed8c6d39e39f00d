//! Counts executed instructions and stack bytes.

use core::arch::asm;
use core::hint::black_box;

use super::machine::Counter;
use super::print::Line;
use super::stack::high_water_mark;
use crate::pil::Probe;

/// Counts what a closure executes, less what the reading itself costs.
///
/// Exact under `-icount` with the shift of the board (10 on `mps2-an386`, 0 on `virt`); meaningless without.
#[derive(Debug)]
pub struct Meter {
    counter: Counter,
    overhead: u32,
}

impl Meter {
    /// Starts the counter and measures an empty region.
    pub fn start() -> Self {
        let mut meter = Self {
            counter: Counter::start(),
            overhead: 0,
        };
        meter.overhead = meter.raw(|| ()).1;
        meter
    }

    /// Runs `work` and returns the instructions it executed.
    ///
    /// Let it capture references and write its result in place: a value returned is copied inside the region.
    #[inline(always)]
    pub fn measure<R>(&mut self, work: impl FnOnce() -> R) -> (R, u32) {
        let (result, raw) = self.raw(work);
        (
            result,
            Counter::instructions(raw.saturating_sub(self.overhead)),
        )
    }

    #[inline(always)]
    fn raw<R>(&mut self, work: impl FnOnce() -> R) -> (R, u32) {
        // What the closure captures becomes unknown to the compiler and its result counts as used; with the
        // readings as memory barriers nothing can then be computed outside of the region.
        let work = black_box(work);
        let before = self.counter.read();
        let result = black_box(work());
        let after = self.counter.read();
        (result, Counter::elapsed(before, after))
    }
}

impl Probe for Meter {
    #[inline(always)]
    fn count<R>(&mut self, work: impl FnOnce() -> R) -> (R, u32) {
        self.measure(work)
    }

    fn stack_bytes(&self) -> u32 {
        high_water_mark()
    }
}

/// Executes 1000 instructions: what a meter must say about it shows that it counts instructions.
#[inline(always)]
pub fn thousand_nops() {
    // SAFETY: does nothing.
    unsafe { asm!(".rept 1000", "nop", ".endr", options(nomem, nostack)) };
}

/// Least, most and sum of what was measured.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    least: u32,
    most: u32,
    sum: u32,
    count: u32,
}

impl Spread {
    /// Nothing measured yet.
    pub const fn new() -> Self {
        Self {
            least: u32::MAX,
            most: 0,
            sum: 0,
            count: 0,
        }
    }

    /// Adds one measurement.
    pub const fn add(&mut self, value: u32) {
        if value < self.least {
            self.least = value;
        }
        if value > self.most {
            self.most = value;
        }
        self.sum = self.sum.saturating_add(value);
        self.count = self.count.saturating_add(1);
    }

    /// Prints `name min mean max`.
    pub fn print(&self, name: &str) {
        Line::new()
            .text(name)
            .number(self.least)
            .mean(self.sum, self.count)
            .number(self.most)
            .print();
    }
}

impl Default for Spread {
    fn default() -> Self {
        Self::new()
    }
}

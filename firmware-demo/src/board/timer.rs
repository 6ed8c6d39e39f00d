//! A closure that runs in the timer's interrupt, as long as another one runs in the background.

use core::cell::UnsafeCell;
use core::mem::transmute;

use super::timer_machine::{COUNTS_PER_US, Timer};

type Tick<'a> = dyn FnMut(u32) + Send + 'a;

struct Slot(UnsafeCell<Running>);

struct Running {
    tick: Option<*mut Tick<'static>>,
    timer: Option<Timer>,
    counts: u32,
    rest: u32,
    now_us: u32,
}

// SAFETY: one core. The slot is written while the timer's interrupt is off, and else touched by that interrupt
// alone, which does not interrupt itself.
unsafe impl Sync for Slot {}

static SLOT: Slot = Slot(UnsafeCell::new(Running {
    tick: None,
    timer: None,
    counts: 0,
    rest: 0,
    now_us: 0,
}));

/// Runs `background` and, every `period_us` in the timer's interrupt, `tick` with the time in microseconds,
/// which wraps around. Not to be nested. The binary has to invoke [`timer_interrupt!`](crate::timer_interrupt).
pub fn with_ticks<R>(
    period_us: u32,
    tick: &mut (dyn FnMut(u32) + Send),
    background: impl FnOnce() -> R,
) -> R {
    let timer = Timer::new(period_us);
    let tick: *mut Tick<'_> = tick;
    let running = Running {
        // SAFETY: only the lifetime changes; the slot forgets the pointer before it ends.
        tick: Some(unsafe { transmute::<*mut Tick<'_>, *mut Tick<'static>>(tick) }),
        counts: timer.counts(),
        timer: Some(timer),
        rest: 0,
        now_us: 0,
    };
    // SAFETY: the interrupt is off, see `Slot`.
    unsafe { *SLOT.0.get() = running };
    Timer::enable();
    let result = background();
    Timer::disable();
    // SAFETY: as above.
    unsafe { (*SLOT.0.get()).tick = None };
    result
}

/// What the timer's interrupt does.
pub fn interrupt() {
    // SAFETY: called by the interrupt alone, see `Slot`.
    let running = unsafe { &mut *SLOT.0.get() };
    let (Some(tick), Some(timer)) = (running.tick, &mut running.timer) else {
        return;
    };
    timer.acknowledge();
    let counts = timer.counts();
    let passed = counts
        .wrapping_sub(running.counts)
        .saturating_add(running.rest);
    running.counts = counts;
    running.rest = passed % COUNTS_PER_US;
    running.now_us = running.now_us.wrapping_add(passed / COUNTS_PER_US);
    // SAFETY: `with_ticks` holds the exclusive borrow for as long as the pointer is in the slot.
    unsafe { (*tick)(running.now_us) };
}

//! Ticks of a whole base between marks, for an emulator that writes down every instruction: following a route from its start, then
//! parking. Prints what the counter says of the same ticks, so that who reads the trace knows that nothing is missing.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
firmware_demo::firmware!(chip::run);

#[cfg(target_os = "none")]
mod chip {
    use controller_core::base::Order;
    use controller_core::types::Pose;
    use firmware_demo::board::print::Line;
    use firmware_demo::board::{Meter, Spread};
    use firmware_demo::mission::{self, PERIOD_US, Tick};
    use firmware_demo::route::CURVE;

    /// The last tick that follows, of those from the second one on, which are marked.
    const FOLLOWED: u32 = 301;
    /// The first one that parks and is marked: a search for a manoeuvre, of 0.35 s at most, is over by then.
    const SEARCHED: u32 = FOLLOWED + 350_000 / PERIOD_US + 1;
    /// The last tick.
    const LAST: u32 = SEARCHED + 299;
    /// Half a metre ahead of where the base is by then.
    const PARK: Order = Order::Park(Pose {
        x: 0.6,
        y: 0.0,
        theta: 0.0,
    });

    /// Where a trace shows that a tick begins or ends: one instruction, and the call.
    macro_rules! mark {
        ($name:ident) => {
            #[allow(unsafe_code)]
            #[unsafe(naked)]
            #[unsafe(no_mangle)]
            extern "C" fn $name() {
                #[cfg(target_arch = "arm")]
                core::arch::naked_asm!("bx lr");
                #[cfg(target_arch = "riscv32")]
                core::arch::naked_asm!("ret");
            }
        };
    }
    mark!(follow_begins);
    mark!(park_begins);
    mark!(tick_ends);

    pub fn run() {
        let Ok(base) = mission::base(false) else {
            return Line::new().text("!parameters").print();
        };
        let mut meter = Meter::start();
        let (mut follow, mut park) = (Spread::new(), Spread::new());
        let mut number = 0;
        let driven = mission::drive(&CURVE, &base, LAST, |base, given| {
            number += 1;
            let Tick {
                dt_us,
                order,
                sensed,
            } = given;
            let mut marked = |begins: extern "C" fn(), order: &Order| {
                let work = || {
                    begins();
                    base.tick(*dt_us, order, sensed);
                    tick_ends();
                };
                meter.measure(work).1
            };
            match number {
                ..2 => {
                    base.tick(*dt_us, order, sensed);
                }
                2..=FOLLOWED => follow.add(marked(follow_begins, order)),
                SEARCHED.. => park.add(marked(park_begins, &PARK)),
                _ => {
                    base.tick(*dt_us, &PARK, sensed);
                }
            }
        });
        if driven.is_err() {
            return Line::new().text("!fault").print();
        }
        follow.print("base/follow");
        park.print("base/park");
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This program runs on an emulated board; `tests/src/cycles.rs` reads its trace.");
}

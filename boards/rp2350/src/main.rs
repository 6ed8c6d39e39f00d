//! A base on an RP2350: pins, timers and interrupts. All that is decided is decided in `board-common`.
//!
//! | what | where |
//! | --- | --- |
//! | PWM right, left | GPIO 2, 3 (slice 1) |
//! | direction right, left | GPIO 4, 5 |
//! | enable of both bridges | GPIO 6 |
//! | encoder right, left | GPIO 10 11, GPIO 12 13 (PIO0) |
//! | line to the host | GPIO 0 out, 1 in (UART0) |
//! | microseconds and tick | TIMER0 and its alarm 1 |
#![no_std]
#![no_main]

mod clocks;
mod encoders;
mod pins;
mod port;
mod safe;
mod timer;
mod watchdog;

use core::cell::Cell;
use core::sync::atomic::{AtomicU32, Ordering};

use board_common::{
    BoardBase, Bytes, MotorSide, NoGyro, NoMemory, NoSupply, Parts, Queues, config, robot, start,
};
use critical_section::Mutex;
use rp_pac::interrupt;

use clocks::SYSTEM_HZ;
use encoders::Encoders;
use pins::{Duty, Output, start_pwm};
use port::Port;
use timer::{Alarm, Micros};
use watchdog::Watchdog;

type Robot = BoardBase<'static, Duty, Output, Output, Encoders, Micros>;

/// Steps of the PWM but one.
const TOP: u16 = {
    let steps = SYSTEM_HZ / config::PWM_HZ;
    assert!(steps > 1 && steps <= u16::MAX as u32);
    steps as u16 - 1
};

/// Where the boot ROM finds that this is a secure program for the chip's Arm cores (datasheet, 5.9.5.1).
#[used]
#[allow(unsafe_code)]
// SAFETY: the memory map keeps the section for this block alone.
#[unsafe(link_section = ".start_block")]
static IMAGE: [u32; 5] = [0xffff_ded3, 0x1021_0142, 0x0000_01ff, 0, 0xab12_3579];

/// What the timer's interrupt takes over from `main`.
struct Tick {
    robot: Robot,
    alarm: Alarm,
}

static TICK: Mutex<Cell<Option<Tick>>> = Mutex::new(Cell::new(None));
static RECEIVED: Bytes = Bytes::new();
/// Ticks so far: what the watchdog is fed for.
static TICKS: AtomicU32 = AtomicU32::new(0);

#[cortex_m_rt::entry]
fn main() -> ! {
    run();
    // There is no robot to drive: everything stays off.
    safe::halt()
}

/// Sets up and stays in the background; returns only if the board cannot be set up.
fn run() -> Option<()> {
    clocks::start()?;
    // Pins are pulled down inputs from reset on, and the resistors of the wiring table hold the bridges off.
    let enable = Output::low::<6>();
    let (right, left) = start_pwm::<2, 3>(TOP);
    let parts = Parts {
        right: MotorSide {
            pwm: right,
            direction: Output::low::<4>(),
        },
        left: MotorSide {
            pwm: left,
            direction: Output::low::<5>(),
        },
        enable,
        encoders: Encoders::start::<10, 11, 12, 13>(),
        gyro: NoGyro,
        supply: NoSupply,
        clock: Micros,
        memory: NoMemory,
    };
    let queues = cortex_m::singleton!(: Queues = Queues::default())?;
    let (robot, mut line) = start(parts, queues).ok()?;

    let mut port = Port::start::<0, 1>();

    let tick = Tick {
        robot,
        alarm: Alarm::start(robot::PERIOD_US),
    };
    critical_section::with(|token| TICK.borrow(token).set(Some(tick)));
    let mut watchdog = Watchdog::start::<{ config::WATCHDOG_MS }>();
    Alarm::unmask();

    let mut fed_at = 0;
    loop {
        port.receive(|byte| RECEIVED.push(byte));
        line.poll(&RECEIVED, |byte| port.send(byte));
        // Fed by the background for what the interrupt did: both have to be alive.
        let ticks = TICKS.load(Ordering::Relaxed);
        if ticks != fed_at {
            fed_at = ticks;
            watchdog.feed();
        }
    }
}

#[interrupt]
fn TIMER0_IRQ_1() {
    static mut MINE: Option<Tick> = None;
    if MINE.is_none() {
        *MINE = critical_section::with(|token| TICK.borrow(token).take());
    }
    if let Some(Tick { robot, alarm }) = MINE {
        alarm.again();
        robot.tick();
        TICKS.store(
            TICKS.load(Ordering::Relaxed).wrapping_add(1),
            Ordering::Relaxed,
        );
    }
}

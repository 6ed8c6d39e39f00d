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

mod encoders;
mod safe;
mod timer;

use core::cell::Cell;
use core::sync::atomic::{AtomicU32, Ordering};

use board_common::{BAUD, Base, Bytes, MotorSide, Parts, Queues, config, start};
use critical_section::Mutex;
use embassy_rp::clocks::clk_sys_freq;
use embassy_rp::gpio::{Level, Output};
use embassy_rp::interrupt;
use embassy_rp::pwm::{Pwm, PwmOutput};
use embassy_rp::uart::{self, Uart};
use embassy_rp::watchdog::Watchdog;
use embassy_time::Duration;
use embedded_hal_nb::serial::{Read as _, Write as _};

use encoders::Encoders;
use timer::{Alarm, Micros};

type Pin = Output<'static>;
type Robot = Base<'static, PwmOutput<'static>, Pin, Pin, Encoders, Micros>;

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
    let device = embassy_rp::init(embassy_rp::config::Config::default());
    // Pins are pulled down inputs from reset on, and the resistors of the wiring table hold the bridges off.
    let enable = Output::new(device.PIN_6, Level::Low);

    let mut pwm = embassy_rp::pwm::Config::default();
    let steps = clk_sys_freq().checked_div(config::PWM_HZ)?;
    pwm.top = u16::try_from(steps.saturating_sub(1)).ok()?;
    let pwm = Pwm::new_output_ab(device.PWM_SLICE1, device.PIN_2, device.PIN_3, pwm);
    let (right, left) = pwm.split();
    let encoders = Encoders::start(
        device.PIO0,
        (device.PIN_10, device.PIN_11),
        (device.PIN_12, device.PIN_13),
    );
    let parts = Parts {
        right: MotorSide {
            pwm: right?,
            direction: Output::new(device.PIN_4, Level::Low),
        },
        left: MotorSide {
            pwm: left?,
            direction: Output::new(device.PIN_5, Level::Low),
        },
        enable,
        encoders,
        clock: Micros,
    };
    let queues = cortex_m::singleton!(: Queues = Queues::default())?;
    let (robot, mut line) = start(parts, queues).ok()?;

    let mut port = uart::Config::default();
    port.baudrate = BAUD;
    let port = Uart::new_blocking(device.UART0, device.PIN_0, device.PIN_1, port);
    let (mut transmitter, mut receiver) = port.split();

    let tick = Tick {
        robot,
        alarm: Alarm::start(config::PERIOD_US),
    };
    critical_section::with(|token| TICK.borrow(token).set(Some(tick)));
    let patience = Duration::from_millis(u64::from(config::WATCHDOG_MS));
    let mut watchdog = Watchdog::new(device.WATCHDOG);
    watchdog.start(patience);
    Alarm::unmask();

    let mut fed_at = 0;
    loop {
        // No more than the port's own queue holds. A byte with an error is left out; its frame fails the check sum.
        for _ in 0..32 {
            match receiver.read() {
                Ok(byte) => RECEIVED.push(byte),
                Err(_) => break,
            }
        }
        line.poll(&RECEIVED, |byte| transmitter.write(byte).is_ok());
        // Fed by the background for what the interrupt did: both have to be alive.
        let ticks = TICKS.load(Ordering::Relaxed);
        if ticks != fed_at {
            fed_at = ticks;
            watchdog.feed(patience);
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

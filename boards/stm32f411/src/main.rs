//! A base on an STM32F411: pins, timers and interrupts. All that is decided is decided in `board-common`.
//!
//! | what | where |
//! | --- | --- |
//! | PWM right, left | PA8, PA9 (TIM1) |
//! | direction right, left | PB0, PB1 |
//! | enable of both bridges | PB10 |
//! | encoder right, left | PA6 PA7 (TIM3), PB6 PB7 (TIM4) |
//! | supply, if `config::SUPPLY_DIVIDER` says so | PA1 (ADC1) |
//! | line to the host | PA2 out, PA3 in (USART2) |
//! | microseconds, tick | TIM2, TIM5 |
//! | stored parameters | sectors 1 and 2 of the flash |
//! | lamp: the clock is not the crystal's | PC13 |
#![no_std]
#![no_main]

mod clocks;
mod encoders;
mod flash;
mod micros;
mod safe;
mod supply;

use core::cell::Cell;
use core::sync::atomic::{AtomicU32, Ordering};

use board_common::{
    BAUD, BoardBase, Bytes, MotorSide, NoGyro, Parts, Queues, Slots, config, robot, start,
};
use cortex_m::peripheral::NVIC;
use critical_section::Mutex;
use embedded_hal_nb::serial::{Read as _, Write as _};
use stm32f4xx_hal::gpio::{Output, PB10, PinState};
use stm32f4xx_hal::pac::{self, Interrupt, TIM1, TIM5, USART2, interrupt};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::serial::{self, Rx};
use stm32f4xx_hal::timer::{CounterUs, ErasedChannel, Event};
use stm32f4xx_hal::watchdog::IndependentWatchdog;

use clocks::Clocks;
use encoders::Encoders;
use flash::Sectors;
use micros::Micros;
use supply::Adc;

type Direction = stm32f4xx_hal::gpio::AnyPin<Output>;
type Robot = BoardBase<
    'static,
    ErasedChannel<TIM1>,
    Direction,
    PB10<Output>,
    Encoders,
    Micros,
    Slots<Sectors>,
    NoGyro,
    Option<Adc>,
>;

/// What the timer's interrupt takes over from `main`.
struct Tick {
    robot: Robot,
    timer: CounterUs<TIM5>,
}

static TICK: Mutex<Cell<Option<Tick>>> = Mutex::new(Cell::new(None));
static RECEIVER: Mutex<Cell<Option<Rx<USART2>>>> = Mutex::new(Cell::new(None));
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
    let device = pac::Peripherals::take()?;
    let mut core = cortex_m::Peripherals::take()?;
    // Pins are inputs from reset on, and the resistors of the wiring table hold the bridges off.
    let clocks = Clocks::start(&device.RCC, &device.PWR, &device.FLASH)?;
    let mut rcc = device.RCC.constrain();
    let a = device.GPIOA.split(&mut rcc);
    let b = device.GPIOB.split(&mut rcc);
    let c = device.GPIOC.split(&mut rcc);
    // The board's lamp shines while its pin is low: then the clock is not the crystal's, for which the line has no message.
    c.pc13
        .into_push_pull_output_in_state(PinState::from(clocks.from_crystal));
    let enable = b.pb10.into_push_pull_output_in_state(PinState::Low);

    let (_, (right, left, ..)) = device.TIM1.pwm_hz(config::PWM_HZ.Hz(), &mut rcc);
    let (mut right, mut left) = (right.with(a.pa8), left.with(a.pa9));
    let mut timer = device.TIM5.counter_us(&mut rcc);
    let pins = (a.pa2, a.pa3);
    let port = serial::config::Config::default().baudrate(BAUD.bps());
    let port = device.USART2.serial::<u8>(pins, port, &mut rcc).ok()?;
    clocks.correct();
    right.set_duty(0);
    left.set_duty(0);
    right.enable();
    left.enable();
    let low = PinState::Low;
    let parts = Parts {
        right: MotorSide {
            pwm: right.erase(),
            direction: b.pb0.into_push_pull_output_in_state(low).erase(),
        },
        left: MotorSide {
            pwm: left.erase(),
            direction: b.pb1.into_push_pull_output_in_state(low).erase(),
        },
        enable,
        encoders: Encoders::new(
            device.TIM3.qei((a.pa6, a.pa7), &mut rcc),
            device.TIM4.qei((b.pb6, b.pb7), &mut rcc),
        ),
        gyro: NoGyro,
        supply: config::SUPPLY_DIVIDER
            .map(|divider| Adc::start(device.ADC1, &device.ADC_COMMON, a.pa1, divider, &mut rcc)),
        clock: Micros::start(device.TIM2, clocks, &mut rcc),
        memory: Sectors::prepared(device.FLASH),
    };
    let queues = cortex_m::singleton!(: Queues = Queues::default())?;
    let (robot, mut line) = start(parts, queues).ok()?;

    let (mut transmitter, mut receiver) = port.split();
    receiver.listen();
    timer.start(robot::PERIOD_US.micros()).ok()?;
    timer.listen(Event::Update);
    critical_section::with(|token| {
        RECEIVER.borrow(token).set(Some(receiver));
        TICK.borrow(token).set(Some(Tick { robot, timer }));
    });
    let mut watchdog = IndependentWatchdog::new(device.IWDG);
    watchdog.start(config::WATCHDOG_MS.millis());
    unmask(&mut core.NVIC);

    let mut fed_at = 0;
    loop {
        line.poll(&RECEIVED, |byte| transmitter.write(byte).is_ok());
        // Fed by the background for what the interrupt did: both have to be alive.
        let ticks = TICKS.load(Ordering::Relaxed);
        if ticks != fed_at {
            fed_at = ticks;
            watchdog.feed();
        }
    }
}

/// Bytes come before ticks, for the port holds only one.
#[allow(unsafe_code)]
fn unmask(nvic: &mut NVIC) {
    // SAFETY: no critical section relies on priorities, and both handlers cope with coming at once.
    unsafe {
        nvic.set_priority(Interrupt::USART2, 0x10);
        nvic.set_priority(Interrupt::TIM5, 0x20);
        NVIC::unmask(Interrupt::USART2);
        NVIC::unmask(Interrupt::TIM5);
    }
}

#[interrupt]
fn TIM5() {
    static mut MINE: Option<Tick> = None;
    if MINE.is_none() {
        *MINE = critical_section::with(|token| TICK.borrow(token).take());
    }
    if let Some(Tick { robot, timer }) = MINE {
        // Clears the request; there is nothing else to wait for.
        let _ = timer.wait();
        robot.tick();
        TICKS.store(
            TICKS.load(Ordering::Relaxed).wrapping_add(1),
            Ordering::Relaxed,
        );
    }
}

#[interrupt]
fn USART2() {
    static mut MINE: Option<Rx<USART2>> = None;
    if MINE.is_none() {
        *MINE = critical_section::with(|token| RECEIVER.borrow(token).take());
    }
    if let Some(receiver) = MINE {
        // A byte with an error is read, which clears the error, and left out; its frame fails the check sum.
        if let Ok(byte) = receiver.read() {
            RECEIVED.push(byte);
        }
    }
}

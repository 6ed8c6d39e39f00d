//! Pins, outputs and PWM. Numbers of pins are constants, so that the checks of the accessors fold away.

use core::convert::Infallible;

use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use rp_pac as pac;
use rp_pac::io::vals::Gpio0ctrlFuncsel;

/// What a pin is connected to, by the number in its control register.
#[derive(Clone, Copy)]
pub enum Function {
    Uart = Gpio0ctrlFuncsel::UART0_TX as isize,
    Pwm = Gpio0ctrlFuncsel::PWM_A_0 as isize,
    Software = Gpio0ctrlFuncsel::SIOB_PROC_0 as isize,
    Pio0 = Gpio0ctrlFuncsel::PIO0_0 as isize,
}

/// Connects a pin; its pad holds what it was until the last of these writes.
pub fn connect<const PIN: usize>(function: Function, pull_up: bool) {
    let (gpio, pad) = (pac::IO_BANK0.gpio(PIN), pac::PADS_BANK0.gpio(PIN));
    gpio.ctrl().write(|w| w.set_funcsel(function as u8));
    pad.modify(|w| {
        w.set_ie(true);
        w.set_pue(pull_up);
        w.set_pde(false);
        w.set_iso(false);
    });
}

/// A pin that software sets.
pub struct Output {
    mask: u32,
}

impl Output {
    /// Low from the moment in which it becomes an output.
    pub fn low<const PIN: usize>() -> Self {
        let mask = const {
            assert!(PIN < 32);
            1 << PIN
        };
        pac::SIO.gpio_out(0).value_clr().write_value(mask);
        pac::SIO.gpio_oe(0).value_set().write_value(mask);
        connect::<PIN>(Function::Software, false);
        Self { mask }
    }
}

impl digital::ErrorType for Output {
    type Error = Infallible;
}

impl OutputPin for Output {
    fn set_low(&mut self) -> Result<(), Infallible> {
        pac::SIO.gpio_out(0).value_clr().write_value(self.mask);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        pac::SIO.gpio_out(0).value_set().write_value(self.mask);
        Ok(())
    }
}

/// The slice of both motors.
pub const SLICE: usize = 1;

/// One channel of the slice.
pub struct Duty {
    channel: Channel,
    top: u16,
}

enum Channel {
    A,
    B,
}

/// Starts both channels at a duty of 0, right (A) and left (B), with `top` + 1 steps of the system clock.
pub fn start_pwm<const RIGHT: usize, const LEFT: usize>(top: u16) -> (Duty, Duty) {
    const { assert!(RIGHT == 2 * SLICE && LEFT == 2 * SLICE + 1) };
    let slice = pac::PWM.ch(SLICE);
    slice.csr().write(|w| w.set_en(false));
    slice.ctr().write(|w| w.set_ctr(0));
    slice.div().write(|w| w.set_int(1));
    slice.cc().write(|w| {
        w.set_a(0);
        w.set_b(0);
    });
    slice.top().write(|w| w.set_top(top));
    slice.csr().write(|w| w.set_en(true));
    connect::<RIGHT>(Function::Pwm, false);
    connect::<LEFT>(Function::Pwm, false);
    let duty = |channel| Duty { channel, top };
    (duty(Channel::A), duty(Channel::B))
}

impl pwm::ErrorType for Duty {
    type Error = Infallible;
}

impl SetDutyCycle for Duty {
    fn max_duty_cycle(&self) -> u16 {
        self.top
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        let slice = pac::PWM.ch(SLICE);
        let duty = duty.min(self.top);
        // Both channels share the register, and only the tick writes it.
        slice.cc().modify(|w| match self.channel {
            Channel::A => w.set_a(duty),
            Channel::B => w.set_b(duty),
        });
        Ok(())
    }
}

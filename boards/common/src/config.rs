//! How a board drives its robot. The robot itself is [`robot`](crate::robot).

use firmware_demo::drive::OffPhase;

/// Decimation of reports: one of this many is sent.
pub const DECIMATE: u16 = 20;
/// The watchdog resets the chip after this long without ticks \[ms\].
pub const WATCHDOG_MS: u32 = 50;
/// PWM frequency \[Hz\]: above hearing, and slow enough for a common bridge.
pub const PWM_HZ: u32 = 20_000;
/// What the bridges do while their PWM is low; those of the board's README short the motors.
pub const OFF_PHASE: OffPhase = OffPhase::Shorted;
/// Volts of the motor supply for each volt at the board's pin that measures it: 11 behind 100 kΩ to the supply and 10 kΩ to
/// ground. `None` where nothing is wired to that pin, and for boards without one: what an open pin says is no supply.
pub const SUPPLY_DIVIDER: Option<f32> = None;

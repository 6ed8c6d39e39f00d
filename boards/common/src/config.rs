//! How a board drives its robot. The robot itself is [`robot`](crate::robot).

use controller_core::motor::DriverParams;
use firmware_demo::drive::OffPhase;

use crate::robot;

/// Decimation of reports: one of this many is sent, some [`REPORTS_HZ`] of them, or every one of slower ticks.
pub const DECIMATE: u16 = decimate(robot::PERIOD_US);
/// The watchdog resets the chip after this long without ticks \[ms\].
pub const WATCHDOG_MS: u32 = watchdog_ms(robot::PERIOD_US);
/// Reports a second, of ticks that are not slower.
pub const REPORTS_HZ: u32 = 50;
/// The shortest time after which the watchdog resets the chip \[ms\].
const LEAST_WATCHDOG_MS: u32 = 50;
/// It waits for so many ticks at least: the oscillator of the STM32F411's watchdog runs at 17 to 47 instead of 32 kHz, which leaves 2.7
/// of them.
const WATCHDOG_TICKS: u32 = 4;
/// PWM frequency \[Hz\]: above hearing, and slow enough for a common bridge.
pub const PWM_HZ: u32 = 20_000;
/// What the bridges do while their PWM is low; those of the board's README short the motors.
pub const OFF_PHASE: OffPhase = OffPhase::Shorted;
/// Volts of the motor supply for each volt at the board's pin that measures it: 11 behind 100 kΩ to the supply and 10 kΩ to
/// ground. `None` where nothing is wired to that pin, and for boards without one: what an open pin says is no supply.
pub const SUPPLY_DIVIDER: Option<f32> = None;

const _: () = assert!(
    is_driven(&robot::BASE.driver),
    "the boards have PWM outputs for motors only: the robot needs [motor], and neither [speed_driver] nor drivers of torques"
);

/// Whether the boards have outputs for such drivers.
const fn is_driven(driver: &DriverParams<f32>) -> bool {
    matches!(driver, DriverParams::Motors(_))
}

/// The decimation that comes nearest to [`REPORTS_HZ`]. Periods of a robot's file are 100 µs and more.
const fn decimate(period_us: u32) -> u16 {
    let apart_us = 1_000_000 / REPORTS_HZ;
    let ticks = (apart_us + period_us / 2) / period_us;
    assert!(ticks <= u16::MAX as u32, "the robot's period is too short");
    if ticks > 1 { ticks as u16 } else { 1 }
}

const fn watchdog_ms(period_us: u32) -> u32 {
    let ms = (WATCHDOG_TICKS * period_us).div_ceil(1000);
    if ms > LEAST_WATCHDOG_MS {
        ms
    } else {
        LEAST_WATCHDOG_MS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use controller_core::motor::SpeedParams;

    /// What `control.period_s` may be, and those of the shipped robots between.
    const PERIODS_US: [u32; 8] = [100, 1_000, 5_000, 10_000, 20_000, 30_000, 50_000, 100_000];

    #[test]
    fn reports_come_fifty_times_a_second_or_each_tick() {
        for period_us in PERIODS_US {
            let apart_us = u32::from(decimate(period_us)) * period_us;
            assert_eq!(apart_us, period_us.max(20_000), "{period_us} us");
        }
        // Those that do not divide 20 ms: as near as whole ticks come.
        for (period_us, ticks) in [(3_000, 7), (7_000, 3), (12_000, 2), (15_000, 1)] {
            assert_eq!(decimate(period_us), ticks, "{period_us} us");
        }
    }

    #[test]
    fn the_watchdog_outlasts_ticks_by_the_slowest_and_the_fastest_oscillator() {
        for period_us in PERIODS_US {
            let patience_us = 1000 * watchdog_ms(period_us);
            assert!(patience_us >= 50_000, "{period_us} us: {patience_us} us");
            let shortest_us = patience_us / 47 * 32;
            assert!(
                shortest_us > 2 * period_us,
                "{period_us} us: {shortest_us} us"
            );
        }
        assert_eq!(watchdog_ms(1_000), 50);
    }

    #[test]
    fn a_robot_without_motors_is_none_of_a_board() {
        let motor = robot::BASE.driver.motor().expect("motors");
        assert!(is_driven(&DriverParams::Motors(*motor)));
        assert!(!is_driven(&DriverParams::Torques));
        assert!(!is_driven(&DriverParams::Speeds(SpeedParams {
            max_speed_rad_s: 10.0,
            min_speed_rad_s: 0.0,
            lag_s: 0.0,
            breakaway_nm: 0.0,
        })));
    }
}

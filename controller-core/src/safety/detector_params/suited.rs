//! Thresholds and times that follow from a base.

use super::{
    CurrentDetectorParams, DetectorParams, LOADS, SlipDetectorParams, StuckDetectorParams,
    SupplyDetectorParams, TickDetectorParams, Timeout, UNNOTICED, WheelDetectorParams,
};
use crate::motion::MotionParams;
use crate::scalar::{Scalar, microseconds};

/// A supply is too low below this share of its nominal voltage, and good again above the other.
/// Lead and lithium batteries are empty at 0.8 to 0.85 and sag by a tenth under load.
const LOW_SUPPLY: (f64, f64) = (0.7, 0.75);

impl<T: Scalar> SupplyDetectorParams<T> {
    /// What suits a battery of this nominal voltage \[V\]: [`DetectorParams::for_base`] does not know it, a base with motors does.
    pub fn for_nominal(volts: T) -> Self {
        Self {
            low_v: T::from_f64(LOW_SUPPLY.0) * volts,
            recovered_v: T::from_f64(LOW_SUPPLY.1) * volts,
            // Longer than the current of a start from rest.
            after: Timeout::AfterUs(500_000),
        }
    }
}

impl<T: Scalar> DetectorParams<T> {
    /// What suits a base with encoders and a host, ticking every `period_us`.
    ///
    /// External poses, currents and supply are off: their limits are not known from the base.
    pub fn for_base(motion: &MotionParams<T>, counts_per_turn: T, period_us: u32) -> Self {
        let f = T::from_f64;
        let wheels = &motion.robot.wheels;
        let radius = wheels.mean_radius_m();
        // Half of the weight is on each wheel. 5 % of it is a ramp of 3 degrees; ramps and pushes of 15 % are
        // still not taken for a fault.
        let share = f(0.05 * 9.81) * T::HALF * motion.robot.mass_kg * radius;
        // Feeble wheels have to be able to exceed it fourfold, or nothing would ever be found.
        let most = f(0.25) * motion.limits.wheel_torque_nm;
        let load_nm = if share < most { share } else { most };
        // Of a coarse encoder 3 counts in the time are more; a tenth keeps it clear of rounding.
        let (slow, counts) = (
            f(0.02) / radius,
            f(3.3 / 0.25) * (T::PI + T::PI) / counts_per_turn,
        );
        let us = |n: u32, least: u32| period_us.saturating_mul(n).max(least);
        let ticks = |n: u32, least: u32| Timeout::AfterUs(us(n, least));
        Self {
            period_us,
            robot: motion.robot,
            // Five readings lost in a row are no accident.
            measurement: ticks(5, 0),
            pose: Timeout::Off,
            command: ticks(UNNOTICED.0, UNNOTICED.1),
            ticks: TickDetectorParams {
                late: Timeout::AfterUs(period_us.saturating_add(period_us / 2)),
                row: 5,
                of_64: 16,
                // The gains of faster loops are those of ticks of 20 ms and less: what one of 5 ms can stand, its ten periods, they can.
                // A tick of which the law takes no step is too long for any.
                long: Timeout::AfterUs(us(10, 50_000).min(microseconds(motion.max_tick_s))),
            },
            wheels: WheelDetectorParams {
                counts_per_turn,
                load_nm,
                stuck: StuckDetectorParams {
                    // The load that a reversed wheel may not be confused with, too.
                    torque_nm: f(LOADS) * load_nm,
                    // 2 cm/s: slower, and nothing is lost by waiting.
                    speed_rad_s: if slow > counts { slow } else { counts },
                    after: ticks(10, 250_000),
                },
                reversed: ticks(3, 30_000),
                slip: SlipDetectorParams {
                    // 3 m/s²: a third of the weight would have to push.
                    accel_rad_s2: f(3.0) / radius,
                    speed_m_s: f(0.2),
                    after: ticks(5, 50_000),
                },
            },
            current: CurrentDetectorParams {
                limit_a: f(10.0),
                after: Timeout::Off,
            },
            supply: SupplyDetectorParams {
                low_v: f(10.0),
                recovered_v: f(11.0),
                after: Timeout::Off,
            },
        }
    }
}

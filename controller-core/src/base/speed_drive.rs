//! Drivers that close their own speed loop: the law's command as wheel speeds, and the way that a wheel lacks while the base creeps.
//!
//! A driver's loop integrates what its wheel lacks of a speed, so friction holds a wheel until enough of the way has been commanded: of
//! millimetres a second, as they are asked for beside a goal, for tens of seconds. And a driver whose slowest speed is higher does nothing at all. A base that
//! creeps ([`Creeps`](super::wheel_friction::Creeps)) therefore commands the way beside the speed, by counts:
//!
//! ```text
//! e' = φ̇_c − φ̇      φ̇* = φ̇_c + k e      k = 1/(4 (T_d + Δt))      |k e| ≤ max(φ̇_w, φ̇_min)
//! ```
//!
//! | symbol | name | unit |
//! | --- | --- | --- |
//! | φ̇_c, φ̇, φ̇* | speed of a wheel: commanded by the law, counted, handed to the driver | rad/s |
//! | e | way that it lacks | rad |
//! | T_d, Δt | lag of the driver's loop, period | s |
//! | φ̇_w | speed from which on a wheel is watched: [`StuckDetectorParams::speed_rad_s`](crate::safety::StuckDetectorParams) | rad/s |
//! | φ̇_min | slowest speed that the driver executes | rad/s |
//!
//! With a driver that follows as 1/(T s + 1), T = T_d + Δt, the loop has T s² + s + k = 0: critically damped. What holds a wheel against more than φ̇_w is for
//! the detectors. At φ̇_min the driver executes it: slower speeds become pulses, whose mean is right.

use crate::error::StepFault;
use crate::hal::WheelCounts;
use crate::motor::{SpeedOutput, SpeedState, WheelSpeedCommand};
use crate::range::clamp;
use crate::scalar::Scalar;
use crate::types::{Accel, Twist, WheelSpeeds};
use crate::wheels::WheelMap;

/// What is remembered of both wheels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SpeedDrive<T> {
    state: SpeedState,
    /// The last reading.
    counts: Option<WheelCounts>,
    /// e.
    lacks: WheelSpeeds<T>,
    /// Commanded by the law in the last tick.
    commanded: WheelSpeeds<T>,
}

/// A tick of it.
pub(super) struct SpeedTick<'a, T> {
    pub(super) output: &'a SpeedOutput<T>,
    pub(super) wheels: &'a WheelMap<T>,
    /// What the law commands from now on, and its rate.
    pub(super) command: (&'a Twist<T>, &'a Accel<T>),
    pub(super) creeps: bool,
    pub(super) counts: Option<WheelCounts>,
    /// Turn of a wheel \[rad\].
    pub(super) per_count: T,
    /// Largest |k e| \[rad/s\].
    pub(super) most: T,
    pub(super) dt: T,
}

impl<T: Scalar> SpeedDrive<T> {
    /// What the drivers are to hold.
    ///
    /// # Errors
    /// Speeds that are not finite; nothing has changed then.
    pub(super) fn command(
        &mut self,
        tick: &SpeedTick<'_, T>,
    ) -> Result<WheelSpeedCommand<T>, StepFault> {
        let gain = self.gain(tick);
        let lacks = if tick.creeps {
            self.lacks(tick, tick.most / gain)
        } else {
            WheelSpeeds::default()
        };
        let more = WheelSpeeds {
            right: gain * lacks.right,
            left: gain * lacks.left,
        };
        let (state, wheels) = (&mut self.state, tick.wheels);
        let command = tick
            .output
            .command_with(state, wheels, tick.command, &more)?;
        self.lacks = lacks;
        self.commanded = wheels.wheel_speeds_apart(tick.command.0);
        self.counts = tick.counts.or(self.counts);
        Ok(command)
    }

    fn gain(&self, tick: &SpeedTick<'_, T>) -> T {
        T::ONE / (T::from_f64(4.0) * (tick.output.params().lag_s + tick.dt))
    }

    /// e after a tick, within ± `most`.
    fn lacks(&self, tick: &SpeedTick<'_, T>, most: T) -> WheelSpeeds<T> {
        let asked = self.commanded;
        let (Some(now), Some(last)) = (tick.counts, self.counts) else {
            return self.lacks;
        };
        WheelSpeeds {
            right: tick.lack(most, self.lacks.right, asked.right, (now.right, last.right)),
            left: tick.lack(most, self.lacks.left, asked.left, (now.left, last.left)),
        }
    }
}

impl<T: Scalar> SpeedTick<'_, T> {
    /// e of a wheel that lacked `before`, was to turn at `asked`, and counts `now` instead of `last`.
    #[inline(never)]
    fn lack(&self, most: T, before: T, asked: T, (now, last): (i32, i32)) -> T {
        let turned = T::from_i32(now.wrapping_sub(last)) * self.per_count;
        clamp(before + asked * self.dt - turned, most)
    }
}

#[cfg(test)]
mod tests {
    use super::{SpeedDrive, SpeedTick};
    use crate::error::{Input, StepFault};
    use crate::hal::WheelCounts;
    use crate::motor::{SpeedOutput, SpeedParams, WheelSpeedCommand};
    use crate::types::{Accel, Twist};
    use crate::wheels::{WheelGeometry, WheelMap};

    const DT: f64 = 0.01;
    const LAG_S: f64 = 0.04;
    /// k = 1/(4 (0.04 + 0.01)).
    const GAIN: f64 = 5.0;
    const PER_COUNT: f64 = 0.001;
    /// Wheels of 0.1 m: 2 cm/s.
    const MOST: f64 = 0.2;

    fn output() -> SpeedOutput<f64> {
        let params = SpeedParams {
            max_speed_rad_s: 10.0,
            min_speed_rad_s: 0.0,
            lag_s: LAG_S,
            breakaway_nm: 0.0,
        };
        params.validate().expect("valid")
    }

    fn wheels() -> WheelMap<f64> {
        let wheels = WheelGeometry {
            radius_right_m: 0.1,
            radius_left_m: 0.1,
            track_m: 0.5,
        };
        WheelMap::from_geometry(&wheels).expect("valid")
    }

    /// A tick that commands `speed` \[m/s\], after which the encoders give `counts`.
    fn tick(
        drive: &mut SpeedDrive<f64>,
        speed: f64,
        counts: Option<(i32, i32)>,
        creeps: bool,
    ) -> Result<WheelSpeedCommand<f64>, StepFault> {
        let (twist, rate) = (Twist::new(speed, 0.0), Accel::default());
        drive.command(&SpeedTick {
            output: &output(),
            wheels: &wheels(),
            command: (&twist, &rate),
            creeps,
            counts: counts.map(|(right, left)| WheelCounts { right, left }),
            per_count: PER_COUNT,
            most: MOST,
            dt: DT,
        })
    }

    /// 3 mm/s are 0.03 rad/s of a wheel: after n ticks one that stands lacks 0.03 n DT rad.
    #[test]
    fn a_wheel_that_stands_is_commanded_the_way_that_it_lacks() {
        for way in [1.0, -1.0] {
            let mut drive = SpeedDrive::default();
            for n in 0..2000 {
                let command = tick(&mut drive, 0.003 * way, Some((7, -3)), true).expect("finite");
                let more = (GAIN * 0.03 * DT * f64::from(n)).min(MOST);
                for speed in [command.speeds.right, command.speeds.left] {
                    // Sums of 2,000 roundings.
                    assert!((speed - way * (0.03 + more)).abs() < 1e-12, "{n} {speed}");
                }
            }
            // It comes loose and goes the 0.04 rad that it lacks at once: nothing is left of them.
            let counts = (7 + (40.0 * way) as i32, -3 + (40.0 * way) as i32);
            let command = tick(&mut drive, 0.0, Some(counts), true).expect("finite");
            assert!(
                (command.speeds.right - way * GAIN * 0.03 * DT).abs() < 1e-9,
                "{command:?}"
            );
        }
    }

    /// Its own side only, and counts that wrap around are counts.
    #[test]
    fn each_wheel_lacks_its_own_way() {
        let mut drive = SpeedDrive::default();
        tick(&mut drive, 0.1, Some((i32::MAX, 0)), true).expect("finite");
        // The right one turned by 10 counts as it was to, the left one by 6.
        let command = tick(&mut drive, 0.1, Some((i32::MIN + 9, 6)), true).expect("finite");
        assert!((command.speeds.right - 1.0).abs() < 1e-12);
        assert!((command.speeds.left - 1.0 - GAIN * 0.004).abs() < 1e-12);
    }

    #[test]
    fn a_base_that_does_not_creep_is_commanded_what_the_law_says() {
        let mut drive = SpeedDrive::default();
        for creeps in [true, true, false] {
            let command = tick(&mut drive, 0.05, Some((0, 0)), creeps).expect("finite");
            if !creeps {
                assert!((command.speeds.right - 0.5).abs() < 1e-12);
            }
        }
        // What it lacked before is forgotten.
        let command = tick(&mut drive, 0.05, Some((5, 5)), true).expect("finite");
        assert!((command.speeds.right - 0.5).abs() < 1e-12, "{command:?}");
    }

    /// Counts that are missing for a tick leave what is lacking as it was, and are made up for by the next ones, as what was commanded
    /// meanwhile is not: a lost reading makes no wheel run.
    #[test]
    fn a_lost_reading_is_no_way() {
        let mut drive = SpeedDrive::default();
        tick(&mut drive, 0.01, Some((0, 0)), true).expect("finite");
        let before = tick(&mut drive, 0.01, Some((0, 0)), true).expect("finite");
        let lost = tick(&mut drive, 0.01, None, true).expect("finite");
        assert_eq!(lost, before);
        let next = tick(&mut drive, 0.01, Some((2, 2)), true).expect("finite");
        let lacks = 2.0 * 0.1 * DT - 2.0 * PER_COUNT;
        assert!((next.speeds.right - 0.1 - GAIN * lacks).abs() < 1e-12);
    }

    #[test]
    fn what_is_refused_changes_nothing() {
        let mut drive = SpeedDrive::default();
        tick(&mut drive, 0.01, Some((0, 0)), true).expect("finite");
        let before = drive;
        for speed in [f64::NAN, f64::INFINITY] {
            let refused = StepFault::NotFinite(Input::Reference);
            assert_eq!(tick(&mut drive, speed, Some((9, 9)), true), Err(refused));
            assert_eq!(drive, before);
        }
    }
}

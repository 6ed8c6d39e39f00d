//! Pose and twist of a tick, also where the encoders gave nothing.

use super::io::Sensed;
use super::report::BaseReport;
use crate::error::StepFault;
use crate::gyro::{Encoder, GyroReport};
use crate::localiser::{Estimator, FixOutcome, ValidLocaliserParams};
use crate::maths::Maths;
use crate::odometry::{Accelerations, Odometry};
use crate::reference::sinc;
use crate::scalar::{Scalar, microseconds};
use crate::types::{Measured, Pose};

/// How much faster than its largest rim speed, which a motor reaches on a low battery and under load, no wheel turns: not on ice, nor
/// downhill. Counts that say so are no reading, and the next ones are compared with them: counts that are wrong for once cost that tick
/// and the next, encoders that begin anew cost one, and counts that are always wrong are none, which soon is a fault. Two counts more
/// are one that a wheel was about to make and one that is false: where ticks are short a single one may be more than a wheel turns in them.
const FASTER: f64 = 4.0;
/// Time between two readings that is allowed for beyond what the ticks say \[s\]: right after a late tick another one may come in no time.
const SOONEST_S: f64 = 1.0e-3;

/// The localiser, and what it needs across ticks without a reading beside the report of the last one.
// In this order, as in `BaseController`: what every tick needs lies before the history of poses.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Locator<T, const N: usize> {
    /// Where the base is if there was no reading yet, or if it was `set` there since the last tick.
    start: Pose<T>,
    /// Time since the last reading \[s\].
    blind_s: T,
    /// Time since the encoders last gave counts, be they believed or not \[s\].
    silent_s: T,
    set: bool,
    /// `None` before the first reading.
    localiser: Option<Estimator<T, N>>,
}

/// What is known of the pose at a tick, beside what stands in its report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Located {
    /// How long the base has been without poses, and without a gyro that carries it instead \[µs\]; 0 without a localisation
    /// that could be stale.
    pub(super) fix_age_us: u32,
    /// The pose is elsewhere than the base has driven.
    pub(super) jumped: bool,
    /// Poses said so, and not who set it.
    pub(super) poses_jumped: bool,
}

impl Located {
    /// Nothing is known of a tick that is refused.
    const NOT: Self = Self {
        fix_age_us: 0,
        jumped: false,
        poses_jumped: false,
    };
}

impl<T: Scalar, const N: usize> Locator<T, N> {
    pub(super) fn new(start: Pose<T>) -> Self {
        Self {
            localiser: None,
            start,
            blind_s: T::ZERO,
            silent_s: T::ZERO,
            set: false,
        }
    }

    /// That of the last reading.
    pub(super) fn odometry(&self) -> Option<&Odometry<T>> {
        self.localiser.as_ref().map(Estimator::odometry)
    }

    /// For other parameters: begins anew, where it was by the last report.
    pub(super) fn begin_anew(&mut self, reported: Option<&Measured<T>>) {
        let last = reported.map(|measured| self.with_set(measured).pose);
        // In place: a whole one would be made on the stack first.
        self.localiser = None;
        self.start = last.unwrap_or(self.start);
        self.blind_s = T::ZERO;
        self.silent_s = T::ZERO;
        self.set = false;
    }

    /// What was measured, but where the base was set since.
    fn with_set(&self, measured: &Measured<T>) -> Measured<T> {
        Measured {
            pose: if self.set { self.start } else { measured.pose },
            ..*measured
        }
    }

    /// The pose is set; the next tick says that it jumped.
    pub(super) fn set_pose(&mut self, localisation: &ValidLocaliserParams<T>, pose: Pose<T>) {
        self.start = pose;
        self.set = true;
        if let Some(localiser) = &mut self.localiser {
            localiser.set_pose(localisation, pose);
        }
    }

    /// Of [`GyroHeading::encoder`](crate::gyro::GyroHeading).
    pub(super) fn encoder(&self) -> Option<Encoder> {
        self.localiser.as_ref()?.encoder()
    }

    /// `accelerations` are those since the last tick, `rim_speed` is the largest of [`Limits`](crate::motion::Limits). Where the base is goes into `report`.
    ///
    /// What the localiser refuses, a tick or an acceleration that is no number, is a fault there. Nothing has changed then.
    pub(super) fn advance<M: Maths<T>>(
        &mut self,
        localisation: &ValidLocaliserParams<T>,
        dt: T,
        (accelerations, rim_speed): (&Accelerations<T>, T),
        sensed: &Sensed<T>,
        report: &mut BaseReport<T>,
    ) -> Located {
        let Ok(counts) = sensed.counts else {
            self.silent_s += dt;
            return self.go_on::<M>(localisation, dt, report);
        };
        let jumped = match &mut self.localiser {
            None => {
                // In two steps: a result that holds all of it would be copied to and fro.
                let pose = self.start;
                if let Err(fault) = Estimator::<T, N>::check(&pose) {
                    return refused(report, fault);
                }
                let localiser = self.localiser.insert(Estimator::new(localisation));
                localiser.begin(localisation, pose, counts);
                blind(report);
                report.measured = Some(Measured {
                    pose,
                    ..Measured::default()
                });
                false
            }
            Some(localiser) => {
                // The counts of a gap came in all of it.
                let (tick_s, dt) = (dt, self.blind_s + dt);
                let (fix, gyro) = (sensed.fix.as_ref(), sensed.gyro.as_ref());
                let tick = match localiser.roll(localisation, counts, dt, accelerations) {
                    Ok(tick) => tick,
                    Err(fault) => return refused(report, fault),
                };
                let since = self.silent_s + tick_s + T::from_f64(SOONEST_S);
                let most = T::from_f64(FASTER) * rim_speed * since;
                // Asked for last, since it divides and nearly every reading is within the rest.
                let two_counts = || {
                    let count = localisation.params().odometry.travel_per_count_m();
                    count + count
                };
                if !(tick.rolled.is_within(most) || tick.rolled.is_within(most + two_counts())) {
                    self.silent_s = T::ZERO;
                    localiser.count_from(counts, dt);
                    return self.go_on::<M>(localisation, tick_s, report);
                }
                let estimate = localiser.update::<M>(localisation, tick, accelerations, fix, gyro);
                report.measured = Some(estimate.measured);
                report.fix = estimate.fix;
                report.gyro = estimate.gyro;
                estimate.jumped
            }
        };
        self.blind_s = T::ZERO;
        self.silent_s = T::ZERO;
        report.blind = false;
        self.located(localisation, report, jumped)
    }

    /// A tick without a reading: on along the arc of the last twist.
    #[cold]
    #[inline(never)]
    fn go_on<M: Maths<T>>(
        &mut self,
        localisation: &ValidLocaliserParams<T>,
        dt: T,
        report: &mut BaseReport<T>,
    ) -> Located {
        blind(report);
        self.blind_s += dt;
        let last = report.measured.map(|measured| self.with_set(&measured));
        report.measured = last.map(|last| coast::<T, M>(&last, dt));
        self.located(localisation, report, false)
    }

    fn located(
        &mut self,
        localisation: &ValidLocaliserParams<T>,
        report: &mut BaseReport<T>,
        poses_jumped: bool,
    ) -> Located {
        let jumped = poses_jumped || self.set;
        self.set = false;
        let Some(localiser) = &self.localiser else {
            report.curvature_bias = T::ZERO;
            report.turn_bias = T::ZERO;
            report.tyre_slip = T::ZERO;
            return Located {
                fix_age_us: 0,
                jumped,
                poses_jumped,
            };
        };
        report.curvature_bias = localiser.curvature_bias();
        report.turn_bias = localiser.turn_bias();
        report.tyre_slip = localiser.tyre_slip();
        let fuses = localisation.params().fusion.is_some();
        Located {
            fix_age_us: if fuses {
                microseconds(localiser.uncarried_s(localisation) + self.blind_s)
            } else {
                0
            },
            jumped,
            poses_jumped,
        }
    }
}

/// Reports a tick without a measurement.
fn blind<T: Scalar>(report: &mut BaseReport<T>) {
    report.blind = true;
    report.fix = FixOutcome::Absent;
    report.gyro = GyroReport::default();
}

/// A tick that the localiser refuses.
#[cold]
#[inline(never)]
fn refused<T: Scalar>(report: &mut BaseReport<T>, fault: StepFault) -> Located {
    blind(report);
    report.active_faults.add(fault.into());
    Located::NOT
}

/// Goes on along the arc of the present twist: Eq. (6) over `dt`.
// As a call, a tick of C's archives takes 20 instructions more.
#[inline(always)]
pub(super) fn coast<T: Scalar, M: Maths<T>>(from: &Measured<T>, dt: T) -> Measured<T> {
    let Measured { pose, twist } = from;
    let turn = twist.angular * dt;
    let half = T::HALF * turn;
    let chord = twist.linear * dt * sinc::<T, M>(half);
    let (sine, cosine) = M::sin_cos(pose.theta + half);
    Measured {
        pose: Pose {
            x: pose.x + chord * cosine,
            y: pose.y + chord * sine,
            theta: pose.theta + turn,
        },
        twist: *twist,
    }
}

#[cfg(test)]
mod tests {
    use super::{Located, Locator};
    use crate::base::{BaseReport, Sensed};
    use crate::hal::{ErrorKind, WheelCounts};
    use crate::localiser::{Fix, FixOutcome, LocaliserParams, ValidLocaliserParams};
    use crate::maths::Libm;
    use crate::odometry::Accelerations;
    use crate::safety::FaultKind;
    use crate::safety::supervisor::{Cause, State};
    use crate::types::{Accel, Measured, Pose, Twist};

    const DT: f64 = 0.01;
    /// \[m/s\].
    const RIM_SPEED: f64 = 0.75;
    /// Of a wheel in a tick, for half a metre per second.
    const COUNTS: i32 = 16;
    /// Way of a count \[m\]: 2 pi 0.1 m / 2048.
    const COUNT_M: f64 = core::f64::consts::TAU * 0.1 / 2048.0;
    const START: Pose<f64> = Pose {
        x: 1.0,
        y: -2.0,
        theta: 0.0,
    };
    const ELSEWHERE: Pose<f64> = Pose {
        x: 7.0,
        y: 3.0,
        theta: 0.0,
    };

    /// A base that drives along x.
    struct Bench {
        /// Of a tick.
        dt: f64,
        localisation: ValidLocaliserParams<f64>,
        locator: Locator<f64, 16>,
        report: BaseReport<f64>,
        counts: i32,
    }

    impl Bench {
        fn at(start: Pose<f64>) -> Self {
            Self {
                dt: DT,
                localisation: LocaliserParams::for_test().validate().expect("valid"),
                locator: Locator::new(start),
                report: BaseReport::new(State::Idle, Cause::PowerOn),
                counts: 4711,
            }
        }

        /// At rest at a first reading.
        fn started() -> Self {
            let mut bench = Self::at(START);
            let located = bench.tick(0, true, None);
            assert!(!located.jumped);
            bench
        }

        /// A tick in which the encoders say that both wheels stand at `counts`.
        fn tick_at(&mut self, counts: i32) -> Located {
            let on = counts.wrapping_sub(self.counts);
            let rolled = self.counts;
            let located = self.tick(on, true, None);
            self.counts = rolled.wrapping_add(COUNTS);
            located
        }

        /// A tick in which both wheels roll on by `counts`, which the encoders give or not.
        fn tick(&mut self, counts: i32, given: bool, fix: Option<Pose<f64>>) -> Located {
            self.counts = self.counts.wrapping_add(counts);
            let mut sensed = Sensed::of_counts(WheelCounts {
                right: self.counts,
                left: self.counts,
            });
            if !given {
                sensed.counts = Err(ErrorKind::Bus);
            }
            sensed.fix = fix.map(|pose| Fix { pose, age_s: 0.0 });
            let accelerations = Accelerations::exerted(Accel::default());
            self.locator.advance::<Libm>(
                &self.localisation,
                self.dt,
                (&accelerations, RIM_SPEED),
                &sensed,
                &mut self.report,
            )
        }

        fn measured(&self) -> Measured<f64> {
            self.report.measured.expect("a reading")
        }

        fn is_at(&self, x: f64, y: f64) -> bool {
            let Pose { x: a, y: b, theta } = self.measured().pose;
            (a - x).abs() < 1e-9 && (b - y).abs() < 1e-9 && theta.abs() < 1e-9
        }
    }

    #[test]
    fn a_base_is_where_it_starts_at_its_first_reading() {
        let mut bench = Bench::at(START);
        bench.tick(COUNTS, false, None);
        assert_eq!((bench.report.measured, bench.report.blind), (None, true));
        assert!(bench.locator.odometry().is_none());
        bench.tick(COUNTS, true, None);
        let at_rest = Measured {
            pose: START,
            twist: Twist::default(),
        };
        assert_eq!((bench.measured(), bench.report.blind), (at_rest, false));
        assert!(bench.locator.odometry().is_some());
    }

    /// It goes on as it moved, and says that it is blind and for how long it has had no pose. What the wheels have turned meanwhile was in all of
    /// that time: neither the way nor the speed is wrong afterwards.
    #[test]
    fn a_base_without_counts_goes_on_as_it_moved() {
        let mut bench = Bench::started();
        for tick in 1..=200 {
            let located = bench.tick(COUNTS, true, None);
            assert!(
                located.fix_age_us.abs_diff(10_000 * tick) <= 1,
                "{located:?}"
            );
        }
        let before = bench.measured();
        // What is left of a start by an acceleration that odometry did not know of.
        assert!((before.twist.linear * DT / (16.0 * COUNT_M) - 1.0).abs() < 1e-3);
        for gap in 1..=3 {
            let located = bench.tick(COUNTS, false, None);
            assert!(located.fix_age_us.abs_diff(10_000 * (200 + gap)) <= 1);
            let on = before.pose.x + f64::from(gap) * DT * before.twist.linear;
            assert!(bench.is_at(on, START.y) && bench.report.blind);
            assert_eq!(bench.measured().twist, before.twist);
        }
        let located = bench.tick(COUNTS, true, None);
        assert!(located.fix_age_us.abs_diff(2_040_000) <= 1, "{located:?}");
        assert!(bench.is_at(START.x + 204.0 * 16.0 * COUNT_M, START.y));
        assert!((bench.measured().twist.linear / before.twist.linear - 1.0).abs() < 1e-3);
    }

    /// Of wheels with 48 counts a turn one is 13 mm, which at 0.75 m/s is more than four ticks of 1 ms have and another 3 mm; two may come at once.
    #[test]
    fn single_counts_are_read_where_ticks_are_short() {
        let mut bench = Bench::at(START);
        let mut params = LocaliserParams::for_test();
        params.odometry.counts_per_turn = 48.0;
        bench.localisation = params.validate().expect("valid");
        bench.dt = 1.0e-3;
        for tick in 0..200 {
            bench.tick(i32::from(tick % 26 == 25), true, None);
            assert!(!bench.report.blind, "{tick}");
        }
        let count_m = COUNT_M * 2048.0 / 48.0;
        assert!((bench.measured().pose.x - (START.x + 7.0 * count_m)).abs() < 1e-9);
        bench.tick(2, true, None);
        assert!(!bench.report.blind);
        bench.tick(3, true, None);
        assert!(bench.report.blind);
    }

    /// The base goes on as it moved, and is afterwards where it would be. Encoders that begin anew, or one that lost its count, cost a tick.
    #[test]
    fn counts_that_no_wheel_comes_to_move_nothing() {
        // Four times the rim speed in a tick and a millisecond are 108 counts.
        for wrong in [i32::MIN, i32::MAX, 0, 4711 + 16 * 201 + 200] {
            let mut bench = Bench::started();
            for _ in 0..200 {
                bench.tick(COUNTS, true, None);
            }
            let before = bench.measured();
            bench.tick_at(wrong);
            assert!(bench.report.blind);
            let on = before.pose.x + DT * before.twist.linear;
            assert!(bench.is_at(on, START.y), "{wrong}");
            bench.tick(COUNTS, true, None);
            assert!(bench.report.blind, "{wrong}");
            let located = bench.tick(COUNTS, true, None);
            assert!(!bench.report.blind && !located.jumped);
            // Two counts are rounded off, and the speed was a thousandth off.
            let off = bench.measured().pose.x - (START.x + 203.0 * 16.0 * COUNT_M);
            assert!(off.abs() < 2.1 * COUNT_M, "{wrong}: {off}");
            let faster = bench.measured().twist.linear / before.twist.linear;
            assert!((faster - 1.0).abs() < 0.05, "{wrong}: {faster}");
        }
        let mut bench = Bench::started();
        for _ in 0..200 {
            bench.tick(COUNTS, true, None);
        }
        bench.counts = 0;
        bench.tick(COUNTS, true, None);
        assert!(bench.report.blind);
        bench.tick(COUNTS, true, None);
        let off = bench.measured().pose.x - (START.x + 202.0 * 16.0 * COUNT_M);
        assert!(!bench.report.blind && off.abs() < 1.1 * COUNT_M, "{off}");
        // Half of what is possible is believed.
        bench.tick(48, true, None);
        assert!(!bench.report.blind);
        // What is wrong at every tick is never a reading.
        for tick in 0..8 {
            bench.tick_at(if tick % 2 == 0 { 100_000 } else { -100_000 });
            assert!(bench.report.blind);
        }
    }

    /// What became of a pose is said of the tick in which it came.
    #[test]
    fn a_tick_without_counts_has_no_pose() {
        let mut bench = Bench::started();
        let located = bench.tick(0, true, Some(START));
        assert_eq!(bench.report.fix, FixOutcome::Fused);
        assert_eq!(located.fix_age_us, 0);
        bench.tick(0, false, Some(START));
        assert_eq!(bench.report.fix, FixOutcome::Absent);
    }

    /// It jumps there in the next tick, whether that has counts or not, and drives on from there.
    #[test]
    fn a_base_is_where_it_is_set() {
        let mut bench = Bench::started();
        for _ in 0..200 {
            bench.tick(COUNTS, true, None);
        }
        let Bench {
            locator,
            localisation,
            ..
        } = &mut bench;
        locator.set_pose(localisation, ELSEWHERE);
        let twist = bench.measured().twist;
        let located = bench.tick(COUNTS, false, None);
        assert!(located.jumped && !located.poses_jumped);
        assert!(bench.is_at(ELSEWHERE.x + DT * twist.linear, ELSEWHERE.y));
        assert_eq!(bench.measured().twist, twist);
        assert!(!bench.tick(COUNTS, true, None).jumped);
        assert!(bench.is_at(ELSEWHERE.x + 32.0 * COUNT_M, ELSEWHERE.y));
    }

    /// At its last pose, or where it was set since, and without a jump.
    #[test]
    fn a_base_of_other_parameters_begins_anew_where_it_is() {
        for set in [false, true] {
            let mut bench = Bench::started();
            for _ in 0..200 {
                bench.tick(COUNTS, true, None);
            }
            bench.tick(COUNTS, false, None);
            let last = bench.measured();
            if set {
                bench.locator.set_pose(&bench.localisation, ELSEWHERE);
            }
            bench.locator.begin_anew(Some(&last));
            assert!(bench.locator.odometry().is_none());
            let located = bench.tick(COUNTS, true, None);
            let expected = if set { ELSEWHERE } else { last.pose };
            assert_eq!(
                (bench.measured().pose, located.jumped, located.fix_age_us),
                (expected, false, 0)
            );
        }
        let mut bench = Bench::at(START);
        bench.locator.begin_anew(None);
        bench.tick(COUNTS, true, None);
        assert_eq!(bench.measured().pose, START);
    }

    /// A place that is no number is a fault, and nothing is known of the pose.
    #[test]
    fn a_place_that_is_no_number_is_refused() {
        let mut bench = Bench::at(Pose {
            x: f64::NAN,
            ..START
        });
        bench.tick(COUNTS, true, None);
        assert!(
            bench
                .report
                .active_faults
                .get(FaultKind::NotFinite)
                .is_some()
        );
        assert_eq!((bench.report.measured, bench.report.blind), (None, true));
    }
}

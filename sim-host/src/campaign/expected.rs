//! The rules: for each trouble the name it has to be found by, the time that counts, and how much of it there may be.

use super::fault_injection::{FaultInjection, FaultInjectionKind, What};
use super::outcome::{End, Failing, RunOutcome, Why};
use super::plan::{Bases, Target};
use crate::closed_loop::{self, ClosedLoopError};
use crate::rate::Rate;
use crate::world::{PlantFault, PoseSourceParams};
use controller_core::base::BaseParams;
use controller_core::safety::{FaultKind, LOOK_US, Reaction, Response, Timeout};
use protocol::{Command, TimedSample, WirePose, WireReference, WireTwist};

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// Trouble.
    pub injection: FaultInjectionKind,
    /// What it is found as; nothing where there is nothing to be found.
    pub name: Option<Why>,
    /// Other names that are right too, where physics cannot distinguish, each with the reason.
    pub also: &'static [(Why, &'static str)],
    /// What time counts.
    pub clock: Clock,
}

/// What time counts towards a deadline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// None: nothing has to be found.
    None,
    /// All, from the beginning of the trouble.
    All,
    /// All, in a base that has not driven, whose poses are off by twice the gate: what odometry may be wrong by widens the
    /// gate with the way.
    Beyond,
    /// All, if the tick is as long as one that counts as too long.
    Long,
    /// Since the last sound frame arrived, in a live base.
    SinceFrame,
    /// While the wheel is commanded faster, and pushed harder that way, than the stuck detector's thresholds, without
    /// a break.
    Pushed,
}

impl Clock {
    /// For tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "–",
            Self::All => "from its beginning",
            Self::Beyond => "from its beginning, before any way, beyond twice the gate",
            Self::Long => {
                "from its beginning, if it lasts for 10 periods and 50 ms, or for more than 0.5 s"
            }
            Self::SinceFrame => "since the last sound frame, armed or on its way",
            Self::Pushed => "commanded and pushed above `stuck`, without a break",
        }
    }
}

const fn fault(kind: FaultKind) -> Option<Why> {
    Some(Why::Fault(kind))
}

const fn rule(
    injection: FaultInjectionKind,
    name: Option<Why>,
    also: &'static [(Why, &'static str)],
    clock: Clock,
) -> Rule {
    Rule {
        injection,
        name,
        also,
        clock,
    }
}

/// The table, in the order of [`FaultInjectionKind::ALL`].
pub const RULES: [Rule; FaultInjectionKind::ALL.len()] = {
    use {Clock as C, FaultInjectionKind as U, FaultKind as F};
    [
        rule(U::Nothing, None, &[], C::None),
        rule(
            U::EncoderStuck,
            fault(F::EncoderStuck),
            &[(
                Why::Fault(F::EncoderReversed),
                "counts that come back too soon, as in a contact that fails, look like a wheel that was braked against its torque",
            )],
            C::Pushed,
        ),
        rule(
            U::EncoderReversed,
            fault(F::EncoderReversed),
            &[(
                Why::Fault(F::PoseStale),
                "pushed too little to distinguish it from a load, it makes odometry disagree with the poses until all are rejected",
            )],
            C::Pushed,
        ),
        rule(U::EncoderFails, fault(F::MeasurementStale), &[], C::All),
        rule(U::PoseSilent, fault(F::PoseStale), &[], C::All),
        rule(
            U::PoseJump,
            fault(F::PoseJump),
            &[
                (
                    Why::Fault(F::GoalUnreachable),
                    "a heading inconsistent with the positions makes forward motion look like slip, and no approach ends at the goal",
                ),
                (
                    Why::Fault(F::PoseStale),
                    "the same: poses that imply slip for too long are rejected",
                ),
            ],
            C::Beyond,
        ),
        rule(U::PoseNan, fault(F::PoseStale), &[], C::All),
        rule(U::FixAgeNan, fault(F::PoseStale), &[], C::All),
        rule(U::DriveCoasts, fault(F::Driver), &[], C::All),
        rule(U::DriveHolds, fault(F::Driver), &[], C::All),
        rule(U::OverCurrent, fault(F::Driver), &[], C::All),
        rule(U::BatterySag, fault(F::UnderVoltage), &[], C::All),
        rule(
            U::WheelBlocked,
            fault(F::EncoderStuck),
            &[
                (
                    Why::Fault(F::EncoderReversed),
                    "stopped short, a wheel is slowed against its torque before it stands",
                ),
                (
                    Why::Fault(F::Stalled),
                    "the blocked wheel holds the base, under less torque than a free wheel needs",
                ),
            ],
            C::Pushed,
        ),
        rule(
            U::WheelOnIce,
            fault(F::WheelSlip),
            &[
                (
                    Why::Fault(F::PoseStale),
                    "without a gyro only poses show slip; poses that disagree with odometry for long are all rejected",
                ),
                (
                    Why::Fault(F::GoalUnreachable),
                    "without grip there are goals that are not reached",
                ),
            ],
            C::None,
        ),
        rule(U::LateTick, fault(F::TickTooLong), &[], C::Long),
        rule(U::LateTicks, fault(F::TickJitter), &[], C::All),
        rule(
            U::HostSilent,
            Some(Why::Link),
            &[(
                Why::Fault(F::CommandStale),
                "the last velocity order is older than the last sign of life",
            )],
            C::SinceFrame,
        ),
        rule(U::OrderNan, Some(Why::Refused), &[], C::All),
        rule(U::EmergencyStop, Some(Why::Button), &[], C::All),
        rule(U::LineFull, None, &[], C::None),
        rule(
            U::LineDamaged,
            Some(Why::Link),
            &[
                (
                    Why::Fault(F::CommandStale),
                    "frames come, but so many samples or velocity orders are lost that the trajectory ends, or the last order is stale",
                ),
                (
                    Why::Fault(F::PoseStale),
                    "frames come, but so many poses are lost that they are missing",
                ),
            ],
            C::SinceFrame,
        ),
        rule(
            U::LineDelayed,
            None,
            &[(
                Why::Link,
                "as the delay begins nothing arrives for as long as it is, after up to 20 ms without a sign of life",
            )],
            C::None,
        ),
    ]
};

/// The same of [`FaultInjectionKind::GYRO`]. Nothing is done about any of them by default: the base goes on by its wheels.
pub const GYRO_RULES: [Rule; FaultInjectionKind::GYRO.len()] = {
    use {Clock as C, FaultInjectionKind as U, FaultKind as F};
    const SLIP: &[(Why, &str)] = &[(
        Why::Fault(FaultKind::WheelSlip),
        "until a pose arrives that tells, a gyro that turns less or more than the wheels looks like a wheel that slides",
    )];
    [
        rule(U::GyroSilent, fault(F::Gyro), &[], C::All),
        rule(U::GyroNan, fault(F::Gyro), &[], C::All),
        rule(U::GyroStuck, fault(F::Gyro), SLIP, C::None),
        rule(U::GyroReversed, fault(F::Gyro), SLIP, C::None),
        rule(U::GyroScale, fault(F::Gyro), SLIP, C::None),
        rule(U::GyroBias, fault(F::Gyro), SLIP, C::None),
    ]
};

/// Other names that are right on a base with a gyro, each with the reason.
pub const GYRO_ALSO: [(FaultInjectionKind, Why, &str); 2] = [
    (
        FaultInjectionKind::EncoderReversed,
        Why::Fault(FaultKind::WheelSlip),
        "of a wheel that turns little an encoder of the wrong sign, and a slide, turn the base alike",
    ),
    (
        FaultInjectionKind::EncoderStuck,
        Why::Fault(FaultKind::WheelSlip),
        "counts that come back, as in a contact that fails, are those of a wheel that slid",
    ),
];

impl Rule {
    /// Of a trouble.
    pub const fn of(injection: FaultInjectionKind) -> &'static Self {
        let place = injection as usize;
        if place < RULES.len() {
            &RULES[place]
        } else {
            &GYRO_RULES[place - RULES.len()]
        }
    }

    /// Whether a finding is right.
    pub fn allows(&self, why: Why) -> bool {
        self.name == Some(why) || self.also.iter().any(|(also, _)| *also == why)
    }

    /// The row of docs/faults.md: name and others, time that counts, deadline of each of `bases`.
    pub fn row(&self, bases: &Bases) -> Result<String, ClosedLoopError> {
        let name = |why: Why| format!("`{}`", why.name());
        let mut names: Vec<_> = self.name.map(name).into_iter().collect();
        names.extend(self.also.iter().map(|(why, _)| name(*why)));
        let found = if names.is_empty() {
            "nothing".to_owned()
        } else {
            names.join(", ")
        };
        let mut row = format!(
            "| {} | {found} | {} |",
            self.injection.name(),
            self.clock.name()
        );
        for base in bases.all() {
            let (period_s, source) = base
                .hardware
                .map_or((0.01, None), |h| (h.period_s, h.pose_source));
            let period_us = (1.0e6 * period_s).round() as u32;
            let params = closed_loop::params(base, period_us).map_err(ClosedLoopError::Param)?;
            let within = self.within_s(&params, source.as_ref());
            row += &within.map_or_else(|| " – |".to_owned(), |s| format!(" {s:.3} s |"));
        }
        Ok(row)
    }

    /// Longest time, of the time that counts, before it is found \[s\], for a base with these parameters; for
    /// the longest tick of the trouble and the tick in which it is found half a period of jitter and lateness each comes
    /// to it.
    pub fn within_s(
        &self,
        params: &BaseParams<f32>,
        source: Option<&PoseSourceParams>,
    ) -> Option<f64> {
        let detectors = &params.detectors;
        let period = 1.0e-6 * f64::from(detectors.period_us);
        let ticks = |n: f64| (n + 0.5) * period;
        let look = 1.0e-6 * f64::from(LOOK_US);
        let after = |timeout| match timeout {
            Timeout::AfterUs(us) => Some(1.0e-6 * f64::from(us)),
            Timeout::Off => None,
        };
        use FaultInjectionKind as U;
        match self.injection {
            U::Nothing | U::LineFull | U::LineDelayed | U::WheelOnIce => None,
            // Five readings, or 0.1 s; one may be on its way.
            U::GyroSilent | U::GyroNan => params.localiser.gyro.map(|gyro| {
                let age = f64::from(gyro.latency_s);
                (5.0 / f64::from(gyro.rate_hz)).max(0.1) + age + ticks(2.0)
            }),
            U::GyroStuck | U::GyroReversed | U::GyroScale | U::GyroBias => None,
            // Timed by looks at the wheel.
            U::EncoderStuck | U::WheelBlocked => {
                after(detectors.wheels.stuck.after).map(|s| s + look + ticks(2.0))
            }
            // Once for a wheel that rolls back to be turned round by twice the load, once to be found.
            U::EncoderReversed => {
                after(detectors.wheels.stuck.after).map(|s| 2.0 * s + look + ticks(2.0))
            }
            U::EncoderFails => after(detectors.measurement).map(|s| s + ticks(1.0)),
            // The last pose may be on its way yet, and the one before it was an interval ago.
            U::PoseSilent | U::PoseNan | U::FixAgeNan => {
                let source = source?;
                // A gyro carries the base meanwhile.
                let carried = params
                    .localiser
                    .gyro
                    .map_or(0.0, |gyro| f64::from(gyro.carry_s));
                after(detectors.pose)
                    .map(|s| s.max(carried) + source.latency_s + 1.0 / source.rate_hz + ticks(1.0))
            }
            // As many outliers as have to agree, after the one that was on its way; those that the source drops come on top.
            U::PoseJump => {
                let (source, fusion) = (source?, params.localiser.fusion?);
                let fixes = sent_for(fusion.relocalise_after + 1, source.drop_probability)?;
                Some(fixes / source.rate_hz + source.latency_s + ticks(2.0))
            }
            // Ordered in a tick, answered in it, judged in the next.
            U::DriveCoasts | U::DriveHolds | U::OverCurrent => Some(ticks(2.0)),
            U::BatterySag => after(detectors.supply.after).map(|s| s + ticks(1.0)),
            U::LateTick => Some(ticks(1.0)),
            // So many in a row, after the one under way; each as much longer as the trouble makes it.
            U::LateTicks => Some(ticks(f64::from(detectors.ticks.row) + 1.0)),
            // Judged a tick ahead.
            U::HostSilent | U::LineDamaged => after(detectors.command),
            // Sent with the next tick, answered after it.
            U::OrderNan | U::EmergencyStop => Some(ticks(2.0)),
        }
    }
}

/// Something that is known to go wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// Under this trouble.
    pub injection: FaultInjectionKind,
    /// What.
    pub failing: Failing,
    /// In this share of its runs.
    pub rate: f64,
}

impl Known {
    /// Whether a study is in line with the stated rate: it does not show one that is worse by more than a tenth.
    pub fn holds(&self, rate: &Rate) -> bool {
        rate.interval().0 <= 1.1 * self.rate
    }
}

/// All of it, with the rates that docs/faults.md states with their runs.
pub const KNOWN: [Known; 1] = [Known {
    injection: FaultInjectionKind::WheelOnIce,
    failing: Failing::Adrift,
    rate: 0.0043,
}];

/// How often each of [`KNOWN`] happened, where its trouble was there.
pub fn known(outcomes: &[RunOutcome]) -> Vec<(Known, Rate)> {
    let rate = |known: &Known| {
        let has = |outcome: &&RunOutcome| outcome.injection == known.injection;
        let failed = |outcome: &&RunOutcome| outcome.end == Ok(End::Known(known.failing));
        Rate {
            failed: outcomes.iter().filter(has).filter(failed).count(),
            runs: outcomes.iter().filter(has).count(),
        }
    };
    KNOWN
        .iter()
        .map(|known| (*known, rate(known)))
        .filter(|(_, rate)| rate.runs > 0)
        .collect()
}

/// So rarely a bound on what is random may be passed: what is normally distributed passes 5 σ as often, either way.
const RARELY: f64 = 5.733e-7;

/// How many poses a source has to send for `arriving` of them to arrive, but for [`RARELY`], if it drops them with this
/// probability: as many more as make fewer arrivals, binomially distributed, as improbable as that. None if none arrives.
fn sent_for(arriving: u8, dropped: f64) -> Option<f64> {
    if dropped >= 1.0 {
        return None;
    }
    // Probabilities that 0, 1, … of those sent until now arrived, as long as that is too few.
    let mut few = vec![0.0; usize::from(arriving)];
    if let Some(none) = few.first_mut() {
        *none = 1.0;
    }
    let mut sent = 0.0;
    while few.iter().sum::<f64>() > RARELY {
        for arrived in (0..few.len()).rev() {
            let one_less = arrived.checked_sub(1).map_or(0.0, |less| few[less]);
            few[arrived] = dropped * few[arrived] + (1.0 - dropped) * one_less;
        }
        sent += 1.0;
    }
    Some(sent)
}

/// What a late tick adds to a deadline \[s\].
pub(super) fn late_s(injection: &FaultInjection, params: &BaseParams<f32>) -> f64 {
    match injection.what {
        What::Late(_) => f64::from(params.detectors.ticks.row + 1) * injection.late_s(),
        _ => injection.late_s(),
    }
}

/// Whether there is something to be found at all.
pub(super) fn applies(
    injection: &FaultInjection,
    target: Target,
    params: &BaseParams<f32>,
) -> bool {
    let detectors = &params.detectors;
    match injection.what {
        // Ticks are shorter by up to 0.2 ms: the jitter of a plan.
        What::LateOnce(us) => match detectors.ticks.long {
            Timeout::AfterUs(long) => us + detectors.period_us >= long + 200,
            Timeout::Off => false,
        },
        What::PlantFault(PlantFault::PoseJump { dx, dy, dtheta }) => {
            let Some(fusion) = &params.localiser.fusion else {
                return false;
            };
            let gate = |sigma: f32| 2.0 * f64::from(fusion.gate * sigma) * std::f64::consts::SQRT_2;
            let far = dx.abs().max(dy.abs()) > gate(fusion.noise_m)
                || dtheta.abs() > gate(fusion.noise_rad);
            far && matches!(target, Target::Idle | Target::Armed)
        }
        _ => true,
    }
}

/// A goal, and else a sample or a velocity order, that is not a number.
pub(super) fn no_number(park: bool, drives: bool) -> Command {
    let pose = WirePose {
        x: f32::NAN,
        ..WirePose::default()
    };
    if park {
        Command::Park { goal: pose }
    } else if drives {
        Command::Drive {
            twist: WireTwist {
                v: f32::NAN,
                w: 0.0,
            },
            hold_heading: false,
        }
    } else {
        Command::Sample(TimedSample {
            t: 0.0,
            reference: WireReference {
                pose,
                ..WireReference::default()
            },
        })
    }
}

/// What has to be done at least about a fault that is found while the base may move. Written here anew,
/// so that a policy that forgets something is found out.
pub(super) const fn least(kind: FaultKind) -> Response {
    use FaultKind as F;
    match kind {
        F::PoseJump | F::Gyro => Response::IGNORE,
        F::PoseStale | F::CommandStale | F::WheelSlip | F::Stalled | F::GoalUnreachable => {
            Response::passing(Reaction::ControlledStop)
        }
        F::TickJitter | F::TickTooLong | F::UnderVoltage => {
            Response::latched(Reaction::ControlledStop)
        }
        F::Driver | F::OverCurrent => Response::latched(Reaction::Release),
        // What breaks the measurement or the law, and what is not known here.
        _ => Response::latched(Reaction::Brake),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of the binomial distribution, worked out by hand for three terms or fewer.
    #[test]
    fn poses_that_are_dropped_have_to_be_sent_as_well() {
        assert_eq!(sent_for(4, 0.0), Some(4.0));
        assert_eq!(sent_for(4, 1.0), None);
        for dropped in [0.05, 0.3, 0.9_f64] {
            let few = |sent: f64| {
                let one = sent * (1.0 - dropped) * dropped.powf(sent - 1.0);
                dropped.powf(sent) + one
            };
            let sent = sent_for(2, dropped).expect("some arrive");
            assert!(few(sent) <= RARELY && few(sent - 1.0) > RARELY, "{sent}");
        }
    }

    #[test]
    fn every_trouble_has_its_row() {
        for (injection, rule) in FaultInjectionKind::ALL.into_iter().zip(&RULES) {
            assert_eq!(injection, rule.injection);
            assert_eq!(Rule::of(injection), rule);
        }
        for (injection, rule) in FaultInjectionKind::GYRO.into_iter().zip(&GYRO_RULES) {
            assert_eq!(injection, rule.injection);
            assert_eq!(Rule::of(injection), rule);
        }
    }
}

//! What may be found for each kind of trouble, within what time, and what has to be done about it.

use super::plan::Target;
use super::upset::{Upset, UpsetKind, What};
use crate::drive::Base;
use controller_core::safety::{FaultKind, Reaction, Response};

/// Kinds of fault that trouble may rightly be taken for.
pub(super) const fn kinds(kind: UpsetKind) -> &'static [FaultKind] {
    use {FaultKind as F, UpsetKind as U};
    match kind {
        // Half of the twist is wrong: the velocity loop pushes and turns the base. Fusion, whose poses do not go
        // with odometry, sees them jump. Parking, the base circles beside its goal until it gives up. Where counts
        // come back within 0.1 s, as in a contact that fails, the wheel may look reversed: 3 of 20,000 runs.
        U::EncoderStuck => &[
            F::EncoderStuck,
            F::EncoderReversed,
            F::WheelSlip,
            F::Stalled,
            F::GaveUp,
            F::PoseJump,
            F::PoseStale,
        ],
        U::EncoderReversed => &[
            F::EncoderReversed,
            F::EncoderStuck,
            F::WheelSlip,
            F::Stalled,
            F::GaveUp,
            F::PoseJump,
            F::PoseStale,
        ],
        // When readings come back those of the gap come in one: as slip.
        U::EncoderFails => &[F::MeasurementStale, F::PoseJump],
        U::PoseSilent | U::PoseNan | U::FixAgeNan => &[F::PoseStale, F::PoseJump],
        // Believed after some that agree.
        U::PoseJump => &[F::PoseJump, F::PoseStale, F::GaveUp],
        U::DriveCoasts => &[F::Driver],
        U::DriveHolds => &[F::Driver, F::WheelSlip, F::EncoderReversed, F::EncoderStuck],
        U::OverCurrent => &[F::Driver, F::OverCurrent],
        // Too little voltage for the speed: the base falls behind, as if it were held.
        U::BatterySag => &[F::UnderVoltage, F::Stalled],
        // From wheels alone the same as a stuck encoder; the other wheel carries the base around.
        U::WheelBlocked => &[
            F::EncoderStuck,
            F::EncoderReversed,
            F::WheelSlip,
            F::Stalled,
            F::GaveUp,
            F::PoseJump,
            F::PoseStale,
            F::OverCurrent,
        ],
        U::WheelOnIce => &[
            F::WheelSlip,
            F::EncoderReversed,
            F::Stalled,
            F::GaveUp,
            F::PoseJump,
            F::PoseStale,
        ],
        // So long that the host was not heard in it either.
        U::LateTick => &[F::TickTooLong, F::TickJitter, F::CommandStale],
        U::LateTicks => &[F::TickJitter, F::TickTooLong],
        U::HostSilent => &[F::CommandStale],
        U::OrderNan => &[F::NotFinite],
        U::Nothing | U::EmergencyStop => &[],
    }
}

/// Time within which trouble has to be found for sure \[s\], by the table of
/// [`controller_core::safety::Monitor`]; none where that depends on what the base does.
pub(super) fn deadline_s(base: &Base, target: Target, upset: &Upset) -> Option<f64> {
    let hardware = base.hardware?;
    let period = hardware.period_s;
    // The last tick before may have been late, and the first one is cut short by nothing.
    let ticks = |n: f64| (n + 1.5) * period;
    match upset.what {
        What::HostSilent => Some(ticks(5.0).max(0.1 + 1.5 * period)),
        What::LateOnce(us) => {
            (f64::from(us) > 9.2e6 * period).then_some(ticks(1.0) + upset.late_s())
        }
        What::Late(us) => Some(6.0 * (1.1 * period + 1.0e-6 * f64::from(us))),
        // A base that parks refuses references, so one that is not a number does nothing.
        What::OrderNan { park } => {
            let taken = match target {
                Target::Armed | Target::Tracking | Target::Parked => true,
                Target::Parking => park,
                _ => false,
            };
            taken.then_some(ticks(1.0))
        }
        What::Nothing | What::EmergencyStop => None,
        What::FixAgeNan => stale_s(base),
        What::Defect(_) => match upset.kind {
            UpsetKind::EncoderFails => Some(ticks(5.0)),
            UpsetKind::PoseSilent | UpsetKind::PoseNan => stale_s(base),
            UpsetKind::DriveCoasts | UpsetKind::DriveHolds | UpsetKind::OverCurrent => {
                Some(ticks(1.0))
            }
            UpsetKind::BatterySag => Some(0.5 + ticks(1.0)),
            _ => None,
        },
    }
}

/// Ten poses or a second, and a tick; the one on its way still arrives.
fn stale_s(base: &Base) -> Option<f64> {
    let hardware = base.hardware?;
    let source = hardware.pose_source?;
    let stale = (10.0 / source.rate_hz).max(1.0);
    Some(stale + source.latency_s + 1.0 / source.rate_hz + 2.0 * hardware.period_s)
}

/// What a base may say of any goal: that it does not get there. Friction that is not what the motors'
/// parameters say lets it stand beside its goal.
pub(super) const fn at_any_goal(kind: FaultKind) -> bool {
    matches!(kind, FaultKind::GaveUp | FaultKind::Stalled)
}

/// What has to be done at least about a fault that is found while the base may move. Written here anew,
/// so that a policy that forgets something is found out.
pub(super) const fn least(kind: FaultKind) -> Response {
    use FaultKind as F;
    match kind {
        F::PoseJump => Response::RIDE_OUT,
        F::PoseStale | F::CommandStale | F::WheelSlip | F::Stalled | F::GaveUp => {
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

//! Inputs of the detectors, and the faults that they find.

use core::iter;

use super::fault::{Details, Fault, FaultKind};
use super::policy::ValidPolicyParams;
use super::reaction::{Reaction, Response};
use crate::hal::{ErrorKind, WheelCounts};
use crate::types::{Measured, Twist, WheelTorques};

/// Measured motor currents \[A\]; the sign does not matter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Currents<T> {
    /// Right motor.
    pub right: T,
    /// Left motor.
    pub left: T,
}

/// Everything that the detectors see of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DetectorInputs<T> {
    /// Time since the last tick \[µs\].
    pub dt_us: u32,
    /// What the encoders gave in this tick; `None` if nothing.
    pub counts: Option<WheelCounts>,
    /// Pose and twist that the controller is about to use.
    pub measured: Measured<T>,
    /// A twist that does not come from the wheels, such as of an external pose or a gyro, if there is one.
    pub outside: Option<Twist<T>>,
    /// The commanded twist of the last tick; zero where nothing drives.
    pub command: Twist<T>,
    /// Torques exerted since the last tick \[N m\], zero where the wheels were released; `None` where they are
    /// not known, as with windings shorted.
    pub torques: Option<WheelTorques<T>>,
    /// Age of the last external pose \[µs\], `u32::MAX` if there was none.
    pub pose_age_us: u32,
    /// Time since the last order of the host where one is due \[µs\].
    pub command_age_us: u32,
    /// The localiser says that the pose jumped.
    pub pose_jumped: bool,
    /// What the wheel driver failed with in the last tick.
    pub driver: Option<ErrorKind>,
    /// Supply \[V\], if it is measured.
    pub supply_v: Option<T>,
    /// Motor currents, if they are measured.
    pub currents: Option<Currents<T>>,
}

/// The faults of a tick, at most one of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ActiveFaults {
    /// A bit for each kind.
    kinds: u32,
    details: Details,
}

const _: () = assert!(FaultKind::COUNT <= 32);

/// The bit of a kind.
const fn bit(kind: FaultKind) -> u32 {
    1 << kind as u32
}

impl ActiveFaults {
    /// None.
    pub const NONE: Self = Self {
        kinds: 0,
        details: Details::NONE,
    };

    /// Forgets all of them, which nearly always are none.
    #[inline]
    pub(crate) fn clear(&mut self) {
        if !self.is_empty() {
            *self = Self::NONE;
        }
    }

    /// Adds a fault, such as a refused step or a driver error that this tick met after the check. The
    /// first one of a kind stays.
    #[inline]
    pub fn add(&mut self, fault: Fault) {
        let bit = bit(fault.kind());
        if self.kinds & bit == 0 {
            self.kinds |= bit;
            self.details.keep(fault);
        }
    }

    /// Adds a fault if there is one.
    #[inline]
    pub fn add_some(&mut self, fault: Option<Fault>) {
        if let Some(fault) = fault {
            self.add(fault);
        }
    }

    /// Adds all of `others`.
    #[inline]
    pub fn add_all(&mut self, others: &Self) {
        if !others.is_empty() {
            self.add_each(others);
        }
    }

    /// Apart, so that a quiet tick does not carry it along.
    #[cold]
    #[inline(never)]
    fn add_each(&mut self, others: &Self) {
        others.iter().for_each(|fault| self.add(fault));
    }

    /// Nothing was found.
    #[inline]
    pub const fn is_empty(&self) -> bool {
        self.kinds == 0
    }

    /// All faults, by the code of their kind.
    pub fn iter(&self) -> impl Iterator<Item = Fault> + '_ {
        let mut left = self.kinds;
        iter::from_fn(move || {
            let kind = FaultKind::ALL.get(left.trailing_zeros() as usize)?;
            left &= left.wrapping_sub(1);
            self.get(*kind)
        })
    }

    /// The fault of a kind. By a call, for the same reason.
    #[inline(never)]
    pub fn get(&self, kind: FaultKind) -> Option<Fault> {
        if self.kinds & bit(kind) == 0 {
            None
        } else {
            self.details.fault(kind)
        }
    }

    /// The fault with the most severe response (of equal reactions one that latches; the lowest code among equals), and
    /// the response to all of them together. `None` if nothing is to be done.
    pub fn worst(&self, policy: &ValidPolicyParams) -> Option<(Fault, Response)> {
        let mut worst: Option<(Fault, Response)> = None;
        for fault in self.iter() {
            let response = policy.response(fault);
            if response.reaction == Reaction::Ignore {
                continue;
            }
            worst = Some(match worst {
                None => (fault, response),
                Some((worst, so_far)) => {
                    // What latches is what somebody has to look for.
                    let more = response.reaction > so_far.reaction
                        || (response.reaction == so_far.reaction
                            && response.latch
                            && !so_far.latch);
                    let cause = if more { fault } else { worst };
                    (cause, so_far.and(response))
                }
            });
        }
        worst
    }

    /// Those that the policy ignores.
    pub fn ignored<'a>(
        &'a self,
        policy: &'a ValidPolicyParams,
    ) -> impl Iterator<Item = Fault> + 'a {
        self.iter()
            .filter(|fault| policy.response(*fault).reaction == Reaction::Ignore)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::safety::Side;

    #[test]
    fn the_most_severe_reaction_wins_and_any_latch_latches() {
        let policy = ValidPolicyParams::default();
        let mut active_faults = ActiveFaults::NONE;
        assert_eq!(active_faults.worst(&policy), None);
        active_faults.add(Fault::PoseJump);
        assert_eq!(active_faults.worst(&policy), None, "ignored");
        assert_eq!(active_faults.ignored(&policy).count(), 1);
        // A stop that does not latch, and stops that do: one stop, latched, named by what latches, of those the lower code.
        active_faults.add(Fault::PoseStale);
        active_faults.add(Fault::UnderVoltage);
        active_faults.add(Fault::TickTooLong);
        let all = Response::latched(Reaction::ControlledStop);
        assert_eq!(
            active_faults.worst(&policy),
            Some((Fault::TickTooLong, all))
        );
        let stuck = Fault::EncoderStuck(Side::Left);
        active_faults.add(stuck);
        let brake = Response::latched(Reaction::Brake);
        assert_eq!(active_faults.worst(&policy), Some((stuck, brake)));
        active_faults.add(Fault::Driver(ErrorKind::Bus));
        let release = Response::latched(Reaction::Release);
        let driver = Fault::Driver(ErrorKind::Bus);
        assert_eq!(active_faults.worst(&policy), Some((driver, release)));
    }

    /// Those of another tick are added by the same rule, in the order of their codes, and nothing is left once they are forgotten.
    #[test]
    fn faults_are_added_and_forgotten() {
        let mut one = ActiveFaults::NONE;
        one.add(Fault::WheelSlip(Side::Right));
        one.add(Fault::PoseJump);
        let mut other = ActiveFaults::NONE;
        other.add_some(Some(Fault::WheelSlip(Side::Left)));
        other.add_some(None);
        other.add(Fault::TickJitter);
        let before = one;
        one.add_all(&ActiveFaults::NONE);
        assert_eq!(one, before);
        one.add_all(&other);
        let mut expected = [
            Fault::WheelSlip(Side::Right),
            Fault::PoseJump,
            Fault::TickJitter,
        ];
        expected.sort_by_key(|fault| fault.kind().code());
        assert!(one.iter().eq(expected), "{one:?}");
        one.clear();
        assert_eq!(one, ActiveFaults::NONE);
        assert!(one.is_empty() && one.iter().next().is_none());
    }

    #[test]
    fn the_first_of_a_kind_stays() {
        let mut active_faults = ActiveFaults::NONE;
        active_faults.add(Fault::WheelSlip(Side::Left));
        active_faults.add(Fault::WheelSlip(Side::Right));
        assert_eq!(
            active_faults.get(FaultKind::WheelSlip),
            Some(Fault::WheelSlip(Side::Left))
        );
        assert_eq!(active_faults.iter().count(), 1);
    }
}

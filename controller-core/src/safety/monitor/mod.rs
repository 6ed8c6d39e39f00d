//! Detectors, fed once a tick.
//!
//! | finding | condition | found within |
//! | --- | --- | --- |
//! | measurement stale | no counts for `measurement` | the timeout and a tick |
//! | pose, command stale | their age | the timeout and a tick |
//! | not finite | measured pose or twist | the tick |
//! | tick too long, jitter | `ticks` | the tick; `row` late ticks, or `of_64` of the last 64 |
//! | pose jump, driver | reported by others | the tick |
//! | stuck, stalled | [`wheel`](self#wheels): commanded to turn, stands | `stuck.after` and a [look](self#wheels); four times as late where it is pushed with less than `stuck.torque_nm` |
//! | reversed | turns against its torque, ever faster | 0.3 s and `reversed` once what is exerted is 2.5 times the load |
//! | reversed | commanded to turn, turns the other way | `stuck.after` and a look, and as long for a wheel to come round; four times as late where it is pushed with less |
//! | stuck, on the way | the same, but its counts ceased, or the other wheel's 0.15 s ago | as reversed |
//! | slip | moves more than its torque explains, the way that it is commanded, or than the robot does | 0.1 s and `slip.after` |
//! | over-current, under-voltage | beyond the limit | their time and a tick |
//!
//! # Wheels
//!
//! Both sides of each wheel's equation of motion φ̈ = â + d (â from the torques by the model, d by the load)
//! pass the same filter, so that counts need not be differentiated:
//!
//! ```text
//! seen     y = (s/(s + a))² φ            from the counts
//! expected x = 1/(s + a)² â              from the torques          y = x + 1/(s + a)² d
//! ```
//!
//! | symbol | what | unit |
//! | --- | --- | --- |
//! | φ | turn of the wheel | rad |
//! | â = B̄ᵀ M̄⁻¹ B̄ τ | acceleration by the torques, both wheels together | rad/s² |
//! | a = 10 | rate of the window of 0.1 s | 1/s |
//! | D = d_max/a² | most that the load contributes to y | rad |
//!
//! The filter's impulse response t e^(−at) is positive with area 1/a², so a sound wheel has |y − x| ≤ D for
//! any load up to d_max, and a reversed one |y + x| ≤ D. With |x| ≥ 2 D the two are separated at −x/2: a
//! reversed wheel has y sgn x ≤ −|x|/2, a sound one does not before the load is three times the stated one.
//! Friction may be more than that (gears, tyres that scrub in a turn): when a torque that only just turned a wheel
//! ends, it is braked against what was exerted. But friction only brakes. So a wheel is reversed only if by its counts it
//! also turns against the torque, s/(s + a) φ sgn x < 0: friction never speeds a wheel up. A reversed wheel that is
//! driven from rest does both from the first count on; one that was turning does after it has come round.
//! Under a constant torque c times the load |x| reaches 2 D when 1 − (1 + at) e^(−at) = 2/c: after 0.30 s for
//! c = 2.5, 0.17 s for c = 4, 0.10 s for c = 8. Below 8 counts of x nothing is said, for the sake of rounding.
//!
//! While torques are not known (windings shorted; a supply that is too low, until under-voltage is found) x
//! follows y, as if a constant acceleration explained it: nothing is said of the wheels, and when torques are
//! known again both filters begin from what the wheels really did.
//!
//! Ticks share the looks at the wheels: the two take turns, a look has four parts, and a tick takes
//! one part, two if it is longer than [`PART_US`], all four if it is longer than [`BRIEF_US`], and both looks if it is longer than [`SINGLE_US`].
//! Each look then is [`LOOK_US`] after the last one of its wheel at most, or a tick where that is longer.
//! It takes all that was exerted and counted since then, so nothing is left out, and what it shows stands until the next.
//! What lasts is timed by looks: it is found [`LOOK_US`] and three ticks later at most, a tenth of `stuck.after` as bases have it. The
//! filters have four looks in their window at least.
//!
//! A velocity loop of bandwidth κ on reversed encoders drives the speed up as v_c (e^(κt) − 1) and the force
//! as m κ v_c e^(κt): when the latter has reached F the base has gone less than F/(m κ²), whatever the
//! command was. With the default load that is 10 % of the weight to be reached, 0.11 m for κ = 3, plus what it
//! travels in the 0.3 s that follow.

mod debounce;
mod electric;
mod ticks;
mod wheel;

use super::detector_params::ValidDetectorParams;
use super::fault::{Fault, Side};
use super::inputs::{ActiveFaults, DetectorInputs};
use super::silence::Silence;
use crate::error::Input;
use crate::scalar::{Scalar, seconds};
use crate::types::{Twist, WheelSpeeds, WheelTorques};
pub(super) use debounce::Debounce;

use electric::{OverCurrent, UnderVoltage};
use ticks::Ticks;
use wheel::{Effort, Look, Wheel, WheelDetections};

/// All detectors and what they remember. See the source's table of formulas and bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Monitor<T> {
    settings: ValidDetectorParams<T>,
    detectors: Detectors<T>,
}

impl<T: Scalar> Monitor<T> {
    /// A base that has just started.
    pub fn new(settings: &ValidDetectorParams<T>) -> Self {
        Self {
            settings: *settings,
            detectors: Detectors::default(),
        }
    }

    /// Takes a tick's evidence. A condition that lasts is found again in every tick.
    pub fn check(&mut self, inputs: &DetectorInputs<T>) -> ActiveFaults {
        let mut found = ActiveFaults::NONE;
        let read = inputs.counts.is_some();
        self.detectors
            .check(&self.settings, inputs, read, &mut found);
        found
    }

    /// Late ticks since the start.
    pub fn late_ticks(&self) -> u32 {
        self.detectors.late_ticks()
    }
}

/// Longest time between two looks at a wheel \[µs\], where no tick is longer: a quarter of the window. Ticks of 5 and 10 ms that come up to a quarter
/// late still share the looks.
pub const LOOK_US: u32 = 25_000;
/// Longest tick that takes no more than a part of a look; both looks have eight [parts](Part).
const PART_US: u32 = LOOK_US / 8;
/// Longest one that takes two of them.
const BRIEF_US: u32 = 2 * PART_US;
/// Longest one that takes one look, whole. Longer ones take both.
const SINGLE_US: u32 = 4 * PART_US;

/// What a brief tick does of a look at a wheel, in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Part {
    /// Takes what was exerted and counted since the last one.
    #[default]
    Take,
    Push,
    Filter,
    Compare,
}

impl Part {
    /// Of a look that has begun, this part and those behind it.
    const fn to_come(self) -> u8 {
        match self {
            Self::Take => 0,
            Self::Push => 3,
            Self::Filter => 2,
            Self::Compare => 1,
        }
    }
}

/// A time, and what the wheels exerted in it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Span<T> {
    us: u32,
    /// Torques were not known all the while,
    unknown: bool,
    /// else torque times time \[N m s\].
    impulses: WheelTorques<T>,
}

impl<T: Scalar> Span<T> {
    /// A tick of `us`.
    #[inline(always)]
    fn of(us: u32, torques: Option<WheelTorques<T>>) -> Self {
        let dt = seconds::<T>(us);
        let WheelTorques { right, left } = torques.unwrap_or_default();
        Self {
            us,
            unknown: torques.is_none(),
            impulses: WheelTorques {
                right: right * dt,
                left: left * dt,
            },
        }
    }

    /// This one and another.
    #[inline(always)]
    fn and(&self, other: &Self) -> Self {
        Self {
            us: self.us.saturating_add(other.us),
            unknown: self.unknown | other.unknown,
            impulses: WheelTorques {
                right: self.impulses.right + other.impulses.right,
                left: self.impulses.left + other.impulses.left,
            },
        }
    }
}

/// What the detectors remember; settings are lent: they exist once, wherever the detectors are built in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Detectors<T> {
    ticks: Ticks,
    unread: Silence,
    /// What the next brief tick does of a look,
    part: Part,
    /// which is at the left wheel.
    is_left: bool,
    /// What the look under way has taken.
    look: Look<T>,
    /// Between the looks taken last, of the other wheel and of this one,
    before: Span<T>,
    /// and since the latter.
    gathered: Span<T>,
    right: Wheel<T>,
    left: Wheel<T>,
    current: OverCurrent,
    supply: UnderVoltage,
}

impl<T: Scalar> Detectors<T> {
    /// Takes a tick's evidence, and adds what it shows to what was `found`; see [`Monitor::check`]. The encoders were `read` if they gave counts that are
    /// to be believed.
    #[inline(always)]
    pub(crate) fn check(
        &mut self,
        settings: &ValidDetectorParams<T>,
        inputs: &DetectorInputs<T>,
        read: bool,
        found: &mut ActiveFaults,
    ) {
        let params = settings.params();
        let dt_us = inputs.dt_us;
        self.unread = self.unread.after(dt_us, read);
        let (jitter, long) = self.ticks.advance(&params.ticks, dt_us);
        let mut add = |holds: bool, fault: Fault| {
            if holds {
                found.add(fault);
            }
        };
        add(
            self.unread.exceeds(params.measurement),
            Fault::MeasurementStale,
        );
        add(params.pose.passed(inputs.pose_age_us), Fault::PoseStale);
        add(
            params.command.passed(inputs.command_age_us),
            Fault::CommandStale,
        );
        if !inputs.measured.is_finite() {
            let pose = inputs.measured.pose.is_finite();
            let input = if pose { Input::Twist } else { Input::Pose };
            add(true, Fault::NotFinite(input));
        }
        add(jitter, Fault::TickJitter);
        add(long, Fault::TickTooLong);
        add(inputs.pose_jumped, Fault::PoseJump);
        found.add_some(inputs.driver.map(Fault::Driver));
        let over = self
            .current
            .advance(&params.current, inputs.currents, dt_us);
        found.add_some(over.map(Fault::OverCurrent));
        if self.supply.advance(&params.supply, inputs.supply_v, dt_us) {
            found.add(Fault::UnderVoltage);
        }
        self.check_wheels(settings, inputs, found);
    }

    /// Late ticks since the start.
    pub(crate) const fn late_ticks(&self) -> u32 {
        self.ticks.late
    }

    #[inline(always)]
    fn check_wheels(
        &mut self,
        settings: &ValidDetectorParams<T>,
        inputs: &DetectorInputs<T>,
        found: &mut ActiveFaults,
    ) {
        let torques = match self.supply.suspected(&settings.params.supply) {
            true => None,
            false => inputs.torques,
        };
        self.gathered = self.gathered.and(&Span::of(inputs.dt_us, torques));
        self.look_in_turn(settings, inputs);
        if !self.right.signs.and(self.left.signs).is_empty() {
            let outside = inputs
                .outside
                .map(|twist| settings.map.wheel_speeds_apart(&twist));
            let command = settings.map.wheel_speeds_apart(&inputs.command);
            self.find(settings, &command, outside.as_ref(), found);
        }
    }

    /// As much of the looks at both wheels as belongs to a tick of this length.
    #[inline(always)]
    fn look_in_turn(&mut self, settings: &ValidDetectorParams<T>, inputs: &DetectorInputs<T>) {
        let us = inputs.dt_us;
        if us <= PART_US {
            self.take_part(settings, inputs);
            return;
        }
        let (parts, looks) = if us <= BRIEF_US {
            (2, 0)
        } else {
            // Of a look that brief ticks before it have begun, what is left.
            (self.part.to_come(), if us <= SINGLE_US { 1 } else { 2 })
        };
        for _ in 0..parts {
            self.take_part(settings, inputs);
        }
        for _ in 0..looks {
            let span = self.take_span();
            let wheel = in_turn(self.is_left, &mut self.right, &mut self.left);
            let now = wheel_seen(settings, inputs, &span, self.is_left, wheel);
            wheel.advance(settings, &now);
            self.is_left = !self.is_left;
        }
    }

    /// What was exerted since the last look at the wheel whose turn it is.
    #[inline(always)]
    fn take_span(&mut self) -> Span<T> {
        let span = self.before.and(&self.gathered);
        self.before = core::mem::take(&mut self.gathered);
        span
    }

    /// A part of a look.
    #[inline(always)]
    fn take_part(&mut self, settings: &ValidDetectorParams<T>, inputs: &DetectorInputs<T>) {
        let wheel = in_turn(self.is_left, &mut self.right, &mut self.left);
        self.part = match self.part {
            Part::Take => {
                let span = self.take_span();
                let wheel = in_turn(self.is_left, &mut self.right, &mut self.left);
                self.look = wheel_seen(settings, inputs, &span, self.is_left, wheel);
                Part::Push
            }
            Part::Push => {
                wheel.push(settings, &self.look);
                Part::Filter
            }
            Part::Filter => {
                wheel.filter(settings, &self.look);
                Part::Compare
            }
            Part::Compare => {
                wheel.compare(settings, &self.look);
                self.is_left = !self.is_left;
                Part::Take
            }
        };
    }

    /// What the signs of the wheels come to.
    #[cold]
    #[inline(never)]
    fn find(
        &self,
        settings: &ValidDetectorParams<T>,
        command: &WheelSpeeds<T>,
        outside: Option<&WheelSpeeds<T>>,
        found: &mut ActiveFaults,
    ) {
        let (right, left) = outside.map(|speeds| (speeds.right, speeds.left)).unzip();
        let right = self.right.detections(settings, command.right, right);
        let left = self.left.detections(settings, command.left, left);
        let of = |what: fn(&WheelDetections) -> bool| Side::of(what(&right), what(&left));
        let (dead, reversed) = (dead(&right, &left), reversed(&right, &left));
        found.add_some(of(|wheel| wheel.stuck).or(dead).map(Fault::EncoderStuck));
        found.add_some(of(|wheel| wheel.blocked).map(|_| Fault::Stalled));
        found.add_some(reversed.map(Fault::EncoderReversed));
        found.add_some(of(|wheel| wheel.slips).map(Fault::WheelSlip));
    }
}

/// The wheel whose turn it is.
#[inline(always)]
const fn in_turn<'a, T>(
    is_left: bool,
    right: &'a mut Wheel<T>,
    left: &'a mut Wheel<T>,
) -> &'a mut Wheel<T> {
    if is_left { left } else { right }
}

/// What there is to be seen of a `wheel` after a `span`.
#[inline(always)]
fn wheel_seen<T: Scalar>(
    settings: &ValidDetectorParams<T>,
    inputs: &DetectorInputs<T>,
    span: &Span<T>,
    is_left: bool,
    wheel: &mut Wheel<T>,
) -> Look<T> {
    let (map, counts, command) = (&settings.map, &inputs.counts, &inputs.command);
    let WheelTorques { right, left } = span.impulses;
    let (own, other) = (&settings.own_accel, settings.other_accel);
    let (count, command, impulse, gained) = if is_left {
        let count = counts.as_ref().map(|counts| counts.left);
        let gained = own.left * left + other * right;
        (count, map.left_speed(command), left, gained)
    } else {
        let count = counts.as_ref().map(|counts| counts.right);
        let gained = own.right * right + other * left;
        (count, map.right_speed(command), right, gained)
    };
    let off = inputs.outside.map(|twist| {
        let Twist { linear, angular } = inputs.measured.twist.minus(&twist);
        let turning = T::HALF * settings.params.robot.wheels.track_m * angular;
        if is_left {
            linear - turning
        } else {
            linear + turning
        }
    });
    Look {
        us: span.us,
        moved: wheel.moved(count),
        effort: (!span.unknown).then_some(Effort { impulse, gained }),
        command,
        off,
    }
}

/// Wheels that turn against their torque while neither is silent that should not be.
fn reversed(right: &WheelDetections, left: &WheelDetections) -> Option<Side> {
    let is =
        |own: &WheelDetections, other: &WheelDetections| own.reversed && !own.silent && !other.dead;
    Side::of(is(right, left), is(left, right))
}

/// Encoders without counts that explain a wheel against its torque: its own, which died while it turned, or the
/// other one, whose motor is then driven at a speed that it does not have.
fn dead(right: &WheelDetections, left: &WheelDetections) -> Option<Side> {
    let is = |own: &WheelDetections, other: &WheelDetections| {
        (own.against && own.silent) || (other.against && !other.silent && own.ceased)
    };
    Side::of(is(right, left), is(left, right))
}

#[cfg(test)]
mod tests;

//! The heading by wheels and gyro together.

use super::disagreement::{Disagreement, Turned};
use super::params::{ValidGyroParams, WINDOW_S};
use super::reading::{GyroFault, GyroOutcome, GyroReading, GyroRefusal};
use super::spread::{Gain, Spread};
use crate::angle::wrap;
use crate::range::clamp;
use crate::scalar::Scalar;

/// Readings may be as old \[s\].
const OLDEST_S: f64 = 0.1;
/// A gyro that lied is believed again after it has agreed with the wheels over this turn \[rad\].
const PROOF: f64 = 1.0;
/// To this share: wheels that are believed are good to 2 %, and a curve of a radian has some of the straight in it.
const AGREES: f64 = 0.1;
/// A bias is beyond its limit from this multiple of it on: noise adds to what is just within.
const BEYOND: f64 = 1.1;
/// Standard deviations, squared, that readings of a base at rest may be apart.
const STEADY: f64 = 25.0;
/// By which a reading at rest says that the bias has jumped: six are exceeded by chance once in 500 million readings, a week at 1 kHz.
const JUMPED: f64 = 36.0;
/// Way over which the wheels' curvature bias is learnt from the gyro \[m\], and how much of what is seen is taken.
const STRETCH_M: f64 = 0.3;
const TAKEN: f64 = 0.3;
/// Only where the wheels differ by less than this share of the way: in curves the track matters more.
const STRAIGHT: f64 = 0.1;
/// A wheel that turns counts at least once in this time \[s\].
const COUNTS_S: f64 = 0.05;
/// One that has not for so long, while the other one turns, stands or has a dead encoder \[s\]: twice the time in which a wheel that changes its
/// direction counts again.
const CEASED_S: f64 = 0.3;
/// The bias is held to what the wheels say with this time constant \[s\], while it is known worse than that.
const WHEELS_S: f64 = 1.0;

/// A body may rock on its tyres so far after a stop \[rad\]: three times what simulated ones do.
const ROCKS: f64 = 5.0e-3;

/// An encoder that a gyro shows to be wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Encoder {
    /// Of the right wheel, or of the left one.
    Dead { right: bool },
    /// It counts the wrong way.
    Reversed,
}

/// Since a wheel counted last.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Standing<T> {
    /// What the gyro turned beyond the wheels, and what of it the heading did \[rad\].
    read: T,
    taken: T,
    /// More than its bias explains.
    turned: bool,
    /// The heading is held.
    holds: bool,
}

/// What the wheels did in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rolled<T> {
    /// Way of the middle \[m\].
    pub travel: T,
    /// Turn, what is known of the wheels' curvature bias included \[rad\].
    pub turn: T,
    /// Whether the right and the left wheel moved by a count.
    pub counted: (bool, bool),
    /// Time since the last tick \[s\].
    pub dt: T,
}

/// What is known of the gyro after a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GyroReport<T> {
    /// What became of the reading.
    pub outcome: GyroOutcome,
    /// Bias in use \[rad/s\].
    pub bias: T,
    /// Gyro and wheels disagree, by this turn since it began \[rad\]: the wheels' more than the gyro's. A wheel slides, or the
    /// gyro is faulty. 0 while they agree.
    pub slid: T,
    /// For so long a wheel has been sliding \[s\]: both count, they have disagreed for more than the 0.05 s in which a faulty gyro shows, and
    /// nothing speaks against the gyro; or only one counts, and the other has not for 0.3 s. 0 if not.
    pub slides_s: T,
    /// The gyro is faulty; the heading goes by the wheels.
    pub fault: Option<GyroFault>,
}

/// Integrates gyro readings to a heading, learns the bias, and compares with the wheels. Pure: time is an argument.
///
/// ```
/// use controller_core::gyro::{GyroHeading, GyroParams, GyroReading, Rolled};
/// use controller_core::odometry::{Calibration, OdometryParams};
/// use controller_core::wheels::WheelGeometry;
///
/// let wheels = OdometryParams {
///     wheels: WheelGeometry { radius_right_m: 0.035, radius_left_m: 0.035, track_m: 0.14 },
///     calibration: Calibration::NOMINAL, counts_per_turn: 2048.0, bandwidth: 50.0,
/// };
/// let gyro = GyroParams::<f32>::icm_42688_p().validate(&wheels, 0.02)?;
/// let mut heading = GyroHeading::new(&gyro);
/// let reading = GyroReading { rate: 0.5, heading: None, age_s: 0.0 };
/// // The wheels say 0.4 rad/s, the gyro 0.5: a tick of 10 ms turns by 5 mrad. The first reading only begins.
/// let rolled = Rolled { travel: 0.004, turn: 0.004, counted: (true, true), dt: 0.01 };
/// heading.advance(&gyro, &rolled, Some(&reading));
/// let turn = heading.advance(&gyro, &rolled, Some(&reading));
/// assert!((turn - 0.005).abs() < 1e-6);
/// # Ok::<(), controller_core::error::ParamError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroHeading<T> {
    bias: T,
    /// Learnt scale, less 1.
    scale: T,
    spread: Spread<T>,
    /// Time since the last reading came, and its age then \[s\].
    since_s: T,
    age_s: T,
    /// Whether there was one that the next continues.
    begun: bool,
    last_rate: T,
    last_heading: Option<T>,
    same: u8,
    /// Turn of the wheels within the last reading's age \[rad\].
    lag: T,
    /// Turn of the wheels that the next reading is about.
    behind: T,
    /// Leaky sums over the window: gyro less wheels, ways, turns.
    off: T,
    way: T,
    turned: T,
    /// Time without a count of the right and the left wheel; way that the next reading is about.
    quiet_s: (T, T),
    travelled: T,
    /// Time that readings have been steady at rest; their mean, and the turn that they were taken for.
    steady_s: T,
    steady: T,
    steady_turn: T,
    standing: Standing<T>,
    disagreement: Disagreement<T>,
    fault: Option<GyroFault>,
    /// Since it lied, or failed to prove the contrary: turn of the wheels, gyro less wheels.
    proof: (T, T),
    /// What odometry alone may have turned too much since the gyro was last believed.
    alone: T,
    /// Since curvature bias was learnt: way, turn, gyro less wheels.
    stretch: (T, T, T),
    outcome: GyroOutcome,
}

/// What a sound gyro's bias is estimated to be, at most \[rad/s\]: an estimate that ended at the limit itself would take noise of
/// one sign only from a bias just within.
fn largest_bias<T: Scalar>(gyro: &ValidGyroParams<T>) -> T {
    T::from_f64(BEYOND) * gyro.params.bias_limit
}

impl<T: Scalar> GyroHeading<T> {
    /// Nothing read yet; the bias anywhere within its limit.
    pub fn new(gyro: &ValidGyroParams<T>) -> Self {
        let zero = T::ZERO;
        Self {
            bias: zero,
            scale: zero,
            spread: Spread::new(zero, gyro.prior, gyro.scale),
            since_s: zero,
            age_s: zero,
            begun: false,
            last_rate: zero,
            last_heading: None,
            same: 0,
            lag: zero,
            behind: zero,
            off: zero,
            way: zero,
            turned: zero,
            quiet_s: (zero, zero),
            travelled: zero,
            steady_s: zero,
            steady: zero,
            steady_turn: zero,
            standing: Standing::default(),
            disagreement: Disagreement::default(),
            fault: None,
            proof: (zero, zero),
            alone: zero,
            stretch: (zero, zero, zero),
            outcome: GyroOutcome::Absent,
        }
    }

    /// Takes a tick; by how much the heading turned in it \[rad\].
    ///
    /// A reading is compared with what the wheels turned at its own time: their turn passes a lag of its age, which is exact at
    /// constant rates, so that the age costs nothing but while wheels and gyro disagree.
    pub fn advance(
        &mut self,
        gyro: &ValidGyroParams<T>,
        rolled: &Rolled<T>,
        reading: Option<&GyroReading<T>>,
    ) -> T {
        let (dt, window) = (rolled.dt, T::from_f64(WINDOW_S));
        self.since_s += dt;
        let kept = window / (window + dt);
        self.off = self.off * kept;
        self.way = (self.way + rolled.travel.abs()) * kept;
        self.turned = (self.turned + rolled.turn.abs()) * kept;
        let lag = (self.lag + rolled.turn) * (self.age_s / (self.age_s + dt));
        self.behind += rolled.turn - (lag - self.lag);
        self.lag = lag;
        let quiet = |counted: bool, quiet_s: T| if counted { T::ZERO } else { quiet_s + dt };
        self.quiet_s.0 = quiet(rolled.counted.0, self.quiet_s.0);
        self.quiet_s.1 = quiet(rolled.counted.1, self.quiet_s.1);
        self.travelled += rolled.travel;
        self.stretch.0 += rolled.travel;
        self.stretch.1 += rolled.turn.abs();
        if self.fault.is_some() {
            self.alone += gyro.per_way * rolled.travel.abs() + gyro.per_turn * rolled.turn.abs();
        }
        self.outcome = match reading.map(|reading| (reading, self.refusal(gyro, reading))) {
            None => GyroOutcome::Absent,
            Some((_, Some(refusal))) => GyroOutcome::Refused(refusal),
            Some((reading, None)) => return rolled.turn + self.take(gyro, reading),
        };
        if self.since_s > gyro.silent_s && self.fault.is_none() {
            self.fail(GyroFault::Silent);
            self.begun = false;
        }
        rolled.turn
    }

    fn refusal(&self, gyro: &ValidGyroParams<T>, reading: &GyroReading<T>) -> Option<GyroRefusal> {
        let finite = reading.heading.is_none_or(Scalar::is_finite);
        if !(finite && reading.rate.is_finite() && reading.age_s.is_finite()) {
            Some(GyroRefusal::NotFinite)
        } else if reading.age_s < T::ZERO {
            Some(GyroRefusal::NegativeAge)
        } else if reading.age_s > T::from_f64(OLDEST_S) {
            Some(GyroRefusal::TooOld)
        } else if reading.rate.abs() >= gyro.params.range {
            Some(GyroRefusal::BeyondRange)
        } else if self.begun && self.since_s + self.age_s <= reading.age_s {
            Some(GyroRefusal::NotNewer)
        } else {
            None
        }
    }

    /// A sound reading; what the heading turned beyond the wheels.
    fn take(&mut self, gyro: &ValidGyroParams<T>, reading: &GyroReading<T>) -> T {
        let t = self.since_s + self.age_s - reading.age_s;
        let before = self.last_heading;
        let same = self.begun && reading.rate == self.last_rate && reading.heading == before;
        self.same = if same { self.same.saturating_add(1) } else { 0 };
        self.last_rate = reading.rate;
        self.last_heading = reading.heading;
        self.since_s = T::ZERO;
        self.age_s = reading.age_s;
        let (wheels, travel) = (self.behind, self.travelled);
        self.behind = T::ZERO;
        self.travelled = T::ZERO;
        self.outcome = if self.fault.is_none() {
            GyroOutcome::Used
        } else {
            GyroOutcome::Compared
        };
        // Over so long a tick, or over none, no rate says what was turned.
        if !self.begun || t > T::ONE {
            self.begun = true;
            if self.fault == Some(GyroFault::Silent) {
                self.believe();
            }
            return T::ZERO;
        }
        let fused = match (reading.heading, before) {
            (Some(now), Some(before)) => Some(wrap(now - before)),
            _ => None,
        };
        let read = (T::ONE + self.scale) * fused.unwrap_or((reading.rate - self.bias) * t);
        self.off += read - wheels;
        let apart = self.while_standing(gyro, read - wheels, t);
        let turned = Turned {
            t,
            gyro: wheels + apart,
            wheels,
            travel,
            same: self.same,
        };
        self.stretch.2 += apart;
        if let Some(taken_back) = self.rest(gyro, &turned, fused.is_some()) {
            return taken_back;
        }
        if self.fault.is_some() {
            self.prove(gyro, &turned);
            return T::ZERO;
        }
        let seen = self.beyond_honest(gyro, fused.is_some());
        if let Some(fault) = self.disagreement.take(gyro, &turned, seen) {
            return apart - self.fail(fault);
        }
        if fused.is_some() {
            self.spread
                .pass(T::ZERO, turned.gyro, gyro.noise * t, T::ZERO);
        } else {
            let (noise, walk) = (gyro.noise * t, gyro.walk * t);
            // A bias that was not taken is in no heading.
            let biased_s = if self.standing.holds { T::ZERO } else { t };
            self.spread.pass(biased_s, turned.gyro, noise, walk);
            self.hold_to_wheels(gyro, read - wheels, t);
        }
        apart
    }

    /// Of the turn `apart` from the wheels, in `t`, what the heading takes. Between two counts no wheel turns by more than one: what goes on beyond
    /// that is bias, as long as what is not known of the bias explains it, and is held. Beyond it somebody turns a base whose wheels stand.
    fn while_standing(&mut self, gyro: &ValidGyroParams<T>, apart: T, t: T) -> T {
        let still_s = self.still_s();
        let standing = &mut self.standing;
        if still_s < t {
            *standing = Standing::default();
            return apart;
        }
        let most = T::HALF * gyro.rounding + self.lag.abs();
        standing.read += apart;
        let beyond = standing.read.abs() - most;
        let turned = beyond - T::from_f64(ROCKS);
        let bias = T::from_f64(9.0) * still_s * still_s * self.spread.bb;
        standing.turned |= turned > T::ZERO && turned * turned > gyro.honest + bias;
        standing.holds = beyond > T::ZERO && !standing.turned;
        let taken = if standing.holds {
            clamp(standing.read, most)
        } else {
            standing.read
        };
        let more = taken - standing.taken;
        standing.taken = taken;
        more
    }

    /// The turn apart in the window, where it is more than noise, biases, radii and rounding explain.
    fn beyond_honest(&self, gyro: &ValidGyroParams<T>, fused: bool) -> Option<T> {
        let beyond = self.off.abs() - self.geometry(gyro);
        let f = T::from_f64;
        let bias = if fused {
            T::ZERO
        } else {
            f(9.0 * WINDOW_S * WINDOW_S) * self.spread.bb
        };
        (beyond > T::ZERO && beyond * beyond > gyro.honest + bias).then_some(self.off)
    }

    /// What radii, track, scale, counts and the age leave of two equal turns in the window \[rad\].
    fn geometry(&self, gyro: &ValidGyroParams<T>) -> T {
        gyro.per_way * self.way + gyro.per_turn * self.turned + gyro.rounding + self.lag.abs()
    }

    /// Where the wheels have stood and the readings been steady for long enough the base stands, and what is read is bias: the
    /// turn that the reading is worth, and all that steady ones were taken for before is taken back.
    fn rest(&mut self, gyro: &ValidGyroParams<T>, turned: &Turned<T>, fused: bool) -> Option<T> {
        let (t, rest) = (turned.t, gyro.params.rest_s);
        if self.still_s() < rest {
            self.steady_s = T::ZERO;
            return None;
        }
        let variance = gyro.noise / t + T::from_f64(12.0) * gyro.rounded;
        let off = self.last_rate - self.steady;
        // The mean of what was steady so far is worth as many readings.
        let gate = T::from_f64(STEADY) * variance * (T::ONE + t / (self.steady_s + t));
        if self.steady_s <= T::ZERO || off * off > gate {
            self.steady = self.last_rate;
            self.steady_s = t;
            self.steady_turn = if self.fault.is_some() {
                T::ZERO
            } else {
                turned.gyro
            };
            return None;
        }
        self.steady_s += t;
        self.steady += t / self.steady_s * off;
        if self.steady_s < rest {
            if self.fault.is_some() {
                return Some(T::ZERO);
            }
            // Not counted as a turn that the bias would explain: it will be taken back, or was one.
            self.steady_turn += turned.gyro;
            return Some(turned.gyro - turned.wheels);
        }
        let false_turn = self.steady_turn;
        self.steady_turn = T::ZERO;
        self.off = T::ZERO;
        self.stretch.2 -= turned.gyro + false_turn;
        let within = self.steady.abs() <= largest_bias(gyro);
        if self.fault.is_none() && !within && !fused {
            return Some(-self.fail(GyroFault::Bias) - false_turn);
        }
        self.disagreement = Disagreement::default();
        match self.fault {
            None if fused => Some(-false_turn),
            None => Some(self.learn(gyro, t) - false_turn),
            Some(GyroFault::Bias) if within => {
                self.believe();
                self.spread.forget_bias(gyro.prior);
                Some(T::ZERO)
            }
            Some(_) => Some(T::ZERO),
        }
    }

    /// A reading at rest: b ← b + K (ω − b); what that says of the heading so far.
    fn learn(&mut self, gyro: &ValidGyroParams<T>, t: T) -> T {
        let off = self.last_rate - self.bias;
        let variance = gyro.noise / t + gyro.rounded;
        self.spread.pass(T::ZERO, T::ZERO, T::ZERO, gyro.walk * t);
        if off * off > T::from_f64(JUMPED) * (self.spread.bb + variance) {
            // It has jumped within its limit: what was learnt is worth nothing.
            self.spread.forget_bias(gyro.prior);
        }
        let gain = self.spread.see_bias(variance);
        self.correct(gyro, gain, off);
        gain.heading * off
    }

    /// While the bias is known worse than the wheels know the turn rate, they teach it: to their own doubt, not beyond.
    fn hold_to_wheels(&mut self, gyro: &ValidGyroParams<T>, apart: T, t: T) {
        let doubt = self.geometry(gyro) * T::from_f64(1.0 / WINDOW_S);
        let doubt = doubt * doubt;
        if self.spread.bb > doubt && !self.disagreement.lasts() {
            let share = clamp(t * T::from_f64(1.0 / WHEELS_S), T::ONE);
            let share = share * (T::ONE - doubt / self.spread.bb);
            self.bias = clamp(self.bias + share * apart / t, largest_bias(gyro));
            self.spread.narrow_bias(T::ONE - share);
        }
    }

    /// From now on it is not used; the turn that it has reported since it disagrees.
    fn fail(&mut self, fault: GyroFault) -> T {
        self.fault = Some(fault);
        self.proof = (T::ZERO, T::ZERO);
        let turn = self.disagreement.apart;
        self.disagreement = Disagreement::default();
        turn
    }

    /// A gyro that lied has to agree with the wheels over a radian one way.
    fn prove(&mut self, gyro: &ValidGyroParams<T>, turned: &Turned<T>) {
        let (wheels, apart) = &mut self.proof;
        *wheels += turned.wheels;
        *apart += turned.gyro - turned.wheels;
        if wheels.abs() < T::from_f64(PROOF) {
            return;
        }
        let agrees = apart.abs() < T::from_f64(AGREES) * wheels.abs();
        self.proof = (T::ZERO, T::ZERO);
        if agrees {
            self.believe();
            self.spread.forget_bias(gyro.prior);
        }
    }

    fn believe(&mut self) {
        self.fault = None;
        self.outcome = GyroOutcome::Used;
        self.off = T::ZERO;
        // Not more than all around.
        let alone = clamp(self.alone, T::PI);
        self.spread.set_heading(self.spread.hh + alone * alone);
        self.alone = T::ZERO;
    }

    /// A fix was fused whose heading is off by `off`.
    pub(crate) fn fused(&mut self, gyro: &ValidGyroParams<T>, off: T, variance: T) {
        if self.fault.is_some() {
            return;
        }
        let gain = self.spread.see_heading(variance);
        self.correct(gyro, gain, off);
    }

    fn correct(&mut self, gyro: &ValidGyroParams<T>, gain: Gain<T>, off: T) {
        self.bias = clamp(self.bias + gain.bias * off, largest_bias(gyro));
        self.scale = clamp(self.scale + gain.scale * off, gyro.params.scale_error);
    }

    /// The pose was set to one whose heading has this variance.
    pub(crate) fn set(&mut self, variance: T) {
        self.spread.set_heading(variance);
    }

    /// An external heading is off by `off` from this one; the turn to be taken back where it shows a faulty gyro.
    pub(crate) fn judge(&mut self, gyro: &ValidGyroParams<T>, off: T, variance: T) -> Option<T> {
        let variance = variance + self.spread.hh;
        if self.fault.is_some() {
            return None;
        }
        let fault = self
            .disagreement
            .sides_with_wheels(gyro, off, variance, self.same)?;
        Some(self.fail(fault))
    }

    /// What the wheels turn too little per way by the gyro \[rad/m\], once after each stretch of some decimetres.
    pub(crate) fn curvature(&mut self, gyro: &ValidGyroParams<T>) -> Option<T> {
        let (way, turned, off) = self.stretch;
        if way.abs() < T::from_f64(STRETCH_M) && turned < T::ONE {
            return None;
        }
        self.stretch = (T::ZERO, T::ZERO, T::ZERO);
        let straight = turned * gyro.wheels_half_track < T::from_f64(STRAIGHT) * way.abs();
        let sound = self.fault.is_none() && !self.disagreement.lasts();
        (straight && sound).then(|| T::from_f64(TAKEN) * off / way)
    }

    /// The gyro carries the heading.
    pub fn carries(&self) -> bool {
        self.fault.is_none() && self.begun
    }

    /// Wheels and gyro disagree.
    pub fn slides_now(&self) -> bool {
        self.disagreement.lasts()
    }

    /// Variance of the heading \[rad²\].
    pub fn heading_variance(&self) -> T {
        self.spread.hh
    }

    /// Variance of the bias \[rad²/s²\].
    pub fn bias_variance(&self) -> T {
        self.spread.bb
    }

    /// What is known after the tick.
    pub fn report(&self) -> GyroReport<T> {
        GyroReport {
            outcome: self.outcome,
            bias: self.bias,
            slid: -self.disagreement.apart,
            slides_s: if self.disagreement.lasts() {
                self.slides_s()
            } else {
                T::ZERO
            },
            fault: self.fault,
        }
    }

    /// For so long a wheel has been sliding, or an encoder wrong. Counts that have just ceased may come again.
    #[cold]
    #[inline(never)]
    fn slides_s(&self) -> T {
        let counts = |quiet_s: T| quiet_s < T::from_f64(COUNTS_S);
        let turns = counts(self.quiet_s.0) && counts(self.quiet_s.1);
        if turns || self.ceased().is_some() {
            self.disagreement.slides_s(self.same)
        } else {
            T::ZERO
        }
    }

    /// The wheel, right or not, that has not counted for so long that its encoder is dead if the gyro disagrees, while the other one counts.
    #[cold]
    #[inline(never)]
    fn ceased(&self) -> Option<bool> {
        let (right, left) = self.quiet_s;
        let (counts, ceased) = (T::from_f64(COUNTS_S), T::from_f64(CEASED_S));
        let right_ceased = right > ceased && left < counts;
        let left_ceased = left > ceased && right < counts;
        (right_ceased || left_ceased).then_some(right_ceased)
    }

    /// The encoder that is the cause where wheels and gyro disagree, if one is.
    #[cold]
    #[inline(never)]
    pub(crate) fn encoder(&self) -> Option<Encoder> {
        match self.ceased() {
            Some(right) => Some(Encoder::Dead { right }),
            None if self.disagreement.may_be_encoder() => Some(Encoder::Reversed),
            None => None,
        }
    }

    /// Both wheels have stood for so long.
    fn still_s(&self) -> T {
        let (right, left) = self.quiet_s;
        if right < left { right } else { left }
    }
}

#[cfg(test)]
mod tests;

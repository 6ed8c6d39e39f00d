//! Parking at a pose, position and heading, forward or backward.

use super::gains::{BEARING, COUPLING};
use super::lag::LagState;
use super::params::ValidMotionParams;
use super::setpoint::Setpoint;
use crate::angle::wrap;
use crate::maths::Maths;
use crate::pose_error::PoseError;
use crate::range::{clamp, signed};
use crate::scalar::Scalar;
use crate::scalar::residue;
use crate::shunting::NeuronUpdate;
use crate::types::{Accel, Twist};

/// Radii of the noise from the goal at which the robot stops to aim at it and aligns, and at which it aims
/// again.
///
/// At 1.5 radii the direction to the goal is known to 0.13 rad, and what stays beside the goal is below
/// the tolerance of arrival. Nothing between the two distances is worth aiming at: a goal 5 mm to the side
/// is a quarter turn away, and before the turn is done the goal is elsewhere. Where the aim fades out instead,
/// both laws may balance: a 10 kg base on a bad floor turned about its goal for 30 s. What is beside the goal
/// then is a new approach's to mend ([`super::retry`]). Exact poses have nothing to balance about, and fade.
const ALIGN: (f64, f64) = (1.5, 5.0);

/// Memory of the parking law.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PoseRegulator<T> {
    approach: LagState<T>,
    turn: LagState<T>,
    /// 1 forward, −1 backward, 0 undecided.
    direction: T,
    /// β of the last tick, to follow it across ±π.
    beta: T,
    /// Close to the goal: heading and what lies ahead are corrected, its direction is not.
    aligning: bool,
}

/// Polar coordinates of the goal as the robot sees it, for one direction of travel.
#[derive(Clone, Copy)]
struct View<T> {
    /// Bearing of the goal from the front (or back) of the robot \[rad\].
    alpha: T,
    /// Bearing as seen from the goal's heading \[rad\].
    beta: T,
}

impl<T: Scalar> PoseRegulator<T> {
    /// Nothing seen yet.
    pub(crate) const NEW: Self = Self {
        approach: LagState::NEW,
        turn: LagState::NEW,
        direction: T::ZERO,
        beta: T::ZERO,
        aligning: false,
    };

    /// A polar law with a strict Lyapunov function, through neurons.
    ///
    /// With ρ the distance and α the bearing of the goal, β = α − e_θ and φ = atan(h β):
    ///
    /// ```text
    /// v_d = s₁ of K e_x
    /// w_d = s₃ of K max(cos α, 0.2) [k_a (α + φ) + (1 + φ′) sin α]
    /// ```
    ///
    /// With v = K ρ cos α the surface z = α + φ decays, ż = −k_a K cos(α) z, and on it β does too:
    /// V = z²/2 + c β²/2 falls strictly. K is k₄ near the goal and √(2p(ρ − r₀/2))/ρ beyond
    /// r₀ = p/k₄²: a straight run brakes at p. Backing up is the same law seen from the back; the
    /// direction with the smaller α² + h β² is taken, and left only for one much better. Where w_d would be beyond the largest turn rate K is
    /// smaller, for both: V falls with any K > 0, but a robot that turns less than it asks for and drives as fast circles about its goal for ever.
    ///
    /// Close to the goal its direction means nothing, and w_d = s₃ of k₄ e_θ: from [`ALIGN`] on, or, with exact
    /// poses, more and more from twice `near` to `near`.
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn advance<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        error: &PoseError<T>,
        distance: T,
        command: &Twist<T>,
        two_per_dt: Option<T>,
    ) -> Setpoint<T> {
        let gains = motion.gains();
        let gain = self.distance_gain::<M>(motion, distance);
        if two_per_dt.is_none() {
            self.direction = T::ZERO;
            self.beta = T::ZERO;
            self.aligning = false;
        }
        let aim = self.aim(motion, distance);
        let view = self.choose::<M>(error, command.linear);
        let bearing = bearing_law::<T, M>(&view, gain);
        let most = motion.turn.demand_for(motion.params().limits.turn_rate);
        let (gain, bearing) = if bearing.abs() > most {
            (gain * (most / bearing.abs()), signed(most, bearing))
        } else {
            (gain, bearing)
        };
        let turn = aim * bearing + (T::ONE - aim) * (gains.approach * error.theta);
        let ahead = gain * error.x;
        match two_per_dt {
            Some(two_per_dt) => {
                self.approach = motion.approach.advance::<U, M>(
                    &self.approach,
                    ahead,
                    motion.approach_decay,
                    two_per_dt,
                );
                self.turn = motion.turn.advance::<U, M>(
                    &self.turn,
                    turn,
                    motion.approach_decay,
                    two_per_dt,
                );
            }
            None => {
                self.approach = motion.approach.reset(command.linear, ahead);
                self.turn = motion.turn.reset(command.angular, turn);
            }
        }
        Setpoint {
            twist: Twist {
                linear: self.approach.value,
                angular: self.turn.value,
            },
            rate: Accel {
                linear: motion.approach.rate(&self.approach, motion.approach_decay),
                angular: motion.turn.rate(&self.turn, motion.approach_decay),
            },
        }
    }

    pub(crate) fn residue(&self) -> T {
        self.approach.residue() + self.turn.residue() + residue([self.beta])
    }

    /// The robot backs up.
    pub(crate) fn is_backing(&self) -> bool {
        self.direction < T::ZERO
    }

    /// At the goal: the neurons rest.
    pub(crate) fn rest(&mut self) {
        self.approach = LagState::default();
        self.turn = LagState::default();
    }

    /// K(ρ): what makes a run to the goal brake at p from far away and decay with k₄ near it.
    fn distance_gain<M: Maths<T>>(&self, motion: &ValidMotionParams<T>, distance: T) -> T {
        let gains = motion.gains();
        let (k4, p) = (gains.approach, gains.approach_brake);
        let knee = p / (k4 * k4);
        if distance <= knee {
            k4
        } else {
            M::sqrt((p + p) * (distance - T::HALF * knee)) / distance
        }
    }

    /// The share of the bearing in turning, 0 to 1; the rest is the heading's.
    fn aim(&mut self, motion: &ValidMotionParams<T>, distance: T) -> T {
        if !motion.noisy {
            return near_share(distance / motion.near);
        }
        let (from, until) = ALIGN;
        let radii = T::from_f64(if self.aligning { until } else { from });
        self.aligning = distance < radii * motion.near;
        if self.aligning { T::ZERO } else { T::ONE }
    }

    fn choose<M: Maths<T>>(&mut self, error: &PoseError<T>, speed: T) -> View<T> {
        let f = T::from_f64;
        let bearing = M::atan2(error.y, error.x);
        let forward = View::new(bearing, error.theta);
        let backward = View::new(wrap(bearing + T::PI), error.theta);
        if self.direction == T::ZERO {
            // A moving robot goes on as it moves unless the other way is much cheaper.
            let slow = f(0.05);
            let weigh = |moving: bool, cost: T| if moving { T::HALF * cost } else { cost };
            let cost_forward = weigh(speed > slow, forward.cost());
            let cost_backward = weigh(speed < -slow, backward.cost());
            self.direction = if cost_forward <= cost_backward {
                T::ONE
            } else {
                -T::ONE
            };
        }
        let (mut view, other) = if self.direction > T::ZERO {
            (forward, backward)
        } else {
            (backward, forward)
        };
        if view.alpha.abs() > f(1.7) && other.cost() < f(0.7) * view.cost() {
            self.direction = -self.direction;
            view = other;
        }
        let margin = f(0.3);
        let crossed = view.beta * self.beta < T::ZERO
            && view.beta.abs() > T::PI - margin
            && self.beta.abs() > T::FRAC_PI_2;
        if crossed {
            let turn = T::PI + T::PI;
            view.beta += if self.beta > T::ZERO { turn } else { -turn };
        }
        self.beta = view.beta;
        view
    }
}

impl<T: Scalar> View<T> {
    fn new(alpha: T, theta: T) -> Self {
        Self {
            alpha,
            beta: wrap(alpha - theta),
        }
    }

    fn cost(&self) -> T {
        self.alpha * self.alpha + T::from_f64(COUPLING) * self.beta * self.beta
    }
}

fn bearing_law<T: Scalar, M: Maths<T>>(view: &View<T>, gain: T) -> T {
    let (h, ka) = (T::from_f64(COUPLING), T::from_f64(BEARING));
    let bent = h * view.beta;
    let phi = M::atan2(bent, T::ONE);
    let phi_slope = h / (T::ONE + bent * bent);
    let (sine, cosine) = M::sin_cos_near(view.alpha);
    let least = T::from_f64(0.2);
    let facing = if cosine > least { cosine } else { least };
    gain * facing * (ka * (view.alpha + phi) + (T::ONE + phi_slope) * sine)
}

/// 0 at the noise radius and below, 1 from twice it on, smooth in between.
fn near_share<T: Scalar>(radii: T) -> T {
    let z = clamp(radii - T::ONE, T::ONE);
    if z <= T::ZERO {
        T::ZERO
    } else {
        z * z * (T::from_f64(3.0) - (z + z))
    }
}

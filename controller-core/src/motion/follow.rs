//! Following a moving reference, at any speed and from any heading.

use super::error_view::ErrorView;
use super::lag::LagState;
use super::params::ValidMotionParams;
use super::pose_law::{Moving, Transition, Wanted};
use super::setpoint::Setpoint;
use crate::maths::Maths;
use crate::pose_error::PoseError;
use crate::reference::Reference;
use crate::scalar::Scalar;
use crate::shunting::NeuronUpdate;
use crate::types::{Accel, Twist};

/// Memory of the following law.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Follower<T> {
    along: LagState<T>,
    across: LagState<T>,
    around: LagState<T>,
    /// Which way to turn out of a heading error beyond π/2: ±1, 0 if there is none.
    side: T,
}

/// The present instant of a follower.
pub(crate) struct Instant<'a, T> {
    /// Of the reference.
    pub(crate) twist: &'a Twist<T>,
    /// Of the reference.
    pub(crate) accel: &'a Accel<T>,
    pub(crate) error: PoseError<T>,
    /// (sin e_θ, cos e_θ).
    pub(crate) heading: (T, T),
    /// Measured turn rate.
    pub(crate) turn_rate: T,
    /// The reference's turn rate, of one that will brake as hard as the base can: a manoeuvre's.
    pub(crate) ending: Option<T>,
}

impl<T: Scalar> Follower<T> {
    /// Nothing seen yet.
    pub(crate) const NEW: Self = Self {
        along: LagState::NEW,
        across: LagState::NEW,
        around: LagState::NEW,
        side: T::ZERO,
    };

    /// Eq. (15) for any v_r, with the reference fed forward and the schedule in a neuron's input.
    ///
    /// ```text
    /// v_d = s₁ + v_r cos e_θ
    /// w_d = w_r + w(s₂ + sin e_θ + s₃)            w of [`TurnDemand`](super::turn_demand::TurnDemand): k₃ e, as far as the base can brake
    /// ```
    ///
    /// | neuron | demand | bound |
    /// | --- | --- | --- |
    /// | s₁ | k₁ e_x | `along_bound` |
    /// | s₂ | g e_y/√(1 + (g e_x)²), g = (c/k₃) v_r/(v_r² + v_f²), limited to B | B = √2 |
    /// | s₃ | beyond \|e_θ\| = π/2: ±1 − sin e_θ, so that a robot that looks back turns as fast as one that looks aside | 1.5 |
    ///
    /// k₂ of the paper is c/(v_r² + v_f²): lateral poles that do not depend on v_r, no division by it,
    /// smooth through 0 and the same for v_r < 0. As it is part of an input, no derivative of it is
    /// needed. The heading asked for by s₂ is at most asin B/2 for any offset, 45°.
    #[inline(always)]
    pub(crate) fn advance<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        now: &Instant<'_, T>,
        command: &Twist<T>,
        two_per_dt: Option<T>,
    ) -> Setpoint<T> {
        let gains = motion.gains();
        let (reference, accel) = (now.twist, now.accel);
        let (sine, cosine) = now.heading;
        let v = reference.linear;
        let slope = motion.lateral * v / (v * v + gains.slow * gains.slow);
        let ahead = slope * now.error.x;
        let across = slope * now.error.y * M::inverse_sqrt(T::ONE + ahead * ahead);
        let demands = (
            gains.longitudinal * now.error.x,
            motion.across.clip(across),
            self.turn_around(now.error.theta, sine),
        );
        // Hardly a robot looks back. One that does not, and has not done so lately, has nothing of the third neuron, and does not work it out.
        let looks_back = demands.2 != T::ZERO || self.around.is_felt();
        match two_per_dt {
            Some(two_per_dt) => {
                let step = |lag: &super::lag::Lag<T>, state: &LagState<T>, demand| {
                    lag.advance::<U, M>(state, demand, gains.decay, two_per_dt)
                };
                self.along = step(&motion.along, &self.along, demands.0);
                self.across = step(&motion.across, &self.across, demands.1);
                if looks_back {
                    self.around = step(&motion.around, &self.around, demands.2);
                }
            }
            None => {
                let beyond = command.angular - reference.angular;
                let turned = motion.turning.error_of(beyond, now.ending) - sine;
                self.along = motion.along.reset(command.linear - v * cosine, demands.0);
                self.across = motion.across.reset(turned, demands.1);
                self.around = motion.around.reset(T::ZERO, demands.2);
            }
        }
        let heading_rate = reference.angular - now.turn_rate;
        let mut turn = self.across.value + sine;
        let mut turn_rate = motion.across.rate(&self.across, gains.decay) + cosine * heading_rate;
        if looks_back {
            turn += self.around.value;
            turn_rate += motion.around.rate(&self.around, gains.decay);
        }
        let turn = motion.turning.at::<M>(turn, now.ending);
        Setpoint {
            twist: Twist {
                linear: self.along.value + v * cosine,
                angular: reference.angular + turn.rate,
            },
            rate: Accel {
                linear: motion.along.rate(&self.along, gains.decay) + accel.linear * cosine
                    - v * sine * heading_rate,
                angular: turn.by_reference * accel.angular + turn.by_error * turn_rate,
            },
        }
    }

    /// A tick along a reference.
    #[inline(always)]
    pub(crate) fn follow<U: NeuronUpdate<T>, M: Maths<T>>(
        &mut self,
        motion: &ValidMotionParams<T>,
        reference: &Reference<T>,
        view: &ErrorView<T>,
        moving: Moving<'_, T>,
        two_per_dt: Option<T>,
    ) -> Wanted<T> {
        let now = Instant {
            twist: reference.twist(),
            accel: reference.accel(),
            error: view.error,
            heading: view.heading,
            turn_rate: moving.twist.angular,
            ending: None,
        };
        let command = &moving.command.twist;
        Wanted {
            setpoint: self.advance::<U, M>(motion, &now, command, two_per_dt),
            transition: Transition::after(two_per_dt),
        }
    }

    /// What sin e_θ lacks beyond a quarter turn. Which way is decided once and kept near half a
    /// turn, where the sign of e_θ is noise.
    fn turn_around(&mut self, theta: T, sine: T) -> T {
        if theta.abs() <= T::FRAC_PI_2 {
            self.side = T::ZERO;
            return T::ZERO;
        }
        if self.side == T::ZERO || theta.abs() < T::PI - T::from_f64(0.3) {
            self.side = if theta > T::ZERO { T::ONE } else { -T::ONE };
        }
        self.side - sine
    }
}

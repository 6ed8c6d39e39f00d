//! References that move by Eq. (6): constant or sinusoidally modulated speeds.

use controller_core::maths::{Libm, Maths};
use controller_core::reference::{ConstantTwist, Reference};
use controller_core::types::{Accel, Pose, Twist};

/// c(t) = mean + amplitude · sin(frequency · t + phase).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Profile {
    /// v0 or w0.
    pub mean: f64,
    /// v1 or w1.
    pub amplitude: f64,
    /// Ov or Ow \[rad/s\].
    pub frequency: f64,
    /// pv or pw \[rad\].
    pub phase: f64,
}

impl Profile {
    /// c(t).
    pub fn value(&self, t: f64) -> f64 {
        self.mean + self.amplitude * self.sin_cos(t).0
    }

    /// dc/dt.
    pub fn rate(&self, t: f64) -> f64 {
        self.amplitude * self.frequency * self.sin_cos(t).1
    }

    /// ∫₀ᵗ c, exact for every frequency.
    ///
    /// cos p − cos(Ot + p) is written as 2 sin(Ot/2 + p) sin(Ot/2): no cancellation, and no
    /// special case but sin(x)/x at small frequencies.
    pub fn integral(&self, t: f64) -> f64 {
        let half = 0.5 * self.frequency * t;
        let sinc = if half.abs() < 1.0e-4 {
            1.0 - half * half / 6.0
        } else {
            Libm::sin_cos(half).0 / half
        };
        self.mean * t + self.amplitude * t * sinc * Libm::sin_cos(half + self.phase).0
    }

    /// The largest |c(t)| that can occur.
    pub fn largest(&self) -> f64 {
        self.mean.abs() + self.amplitude.abs()
    }

    fn sin_cos(&self, t: f64) -> (f64, f64) {
        Libm::sin_cos(self.frequency * t + self.phase)
    }
}

/// How the reference moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReferenceMotion {
    /// A line, an arc or a turn in place, in closed form.
    Constant(ConstantTwist<f64>),
    /// v_r(t) and w_r(t) each a constant plus a sine.
    Modulated {
        /// q_r(0).
        start: Pose<f64>,
        /// v_r(t).
        speed: Profile,
        /// w_r(t).
        turn_rate: Profile,
    },
}

impl ReferenceMotion {
    /// The reference at time `t` ≥ 0 \[s\]. For many times in order, [`ReferenceMotion::walk`] is cheaper.
    pub fn at(&self, t: f64) -> Reference<f64> {
        self.walk().advance_to(t)
    }

    /// A walker at t = 0.
    pub fn walk(&self) -> Walker {
        Walker {
            motion: *self,
            t: 0.0,
            travel: (0.0, 0.0),
        }
    }

    /// The largest |v_r| that can occur \[m/s\].
    pub fn largest_speed(&self) -> f64 {
        match self {
            Self::Constant(path) => path.twist.linear.abs(),
            Self::Modulated { speed, .. } => speed.largest(),
        }
    }
}

/// Samples a [`ReferenceMotion`] at rising times, integrating only from one to the next.
///
/// Heading and its rates are exact. Position is the integral of v_r (cos θ_r, sin θ_r), by
/// five-point Gauss-Legendre panels over which neither the sine of the speed nor the heading
/// turns by more than 0.1 rad. The rule's error over a panel of length h, 4e-13 h¹¹ |f⁽¹⁰⁾|, is
/// then below 1e-20 of the way: what is left is the rounding of the sum.
#[derive(Clone, Debug)]
pub struct Walker {
    motion: ReferenceMotion,
    t: f64,
    travel: (f64, f64),
}

/// Nodes and weights of the five-point rule on [−1, 1].
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// Largest turn of heading or sine within one panel \[rad\].
const PANEL_TURN: f64 = 0.1;

impl Walker {
    /// The reference at `t`, not before the time of the last call.
    pub fn advance_to(&mut self, t: f64) -> Reference<f64> {
        match self.motion {
            ReferenceMotion::Constant(path) => path.at::<Libm>(t),
            ReferenceMotion::Modulated {
                start,
                speed,
                turn_rate,
            } => {
                self.travel_to(t, start.theta, &speed, &turn_rate);
                Reference::new_with::<Libm>(
                    Pose {
                        x: start.x + self.travel.0,
                        y: start.y + self.travel.1,
                        theta: start.theta + turn_rate.integral(t),
                    },
                    Twist::new(speed.value(t), turn_rate.value(t)),
                    Accel::new(speed.rate(t), turn_rate.rate(t)),
                )
            }
        }
    }

    fn travel_to(&mut self, t: f64, heading: f64, speed: &Profile, turn_rate: &Profile) {
        let fastest = speed.frequency.abs() + turn_rate.frequency.abs() + turn_rate.largest();
        let panels = ((t - self.t) * fastest / PANEL_TURN).ceil().max(1.0);
        let width = (t - self.t) / panels;
        // A handful per tick; the ranges of scenario files bound it for every reference.
        for panel in 0..panels as usize {
            let middle = self.t + width * (panel as f64 + 0.5);
            for (node, weight) in GAUSS {
                let at = middle + 0.5 * width * node;
                let step = 0.5 * width * weight * speed.value(at);
                let (sine, cosine) = Libm::sin_cos(heading + turn_rate.integral(at));
                self.travel.0 += step * cosine;
                self.travel.1 += step * sine;
            }
        }
        self.t = t;
    }
}

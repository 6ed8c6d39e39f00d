//! Posture and twist from counts.

use std::f64::consts::PI;

use nalgebra::{Vector2, Vector3};

use super::{Body, Constants};

/// Nodes of Gauss' rule with eight points on \[−1, 1\], one of each pair, and their weights.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_3),
];

/// Loop's bandwidth times the time between counts, at most.
const PER_COUNT: f64 = 1.5;
/// Longest time between counts that slows the loop \[s\].
const LONGEST: f64 = 0.2;
/// Without a count for so long a wheel rests \[s\].
const REST: f64 = 0.5;
/// Counts a second of a wheel that stands.
const STANDS: f64 = 0.01;
/// Single counts in one direction of a wheel that rolls.
const ROLLS: i32 = 4;
/// Third coefficient of the loop, s³ + 2ω s² + ω² s + this ω³.
const THIRD: f64 = 0.0625;

/// The loop of a wheel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Wheel {
    /// What is counted beyond what is estimated \[m\].
    lag: f64,
    speed: f64,
    between: f64,
    since: f64,
    overdue: f64,
    streak: i32,
    held: f64,
    /// Of the wheel, known to nobody \[m/s²\].
    drag: f64,
}

/// Odometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Odometry {
    /// Posture.
    pub q: Vector3<f64>,
    counts: [i32; 2],
    wheels: [Wheel; 2],
}

/// What odometry did in a tick.
pub struct Moved {
    /// (v, w).
    pub twist: Vector2<f64>,
    /// Of the middle \[m\].
    pub way: f64,
    /// Acceleration by the tyres, forward and to the left \[m/s²\].
    pub pushed: Vector2<f64>,
    /// Turn that tyres of 1 s²/m lose \[rad m/s²\].
    pub turn_lost: f64,
}

/// Accelerations that each rim would give to half of the mass \[m/s²\], what a difference of 1 m/s between rims turns \[1/m\], and the most
/// that is taken off a twist \[s\]; nothing for tyres of which nothing is to be learnt.
fn pushes(k: &Constants, accel: &Vector2<f64>) -> ([f64; 2], f64, f64) {
    let Some(Body {
        mass,
        inertia,
        track,
        bandwidth,
    }) = k.robot
    else {
        return ([0.0; 2], 0.0, 0.0);
    };
    // A loop that may be late by a fifth of its time constant, in which a turn counts `hard` times as much.
    let hard = 4.0 * inertia / (mass * track.powi(2));
    let most = 0.2 / bandwidth / hard.max(1.0);
    let turning = inertia * accel.y / track;
    let force = [
        0.5 * mass * accel.x + turning,
        0.5 * mass * accel.x - turning,
    ];
    (force.map(|force| force / (0.5 * mass)), 1.0 / track, most)
}

impl Odometry {
    /// At rest.
    pub fn start(q: Vector3<f64>, counts: [i32; 2]) -> Self {
        Self {
            q,
            counts,
            wheels: [Wheel::default(); 2],
        }
    }

    /// A tick.
    pub fn advance(
        &mut self,
        k: &Constants,
        counts: [i32; 2],
        dt: f64,
        accel: &Vector2<f64>,
        bias: &Vector3<f64>,
    ) -> Moved {
        let moved: [i32; 2] = std::array::from_fn(|i| counts[i].wrapping_sub(self.counts[i]));
        self.counts = counts;
        let per_count = k.radius * (2.0 * PI / k.counts_per_turn);
        let ways: [f64; 2] = std::array::from_fn(|i| f64::from(moved[i]) * per_count[i]);
        let (push, per_track, most) = pushes(k, accel);
        // Of rims that roll so far or so fast: what tyres of 1 s²/m lose, of the middle and of the turn.
        let lost = |rolled: f64| {
            let rims = push.map(|push| rolled.abs() * push);
            Vector2::new((rims[0] + rims[1]) / 2.0, (rims[0] - rims[1]) * per_track)
        };
        let rolled = (ways[0] + ways[1]) / 2.0;
        // Of travel of the middle and of what the right wheel is ahead: the learnt part is per way and per turn.
        let turned = |ahead: f64, way: f64| {
            bias.xy().dot(&Vector2::new(way, ahead / k.track)) + ahead / k.track
        };
        let lost_now = lost(rolled);
        let way = rolled - bias.z * lost_now.x;
        let turn = turned(ways[0] - ways[1], rolled) - bias.z * lost_now.y;
        let rim = [1.0, -1.0].map(|side| accel.x + side * k.track / 2.0 * accel.y);
        for i in 0..2 {
            self.wheels[i].advance(k.omega, moved[i], per_count[i], rim[i], dt);
        }
        let [right, left] = self.wheels.map(|wheel| wheel.speed);
        let v = (right + left) / 2.0;
        let slips = (bias.z * v.abs()).min(most);
        let twist = Vector2::new(v, turned(right - left, v)) - slips * lost(1.0);
        // What keeps the base on its curve comes of tyres that slip outward.
        let outward = bias.z * twist.x.abs() * twist.y;
        // The heading turns evenly along the way.
        let middle = self.q.z + turn / 2.0 - outward;
        let (mut along, mut aside) = (0.0, 0.0);
        for (node, weight) in GAUSS {
            for side in [-1.0, 1.0] {
                let (sine, cosine) = (middle + side * node * turn / 2.0).sin_cos();
                along += weight / 2.0 * cosine;
                aside += weight / 2.0 * sine;
            }
        }
        self.q += Vector3::new(way * along, way * aside, turn);
        Moved {
            twist,
            way,
            pushed: Vector2::new((push[0] + push[1]) / 2.0, twist.x * twist.y),
            turn_lost: lost_now.y,
        }
    }
}

impl Wheel {
    /// How long it is since the last count, the time between counts, and whether a single count ends a rest.
    fn count(&mut self, counts: i32, dt: f64) -> bool {
        let since = (self.since + dt).min(REST);
        if counts == 0 {
            self.since = since;
            return false;
        }
        self.since = 0.0;
        let single = counts.abs() == 1;
        let ends_rest = single && since >= REST;
        if ends_rest || counts.signum() != self.streak.signum() {
            self.streak = 0;
        }
        self.streak += counts.signum();
        if !single || self.streak.abs() >= ROLLS {
            self.held = 0.0;
        }
        self.between = if single { since } else { dt }.min(LONGEST);
        ends_rest
    }

    fn advance(&mut self, omega: f64, counts: i32, q: f64, accel: f64, dt: f64) {
        let ends_rest = self.count(counts, dt);
        let accel = accel + self.drag;
        let a = accel.signum() * (accel.abs() - self.held).max(0.0);
        let whole = omega;
        let rare = omega * self.between > PER_COUNT / 2.0;
        let omega = omega.min(PER_COUNT / self.between);
        let x = omega * dt;
        let ahead = self.speed * dt + a * dt.powi(2) / 2.0;
        let e = self.lag + f64::from(counts) * q - ahead;
        let inside = e.clamp(-q / 2.0, q / 2.0);
        let beyond = if ends_rest { 0.0 } else { e - inside };
        let shrink = (1.0 + x).powi(-2);
        self.lag = if ends_rest {
            inside
        } else {
            inside + beyond * shrink
        };
        let mut v = self.speed + a * dt + omega * x * shrink * beyond;
        let most = THIRD * whole * self.speed.abs();
        self.drag += THIRD * omega.powi(3) * dt * shrink * beyond;
        self.drag = self.drag.clamp(-most, most);
        if rare {
            self.drag = 0.0;
        }
        if counts == 0 && beyond * ahead < 0.0 {
            self.overdue += dt;
            let most = q / self.overdue;
            if v.abs() > most {
                v = v.clamp(-most, most);
                self.drag = 0.0;
                self.lag = inside;
                if a * ahead > 0.0 {
                    self.held += a.abs();
                }
            }
            if v.abs() < STANDS * q || v * ahead < 0.0 {
                v = 0.0;
                self.lag = inside;
                self.drag = 0.0;
            }
        } else {
            self.overdue = 0.0;
        }
        self.speed = v;
    }
}

//! The body in motion: one substep of all mechanics.
//!
//! Velocities are those of the centre of mass in the frame of the body, (u, v, w), because there
//! the mass matrix is diagonal and the off-centre mass shows in the contacts only:
//!
//! ```text
//! m (u' − w v) = F_x         v = s + d w,  s sideways at the axle (0 while tyres hold)
//! m (v' + w u) = F_y
//! I w'         = (l/2)(f_r − f_l) − d f_y + M
//! ```
//!
//! With s = 0 this is the textbook's m u' = F_x + m d w², (I + m d²) w' = M − m d u w.

use super::electric::MotorDrives;
use super::floor;
use super::params::{FloorParams, FrictionParams, PushParams, WorldParams};
use super::substep::{Frame, Solved, Task};
use controller_core::maths::{Libm, Maths};
use controller_core::types::{Measured, Pose, Twist};

/// The mechanical half of the plant.
#[derive(Clone, Debug)]
pub(super) struct Body {
    frame: Frame,
    mass_kg: f64,
    /// Of each wheel with its rotor.
    pub wheel_inertia: [f64; 2],
    pub load: [f64; 2],
    downhill: [f64; 2],
    friction: FrictionParams,
    pub floor: FloorParams,
    pub push: Vec<PushParams>,
    pub pose: Pose<f64>,
    /// (u, v, w) and its rate over the last substep.
    pub speed: [f64; 3],
    rate: [f64; 3],
    pub omega: [f64; 2],
    /// Turned since the start \[rad\].
    pub angle: [f64; 2],
    /// Force of the floor on each wheel, forward and leftward \[N\].
    pub force: [[f64; 2]; 2],
    /// Wheels that dry friction held over the last substep.
    resting: [bool; 2],
    pub slipping: [bool; 2],
}

/// What changes from outside during a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outside {
    pub blocked: [bool; 2],
    pub ice: [Option<f64>; 2],
}

/// Dry friction that no motor moves: 1e9 N s over a substep.
const BLOCKED: f64 = 1.0e9;

impl Body {
    pub fn new(p: &WorldParams, start: &Measured<f64>) -> Self {
        let b = &p.body;
        let rotor = p.motor.map_or(0.0, |motor| motor.rotor_at_wheel_kg_m2());
        let Measured { pose, twist } = *start;
        let frame = Frame {
            per_mass: 1.0 / b.mass_kg,
            per_inertia: 1.0 / b.inertia_com_kg_m2,
            half: 0.5 * b.track_m,
            ahead: b.com_ahead_m,
            radius: [b.radius_right_m, b.radius_left_m],
        };
        let speed = [twist.linear, b.com_ahead_m * twist.angular, twist.angular];
        let omega = [0, 1].map(|i| frame.forward(&speed, i) / frame.radius[i]);
        Self {
            frame,
            mass_kg: b.mass_kg,
            wheel_inertia: [b.wheel_inertia_kg_m2 + rotor; 2],
            load: floor::loads(&p.floor, b.mass_kg, b.load_share, b.load_right),
            downhill: floor::downhill(&p.floor, b.mass_kg),
            friction: p.friction,
            floor: p.floor.clone(),
            push: p.push.clone(),
            pose,
            speed,
            rate: [0.0; 3],
            omega,
            angle: [0.0; 2],
            force: [[0.0; 2]; 2],
            resting: omega.map(|omega| omega == 0.0),
            slipping: [false; 2],
        }
    }

    pub fn truth(&self) -> Measured<f64> {
        Measured {
            pose: self.pose,
            twist: Twist::new(self.speed[0], self.speed[2]),
        }
    }

    /// At rest somewhere else.
    pub fn place(&mut self, pose: Pose<f64>) {
        self.pose = pose;
        self.speed = [0.0; 3];
        self.rate = [0.0; 3];
        self.omega = [0.0; 2];
        self.force = [[0.0; 2]; 2];
        self.resting = [true; 2];
        self.slipping = [false; 2];
    }

    /// Speed of the axle's middle to the left \[m/s\]: 0 while tyres hold.
    pub fn sideways(&self) -> f64 {
        self.frame.sideways(&self.speed)
    }

    pub fn radius(&self, i: usize) -> f64 {
        self.frame.radius[i]
    }

    /// Moves on by `h` \[s\]; `time_s` is its start.
    pub fn substep(&mut self, drive: &MotorDrives, outside: &Outside, time_s: f64, h: f64) {
        let task = self.task(drive, outside, time_s, h);
        let guess = self.force.map(|[forward, _]| h * forward);
        let solved = task.solve(&self.frame, guess);
        self.accept(&solved, h);
    }

    fn task(&self, drive: &MotorDrives, outside: &Outside, time_s: f64, h: f64) -> Task {
        let (dry, grip) = self.bounds(drive, outside, time_s);
        let mut task = Task {
            free: self.free(time_s, h),
            momentum: [0.0; 2],
            inertia: [0.0; 2],
            dry: dry.map(|torque| h * torque),
            give: [0.0; 2],
            held: [[0.0; 2]; 2],
            grip: grip.map(|force| h * force),
            share: self.load.map(|load| load / (self.load[0] + self.load[1])),
        };
        for i in 0..2 {
            let damping = h * (drive.slope[i] + self.friction.viscous_nm_s);
            let inertia = self.wheel_inertia[i];
            // Share of the damping at the end: 1/2 is second order, 1/2 + z/12 follows the
            // exponential for z = damping/inertia, 1 never overshoots.
            let end = (0.5 + damping / inertia / 12.0).min(1.0);
            task.momentum[i] =
                (inertia - damping * (1.0 - end)) * self.omega[i] + h * drive.torque[i];
            task.inertia[i] = inertia + damping * end;
            if self.floor.slip_stiffness > 0.0 {
                // Tyre as a spring k that forgets over the relaxation length σ:
                // z' = slip − |r ω| z/σ, F = k z; implicit in h it gives slip = c f − e.
                let stiff = self.floor.slip_stiffness * self.load[i] / self.floor.relaxation_m;
                let tread = (self.frame.radius[i] * self.omega[i]).abs();
                let forget = 1.0 + h * tread / self.floor.relaxation_m;
                task.give[i] = forget / (stiff * h * h);
                task.held[i] = self.force[i].map(|force| force / (stiff * h));
            }
        }
        task
    }

    /// Dry friction \[N m\] and grip \[N\] of each wheel.
    fn bounds(&self, drive: &MotorDrives, outside: &Outside, time_s: f64) -> ([f64; 2], [f64; 2]) {
        let friction = &self.friction;
        let axle = if self.floor.patch.is_empty() {
            [0.0; 2]
        } else {
            let (sine, cosine) = Libm::sin_cos(self.pose.theta);
            [-sine, cosine].map(|part| part * self.frame.half)
        };
        let (mut dry, mut grip) = ([0.0; 2], [0.0; 2]);
        for i in 0..2 {
            // Static friction of 0 means no more than when turning.
            let bearing = if self.resting[i] {
                friction.static_nm.max(friction.coulomb_nm)
            } else {
                friction.coulomb_nm
            };
            let rolling = friction.rolling * self.load[i] * self.frame.radius[i];
            dry[i] = bearing + rolling + drive.loss[i];
            if outside.blocked[i] {
                dry[i] = BLOCKED;
            }
            // The left wheel stands to the left of the middle.
            let side = if i == 0 { -1.0 } else { 1.0 };
            let place = [self.pose.x + side * axle[0], self.pose.y + side * axle[1]];
            let mu = floor::mu(&self.floor, place, time_s);
            grip[i] = outside.ice[i].map_or(mu, |ice| mu.min(ice)) * self.load[i];
        }
        (dry, grip)
    }

    /// (u, v, w) at the end of the substep if no wheel touched anything. Rotation, slope and pushes
    /// are taken at the middle, as far as the last substep's rate tells where that is.
    fn free(&self, time_s: f64, h: f64) -> [f64; 3] {
        let [u, v, w] = self.speed;
        let [mid_u, mid_v, mid_w] = [0, 1, 2].map(|n| self.speed[n] + 0.5 * h * self.rate[n]);
        let mut free = [u + h * mid_w * mid_v, v - h * mid_w * mid_u, w];
        let [mut x, mut y] = self.downhill;
        if !self.push.is_empty() {
            let [force_x, force_y, moment] = floor::pushes(&self.push, time_s + 0.5 * h);
            (x, y) = (x + force_x, y + force_y);
            free[2] += h * self.frame.per_inertia * moment;
        }
        if x != 0.0 || y != 0.0 {
            let (sine, cosine) = Libm::sin_cos(self.pose.theta + 0.5 * h * mid_w);
            free[0] += h * self.frame.per_mass * (x * cosine + y * sine);
            free[1] += h * self.frame.per_mass * (y * cosine - x * sine);
        }
        free
    }

    fn accept(&mut self, solved: &Solved, h: f64) {
        let before = self.speed;
        let sideways = 0.5 * (self.sideways() + self.frame.sideways(&solved.speed));
        self.rate = [0, 1, 2].map(|n| (solved.speed[n] - before[n]) / h);
        self.speed = solved.speed;
        // Speeds are linear within the substep: the heading half-way is exact, and the midpoint
        // leaves h²/24 max|f''| per second in x and y.
        let middle = self.pose.theta + h * (3.0 * before[2] + self.speed[2]) / 8.0;
        let (sine, cosine) = Libm::sin_cos(middle);
        let ahead = 0.5 * (before[0] + self.speed[0]);
        self.pose.x += h * (ahead * cosine - sideways * sine);
        self.pose.y += h * (ahead * sine + sideways * cosine);
        self.pose.theta += h * 0.5 * (before[2] + self.speed[2]);
        for i in 0..2 {
            self.angle[i] += h * 0.5 * (self.omega[i] + solved.omega[i]);
            self.omega[i] = solved.omega[i];
            self.resting[i] = self.omega[i] == 0.0;
            self.force[i] = solved.floor[i].map(|impulse| impulse / h);
        }
        self.slipping = solved.slipping;
    }

    /// Half of the mass each, and the wheel: what a driver moves on a straight line \[kg m²\].
    pub fn moved(&self) -> [f64; 2] {
        [0, 1].map(|i| {
            let r = self.frame.radius[i];
            0.5 * self.mass_kg * r * r + self.wheel_inertia[i]
        })
    }
}

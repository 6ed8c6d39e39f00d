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
use super::facing::Facing;
use super::floor;
use super::pair::Pair;
use super::params::{FloorParams, PushParams, WorldParams};
use super::substep::{Frame, Solved, Task};
use super::tyre::{Tyre, Tyres};
use controller_core::types::{Measured, Pose, Twist};

/// The mechanical half of the plant.
#[derive(Clone, Debug)]
pub(super) struct Body {
    frame: Frame,
    mass_kg: f64,
    /// Of a wheel with its rotor.
    wheel_inertia: f64,
    load: Pair,
    /// Of each wheel in the load.
    share: Pair,
    /// Force per slip and way over which a tyre forgets, k/σ \[N/m\].
    stiff: Pair,
    downhill: [f64; 2],
    /// Dry friction of bearing and floor, of a wheel at rest and of one that turns \[N m\].
    dry: [Pair; 2],
    viscous_nm_s: f64,
    pub floor: FloorParams,
    pub push: Vec<PushParams>,
    pub pose: Pose<f64>,
    /// Its heading, or a little before.
    facing: Facing,
    /// (u, v, w) and its rate over the last substep.
    pub speed: [f64; 3],
    rate: [f64; 3],
    /// Wheel speeds, as well.
    pub omega: Pair,
    omega_rate: Pair,
    /// Turned since the start \[rad\].
    pub angle: Pair,
    /// Forces of the floor on the wheels, forward and leftward, at the end of the last substep \[N\].
    pub force: [Pair; 2],
    pub slipping: [bool; 2],
    damped: Damped,
}

/// Wheels in a substep of `h` \[s\] whose motors have a `slope` \[N m s/rad\]: most are as the last one.
#[derive(Clone, Copy, Debug, Default)]
struct Damped {
    h: f64,
    slope: Pair,
    /// 1/h.
    per_s: f64,
    /// Angular momentum at the end per speed at the start \[kg m²\].
    kept: Pair,
    /// As in [`Task`].
    per_inertia: Pair,
    rim: Pair,
    /// Tyres that give; rigid ones do not.
    tyres: Option<Tyres>,
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
        let radius = [b.radius_right_m, b.radius_left_m];
        let half = 0.5 * b.track_m;
        let frame = Frame::new(b.mass_kg, b.inertia_com_kg_m2, half, b.com_ahead_m, radius);
        let speed = [twist.linear, b.com_ahead_m * twist.angular, twist.angular];
        let load = Pair(floor::loads(
            &p.floor,
            b.mass_kg,
            b.load_share,
            b.load_right,
        ));
        let friction = &p.friction;
        let rolling = friction.rolling * load * frame.radius;
        // Static friction of 0 means no more than when turning.
        let bearing = [
            friction.static_nm.max(friction.coulomb_nm),
            friction.coulomb_nm,
        ];
        Self {
            mass_kg: b.mass_kg,
            wheel_inertia: b.wheel_inertia_kg_m2 + rotor,
            load,
            share: load / (load[0] + load[1]),
            stiff: p.floor.slip_stiffness * load / p.floor.relaxation_m,
            downhill: floor::downhill(&p.floor, b.mass_kg),
            dry: bearing.map(|bearing| bearing + rolling),
            viscous_nm_s: friction.viscous_nm_s,
            floor: p.floor.clone(),
            push: p.push.clone(),
            pose,
            facing: Facing::new(pose.theta),
            speed,
            rate: [0.0; 3],
            omega: frame.forward(&speed) / frame.radius,
            omega_rate: Pair::default(),
            angle: Pair::default(),
            force: [Pair::default(); 2],
            slipping: [false; 2],
            damped: Damped::default(),
            frame,
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
        self.face();
        self.speed = [0.0; 3];
        self.rate = [0.0; 3];
        self.omega = Pair::default();
        self.omega_rate = Pair::default();
        self.force = [Pair::default(); 2];
        self.slipping = [false; 2];
    }

    /// Speed of the axle's middle to the left \[m/s\]: 0 while tyres hold.
    pub fn sideways(&self) -> f64 {
        self.frame.sideways(&self.speed)
    }

    /// Torques between wheels and floor \[N m\].
    pub fn torques(&self) -> Pair {
        self.force[0] * self.frame.radius
    }

    /// Looks anew where it heads, which substeps follow by small turns.
    pub fn face(&mut self) {
        self.facing = Facing::new(self.pose.theta);
    }

    /// Wheel speeds at the middle of a substep of `h` \[s\], as far as the last one tells.
    #[inline(always)]
    pub fn omega_within(&self, h: f64) -> Pair {
        self.omega + 0.5 * h * self.omega_rate
    }

    /// Moves on by `h` \[s\]; `time_s` is its start.
    pub fn substep(&mut self, drive: &MotorDrives, outside: &Outside, time_s: f64, h: f64) {
        if self.damped.h != h || self.damped.slope != drive.slope {
            self.damped = self.damped(drive.slope, h);
        }
        let mut task = self.task(drive, outside, time_s, h);
        let tyre = self.give(&mut task, h);
        let solved = task.solve(&self.frame, h * self.force[0]);
        self.accept(&solved, tyre.as_ref(), h);
    }

    /// Lets tyres give in the task, if they do.
    #[inline(always)]
    fn give(&self, task: &mut Task, h: f64) -> Option<Tyre> {
        let tyres = self.damped.tyres.as_ref()?;
        let tread = (self.frame.radius * self.omega_within(h)).abs();
        let tyre = tyres.of(self.slipping, tread);
        let forward = self.frame.radius * self.omega - self.frame.forward(&self.speed);
        let sideways = Pair::both(-self.sideways());
        task.give = tyre.give(tread);
        task.held = [
            tyre.held(self.force[0], forward),
            tyre.held(self.force[1], sideways),
        ];
        Some(tyre)
    }

    #[inline(always)]
    fn task(&self, drive: &MotorDrives, outside: &Outside, time_s: f64, h: f64) -> Task {
        let damped = &self.damped;
        let (dry, grip) = self.bounds(drive, outside, time_s);
        Task {
            free: self.free(time_s, h),
            momentum: damped.kept * self.omega + h * drive.torque,
            per_inertia: damped.per_inertia,
            rim: damped.rim,
            dry: h * dry,
            give: Pair::default(),
            held: [Pair::default(); 2],
            grip: h * grip,
            share: self.share,
        }
    }

    fn damped(&self, slope: Pair, h: f64) -> Damped {
        let inertia = self.wheel_inertia;
        let damping = h * (slope + self.viscous_nm_s);
        // Share of the damping at the end: 1/2 is second order, 1/2 + z/12 follows the
        // exponential for z = damping/inertia, 1 never overshoots.
        let end = (0.5 + damping / inertia / 12.0).map(|end| end.min(1.0));
        let per_inertia = 1.0 / (inertia + damping * end);
        let square = self.frame.radius * self.frame.radius;
        let tyres = (self.floor.slip_stiffness > 0.0).then(|| {
            let per_impulse = square / inertia + self.frame.along;
            Tyres::new(self.stiff, self.floor.relaxation_m, per_impulse, h)
        });
        Damped {
            h,
            slope,
            per_s: 1.0 / h,
            kept: inertia - damping * (1.0 - end),
            per_inertia,
            rim: square * per_inertia,
            tyres,
        }
    }

    /// Dry friction \[N m\] and grip \[N\] of each wheel.
    #[inline(always)]
    fn bounds(&self, drive: &MotorDrives, outside: &Outside, time_s: f64) -> (Pair, Pair) {
        let [resting, turning] = self.dry;
        let dry = |i: usize| {
            if self.omega[i] == 0.0 {
                resting[i]
            } else {
                turning[i]
            }
        };
        let mut dry = Pair([dry(0), dry(1)]) + drive.loss;
        if outside.blocked != [false; 2] {
            dry = Pair([0, 1].map(|i| if outside.blocked[i] { BLOCKED } else { dry[i] }));
        }
        let mut mu = [self.floor.mu; 2];
        if !self.floor.patch.is_empty() {
            let facing = self.facing.at(self.pose.theta);
            // The left wheel stands to the left of the middle.
            let [x, y] = [-facing.sine, facing.cosine].map(|part| part * self.frame.lever);
            mu = [0, 1].map(|i| {
                let place = [self.pose.x - x[i], self.pose.y - y[i]];
                floor::mu(&self.floor, place, time_s)
            });
        }
        if outside.ice != [None; 2] {
            mu = [0, 1].map(|i| outside.ice[i].map_or(mu[i], |ice| mu[i].min(ice)));
        }
        (dry, Pair(mu) * self.load)
    }

    /// (u, v, w) at the end of the substep if no wheel touched anything. Rotation, slope and pushes
    /// are taken at the middle, as far as the last substep's rate tells where that is.
    #[inline(always)]
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
            let Facing { sine, cosine, .. } = self.facing.at(self.pose.theta + 0.5 * h * mid_w);
            free[0] += h * self.frame.per_mass * (x * cosine + y * sine);
            free[1] += h * self.frame.per_mass * (y * cosine - x * sine);
        }
        free
    }

    #[inline(always)]
    fn accept(&mut self, solved: &Solved, tyre: Option<&Tyre>, h: f64) {
        let per_s = self.damped.per_s;
        let before = self.speed;
        let sideways = 0.5 * (self.sideways() + self.frame.sideways(&solved.speed));
        self.rate = [0, 1, 2].map(|n| (solved.speed[n] - before[n]) * per_s);
        self.speed = solved.speed;
        // Speeds are linear within the substep: the heading half-way is exact, and the midpoint
        // leaves h²/24 max|f''| per second in x and y.
        let middle = self.pose.theta + h * (3.0 * before[2] + self.speed[2]) / 8.0;
        self.facing = self.facing.at(middle);
        let Facing { sine, cosine, .. } = self.facing;
        let ahead = 0.5 * (before[0] + self.speed[0]);
        self.pose.x += h * (ahead * cosine - sideways * sine);
        self.pose.y += h * (ahead * sine + sideways * cosine);
        self.pose.theta += h * 0.5 * (before[2] + self.speed[2]);
        self.angle = self.angle + h * 0.5 * (self.omega + solved.omega);
        self.omega_rate = (solved.omega - self.omega) * per_s;
        self.omega = solved.omega;
        let mean = solved.floor.map(|impulse| impulse * per_s);
        self.force = tyre.map_or(mean, |tyre| {
            [0, 1].map(|n| tyre.end(self.force[n], mean[n], solved.slipping))
        });
        self.slipping = solved.slipping;
    }

    /// Half of what a wheel moves of the body on a straight line or turning on the spot, whichever is more, and the wheel: what a driver's loop is
    /// tuned for \[kg m²\].
    pub fn moved(&self) -> Pair {
        let (r, frame) = (self.frame.radius, &self.frame);
        let half = frame.lever[0];
        let turning =
            (1.0 / frame.per_inertia + self.mass_kg * frame.ahead * frame.ahead) / (half * half);
        0.5 * self.mass_kg.max(turning) * r * r + self.wheel_inertia
    }
}

//! How far a base may go once it stops, on level floor.
//!
//! | symbol | what | unit |
//! | --- | --- | --- |
//! | m, I | true mass and inertia, with payload and turning rotors | kg, kg m² |
//! | f = m/m̂ | over the mass that the controller believes in | – |
//! | c | largest braking force of a wheel: that of the driver's current limit, or grip μ m g/2 | N |
//! | τ | least dry friction of a wheel, as a force at its tread | N |
//!
//! **Controlled stop.** [`controlled_stop`] and its term for ticks, for a base that is as it is believed to be.
//! Under v̂ = v_c + e the velocity loop gives f e′ = −κ e + (1 − f) v_c′, whose integral over a stop is
//! ∫e dt = (f e₀ + (f − 1) v₀)/κ: so the term of the error grows by f, and (f − 1) v₀/κ comes to it.
//!
//! A force d̂ that the disturbance estimate makes up for may be gone in the moment in which the stop begins, such
//! as the stiction of a wheel that breaks loose. It is unlearnt as e^(−ωt), and the loop lets d̂/(m̂ κ) of speed
//! pass: d̂/(m̂ κ ω) comes to the way. What breaks standing wheels loose, a_s, is seen after two ticks at the latest, and
//! the loop takes away the speed that they gave: a_s 2 dt (dt + 1/κ).
//!
//! **Electrical brake.** [`electrical_brake`] gives v₀ T_v, times f. That holds while the current that v₀ needs is
//! below the driver's limit; beyond it the base slows down by 2 c/m at least when both wheels roll forward,
//! hence v₀²/(2 · 2c/m), and by half of that while it also turns, for at most |w₀| I/(c l/2). Drivers of speeds brake by the
//! motors that their file states; where it states none the simulated ones have no windings to short, and brake as they release.
//!
//! **Release.** Friction of both wheels takes from the kinetic energy E at least τ (|v_R| + |v_L|) ≥ 2 τ |v|, also
//! while one of them stands: the way is at most E/(2 τ). It holds for brakes too, with c beside τ.

use crate::mission::BaseSpec;
use crate::world::GRAVITY;
use crate::world::WorldSetup;
use controller_core::base::{BaseReport, ValidBaseParams as Core};
use controller_core::maths::Single;
use controller_core::motor::electrical_brake;
use controller_core::safety::controlled_stop;
use controller_core::types::Twist;

/// For the 0.3 % of the radii, friction that is not exactly Coulomb's and rounding.
const SLACK: f64 = 1.02;
/// Creep below the speed that counts as rest (1 cm/s for 0.1 s, then released), and a wheel that breaks loose
/// while the disturbance estimate still pushes \[m\].
const CREEP_M: f64 = 0.01;

/// Tolerances of distance and heading within which a base that parked says that it still is, once it has settled. Written here
/// anew.
const LEAVES: (f64, f64) = (2.0, 1.3);

/// How far from its goal the pose of a base may be that gets none from outside and says it is parked: \[m\] and \[rad\].
///
/// Nothing takes away what odometry was wrong by, on all of the way since it was switched on, so all that can be held is that it stays where it says it
/// does: it leaves its goal, and says so, at [`LEAVES`] times its tolerances, and five deviations of its pose's noise, which counts have as well.
pub(super) fn stays_parked(core: &Core<f32>) -> (f64, f64) {
    let (distance, heading) = tolerances(core);
    let noise = 5.0 * f64::from(core.localisation().pose_noise_m());
    (LEAVES.0 * distance + noise, LEAVES.1 * heading)
}

/// D and H of [`Bounds::parked`].
fn tolerances(core: &Core<f32>) -> (f64, f64) {
    let arrival = &core.motion().params().arrival;
    (
        f64::from(arrival.distance_m),
        f64::from(arrival.heading_rad),
    )
}

/// Numbers of a true base that bounds follow from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    mass: f64,
    inertia: f64,
    /// f.
    heavier: f64,
    half_track: f64,
    radius: f64,
    /// T_v as it is believed \[s\]; none without motors, which then brake nothing.
    brake_s: Option<f64>,
    /// c without grip, and grip \[N\].
    current_n: f64,
    grip: f64,
    load: f64,
    /// τ at the tread \[N\].
    dry_n: f64,
    /// Share of the way that odometry is wrong by, and turn per way \[rad/m\].
    odometry: (f64, f64),
    /// What both motors add to break standing wheels loose, over the mass \[m/s²\].
    loose: f64,
}

/// What the trouble leaves of the wheels.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wheels {
    /// Grip of the worse one.
    pub ice: Option<f64>,
    /// One does not turn.
    pub blocked: bool,
}

impl Bounds {
    pub fn new(base: &BaseSpec, setup: &WorldSetup, core: &Core<f32>) -> Self {
        let robot = &base.robot;
        let body = &setup.world.body;
        let wheels = &robot.wheels;
        let radius = base.smaller_radius_m();
        let half_track = 0.5 * wheels.track_m;
        let motor = base
            .hardware
            .as_ref()
            .and_then(|hardware| hardware.drivers.motor());
        let believed = base.robot_with_rotors();
        let mass = believed.mass_kg + robot.mass_kg * (body.mass_factor - 1.0);
        let inertia = believed.inertia_kg_m2 + robot.inertia_kg_m2 * (body.inertia_factor - 1.0);
        let brake_s = match core.motor() {
            Some(motor) => electrical_brake(motor, &core.motion().params().robot)
                .ok()
                .and_then(|slowing| slowing.linear.time_constant_s())
                .map(f64::from),
            // Those of drivers of speeds are not the core's: T_v = m̂ R r²/(2 K²) by their file.
            None => motor.map(|m| {
                let tread = m.gear_ratio * m.kt_nm_per_a / radius;
                believed.mass_kg * m.resistance_ohm / (2.0 * tread * tread)
            }),
        };
        Self {
            mass,
            inertia,
            heavier: (mass / believed.mass_kg).max(1.0),
            half_track,
            radius,
            brake_s,
            current_n: motor.map_or(f64::INFINITY, |m| {
                m.gear_ratio * m.kt_nm_per_a * m.current_limit_a / radius
            }),
            grip: setup.world.floor.mu,
            load: 0.5 * robot.mass_kg * body.mass_factor * GRAVITY,
            dry_n: setup.world.friction.coulomb_nm / radius,
            odometry: {
                let (right, left) = (body.radius_right_factor, body.radius_left_factor);
                (
                    (0.5 * (right + left) - 1.0).abs(),
                    (right - left).abs() / wheels.track_m,
                )
            },
            loose: core.motor().map_or(0.0, |motor| {
                let stiction = f64::from(motor.params().friction.stiction_nm);
                2.0 * stiction / (radius * robot.mass_kg)
            }),
        }
    }

    /// E/(2 × force).
    fn by_energy(&self, twist: &Twist<f64>, force_n: f64) -> f64 {
        let Twist { linear, angular } = twist;
        let energy = 0.5 * (self.mass * linear * linear + self.inertia * angular * angular);
        energy / (2.0 * force_n)
    }

    /// Windings open \[m\].
    pub fn release(&self, twist: &Twist<f64>, wheels: &Wheels) -> f64 {
        let dry = match wheels.ice {
            Some(mu) => self.dry_n.min(mu * self.load),
            None => self.dry_n,
        };
        SLACK * self.by_energy(twist, dry) + CREEP_M
    }

    /// Windings shorted \[m\].
    pub fn brake(&self, twist: &Twist<f64>, wheels: &Wheels) -> f64 {
        let (v, w) = (twist.linear.abs(), twist.angular.abs());
        let friction = self.release(twist, wheels);
        let Some(brake_s) = self.brake_s else {
            return friction;
        };
        let grip = wheels.ice.map_or(self.grip, |mu| mu.min(self.grip));
        let most = self.current_n.min(grip * self.load);
        let way = if wheels.ice.is_some() || wheels.blocked {
            // One wheel brakes less than the other: it also turns the base, which the linear part of the
            // brake ends with the larger of both time constants, about the wheel that stands.
            let lever = self.half_track;
            let pivot = self.inertia + self.mass * lever * lever;
            let damping = 2.0 * self.mass / (self.heavier * brake_s.max(1.0e-3));
            let tau = 2.0 * pivot / (damping * lever * lever);
            let fastest = v + lever * w;
            self.by_energy(twist, 0.5 * most) + fastest * tau
        } else {
            let slowest = 0.5 * self.mass / most;
            let turning = w * self.inertia / (most * self.half_track);
            v * brake_s * self.heavier + 0.5 * v * v * slowest + v * turning
        };
        // Sliding tyres reach the brake's speed late; both are bounds.
        (SLACK * way + CREEP_M).min(friction)
    }

    /// A controlled stop from the last report, at the true `twist` \[m\].
    pub fn controlled(
        &self,
        core: &Core<f32>,
        last: &BaseReport<f32>,
        twist: &Twist<f64>,
        dt_s: f64,
        wheels: &Wheels,
    ) -> f64 {
        let Some(motion) = &last.motion else {
            return self.brake(twist, wheels);
        };
        let error = Twist::new(
            (twist.linear - f64::from(motion.command.linear)) as f32,
            (twist.angular - f64::from(motion.command.angular)) as f32,
        );
        let rate = motion.command_rate;
        let none = Twist::default();
        let law = core.motion();
        let plan = controlled_stop::<f32, Single>(law, &motion.command, &rate, &none);
        let whole = controlled_stop::<f32, Single>(law, &motion.command, &rate, &error);
        // A wheel without grip leaves the base to the other one, which goes with its own part of the plan.
        let swing = self.half_track * f64::from(whole.angle_rad);
        let (plan, whole) = (f64::from(plan.distance_m), f64::from(whole.distance_m));
        let gains = law.gains();
        let v = f64::from(motion.command.linear.abs());
        let a = f64::from(rate.linear.abs());
        let ticks = 2.0 * dt_s * (v + a / f64::from(gains.decay));
        let heavy = (self.heavier - 1.0) * v / f64::from(gains.speed_loop);
        let mass = f64::from(law.params().robot.mass_kg);
        let loops = f64::from(gains.speed_loop) * f64::from(gains.disturbance);
        let learnt = if loops > 0.0 {
            f64::from(motion.disturbance.force.abs()) / (mass * loops)
        } else {
            0.0
        };
        let unseen = 2.0 * dt_s;
        let loose = self.loose * unseen * (0.5 * unseen + 1.0 / f64::from(gains.speed_loop));
        let way = plan + self.heavier * (whole - plan) + heavy + learnt + loose + ticks;
        let way = if wheels.ice.is_some() || wheels.blocked {
            (way + swing).max(self.release(twist, wheels))
        } else {
            way
        };
        SLACK * way + CREEP_M
    }

    /// How far from its goal a base may truly be that gets poses and says it is parked: \[m\] and \[rad\].
    ///
    /// ```text
    /// D + 5 σ + ε ℓ (1 + δ ℓ) + b τ ℓ + G q(x₁) + |β| + |β_θ| ℓ        H + 5 σ_θ + δ ℓ + b τ ℓ π/x₀ + G_θ q(x₁) + |β_θ|
    /// ```
    ///
    /// | symbol | what |
    /// | --- | --- |
    /// | D, H | tolerance by the pose that the base knows ([`Arrival`](controller_core::motion::Arrival)) |
    /// | σ, σ_θ | what the filter leaves of the fixes' noise; 5 of them are passed once in a million times |
    /// | ε, δ | true radii: error of the way, and turn per way, that odometry has |
    /// | τ | by how much poses are older than they say: the line's delay |
    /// | β, β_θ | constant error of the poses, as the file states it; a heading that is wrong leads odometry aside, by β_θ of the way |
    /// | G, G_θ | most that the pose may be off before the approach, of a brake in which wheels slid for example: more is an outlier |
    /// | ℓ | way of which the fixes have not yet taken away what odometry was wrong by |
    ///
    /// Fixes take an error away as e^(−bt), b by the share of them that arrives: what neither the source drops nor the line loses. The approach from x₀ goes as e^(−gt) until D is left, and then it rests for
    /// the dwell t_d: q(x₀) = (D/x₀)^(b/g) e^(−b t_d) is left of what there was at its beginning, and ℓ = x₀ g/(g − b) q(x₀).
    /// The farthest goal of a plan is x₀ = 2 s times the top speed away, and half a turn; the nearest one x₁ = 0.6 s. The pose source's latency is stated.
    pub fn parked(
        &self,
        core: &Core<f32>,
        base: &BaseSpec,
        (share, late_s): (f64, f64),
    ) -> (f64, f64) {
        let arrival = &core.motion().params().arrival;
        let (distance, heading) = tolerances(core);
        let localisation = core.localisation();
        let source = base.hardware.and_then(|hardware| hardware.pose_source);
        let (dropped, bias, bias_rad) = source.map_or((0.0, 0.0, 0.0), |source| {
            let [x, y] = source.bias_m;
            (source.drop_probability, x.hypot(y), source.bias_rad.abs())
        });
        let share = share * (1.0 - dropped);
        let noise = 5.0 * f64::from(localisation.filtered_noise_m());
        let noise_rad = 5.0 * f64::from(localisation.filtered_noise_rad());
        let fusion = localisation.params().fusion;
        let fixes = fusion.map_or(0.0, |fusion| {
            share * f64::from(fusion.bandwidth.min(fusion.heading_bandwidth))
        });
        let approach = f64::from(core.motion().gains().approach).max(1.01 * fixes);
        let farthest = 2.0 * base.limits.speed;
        let left = |way: f64| {
            (distance / way).powf(fixes / approach) * (-fixes * f64::from(arrival.dwell_s)).exp()
        };
        let way = farthest * approach / (approach - fixes) * left(farthest);
        let before = left(0.6 * base.limits.speed);
        let gates = fusion.map_or((0.0, 0.0), |fusion| {
            let gate = |sigma: f32| f64::from(fusion.gate * sigma);
            (gate(fusion.noise_m), gate(fusion.noise_rad))
        });
        let (wrong, curvature_bias) = self.odometry;
        let late = fixes * late_s * way;
        (
            distance
                + noise
                + wrong * way * (1.0 + curvature_bias * way)
                + late
                + gates.0 * before
                + bias
                + bias_rad * way,
            heading
                + noise_rad
                + curvature_bias * way
                + late * std::f64::consts::PI / farthest
                + gates.1 * before
                + bias_rad,
        )
    }

    /// Speed of the middle below which it counts as resting with these wheels turning so \[m/s\].
    pub fn rolls(&self, right: f64, left: f64) -> f64 {
        self.radius * right.abs().max(left.abs())
    }
}

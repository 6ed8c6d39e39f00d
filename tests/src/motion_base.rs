//! Bases that the motion tests drive, and a robot of each as exact as its held torque allows.

use controller_core::maths::{Libm, Maths};
use controller_core::motion::{Limits, MotionParams, SaturationPolicy};
use controller_core::robot::Robot as Belief;
use controller_core::scalar::Scalar;
use controller_core::types::{Measured, Pose, Twist, Wrench};
use controller_core::wheels::WheelGeometry;

use crate::ideal::Robot;

/// Mass, inertia, wheels of one radius, and limits.
#[derive(Clone, Copy, Debug)]
pub struct Base {
    /// Mass \[kg\].
    pub mass: f64,
    /// Inertia \[kg m²\].
    pub inertia: f64,
    /// Radius of both wheels \[m\].
    pub radius: f64,
    /// Distance of the wheels \[m\].
    pub track: f64,
    /// Its limits.
    pub limits: Limits<f64>,
}

/// Wheel radius \[m\].
pub(crate) const RADIUS: f64 = 0.1;
/// Track \[m\].
const TRACK: f64 = 0.5;
/// From the middle to a wheel \[m\].
pub(crate) const HALF_TRACK: f64 = 0.25;

impl Base {
    /// The paper's masses on wheels of 15 N m: 60 N and 60 N m at the same time.
    pub const STANDARD: Self = Self {
        mass: 30.0,
        inertia: 15.0,
        radius: RADIUS,
        track: TRACK,
        limits: Limits::PAPER,
    };

    /// The same masses with 10 N and 5 N m at the same time: wheels of 1.5 N m.
    pub const WEAK: Self = Self {
        limits: Limits {
            accel: 0.28,
            brake: 0.28,
            turn_accel: 0.28,
            jerk: 5.0,
            turn_jerk: 5.0,
            wheel_torque_nm: 1.5,
            ..Self::STANDARD.limits
        },
        ..Self::STANDARD
    };

    /// A desk robot of 1 kg.
    pub const SMALL: Self = Self {
        mass: 1.0,
        inertia: 0.005,
        radius: RADIUS,
        track: TRACK,
        limits: Limits {
            turn_rate: 10.0,
            turn_accel: 15.0,
            turn_jerk: 300.0,
            wheel_torque_nm: 0.12,
            ..Self::STANDARD.limits
        },
    };

    /// What parameters describe, with wheels of one radius.
    pub fn of(params: &MotionParams<f64>) -> Self {
        let Belief {
            mass_kg,
            inertia_kg_m2,
            wheels,
        } = params.robot;
        assert!(wheels.radius_right_m == wheels.radius_left_m);
        Self {
            mass: mass_kg,
            inertia: inertia_kg_m2,
            radius: wheels.radius_right_m,
            track: wheels.track_m,
            limits: params.limits,
        }
    }

    /// With another policy.
    pub fn with_policy(self, policy: SaturationPolicy) -> Self {
        let limits = Limits {
            policy,
            ..self.limits
        };
        Self { limits, ..self }
    }

    /// The core's parameters, with the gains that follow from the limits.
    pub fn params<T: Scalar, M: Maths<T>>(&self) -> MotionParams<T> {
        let f = T::from_f64;
        let limits = &self.limits;
        MotionParams::new_with::<M>(
            self.robot(),
            Limits {
                speed: f(limits.speed),
                turn_rate: f(limits.turn_rate),
                rim_speed: f(limits.rim_speed),
                accel: f(limits.accel),
                brake: f(limits.brake),
                turn_accel: f(limits.turn_accel),
                jerk: f(limits.jerk),
                turn_jerk: f(limits.turn_jerk),
                wheel_torque_nm: f(limits.wheel_torque_nm),
                policy: limits.policy,
            },
        )
    }

    /// Parameters in double precision.
    pub fn exact(&self) -> MotionParams<f64> {
        self.params::<f64, Libm>()
    }

    fn robot<T: Scalar>(&self) -> Belief<T> {
        let f = T::from_f64;
        Belief {
            mass_kg: f(self.mass),
            inertia_kg_m2: f(self.inertia),
            wheels: WheelGeometry {
                radius_right_m: f(self.radius),
                radius_left_m: f(self.radius),
                track_m: f(self.track),
            },
        }
    }

    /// Wheel torque that a wrench asks of the harder worked wheel \[N m\].
    pub fn wheel_norm(force: f64, moment: f64) -> f64 {
        RADIUS * (force.abs() / 2.0 + moment.abs() / TRACK)
    }
}

/// A robot: pose, heading not wrapped, and twist.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Body {
    /// Pose.
    pub pose: Pose<f64>,
    /// Twist.
    pub twist: Twist<f64>,
}

/// Nodes and weights of Gauss' rule with three points: wrong by the tick to the sixth power.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_3, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

impl Robot for Body {
    type Build = Base;
    type Held = Wrench<f64>;

    fn after(&self, base: &Base, wrench: &Wrench<f64>, dt: f64) -> Self {
        let (a, alpha) = (wrench.force / base.mass, wrench.moment / base.inertia);
        let heading = |t: f64| self.pose.theta + t * (self.twist.angular + t / 2.0 * alpha);
        let (mut x, mut y) = (self.pose.x, self.pose.y);
        for (node, weight) in GAUSS {
            let t = node * dt;
            let way = weight * dt * (self.twist.linear + a * t);
            let (sine, cosine) = heading(t).sin_cos();
            x += way * cosine;
            y += way * sine;
        }
        Self {
            pose: Pose::new(x, y, heading(dt)),
            twist: Twist::new(self.twist.linear + a * dt, self.twist.angular + alpha * dt),
        }
    }
}

impl Body {
    /// At rest.
    pub fn at(x: f64, y: f64, theta: f64) -> Self {
        Self {
            pose: Pose::new(x, y, theta),
            twist: Twist::default(),
        }
    }

    /// What the controller gets to see, in its own scalar.
    pub fn measured<T: Scalar>(&self) -> Measured<T> {
        let f = T::from_f64;
        Measured {
            pose: pose(&self.pose),
            twist: Twist::new(f(self.twist.linear), f(self.twist.angular)),
        }
    }
}

/// A pose in another scalar; its heading wrapped, so that single precision keeps its digits.
pub fn pose<T: Scalar>(pose: &Pose<f64>) -> Pose<T> {
    let f = T::from_f64;
    let theta = controller_core::angle::wrap(pose.theta);
    Pose::new(f(pose.x), f(pose.y), f(theta))
}

//! The plant against closed forms and against an independent integrator.

use controller_core::robot::Robot;
use controller_core::types::{Measured, Pose, Twist, WheelTorques};
use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};
use sim_host::plant::Plant;

/// Rounding of a thousand ticks, each by half a unit in the last place of a coordinate below 8.
const ROUNDING: f64 = 1.0e-12;

fn robot() -> Robot<f64> {
    Robot::paper()
}

fn at_rest() -> Measured<f64> {
    Measured::default()
}

fn run(plant: &mut Plant, torques: WheelTorques<f64>, dt: f64, ticks: usize) -> Measured<f64> {
    for _ in 0..ticks {
        plant.advance(&torques, dt);
    }
    plant.truth()
}

fn close(left: f64, right: f64) -> bool {
    (left - right).abs() < ROUNDING
}

#[test]
fn equal_torques_accelerate_along_a_straight_line() {
    let mut plant = Plant::new(robot(), &at_rest());
    let torques = WheelTorques {
        right: 1.5,
        left: 1.5,
    };
    let end = run(&mut plant, torques, 0.01, 300);
    // F = 2 τ/r = 30 N on 30 kg: 1 m/s² for 3 s.
    assert!(
        close(end.twist.linear, 3.0) && close(end.pose.x, 4.5),
        "{end:?}"
    );
    assert!(end.pose.y == 0.0 && end.pose.theta == 0.0 && end.twist.angular == 0.0);
}

#[test]
fn opposite_torques_turn_in_place() {
    let mut plant = Plant::new(robot(), &at_rest());
    let torques = WheelTorques {
        right: 3.0,
        left: -3.0,
    };
    let end = run(&mut plant, torques, 0.01, 200);
    // Moment = (τ/r)(l/2) twice = 15 N m on 15 kg m²: 1 rad/s² for 2 s, to the left.
    assert!(
        close(end.twist.angular, 2.0) && close(end.pose.theta, 2.0),
        "{end:?}"
    );
    assert!(end.pose.x == 0.0 && end.pose.y == 0.0 && end.twist.linear == 0.0);
}

#[test]
fn a_coasting_robot_drives_a_circle() {
    let start = Measured {
        pose: Pose::new(1.0, -2.0, 0.3),
        twist: Twist::new(0.8, 0.5),
    };
    let mut plant = Plant::new(robot(), &start);
    let end = run(&mut plant, WheelTorques::default(), 0.01, 1000);
    // Radius v/w = 1.6 m about the centre (x − R sin θ, y + R cos θ).
    let turned = 0.3_f64 + 5.0;
    let x = 1.0 + 1.6 * (turned.sin() - 0.3_f64.sin());
    let y = -2.0 - 1.6 * (turned.cos() - 0.3_f64.cos());
    assert!(close(end.pose.x, x) && close(end.pose.y, y) && close(end.pose.theta, turned));
    assert_eq!(end.twist, start.twist);
}

#[test]
fn each_wheel_pushes_through_its_own_radius() {
    let mut robot = robot();
    robot.wheels.radius_right_m = 0.2;
    let mut plant = Plant::new(robot, &at_rest());
    // 2 N m at 0.2 m and 1 N m at 0.1 m push alike.
    let end = run(
        &mut plant,
        WheelTorques {
            right: 2.0,
            left: 1.0,
        },
        0.1,
        30,
    );
    assert!(
        close(end.twist.angular, 0.0) && close(end.twist.linear, 2.0),
        "{end:?}"
    );
}

/// Eqs. (1) and (3) once more, as one system of five.
struct Oracle {
    acceleration: (f64, f64),
}

impl ODE<f64, [f64; 5]> for Oracle {
    fn diff(&self, _t: f64, y: &[f64; 5], rate: &mut [f64; 5]) {
        let [_, _, theta, v, w] = *y;
        *rate = [
            v * theta.cos(),
            v * theta.sin(),
            w,
            self.acceleration.0,
            self.acceleration.1,
        ];
    }
}

#[test]
fn an_adaptive_order_eight_solver_finds_the_same_path() {
    let robot = robot();
    let start = Measured {
        pose: Pose::new(0.2, -0.1, 2.0),
        twist: Twist::new(0.5, -1.0),
    };
    let mut plant = Plant::new(robot, &start);
    let mut state = [0.2, -0.1, 2.0, 0.5, -1.0];
    // Held torques that change from tick to tick: up to 1.3 m/s² and 2.6 rad/s².
    for tick in 0..50 {
        let t = f64::from(tick);
        let torques = WheelTorques {
            right: 2.0 * (0.7 * t).sin(),
            left: 2.0 * (1.1 * t).cos(),
        };
        plant.advance(&torques, 0.05);
        let wheels = robot.wheels;
        let (right, left) = (
            torques.right / wheels.radius_right_m,
            torques.left / wheels.radius_left_m,
        );
        let oracle = Oracle {
            acceleration: (
                (right + left) / robot.mass_kg,
                0.5 * wheels.track_m * (right - left) / robot.inertia_kg_m2,
            ),
        };
        let solution = IVP::ode(&oracle, 0.0, 0.05, state)
            .method(ExplicitRungeKutta::dop853().rtol(1e-13).atol(1e-13))
            .solve()
            .expect("a smooth problem");
        state = *solution.y.last().expect("at least the end");
    }
    let Measured { pose, twist } = plant.truth();
    let found = [pose.x, pose.y, pose.theta, twist.linear, twist.angular];
    for (ours, theirs) in found.iter().zip(state) {
        // The bound of the plant's own doc is 1e-14 m here; their tolerance is 1e-13 a call.
        assert!((ours - theirs).abs() < 1.0e-12, "{found:?} {state:?}");
    }
}

//! Theorem 2: what is exerted is within the wheels' limit; theorem 3: what is not finite does not reach them.

use controller_core::error::StepFault;
use controller_core::maths::Single;
use controller_core::motion::{MotionController, MotionParams, SaturationPolicy, Task, share};
use controller_core::reference::Reference;
use controller_core::robot::Robot;
use controller_core::shunting::RationalMean;
use controller_core::types::{Accel, Measured, Pose, Twist, Wrench};
use controller_core::wheels::{WheelGeometry, WheelMap};
use tests::motion_base::Base;

use crate::corners;

const POLICIES: [SaturationPolicy; 3] = [
    SaturationPolicy::KeepCurvature,
    SaturationPolicy::TurnFirst,
    SaturationPolicy::DriveFirst,
];

/// Wheels from the smallest to the largest that are accepted.
fn wheels() -> Vec<WheelGeometry<f32>> {
    let mut all = Vec::new();
    for (right, left) in [
        (1.0e-3, 1.0e-3),
        (0.1, 0.1),
        (0.03, 0.05),
        (10.0, 10.0),
        (1.0e-3, 10.0),
    ] {
        for track_m in [1.0e-2, 0.5, 100.0] {
            all.push(WheelGeometry {
                radius_right_m: right,
                radius_left_m: left,
                track_m,
            });
        }
    }
    all
}

/// Theorem 2 by trial: both torques are beyond the limit by four roundings at most, neither component grows or changes its sign, and
/// what fits is not touched; whatever the sizes of force and moment, as long as the torques asked for are finite, and no more than 2^126 limits.
#[test]
fn a_shared_wrench_fits_the_wheels_at_the_corners_of_all_arguments() {
    let sizes: Vec<f32> = std::iter::once(0.0).chain(corners(9)).collect();
    let mut tried = 0_u64;
    for geometry in wheels() {
        let map = WheelMap::from_geometry(&geometry).expect("in range");
        for limit in [1.0e-6_f32, 0.12, 15.0, 1.0e6] {
            for &force in &sizes {
                for &moment in &sizes {
                    for (force, moment) in [(force, moment), (force, -moment), (-force, moment)] {
                        let asked = Wrench { force, moment };
                        let wanted = map.torques(&asked);
                        // A factor that is subnormal has lost its digits: the last clip keeps the limit then.
                        let largest = wanted.right.abs().max(wanted.left.abs());
                        let sum = wanted.right - wanted.left;
                        if !sum.is_finite() || limit < largest * f32::MIN_POSITIVE {
                            continue;
                        }
                        for policy in POLICIES {
                            let (shared, limited) = share(&map, &asked, limit, policy);
                            let torques = map.torques(&shared);
                            let most = limit * (1.0 + 4.0 * f32::EPSILON);
                            let fits = torques.right.abs() <= most && torques.left.abs() <= most;
                            assert!(
                                fits,
                                "{geometry:?} {limit} {policy:?} {asked:?}: {torques:?}"
                            );
                            let shrinks = |part: f32, whole: f32| {
                                part.abs() <= whole.abs() && part * whole >= 0.0
                            };
                            assert!(
                                shrinks(shared.force, force) && shrinks(shared.moment, moment),
                                "{policy:?} {asked:?}: {shared:?}"
                            );
                            assert!(limited || shared == asked);
                            tried += 1;
                        }
                    }
                }
            }
        }
    }
    println!("{tried} wrenches");
}

type Controller = MotionController<f32, Single, RationalMean>;

/// From here on parking refuses a speed and a turn rate, added up; the goal, two metres away, is nothing beside it.
// Farther apart than any two poses that may be stated.
const REACH: f32 = 1.0e4;

/// Theorem 3 by trial: finite measurements of any size, on the largest and the smallest bases there may be, give torques within the
/// limit or a refusal that changes nothing. Parking refuses just what is beyond its reach.
#[test]
fn torques_are_within_the_limit_or_the_tick_is_refused_at_the_corners_of_all_measurements() {
    // While following; what parking takes and refuses is known of every tick.
    let (mut refused, mut taken) = (0_u64, 0_u64);
    // Sizes of all kinds, and every binade near the largest number: what gains and masses make of it overflows at one of them.
    let large = (207..=254_u32).map(|exponent| f32::from_bits(exponent << 23));
    let few = corners(60).into_iter().chain(large);
    let sizes: Vec<f32> = std::iter::once(0.0).chain(few).collect();
    for (mass, inertia) in [(1.0e-3, 1.0e-6), (30.0, 15.0), (1.0e5, 1.0e6)] {
        for geometry in wheels() {
            for policy in POLICIES {
                let params = MotionParams {
                    robot: Robot {
                        mass_kg: mass,
                        inertia_kg_m2: inertia,
                        wheels: geometry,
                    },
                    ..Base::STANDARD.with_policy(policy).params::<f32, Single>()
                };
                let motion = params.validate().expect("in range");
                let goal = Pose::new(1.0, 0.5, 0.3);
                let rest = Reference::new_with::<Single>(goal, Twist::default(), Accel::default());
                let start = Measured::default();
                for (task, &v) in [Task::Park(goal), Task::Follow(rest)]
                    .iter()
                    .flat_map(|task| sizes.iter().map(move |v| (task, v)))
                {
                    let fresh = Controller::start(&motion, task, &start).expect("finite");
                    for &w in &sizes {
                        for (v, w) in [(v, w), (v, -w), (-v, w), (-v, -w)] {
                            let measured = Measured {
                                twist: Twist::new(v, w),
                                ..start
                            };
                            let mut controller = fresh;
                            let parks = matches!(task, Task::Park(_));
                            match controller.step(0.01, task, &measured) {
                                Ok(report) => {
                                    taken += u64::from(!parks);
                                    assert!(!parks || v.abs() + w.abs() < REACH, "{v:e} {w:e}");
                                    let limit = params.limits.wheel_torque_nm;
                                    let torques = report.torques;
                                    let within = |torque: f32| (-limit..=limit).contains(&torque);
                                    assert!(
                                        within(torques.right) && within(torques.left),
                                        "{:?} {policy:?} {v:e} {w:e}: {report:?}",
                                        params.robot
                                    );
                                }
                                Err(fault) => {
                                    refused += u64::from(!parks);
                                    assert!(!parks || v.abs() + w.abs() >= REACH, "{v:e} {w:e}");
                                    assert_eq!(fault, StepFault::Overflow);
                                    assert_eq!(controller, fresh, "a refusal changes nothing");
                                }
                            }
                        }
                    }
                }
            }
        }
    }
    println!("following: {taken} ticks taken, {refused} refused");
    assert!(refused > 0 && taken > refused);
}

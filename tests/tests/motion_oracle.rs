//! The law for a real base against the oracle that shares nothing with it but `docs/motion.md`, tick by tick.

use controller_core::maths::Libm;
use controller_core::motion::{
    AtRest, JumpThreshold, MotionController, MotionParams, MotionReport, Parking, SaturationPolicy,
    Task,
};
use controller_core::reference::Reference;
use controller_core::shunting::{ExactMean, NeuronUpdate, RationalMean};
use controller_core::types::{Accel, Measured, Pose, Twist, WheelTorques, Wrench};
use nalgebra::Vector2;
use tests::ideal::Robot;
use tests::motion_base::{Base, Body};
use tests::motion_oracle::{
    NAMES, constants, inputs, numbers, pair, row_numbers, row_said, said, take_over,
    task as oracle_task,
};
use tests::oracle::motion::{Law, Row, Rule};
use tests::random::Random;
use tests::tolerance::MOTION_ORACLE;

/// Missions for each rule of the neuron.
const MISSIONS: u64 = 600;

/// Which of `N`.
fn one_of<const N: usize>(random: &mut Random) -> usize {
    let share = 0.5 * (1.0 + random.within(1.0));
    ((share * N as f64) as usize).min(N - 1)
}

/// A factor of up to `most`, as often below 1 as above.
fn factor(random: &mut Random, most: f64) -> f64 {
    most.powf(random.within(1.0))
}

/// Between `low` and `high`.
fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    0.5 * (low + high) + 0.5 * random.within(high - low)
}

/// A base of the tests with everything changed that may be.
fn params(random: &mut Random) -> MotionParams<f64> {
    let bases = [Base::STANDARD, Base::WEAK, Base::SMALL];
    let mut params = bases[one_of::<3>(random)].exact();
    params.robot.wheels.radius_right_m *= factor(random, 1.1);
    params.robot.wheels.radius_left_m *= factor(random, 1.1);
    let limits = &mut params.limits;
    limits.policy = [
        SaturationPolicy::KeepCurvature,
        SaturationPolicy::TurnFirst,
        SaturationPolicy::DriveFirst,
    ][one_of::<3>(random)];
    for limit in [
        &mut limits.speed,
        &mut limits.turn_rate,
        &mut limits.accel,
        &mut limits.brake,
        &mut limits.turn_accel,
        &mut limits.jerk,
        &mut limits.turn_jerk,
        &mut limits.wheel_torque_nm,
    ] {
        *limit *= factor(random, 2.0);
    }
    let gains = &mut params.gains;
    for gain in [
        &mut gains.decay,
        &mut gains.longitudinal,
        &mut gains.longitudinal_bound,
        &mut gains.heading,
        &mut gains.lateral,
        &mut gains.slow,
        &mut gains.approach,
        &mut gains.approach_brake,
        &mut gains.speed_loop,
        &mut gains.turn_loop,
        &mut gains.disturbance,
        &mut gains.disturbance_share,
    ] {
        *gain *= factor(random, 1.4);
    }
    if one_of::<2>(random) == 0 {
        params = params.with_pose_noise(1e-4 * factor(random, 10.0));
    }
    if one_of::<3>(random) == 0 {
        params.jump = Some(JumpThreshold {
            distance_m: 0.02,
            heading_rad: 0.1,
        });
    }
    let arrival = &mut params.arrival;
    arrival.parking = Parking::Feedback;
    arrival.at_rest = [AtRest::Hold, AtRest::Release][one_of::<2>(random)];
    arrival.distance_m *= factor(random, 3.0);
    arrival.heading_rad *= factor(random, 3.0);
    arrival.dwell_s = [0.0, 0.05, 0.3][one_of::<3>(random)];
    arrival.retries = one_of::<3>(random) as u8;
    arrival.stall_s = 0.5;
    params
}

fn pose(random: &mut Random) -> Pose<f64> {
    Pose::new(random.within(1.5), random.within(1.5), random.within(3.0))
}

/// What the robot is to do for a while, as a function of the time since it began.
#[derive(Clone, Copy, Debug)]
enum Segment {
    /// A path of changing speed and turn rate from a pose: amplitudes, frequencies.
    Path(Pose<f64>, [f64; 6]),
    Park(Pose<f64>),
    /// A goal that moves on at every tick.
    Chase(Pose<f64>),
    Drive(Twist<f64>, bool),
}

impl Segment {
    fn draw(random: &mut Random, from: &Pose<f64>) -> Self {
        match one_of::<8>(random) {
            0..=2 => {
                let turned = if one_of::<3>(random) == 0 { 3.5 } else { 0.3 };
                let start = Pose::new(
                    from.x + random.within(0.3),
                    from.y + random.within(0.3),
                    from.theta + random.within(turned),
                );
                let still = one_of::<4>(random) == 0;
                let of = |scale: f64| if still { 0.0 } else { scale };
                Self::Path(
                    start,
                    [
                        of(random.within(1.5)),
                        of(random.within(0.7)),
                        random.within(1.0),
                        random.within(0.8),
                        random.within(0.6),
                        random.within(1.5),
                    ],
                )
            }
            3 | 4 => Self::Park(pose(random)),
            5 => Self::Chase(pose(random)),
            _ => Self::Drive(
                Twist::new(
                    [0.0, random.within(0.5), random.within(4.0)][one_of::<3>(random)],
                    [0.0, random.within(1.0), random.within(6.0)][one_of::<3>(random)],
                ),
                one_of::<2>(random) == 0,
            ),
        }
    }

    /// The task after `t`; a path's heading and place need only be near each other's rates.
    fn at(&self, t: f64) -> Task<f64> {
        match *self {
            Self::Path(start, [v, dv, fv, w, dw, fw]) => {
                let speed = v + dv * (fv * t).sin();
                let turn_rate = w + dw * (fw * t).sin();
                let way = v * t;
                let theta = start.theta + w * t;
                Task::Follow(Reference::new(
                    Pose::new(
                        start.x + way * theta.cos(),
                        start.y + way * theta.sin(),
                        theta,
                    ),
                    Twist::new(speed, turn_rate),
                    Accel::new(dv * fv * (fv * t).cos(), dw * fw * (fw * t).cos()),
                ))
            }
            Self::Park(goal) => Task::Park(goal),
            Self::Chase(goal) => Task::Park(Pose::new(goal.x + 0.2 * t, goal.y, goal.theta)),
            Self::Drive(twist, hold_heading) => Task::Drive {
                twist,
                hold_heading,
            },
        }
    }
}

/// What the ticks of all missions met.
#[derive(Debug, Default)]
struct Met {
    ticks: u64,
    limited: [u64; 5],
    outcomes: [u64; 3],
    jumps: u64,
    backing: u64,
    retried: u64,
    ties: u64,
    /// The command was set back by wheels at their limit, and not free since.
    set_back: bool,
    /// What rounding may have become since.
    slack: f64,
    /// While that is nothing, and while it is not.
    worst: [(f64, &'static str); 2],
}

/// How the robot of a segment answers its torques.
#[derive(Clone, Copy, Debug)]
enum World {
    /// By its masses and a push.
    Free(Wrench<f64>),
    /// It stands, whatever is exerted.
    Held,
    /// It is where the controller believes, but for noise.
    Noisy(f64),
}

fn mission<U: NeuronUpdate<f64>>(seed: u64, rule: Rule, met: &mut Met) {
    let mut random = Random(seed);
    let mut params = params(&mut random);
    // Drawn apart: every other number is that of the missions before this limit was one.
    params.limits.rim_speed *= factor(&mut Random(!seed), 2.0);
    let plant = Base {
        mass: params.robot.mass_kg,
        inertia: params.robot.inertia_kg_m2,
        ..Base::STANDARD
    };
    let motion = params.validate().expect("within the ranges");
    let mut body = Body::at(random.within(1.0), random.within(1.0), random.within(3.0));
    body.twist = Twist::new(random.within(0.5), random.within(0.5));
    let period = [1e-3, 5e-3, 1e-2, 2e-2][one_of::<4>(&mut random)];
    let mut segment = Segment::draw(&mut random, &body.pose);
    let first = segment.at(0.0);
    let measured = body.measured::<f64>();
    let mut core = MotionController::<f64, Libm, U>::start(&motion, &first, &measured)
        .expect("the start is finite");
    let (mut oracle, row) = Law::start(
        constants(&params, rule),
        oracle_task(&first),
        &inputs(&measured),
    );
    met.slack = 0.0;
    met.set_back = false;
    compare((seed, 0), 0.0, &core, &row, met);
    let mut tick = 0_u64;
    for _ in 0..4 {
        let world = match one_of::<6>(&mut random) {
            0 => World::Held,
            1 => World::Noisy(2e-3),
            _ => World::Free(Wrench {
                force: random.within(0.1) * motion.largest_force(),
                moment: random.within(0.1) * motion.largest_moment(),
            }),
        };
        let lasts = match segment {
            Segment::Park(_) => between(&mut random, 2.0, 25.0),
            _ => between(&mut random, 0.2, 4.0),
        };
        let ticks = (lasts / period) as u64;
        for k in 0..ticks.min(4_000) {
            tick += 1;
            let dt = period * factor(&mut random, 1.2);
            let torques = core.report().torques;
            let exerted = core.motion().wheels().wrench(&torques);
            let noise = match world {
                World::Free(push) => {
                    let wrench = Wrench {
                        force: exerted.force + push.force,
                        moment: exerted.moment + push.moment,
                    };
                    body = body.after(&plant, &wrench, dt);
                    0.0
                }
                World::Held => {
                    body.twist = Twist::default();
                    0.0
                }
                World::Noisy(noise) => {
                    body = body.after(&plant, &exerted, dt);
                    noise
                }
            };
            match one_of::<400>(&mut random) {
                0 => {
                    body.pose.x += random.within(0.1);
                    body.pose.theta += random.within(0.2);
                    if one_of::<2>(&mut random) == 0 {
                        core.declare_jump();
                        oracle.declare_jump();
                    }
                }
                1 => {
                    core.note_not_driven();
                    oracle.note(None);
                }
                2 => {
                    let (right, left) = (0.5 * torques.right, 0.8 * torques.left);
                    core.note_applied(&WheelTorques { right, left })
                        .expect("finite");
                    oracle.note(Some(Vector2::new(right, left)));
                }
                3 => body.twist.angular += random.within(0.5),
                _ => {}
            }
            let task = segment.at(k as f64 * period);
            let mut measured: Measured<f64> = body.measured();
            measured.pose.x += random.within(1.0) * noise;
            measured.pose.theta += random.within(1.0) * noise;
            measured.twist.linear += random.within(1.0) * noise;
            core.step(dt, &task, &measured).expect("finite");
            let row = closest(&mut oracle, core.report(), |oracle| {
                oracle.tick(oracle_task(&task), &inputs(&measured), dt)
            });
            compare((seed, tick), dt, &core, &row, met);
            if core.report().limited.torque {
                take_over(&mut oracle, core.report(), &measured);
            }
        }
        segment = Segment::draw(&mut random, &body.pose);
    }
}

/// A tick of the oracle. Of a command that is at rest but for rounding the sign says whether it brakes or accelerates, by limits that
/// differ; one whose rim is at its limit but for rounding may not gain. The oracle goes on from the answer whose command is that of the core.
fn closest(oracle: &mut Law, report: &MotionReport<f64>, tick: impl Fn(&mut Law) -> Row) -> Row {
    let (twist, rate) = (pair(&report.command), &report.command_rate);
    let rate = Vector2::new(rate.linear, rate.angular);
    let all = oracle.ties().into_iter().map(|mut law| {
        let row = tick(&mut law);
        let off = (row.command.twist - twist).norm() + (row.command.rate - rate).norm();
        (off, law, row)
    });
    let nearest = all.min_by(|a, b| a.0.total_cmp(&b.0));
    let (_, law, row) = nearest.expect("one at least");
    *oracle = law;
    row
}

fn compare<U: NeuronUpdate<f64>>(
    (seed, tick): (u64, u64),
    dt: f64,
    core: &MotionController<f64, Libm, U>,
    row: &Row,
    met: &mut Met,
) {
    let report = core.report();
    let (mut says, expects) = (said(report), row_said(row));
    if says.0 != expects.0 {
        // A command that goes on at a limit, after a jump or at wheels that are held, meets it to the last bit: which side of it
        // is rounding's to say, and the numbers below are the same.
        says.0 = expects.0;
        met.ties += 1;
    }
    assert_eq!(
        says, expects,
        "mission {seed}, tick {tick}: {report:?} and {row:?}"
    );
    // What wheels at their limit make of rounding is forgotten by the command once it is what is desired, and by the disturbance
    // estimate with its bandwidth.
    let [speed, accel, jerk, torque, _] = says.0;
    met.set_back = torque || (met.set_back && (speed || accel || jerk));
    let (free, set_back) = MOTION_ORACLE;
    met.slack = if met.set_back {
        set_back
    } else {
        met.slack * (-core.motion().gains().disturbance * dt).exp()
    };
    let tolerance = free + met.slack;
    for ((found, expected), name) in numbers(report).iter().zip(row_numbers(row)).zip(NAMES) {
        let off = (found - expected).abs() / (1.0 + expected.abs());
        assert!(
            off <= tolerance,
            "mission {seed}, tick {tick}: {name} is {found:e}, the oracle's {expected:e}; {report:?} and {row:?}"
        );
        let worst = &mut met.worst[usize::from(met.slack > free)];
        if off > worst.0 {
            *worst = (off, name);
        }
    }
    met.ticks += 1;
    let (limited, jumped, outcome, backing, retries) = says;
    for (count, limit) in met.limited.iter_mut().zip(limited) {
        *count += u64::from(limit);
    }
    for (count, outcome) in met.outcomes.iter_mut().zip(outcome) {
        *count += u64::from(outcome);
    }
    met.jumps += u64::from(jumped);
    met.backing += u64::from(backing);
    met.retried += u64::from(retries > 0);
}

/// Random missions by one rule; every branch of the law is met by some.
fn agree<U: NeuronUpdate<f64>>(rule: Rule) {
    let mut met = Met::default();
    for seed in 0..MISSIONS {
        mission::<U>(seed, rule, &mut met);
    }
    println!("{rule:?}: {met:?}");
    assert!(1000 * met.ties < met.ticks, "{met:?}");
    let counts = met.limited.iter().chain(&met.outcomes);
    for count in counts.chain([&met.jumps, &met.backing, &met.retried]) {
        assert!(*count > 100, "{met:?}");
    }
}

/// Sections 1 to 9 and 14 of `docs/motion.md`: following, parking by feedback, driving by velocity, offsets, governor,
/// saturation, disturbance estimate, arrival, retries; all numbers and all that is said, in every tick.
#[test]
fn the_law_is_the_oracle_in_every_tick_with_the_default_update() {
    agree::<RationalMean>(Rule::Rational);
}

/// The same with the exact exponential.
#[test]
fn the_law_is_the_oracle_in_every_tick_with_the_exact_update() {
    agree::<ExactMean>(Rule::Exponential);
}

//! Tyres that slip under what they transmit: the localiser learns by how much, and takes it off.

use controller_core::error::Field;
use controller_core::localiser::{Estimate, ValidLocaliserParams};
use controller_core::maths::Libm;
use controller_core::motion::Task;
use controller_core::reference::ConstantTwist;
use controller_core::robot::Robot;
use controller_core::types::{Accel, Pose, Twist};
use sim_host::mission::BaseSpec as File;
use tests::check::assert_within;
use tests::encoded::{Encoded, bases};
use tests::fixes::Source;
use tests::led::Led;
use tests::localised::{Localised, localisation};

const DT: f64 = 0.01;
/// Tyres that are 20 times as stiff as they are loaded, four fifths of the weight on them \[s²/m\].
const SLIP: f64 = 1.0 / (20.0 * 0.8 * 9.81);
/// That of 10 times, with nothing on a caster, to which odometry that may be wrong by 2 % learns \[s²/m\].
const MOST: f64 = 0.02 * (1.0 / (0.2 * 9.81));

/// The heavy base.
fn file() -> File {
    bases()[2].1.clone()
}

/// It, on tyres.
struct Slipping {
    led: Led<f64, 64>,
    /// 4I/(m l²).
    turning: f64,
    slip: f64,
    before: Twist<f64>,
}

impl Slipping {
    fn new(localisation: &ValidLocaliserParams<f64>, slip: f64) -> Self {
        let file = file();
        let robot = &file.robot;
        let lever = robot.wheels.track_m / 2.0;
        Self {
            led: Led::start(localisation, Encoded::new(&file, Pose::default())),
            turning: robot.inertia_kg_m2 / (robot.mass_kg * lever * lever),
            slip,
            before: Twist::default(),
        }
    }

    /// A tick that ends at a twist of the body.
    fn advance(&mut self, twist: Twist<f64>, source: &mut Source) -> Estimate<f64> {
        let accel = Accel::new(
            (twist.linear - self.before.linear) / DT,
            (twist.angular - self.before.angular) / DT,
        );
        self.before = twist;
        let robot = &mut self.led.robot;
        let slips = self.slip * twist.linear.abs() * DT;
        let (way, turn) = (slips * accel.linear, slips * self.turning * accel.angular);
        let lever = robot.wheels.track_m / 2.0;
        robot.travel.0 += way + lever * turn;
        robot.travel.1 += way - lever * turn;
        let aside = -slips * twist.linear * twist.angular;
        let (sine, cosine) = robot.body.pose.theta.sin_cos();
        robot.body.pose.x -= aside * sine;
        robot.body.pose.y += aside * cosine;
        self.led.advance_told::<Libm>(twist, &accel, DT, source)
    }
}

/// The heavy base, with fixes of 5 mm and 5 mrad.
fn heavy() -> ValidLocaliserParams<f64> {
    let file = file();
    with_robot(localisation(&file, 5e-3, 5e-3))
}

/// Of the heavy base, with its velocity loop.
fn with_robot(localisation: ValidLocaliserParams<f64>) -> ValidLocaliserParams<f64> {
    let file = file();
    let gains = file.motion().gains;
    localisation
        .with_robot(&file.robot, gains.turn_loop.max(gains.speed_loop))
        .expect("a valid base")
}

/// Curves to both sides at a speed that comes and goes: every second turns by up to 1 rad.
fn slalom(t: f64) -> Twist<f64> {
    Twist::new(0.6 + 0.3 * (1.3 * t).sin(), (2.0 * t).sin())
}

/// Drives the slalom for so long, forward or backward; `see` sees every estimate with its error.
fn drive(
    base: &mut Slipping,
    forward: f64,
    seconds: f64,
    source: &mut Source,
    mut see: impl FnMut(&Estimate<f64>, &Pose<f64>),
) {
    for _ in 0..(seconds / DT).round() as usize {
        let Twist { linear, angular } = slalom(base.led.t);
        let estimate = base.advance(Twist::new(forward * linear, angular), source);
        let off = base.led.off(&estimate);
        see(&estimate, &off);
    }
}

/// What is learnt of tyres of this slip in each tick of 20 s.
fn learnt(
    localisation: &ValidLocaliserParams<f64>,
    slip: f64,
    forward: f64,
    seed: u64,
) -> Vec<f64> {
    let mut base = Slipping::new(localisation, slip);
    let mut slips = Vec::new();
    let mut source = Source::camera(seed);
    drive(&mut base, forward, 20.0, &mut source, |estimate, _| {
        slips.push(estimate.tyre_slip);
    });
    slips
}

/// What 20 s of the slalom leave \[s²/m\]: tyres that slip by κ take 2 · 8 · 0.6 κ rad off each of 13 swings of a radian, in which the filter
/// expects 11.5 mrad of chance, so it expects to be off by 3.3e-4; half as much more.
const LEFT: f64 = 5e-4;

/// Soft tyres, stiff ones and rigid ones are distinguished on the way, forward and backward.
#[test]
fn what_tyres_slip_is_learnt_on_the_way() {
    for (slip, forward) in [(SLIP, 1.0), (SLIP, -1.0), (0.5 * SLIP, 1.0), (0.0, 1.0)] {
        for seed in 1..=8 {
            let slips = learnt(&heavy(), slip, forward, seed);
            let last = slips[slips.len() - 1];
            println!("{seed}: {last:.5} of {slip:.5}");
            assert_within(last, slip, LEFT, "slip");
            assert!(slips.iter().all(|&slip| slip >= 0.0));
        }
    }
}

/// Tyres that are softer than odometry may be wrong by are learnt up to that.
#[test]
fn the_slip_is_bounded() {
    for seed in 1..=8 {
        let slips = learnt(&heavy(), 2.0 * MOST, 1.0, seed);
        assert!(slips.iter().all(|&slip| slip <= MOST));
        assert_within(slips[slips.len() - 1], MOST, LEFT, "slip");
    }
}

/// A localiser that knows no robot, or whose odometry is said to be exact, learns nothing of tyres.
#[test]
fn nothing_is_learnt_of_tyres_that_nothing_is_known_of() {
    let file = file();
    let alone = localisation(&file, 5e-3, 5e-3);
    let mut exact = *alone.params();
    if let Some(fusion) = &mut exact.fusion {
        fusion.drift = 0.0;
    }
    let exact = exact.validate_with::<Libm>().expect("valid");
    for localisation in [alone, with_robot(exact)] {
        let slips = learnt(&localisation, SLIP, 1.0, 1);
        assert!(slips.iter().all(|&slip| slip == 0.0));
    }
}

/// Root mean square errors aside \[m\] and of the heading \[rad\] over 20 s, after 20 s.
fn errors(localisation: &ValidLocaliserParams<f64>, seed: u64) -> (f64, f64) {
    let mut base = Slipping::new(localisation, SLIP);
    let mut source = Source::camera(seed);
    drive(&mut base, 1.0, 20.0, &mut source, |_, _| {});
    let (mut aside, mut heading, mut count) = (0.0, 0.0, 0.0);
    drive(&mut base, 1.0, 20.0, &mut source, |_, off| {
        aside += off.y * off.y;
        heading += off.theta * off.theta;
        count += 1.0;
    });
    (f64::sqrt(aside / count), f64::sqrt(heading / count))
}

/// Of what soft tyres lead a heavy base astray, a fifth at most is left aside and an eighth of the heading. What is left is the noise of
/// fixes: of 5 mm and 5 mrad a seventh each at rest, and on the way, where the filter doubts odometry, more.
#[test]
fn what_is_learnt_of_tyres_is_taken_off() {
    let file = file();
    for seed in 1..=8 {
        let (aside, heading) = errors(&heavy(), seed);
        let without = errors(&localisation(&file, 5e-3, 5e-3), seed);
        println!(
            "{seed}: {aside:.5} m of {:.5}, {heading:.5} rad of {:.5}",
            without.0, without.1
        );
        assert!(aside < without.0 / 5.0, "{aside} {without:?}");
        assert!(heading < without.1 / 8.0, "{heading} {without:?}");
    }
}

/// Root mean square step of a wheel's torque from tick to tick, over its limit, of the heavy base on rigid tyres in a circle at its top speed,
/// without fixes: what it learnt on tyres that slip by `slip` it goes on believing.
fn shaking(slip: f64) -> f64 {
    let file = file();
    let motion = file.motion().validate().expect("valid");
    let valid = heavy();
    let mut taught = Slipping::new(&valid, slip);
    drive(&mut taught, 1.0, 20.0, &mut Source::camera(1), |_, _| {});
    let circle = ConstantTwist {
        start: taught.led.robot.body.pose,
        twist: Twist::new(motion.params().limits.speed, 0.3),
    };
    let order = |t: f64| Task::Follow(circle.at::<Libm>(t));
    let mut run = Localised::start(&motion, &valid, (&file, taught.led.robot), &order(0.0), DT);
    run.localiser = taught.led.localiser;
    let mut torques = Vec::new();
    while run.drive.t < 15.0 {
        run.coast();
        run.take(&order(run.drive.t), &mut Source::silent());
        torques.push(run.drive.controller.report().torques.right);
    }
    let rolling = &torques[500..];
    let steps = rolling.windows(2).map(|pair| (pair[1] - pair[0]).powi(2));
    f64::sqrt(steps.sum::<f64>() / (rolling.len() - 1) as f64)
        / motion.params().limits.wheel_torque_nm
}

/// A heavy base that comes from the softest tyres to rigid ones goes on as evenly at its top speed as one that never was there. With half of the
/// velocity loop's time constant taken off its twist, in place of a fifth, it swings by a third of its torque's limit.
#[test]
fn what_was_learnt_elsewhere_does_not_shake_the_base() {
    let (rigid, soft) = (shaking(0.0), shaking(2.0 * MOST));
    println!("{rigid:.2e} {soft:.2e}");
    // Counts, which the fine ones of each run meet in another order.
    assert!(soft < 1.25 * rigid, "{soft} {rigid}");
}

/// A robot that cannot be, or a velocity loop that is none, is named.
#[test]
fn a_robot_that_cannot_be_is_refused() {
    let file = file();
    let refused = |change: &dyn Fn(&mut Robot<f64>), bandwidth| {
        let mut robot = file.robot;
        change(&mut robot);
        let known = localisation(&file, 5e-3, 5e-3).with_robot(&robot, bandwidth);
        known.expect_err("out of range").field
    };
    assert_eq!(refused(&|robot| robot.mass_kg = 0.0, 7.0), Field::Mass);
    assert_eq!(
        refused(&|robot| robot.inertia_kg_m2 = f64::NAN, 7.0),
        Field::Inertia
    );
    assert_eq!(
        refused(&|robot| robot.wheels.track_m = 0.0, 7.0),
        Field::Track
    );
    for bandwidth in [0.0, -7.0, 1e4, f64::NAN] {
        assert_eq!(refused(&|_| {}, bandwidth), Field::TurnLoop);
    }
}

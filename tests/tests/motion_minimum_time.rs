//! Parking beside the physical limit: the least time that any controller could take from the same start.

use controller_core::maths::Single;
use controller_core::motion::{MotionParams, Outcome, Task};
use controller_core::shunting::RationalMean;
use controller_core::types::{Pose, Wrench};
use sim_host::bench::minimum::Pool;
use tests::ideal::on_all_cores;
use tests::motion_base::{Base, Body};
use tests::motion_loop::{Drive, home};
use tests::stated::{At, Stated};
use tests::tuning_loop::{BASES, file};

/// Base, start (x, y, θ) of a park at the origin, least time from rest to rest, and time of turning, driving and turning
/// with trapezoids \[m, rad, s\].
///
/// The least times are solutions of an optimal-control problem (direct collocation, an interior-point solver) with the
/// limits of the base files, jerk included, from many first guesses; each was integrated again. Upper bounds of the
/// true minimum. They hold for the limits that those of
/// [`Pool`] hold for, and are to be computed anew when a base file's limits change.
#[rustfmt::skip]
const MINIMUM: [(&str, f64, f64, f64, f64, f64); 36] = [
    ("paper-30kg", 0.122108, -0.157590, 1.825380, 2.8772, 5.3425),
    ("paper-30kg", -0.007486, 0.436036, 0.095213, 3.4769, 6.4336),
    ("paper-30kg", 0.471764, -0.533887, -1.913873, 2.9461, 5.6184),
    ("paper-30kg", 0.529686, -0.778351, 2.807452, 3.5682, 6.4962),
    ("paper-30kg", 0.344711, 1.080299, -1.709705, 3.0353, 5.6204),
    ("paper-30kg", 1.192116, -0.653488, -0.032486, 3.0487, 4.9624),
    ("paper-30kg", 0.734476, -1.407549, -0.000283, 4.1381, 6.5806),
    ("paper-30kg", 1.633747, 0.732108, -0.524200, 3.3929, 5.7248),
    ("paper-30kg", 0.586672, -1.898116, -1.372163, 3.1815, 5.4706),
    ("paper-30kg", -0.885783, -2.167580, 2.777927, 3.5494, 7.5756),
    ("paper-30kg", -0.996067, 2.332144, -2.294861, 3.2261, 7.2381),
    ("paper-30kg", 1.373986, 2.447754, -2.335181, 3.8919, 6.9596),
    ("lab-10kg", 0.122108, -0.157590, 1.825380, 1.4391, 2.7982),
    ("lab-10kg", -0.007486, 0.436036, 0.095213, 2.1072, 3.4518),
    ("lab-10kg", 0.471764, -0.533887, -1.913873, 1.6710, 3.3567),
    ("lab-10kg", 0.529686, -0.778351, 2.807452, 2.2286, 3.8649),
    ("lab-10kg", 0.344711, 1.080299, -1.709705, 2.2848, 3.6291),
    ("lab-10kg", 1.192116, -0.653488, -0.032486, 2.2053, 3.4926),
    ("lab-10kg", 0.734476, -1.407549, -0.000283, 2.4821, 4.2468),
    ("lab-10kg", 1.633747, 0.732108, -0.524200, 2.5809, 4.0371),
    ("lab-10kg", 0.586672, -1.898116, -1.372163, 2.7972, 4.0619),
    ("lab-10kg", -0.885783, -2.167580, 2.777927, 3.1651, 5.0889),
    ("lab-10kg", -0.996067, 2.332144, -2.294861, 3.2690, 5.0814),
    ("lab-10kg", 1.373986, 2.447754, -2.335181, 3.7076, 5.1632),
    ("hobby-1kg", 0.122108, -0.157590, 1.825380, 1.1231, 1.9859),
    ("hobby-1kg", -0.007486, 0.436036, 0.095213, 1.4706, 2.5151),
    ("hobby-1kg", 0.471764, -0.533887, -1.913873, 1.5133, 2.5875),
    ("hobby-1kg", 0.529686, -0.778351, 2.807452, 1.9595, 3.0381),
    ("hobby-1kg", 0.344711, 1.080299, -1.709705, 2.1368, 3.0292),
    ("hobby-1kg", 1.192116, -0.653488, -0.032486, 2.2896, 3.1089),
    ("hobby-1kg", 0.734476, -1.407549, -0.000283, 2.6284, 3.7507),
    ("hobby-1kg", 1.633747, 0.732108, -0.524200, 2.8447, 3.7647),
    ("hobby-1kg", 0.586672, -1.898116, -1.372163, 3.1147, 3.9227),
    ("hobby-1kg", -0.885783, -2.167580, 2.777927, 3.6293, 4.8283),
    ("hobby-1kg", -0.996067, 2.332144, -2.294861, 3.8217, 4.9641),
    ("hobby-1kg", 1.373986, 2.447754, -2.335181, 4.2630, 5.2034),
];

/// What became of a park.
struct Run {
    /// From when on within 10 mm and 20 mrad \[s\].
    inside_s: f64,
    /// From when on it says that it is parked \[s\].
    parked_s: f64,
    /// Turned in all \[rad\].
    turned: f64,
}

/// Parks at the origin, on the ideal robot, in single precision at the base's own period.
fn park(params: &MotionParams<f64>, dt: f64, start: Body) -> Run {
    let mut single = MotionParams::<f32>::new(params.robot.cast(), params.limits.cast());
    single.gains = params.gains.cast();
    single.arrival.distance_m = params.arrival.distance_m as f32;
    single.arrival.heading_rad = params.arrival.heading_rad as f32;
    let motion = single.validate().expect("valid");
    let base = Base::of(params);
    let mut drive =
        Drive::<f32, Single, RationalMean>::start(&motion, base, start, &home()(0.0), dt);
    let mut run = Run {
        inside_s: 0.0,
        parked_s: 0.0,
        turned: 0.0,
    };
    while drive.t < 30.0 {
        drive.coast(&Wrench::default());
        let measured = drive.body.measured();
        drive.take(&Task::Park(Pose::default()), &measured);
        run.turned += (drive.body.twist.angular * dt).abs();
        let error = drive.error(&home()(0.0));
        if error.x.hypot(error.y) > 0.010 || error.theta.abs() > 0.020 {
            run.inside_s = drive.t;
        }
        if drive.report().outcome != Outcome::Parked {
            run.parked_s = drive.t;
        }
    }
    assert_eq!(drive.report().outcome, Outcome::Parked, "{start:?}");
    run
}

fn params(name: &str, tolerance: Option<(f64, f64)>) -> (MotionParams<f64>, f64) {
    let file = file(name);
    let mut params = file.motion();
    if let Some((distance, heading)) = tolerance {
        params.arrival.distance_m = distance;
        params.arrival.heading_rad = heading;
    }
    (params, file.period_s())
}

/// Median, nine tenths and most.
fn shares(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values[((values.len() - 1) as f64 * share).round() as usize];
    [at(0.5), at(0.9), at(1.0)]
}

/// Every start of the table, with the tolerance of most users and with that of exact poses.
#[test]
fn parking_takes_little_more_than_the_least_time() {
    let (mut page, mut medians) = (Stated::of("docs/motion.md"), Vec::new());
    for name in BASES {
        let (params, dt) = params(name, Some((0.005, 0.010)));
        assert!(
            Pool::of(name, &file(name)).is_some(),
            "{name}: the least times are those of other limits"
        );
        let exact = self::params(name, None).0;
        let starts: Vec<_> = MINIMUM.iter().filter(|row| row.0 == name).collect();
        let runs = on_all_cores(&starts, |row| {
            let start = Body::at(row.1, row.2, row.3);
            (park(&params, dt, start), park(&exact, dt, start))
        });
        let (mut ratios, mut late) = (Vec::new(), (0.0_f64, 0.0_f64));
        for ((usual, exact), row) in runs.iter().zip(&starts) {
            let (minimum, trapezoids) = (row.4, row.5);
            ratios.push(usual.inside_s / minimum);
            late = (
                late.0.max(usual.parked_s - usual.inside_s),
                late.1.max(exact.parked_s - exact.inside_s),
            );
            assert!(
                usual.inside_s < 1.05 * trapezoids,
                "{row:?}: {}",
                usual.inside_s
            );
        }
        let [median, most, all] = shares(ratios);
        println!(
            "{name}: {median:.2} {most:.2} {all:.2}, parked {:.2} and {:.2} s later",
            late.0, late.1
        );
        assert!(
            median <= 1.2 && most <= 1.4 && all <= 1.6,
            "{name}: {median} {most} {all}"
        );
        assert!(late.0 <= 0.3 && late.1 <= 1.0, "{name}: {late:?}");
        page.exactly(
            At::Row("13. Beside the least time", name),
            &[median, most, all, late.0, late.1],
        );
        medians.push(median);
    }
    Stated::of("README.md").exactly(
        At::Phrase("# (1 kg), # (10 kg) and # times (30 kg, median) the least time"),
        &medians,
    );
}

/// Base, start (x, y, θ) at rest 0.3 to 20 mm from the origin, least time to rest exactly there, and what that motion turns
/// in all \[m, rad, s\].
///
/// Starts are drawn: distances evenly by their logarithm, bearings evenly, headings of half of them within ±20 mrad and of the
/// others within ±0.5 rad. Least times as those of [`MINIMUM`], by direct multiple shooting over 80 intervals, positions in units
/// of the start's distance: 14 first guesses of 30 intervals each, swings there and back with two drives, the best three
/// refined; integrated again they end within a tenth of a micrometre of the goal.
const NEAR: &str = include_str!("motion_minimum_time/near.csv");

/// Start, least time and turn of a row of [`NEAR`].
fn near(name: &str, line: &str) -> Option<[f64; 5]> {
    let numbers = line.strip_prefix(name)?.strip_prefix(',')?.split(',');
    let numbers: Vec<f64> = numbers
        .map(|field| field.parse().expect("a number"))
        .collect();
    Some(numbers.try_into().expect("five numbers"))
}

/// 0.3 to 20 mm beside the goal, with exact poses: parked half a second after one and a half times the least time, without
/// driving about or turning round.
#[test]
fn a_goal_beside_the_robot_is_near() {
    let mut page = Stated::of("docs/motion.md");
    for name in BASES {
        let (params, dt) = params(name, None);
        let starts: Vec<[f64; 5]> = NEAR.lines().filter_map(|line| near(name, line)).collect();
        assert_eq!(starts.len(), 96, "{name}");
        let runs = on_all_cores(&starts, |&[x, y, theta, ..]| {
            park(&params, dt, Body::at(x, y, theta))
        });
        let worst = |of: &dyn Fn(&Run, f64, f64) -> f64| {
            let all = runs.iter().zip(&starts);
            all.map(|(run, &[.., least_s, turned])| of(run, least_s, turned))
                .fold(f64::MIN, f64::max)
        };
        let parked_s = worst(&|run, _, _| run.parked_s);
        let late_s = worst(&|run, least_s, _| run.parked_s - 1.5 * least_s);
        let more = worst(&|run, _, turned| run.turned - turned);
        println!(
            "{name}: parked by {parked_s:.2} s, {late_s:.2} s late, turned {more:.2} rad more"
        );
        assert!(
            late_s <= 0.5 && more <= 0.5,
            "{name}: {late_s} s, {more} rad"
        );
        page.exactly(
            At::Row(
                "13. Beside the least time",
                &format!("{name}, 0.3 to 20 mm beside it"),
            ),
            &[parked_s, late_s, more],
        );
    }
}

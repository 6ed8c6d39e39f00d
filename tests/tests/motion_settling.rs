//! How fast a lateral offset goes, at any reference speed.

use tests::motion_base::{Base, Body};
use tests::motion_loop::steady;
use tests::motion_tracking::{Tracking, follow};
use tests::stated::{At, Stated};
use tests::tolerance::{MOTION_SETTLED_LATE, MOTION_SETTLING_RATIO};

/// A row of the table of following in `docs/motion.md`.
fn state(label: &str, measured: &[(f64, f64)]) {
    let mut page = Stated::of("docs/motion.md");
    for &(v, value) in measured {
        // As the heading of the column is written.
        let column = if v == 2.0 {
            "2.0".to_owned()
        } else {
            format!("{v}")
        };
        page.exactly(At::Cell("10. What was measured", label, &column), &[value]);
    }
}

/// Starts 0.1 m beside a straight line, moving with it.
fn offset(base: Base, v: f64, dt: f64, end_s: f64) -> Tracking {
    let motion = base.exact().validate().expect("valid");
    let mut body = Body::at(0.0, -0.1, 0.0);
    body.twist.linear = v;
    follow(&motion, base, body, dt, end_s, steady(v, 0.0))
}

/// From 0.1 to 2 m/s the times to 5 mm differ by less than a factor 2, at 10 ms and at 1 ms.
#[test]
fn lateral_offset_settles_in_the_same_time_at_any_speed() {
    for dt in [0.01, 0.001] {
        let (mut times, mut moments) = (Vec::new(), Vec::new());
        for v in [0.1, 0.2, 0.4, 0.8, 1.6, 2.0] {
            let run = offset(Base::STANDARD, v, dt, 10.0);
            println!(
                "{dt} s, {v} m/s: {:.2} s, N {:.0}, w {:.2}",
                run.settled_s, run.moment, run.turn_rate
            );
            assert!(
                run.late < MOTION_SETTLED_LATE,
                "{v} m/s leaves {}",
                run.late
            );
            times.push((v, run.settled_s));
            moments.push((v, run.moment));
        }
        let slowest = times.iter().map(|run| run.1).fold(0.0, f64::max);
        let fastest = times.iter().map(|run| run.1).fold(f64::INFINITY, f64::min);
        assert!(slowest < MOTION_SETTLING_RATIO * fastest, "{times:?}");
        if dt == 0.01 {
            state("time [s]", &times);
            state("moment [N m]", &moments);
            Stated::of("docs/motion.md").exactly(
                At::Phrase("the ratio is # (required 2) from 0.1 to 2 m/s"),
                &[slowest / fastest],
            );
        }
    }
}

/// The paper's gains lose stability at 1.2 m/s; with the schedule 2.4 m/s and 2.4 m/s backward settle too.
#[test]
fn no_speed_is_too_fast() {
    for v in [1.2, 2.0, 2.4, -1.2, -2.4] {
        let run = offset(Base::STANDARD, v, 0.01, 20.0);
        println!("{v} m/s: {:.2} s, {:.1e} m", run.settled_s, run.late);
        assert!(
            run.late < MOTION_SETTLED_LATE,
            "{v} m/s leaves {}",
            run.late
        );
        if v == 2.4 {
            state("time [s]", &[(v, run.settled_s)]);
        }
    }
}

/// Below 0.1 m/s it takes longer, with a moment that no longer grows.
#[test]
fn crawling_is_slower_but_never_harder() {
    let driving = offset(Base::STANDARD, 0.2, 0.01, 10.0);
    for (v, end_s) in [(0.02, 40.0), (0.05, 20.0)] {
        let run = offset(Base::STANDARD, v, 0.01, end_s);
        println!(
            "{v} m/s: {:.2} s, N {:.0}, w {:.2}",
            run.settled_s, run.moment, run.turn_rate
        );
        assert!(run.late < 5e-3, "{v} m/s leaves {}", run.late);
        // A tenth: both meet the limits of acceleration and jerk, not in the same ticks.
        assert!(run.moment < 1.1 * driving.moment);
        state("time [s]", &[(v, run.settled_s)]);
        state("moment [N m]", &[(v, run.moment)]);
    }
}

/// With 10 N and 5 N m gains follow from the limits: slower, not lost.
#[test]
fn weak_base_takes_its_time() {
    for v in [0.1, 0.2, 0.4, 0.8, 1.6, 2.0] {
        let run = offset(Base::WEAK, v, 0.01, 30.0);
        println!("weak, {v} m/s: {:.2} s, N {:.1}", run.settled_s, run.moment);
        assert!(run.settled_s < 16.0 && run.late < 5e-3);
        state("weak [s]", &[(v, run.settled_s)]);
    }
}

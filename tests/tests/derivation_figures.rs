//! What `docs/derivation.md` says of the gains G and of what is only measured.

use nalgebra::{Vector2, Vector3};
use std::f64::consts::PI;
use tests::core_loop::{Exact, Tick, hand_over, run};
use tests::ideal::on_all_cores;
use tests::oracle::{Params, Reference, Scenario};
use tests::random::Random;
use tests::stated::{At, Stated};

/// Tick \[s\].
const DT: f64 = 5e-3;
/// 5 cm and 0.05 rad, as a norm.
const BAND: f64 = 0.05;

/// From when on the pose error stays in the band; not at all if it is outside at the end \[s\].
fn settled(ticks: &[Tick<f64>]) -> Option<f64> {
    let outside = ticks.iter().rposition(|tick| tick.error().norm() >= BAND);
    let first = outside.map_or(0, |last| last + 1);
    ticks.get(first).map(|tick| tick.t)
}

/// Both cases up to the hand-over, with other gains \[s\].
fn settling(change: impl Fn(&mut Params)) -> [f64; 2] {
    [Scenario::paper_line(), Scenario::paper_curve()].map(|mut scenario| {
        change(&mut scenario.params);
        let ticks = run::<f64, Exact>(&scenario, DT);
        settled(&ticks[..hand_over(&ticks)]).expect("settles before the hand-over")
    })
}

/// Along x at (v, w) for ever.
fn follow(params: Params, q0: Vector3<f64>, (v, w): (f64, f64), duration: f64) -> Scenario {
    Scenario {
        params,
        q0,
        twist0: Vector2::zeros(),
        reference: Reference::steady([0.0; 3], v, w),
        duration,
        switch: None,
        ..Scenario::paper_line()
    }
}

/// Half a metre beside a line, moving along: when that is over \[s\].
fn offset(params: Params, v: f64) -> f64 {
    let mut scenario = follow(params, Vector3::new(0.0, 0.5, 0.0), (v, 0.0), 150.0);
    scenario.twist0.x = v;
    settled(&run::<f64, Exact>(&scenario, DT)).expect("settles")
}

#[test]
fn slopes_of_the_torque_are_those_stated() {
    let ticks = run::<f64, Exact>(&Scenario::paper_line(), 1e-3);
    let p = Params::recommended();
    let rate = |tick: &Tick<f64>| tick.report.command_rate.linear;
    let mut page = Stated::of("docs/derivation.md");
    page.exactly(
        At::Phrase("(case 1: # N/s). Likewise"),
        &[(p.kc1 + p.m * p.b) * rate(&ticks[hand_over(&ticks)])],
    );
    page.exactly(
        At::Phrase("(k_d1 + m B) v̇_c(0) (# N/s)"),
        &[(p.kd1 + p.m * p.b) * rate(&ticks[0])],
    );
}

/// One gain after the other by 20 %.
#[test]
fn second_settling_time_is_sensitive_as_stated() {
    let plain = settling(|_| ());
    let mut page = Stated::of("docs/derivation.md");
    let [less, more] = [0.8, 1.2].map(|share| settling(|p| p.k3 *= share));
    page.exactly(
        At::Phrase("k₃ × 0.8 gives # / # s, × 1.2 gives # / # s"),
        &[less, more].concat(),
    );
    let [less, more] = [0.8, 1.2].map(|share| settling(|p| p.k2 *= share));
    page.exactly(
        At::Phrase("k₂ × 0.8 gives # / # s, × 1.2 gives # / # s"),
        &[less, more].concat(),
    );
    let others: [fn(&mut Params, f64); 4] = [
        |p, share| p.k1 *= share,
        |p, share| p.kd1 *= share,
        |p, share| p.kd2 *= share,
        |p, share| (p.a, p.b, p.d) = (share * p.a, share * p.b, share * p.d),
    ];
    let mut most = 0.0_f64;
    for change in others {
        for share in [0.8, 1.2] {
            for (found, plain) in settling(|p| change(p, share)).iter().zip(plain) {
                most = most.max((found - plain).abs());
            }
        }
    }
    page.exactly(At::Phrase("A by 20 % move it by at most # s"), &[most]);
}

#[test]
fn one_gain_does_not_fit_all_speeds() {
    let mut page = Stated::of("docs/derivation.md");
    let p = Params::recommended();
    page.exactly(
        At::Phrase("0.5 m of error takes # s at 0.2 m/s, # s at 0.1 m/s"),
        &[offset(p, 0.2), offset(p, 0.1)],
    );
    let times = [0.05, 0.1, 0.2, 0.4, 0.8, 1.2, 2.0].map(|v| {
        let k2 = 0.96 / (v * v);
        offset(Params { k2, ..p }, v)
    });
    println!("{times:?}");
    page.exactly(
        At::Phrase("and gives # to # s from 0.05 to 2 m/s"),
        &[
            times.into_iter().fold(f64::INFINITY, f64::min),
            times.into_iter().fold(0.0, f64::max),
        ],
    );
}

/// From rest at `q0` \[s\].
fn arrival(q0: Vector3<f64>, speeds: (f64, f64), dt: f64) -> Option<f64> {
    let scenario = follow(Params::recommended(), q0, speeds, 40.0);
    settled(&run::<f64, Exact>(&scenario, dt))
}

/// Random starts, any heading, from rest: all get there, but for a fast reference and slow ticks.
#[test]
fn no_random_start_is_lost() {
    let mut random = Random(0x5EED_0300);
    let boxes = [
        (1.0, 0.4, 0.0),
        (3.0, 0.4, 0.0),
        (10.0, 0.4, 0.0),
        (3.0, 0.4, 0.15),
        (3.0, 1.0, 0.0),
        (3.0, -0.4, 0.0),
    ];
    for (reach, v, w) in boxes {
        let starts: Vec<Vector3<f64>> = (0..300)
            .map(|_| {
                Vector3::new(
                    random.within(reach),
                    random.within(reach),
                    random.within(PI),
                )
            })
            .collect();
        let times = on_all_cores(&starts, |q0| arrival(*q0, (v, w), DT));
        let lost = times.iter().filter(|time| time.is_none()).count();
        let last = times.iter().flatten().copied().fold(0.0, f64::max);
        println!("±{reach} m, {v} m/s, {w} rad/s: lost {lost}, last {last:.1} s");
        assert_eq!(lost, 0, "±{reach} m, {v} m/s, {w} rad/s");
        if v == 1.0 {
            let slow = on_all_cores(&starts, |q0| arrival(*q0, (v, w), 20e-3));
            let lost = slow.iter().filter(|time| time.is_none()).count();
            Stated::of("docs/derivation.md").exactly(
                At::Phrase("with 20 ms # of the 300 at 1.0 m/s do not"),
                &[lost as f64],
            );
        }
    }
    let about = follow(
        Params::recommended(),
        Vector3::new(0.0, 0.0, PI - 1e-6),
        (0.4, 0.0),
        60.0,
    );
    let time = settled(&run::<f64, Exact>(&about, DT)).expect("turns round");
    Stated::of("docs/derivation.md").exactly(At::Phrase("e_y = 0 (# s from π − 1e-6)"), &[time]);
}

/// Where Eq. (18) has a value for a robot at rest beside a straight line.
#[test]
fn few_headings_start_feasibly_below_the_limit() {
    let p = Params::recommended();
    let feasible = |v: f64| {
        let headings = (0..1000).map(|k| PI * (f64::from(k) / 500.0 - 1.0));
        let starts = headings.filter(|&theta| {
            let scenario = follow(p, Vector3::new(0.0, 0.0, theta), (v, 0.0), 0.0);
            !run::<f64, Exact>(&scenario, DT)[0]
                .report
                .has_transition_offset(0.0)
        });
        starts.count() as f64 / 1000.0
    };
    let limit = p.k3 / (p.k2 * p.d);
    assert_eq!(feasible(1.001 * limit), 1.0);
    assert!(feasible(0.99 * limit) < 1.0);
    let share = 100.0 * feasible(0.05);
    Stated::of("docs/errata.md").exactly(
        At::Phrase("(G: # m/s; # % of headings at 0.05 m/s)"),
        &[limit, share],
    );
    Stated::of("docs/derivation.md").exactly(
        At::Phrase("v_r ≥ k₃/(k₂ D) = # m/s; at 0.05 m/s only # % do"),
        &[limit, share],
    );
}

//! Margins agree with the loop itself: just below them it settles, just above it grows.

use controller_core::maths::{Libm, Single};
use controller_core::motion::{MotionGains, MotionParams};
use controller_core::params::Params as CoreParams;
use controller_core::tuning::motion::margins;
use controller_core::tuning::{Channel, Concern, LoopMargins, paper};
use controller_core::types::Twist;
use nalgebra::{Matrix5, Vector2};
use proptest::prelude::*;
use tests::check::assert_within;
use tests::core_draw::{cases, decades};
use tests::motion_base::Body;
use tests::motion_loop::steady;
use tests::tolerance::LIMIT_SPEED;
use tests::tuning_loop::{AS_BELIEVED, BASES, Truth, base, drive, peak};

/// Distance from a delay margin at which the loop's side is clear: held torque adds half a tick of 1 ms, a late pose
/// is a whole number of ticks, and both are at most 1 % of the margins tried.
const NEAR: f64 = 0.04;

/// Speed of the tests \[m/s\]: within that of every base.
const SPEED: f64 = 0.5;

/// The error's size grows from the start of a run to its end.
///
/// Across the path at speed, along it at rest. The start is 0.1 mm beside where late poses let the robot rest, which is
/// ahead by speed times delay: neurons and limits are linear there.
fn grows(params: &MotionParams<f64>, truth: Truth, across: bool) -> bool {
    let (end, off) = (60.0, 1e-4);
    let speed = if across { SPEED } else { 0.0 };
    let mut body = if across {
        Body::at(speed * truth.pose_late as f64 * truth.dt, off, 0.0)
    } else {
        Body::at(-off, 0.0, 0.0)
    };
    body.twist = Twist::new(speed, 0.0);
    let run = drive(params, truth, body, steady(speed, 0.0), end);
    let part = |now: &tests::tuning_loop::Instant| {
        if across { now.error.1 } else { now.error.0 }
    };
    let (early, late) = (peak(&run, 10.0, 20.0, part), peak(&run, 50.0, end, part));
    // A limit cycle of large size is grown, however steady by now.
    late > early || late > 0.01
}

/// A margin in ticks of 1 ms, `share` of it.
fn ticks(margin_s: f64, share: f64) -> usize {
    (share * margin_s / 1e-3).round() as usize
}

/// Both sides of both delay margins, along and across, for the gains of every base.
#[test]
fn delay_margins_are_where_the_loop_starts_to_grow() {
    for name in BASES {
        let params = base(name);
        let found = margins::<f64, Libm>(&params.gains);
        for (across, of) in [(false, found.along), (true, found.across)] {
            println!(
                "{name}, across {across}: pose {:.3} s, torque {:.3} s",
                of.pose_delay_s, of.torque_delay_s
            );
            let late = |share: f64| Truth {
                pose_late: ticks(of.pose_delay_s, share),
                dt: 1e-3,
                ..AS_BELIEVED
            };
            let slow = |share: f64| Truth {
                torque_late: ticks(of.torque_delay_s - 0.5e-3, share),
                dt: 1e-3,
                ..AS_BELIEVED
            };
            for truth in [late(1.0 - NEAR), slow(1.0 - NEAR)] {
                assert!(!grows(&params, truth, across), "{name}: {truth:?} grows");
            }
            for truth in [late(1.0 + NEAR), slow(1.0 + NEAR)] {
                assert!(grows(&params, truth, across), "{name}: {truth:?} settles");
            }
        }
    }
}

/// Heavier than believed: gains chosen so that there is a limit to it, on both sides of which the loop is tried.
#[test]
fn mass_margin_is_where_the_loop_starts_to_grow() {
    let params = base("paper-30kg");
    let gains = MotionGains {
        across: 8.0,
        along: 20.0,
        speed_loop: 12.0,
        ..params.gains
    };
    let params = MotionParams { gains, ..params };
    let found = margins::<f64, Libm>(&gains);
    for (across, heavier) in [(false, found.along.heavier), (true, found.across.heavier)] {
        println!("across {across}: {heavier:.3} times the mass");
        let truth = |share: f64| Truth {
            heavier: share * heavier,
            dt: 1e-3,
            ..AS_BELIEVED
        };
        assert!(heavier > 1.0 && heavier < 100.0);
        assert!(
            !grows(&params, truth(1.0 - NEAR), across),
            "below {heavier}"
        );
        assert!(grows(&params, truth(1.0 + NEAR), across), "above {heavier}");
    }
}

/// The gains that come with every base are healthy, with room; the figures of `docs/tuning.md`.
#[test]
fn gains_of_every_base_are_healthy() {
    for name in BASES {
        let found = margins::<f64, Libm>(&base(name).gains);
        let worst = found.worst();
        println!("{found:.3?}");
        println!(
            "{name}: {worst:.3?}, settling {:.2} s, arrival {:.2} s",
            found.settling_s, found.arrival_s
        );
        assert_eq!(found.warnings().count(), 0);
        assert!(worst.pose_delay_s > 0.15 && worst.torque_delay_s > 0.1);
    }
}

/// Hopeless gains are told, the worst concern first, and one loop's trouble is not another's.
#[test]
fn hopeless_gains_are_told() {
    let good = base("lab-10kg").gains;
    for (gains, channel, concern) in [
        (
            MotionGains {
                across: 100.0,
                ..good
            },
            Channel::Across,
            Concern::Unstable,
        ),
        (
            MotionGains {
                approach: 4.0,
                ..good
            },
            Channel::Bearing,
            Concern::Unstable,
        ),
        (
            MotionGains {
                turn_loop: 60.0,
                ..good
            },
            Channel::Across,
            Concern::ShortOfTorqueDelay,
        ),
        (
            MotionGains { along: 8.0, ..good },
            Channel::Along,
            Concern::Rings,
        ),
    ] {
        let warnings: Vec<_> = margins::<f64, Libm>(&gains).warnings().collect();
        println!("{}", warnings[0]);
        assert!(
            warnings
                .iter()
                .any(|w| w.channel == channel && w.concern == concern),
            "{warnings:?}"
        );
    }
}

/// What each raw gain does, as `docs/tuning.md` says: the table of that page.
#[test]
fn turning_a_gain_does_what_the_page_says() {
    let good = base("paper-30kg").gains;
    let of = |name: &str, gains: MotionGains<f64>| {
        let found = margins::<f64, Libm>(&gains);
        println!(
            "{name:22} across {:.2} s damping {:.2} pose {:.2} s torque {:.2} s | arrival {:.2} s, bearing damping {:.2} pose {:.2} s",
            found.settling_s,
            found.across.damping,
            found.across.pose_delay_s,
            found.across.torque_delay_s,
            found.arrival_s,
            found.bearing.damping,
            found.bearing.pose_delay_s,
        );
        found
    };
    let plain = of("for_limits", good);
    let stiff = of(
        "across x 1.5",
        MotionGains {
            across: 1.5 * good.across,
            ..good
        },
    );
    let soft = of(
        "across / 1.5",
        MotionGains {
            across: good.across / 1.5,
            ..good
        },
    );
    let firm = of(
        "heading x 1.5",
        MotionGains {
            heading: 1.5 * good.heading,
            ..good
        },
    );
    let quick = of(
        "decay x 2",
        MotionGains {
            decay: 2.0 * good.decay,
            ..good
        },
    );
    let calm = of(
        "approach / 1.5",
        MotionGains {
            approach: good.approach / 1.5,
            ..good
        },
    );
    let tight = of(
        "turn_loop x 2",
        MotionGains {
            turn_loop: 2.0 * good.turn_loop,
            ..good
        },
    );
    // Too stiff is slow too: it overshoots by more than a tenth.
    assert!(
        stiff.across.damping < plain.across.damping
            && stiff.across.pose_delay_s < plain.across.pose_delay_s
    );
    assert!(soft.across.damping > plain.across.damping && soft.settling_s > plain.settling_s);
    assert!(firm.across.damping > plain.across.damping);
    assert!(
        quick.across.damping > plain.across.damping
            && quick.bearing.damping > plain.bearing.damping
    );
    assert!(
        calm.bearing.pose_delay_s > plain.bearing.pose_delay_s && calm.arrival_s > plain.arrival_s
    );
    assert!(calm.bearing.damping > plain.bearing.damping);
    assert!(tight.across.torque_delay_s < plain.across.torque_delay_s);
}

/// The largest stable speed of the paper's law is where its lateral margins vanish.
#[test]
fn largest_stable_speed_is_where_the_margins_end() {
    let params = CoreParams::<f64>::paper();
    let at = |speed| paper::margins::<f64, Libm>(&params, speed);
    let limit = at(0.4).max_speed;
    assert_within(limit, 1.215, LIMIT_SPEED, "recommended gains");
    // On both sides of a bisection's last bits.
    let (below, above) = (
        at(limit * (1.0 - 1e-6)).across,
        at(limit * (1.0 + 1e-6)).across,
    );
    assert!(below.is_stable() && !above.is_stable());
    assert!(below.pose_delay_s < 1e-3 && above.pose_delay_s == 0.0);
    // A factor g on the pose's gain is not one on the speed; their common limit is.
    assert!((at(limit).across.gain - 1.0).abs() < 1e-4 || at(limit).across.gain == 0.0);
    // Hand-computed: 4 · 0.9 · 90 and 4 · 6 · 2 · 75.
    let found = at(0.4);
    assert!((found.lyapunov_along - 324.0).abs() < 1e-9);
    assert!((found.lyapunov_across - 3600.0).abs() < 1e-9);
    println!("G at 0.4 m/s: {:.3?}", found.across);
}

/// Latency at which the paper's law was lost in simulations by others: 740 ms at 0.4 m/s, 250 at 0.8, 100 at 1.0.
#[test]
fn delay_margins_of_the_paper_are_those_simulated() {
    let params = CoreParams::<f64>::paper();
    for (speed, lost_s) in [(0.4, 0.74), (0.8, 0.25), (1.0, 0.10)] {
        let found = paper::margins::<f64, Libm>(&params, speed)
            .across
            .pose_delay_s;
        println!("{speed} m/s: {found:.3} s, simulated {lost_s}");
        // Simulated with large errors, in steps of 10 to 20 ms, at a tick of 10 ms.
        assert!((found - lost_s).abs() < 0.03, "{found} for {lost_s}");
    }
}

/// Roots of the lateral loop of the paper by eigenvalues: matrix as in `stability_limits.rs`.
fn roots(p: &CoreParams<f64>, v_r: f64) -> Vec<Vector2<f64>> {
    let (g, a, b) = (&p.tracking, p.neurons.a, p.neurons.b);
    let (kappa, across) = (g.k_d2 / p.robot.inertia_kg_m2, g.k2 * v_r);
    #[rustfmt::skip]
    let matrix = Matrix5::new(
        0.0,            v_r,          0.0,             0.0,          0.0,
        0.0,            0.0,          0.0,            -1.0,          0.0,
        b,              0.0,         -a,               0.0,          0.0,
        0.0,            kappa * g.k3, kappa * across, -kappa,        1.0,
        b * across * b, 0.0,         -b * across * a, -b * g.k3,    -a,
    );
    let found = matrix.complex_eigenvalues();
    found
        .iter()
        .map(|root| Vector2::new(root.re, root.im))
        .collect()
}

proptest! {
    #![proptest_config(cases(300))]

    /// Decay and damping are those of the eigenvalues, in double and in single precision.
    #[test]
    fn decay_and_damping_are_those_of_the_eigenvalues(f in prop::array::uniform6(decades(-0.5, 0.5))) {
        let mut p = CoreParams::<f64>::paper();
        p.tracking.k2 *= f[0];
        p.tracking.k3 *= f[1];
        p.tracking.k_d2 *= f[2];
        p.neurons.a *= f[3];
        p.neurons.b *= f[4];
        p.neurons.d = p.neurons.b;
        let speed = 0.4 * f[5];
        let roots = roots(&p, speed);
        let decay = roots.iter().map(|root| -root.x).fold(f64::INFINITY, f64::min);
        let damping = roots.iter().map(|root| -root.x / root.norm()).fold(1.0, f64::min);
        let found = paper::margins::<f64, Libm>(&p, speed).across;
        // Roots that nearly coincide are known to the square root of rounding only.
        prop_assert!((found.decay - decay).abs() < 1e-6 * (1.0 + decay.abs()), "{} {decay}", found.decay);
        prop_assert!((found.damping - damping.max(0.0)).abs() < 1e-5, "{} {damping}", found.damping);
        let single = CoreParams::<f32> {
            robot: CoreParams::<f32>::paper().robot,
            ..single(&p)
        };
        let single = paper::margins::<f32, Single>(&single, speed as f32).across;
        let clear = found.decay.abs() > 0.01;
        let near = |a: f64, b: f32| (a - f64::from(b)).abs() < 0.02 * (0.1 + a.abs());
        let LoopMargins { decay, pose_delay_s, torque_delay_s, .. } = found;
        prop_assert!(!clear || near(decay, single.decay), "{decay} {}", single.decay);
        prop_assert!(!clear || near(pose_delay_s, single.pose_delay_s));
        prop_assert!(!clear || near(torque_delay_s, single.torque_delay_s));
    }
}

fn single(p: &CoreParams<f64>) -> CoreParams<f32> {
    let mut q = CoreParams::<f32>::paper();
    q.tracking.k2 = p.tracking.k2 as f32;
    q.tracking.k3 = p.tracking.k3 as f32;
    q.tracking.k_d2 = p.tracking.k_d2 as f32;
    q.neurons.a = p.neurons.a as f32;
    q.neurons.b = p.neurons.b as f32;
    q.neurons.d = p.neurons.d as f32;
    q
}

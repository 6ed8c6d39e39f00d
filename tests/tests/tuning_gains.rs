//! What margins say of gains, good and hopeless, and of turning each.

use controller_core::maths::Libm;
use controller_core::motion::MotionGains;
use controller_core::tuning::motion::margins;
use controller_core::tuning::{Channel, Concern};
use sim_host::tune::{POSE_DELAY_S, health, torque_delay_s};
use tests::stated::{At, Stated};
use tests::tuning_loop::{BASES, base, file, shipped};

/// The gains that follow from the limits of every base are healthy, with room; the figures of `docs/tuning.md`, which the
/// 30 kg base is at least as good as: its gains are slowed to what its floor holds.
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
        if name == "paper-30kg" {
            let lab = margins::<f64, Libm>(&base("lab-10kg").gains).worst();
            assert!(worst.pose_delay_s >= lab.pose_delay_s && worst.heavier >= lab.heavier);
            assert!(worst.torque_delay_s >= lab.torque_delay_s && worst.damping >= lab.damping);
            continue;
        }
        let mut page = Stated::of("docs/tuning.md");
        let mut row = |label, measured: &[f64]| {
            let cell = At::Cell("4. Margins", label, "`for_limits`, worst loop");
            page.exactly(cell, measured);
        };
        let (across, along, bearing) = (&found.lateral, &found.longitudinal, &found.bearing);
        row("`decay`", &[bearing.decay]);
        row("`damping`", &[bearing.damping, across.damping]);
        row(
            "`pose_delay_s`",
            &[
                bearing.pose_delay_s,
                across.pose_delay_s,
                along.pose_delay_s,
            ],
        );
        row("`torque_delay_s`", &[across.torque_delay_s]);
        row("`heavier`", &[bearing.heavier, across.heavier]);
        row("`gain`", &[worst.gain]);
    }
}

/// The gains of every base as it is shipped have the margins that `tune` asks for; the table of `docs/tuning.md`.
#[test]
fn shipped_gains_have_their_margins() {
    let mut page = Stated::of("docs/tuning.md");
    for name in BASES {
        let found = margins::<f64, Libm>(&shipped(name).gains);
        let worst = found.worst();
        assert_eq!(found.warnings().count(), 0, "{name}");
        assert!(worst.pose_delay_s >= POSE_DELAY_S, "{name}: {worst:?}");
        let period_s = file(name).period_s();
        let asked_s = torque_delay_s(period_s);
        assert!(worst.torque_delay_s >= asked_s, "{name}: {worst:?}");
        assert_eq!(health(&shipped(name).gains, period_s), 0.0, "{name}");
        page.exactly(
            At::Row("4. Margins", &format!("`{name}`")),
            &[
                worst.pose_delay_s,
                worst.torque_delay_s,
                worst.damping,
                worst.heavier,
                found.settling_s,
                found.arrival_s,
            ],
        );
    }
}

/// Gains of one's own keep a floor v_f with which half of what is tolerated beside the goal turns a base by no more than is
/// tolerated there, if poses correct it on the way; a higher floor stays. The figures of `docs/motion.md`.
#[test]
fn gains_of_ones_own_keep_the_floor_that_arrival_asks_for() {
    let floors = ["paper-30kg", "lab-10kg", "hobby-1kg"].map(|name| {
        let base = file(name);
        let params = sim_host::closed_loop::params(&base, 10_000).expect("in range");
        let (gains, arrival) = (&params.motion.gains, &params.motion.arrival);
        // The largest slope of the heading over the lateral error, by trying all speeds.
        let steepest = (1..10_000).map(|i| {
            let v = f64::from(i) * 1e-4;
            let (c, k3) = (f64::from(gains.lateral), f64::from(gains.heading));
            c / k3 * v / (v * v + f64::from(gains.slow).powi(2))
        });
        let asked = steepest.fold(0.0, f64::max) * 0.5 * f64::from(arrival.distance_m);
        let tolerated = f64::from(arrival.heading_rad);
        assert!((asked / tolerated - 1.0).abs() < 1e-3, "{name}: {asked}");

        let higher = MotionGains {
            slow: 0.4,
            ..*gains
        };
        assert_eq!(params.with_gains(higher).motion.gains, higher);
        let mut alone = params;
        alone.localiser.fusion = None;
        let own = MotionGains {
            slow: 0.03,
            ..*gains
        };
        let noise = gains.slow_for(params.motion.pose_noise_m, 0.03);
        assert_eq!(alone.with_gains(own).motion.gains.slow, noise.max(0.03));
        // Nothing else changes.
        assert_eq!(params.with_gains(own), params);
        f64::from(gains.slow)
    });
    Stated::of("docs/motion.md").exactly(At::Phrase("(#, # and # m/s on the bases)"), &floors);
}

/// Hopeless gains are reported, the worst concern first, and one loop's trouble is not another's.
#[test]
fn hopeless_gains_are_told() {
    let good = base("lab-10kg").gains;
    for (gains, channel, concern) in [
        (
            MotionGains {
                lateral: 100.0,
                ..good
            },
            Channel::Lateral,
            Concern::Unstable,
        ),
        (
            // It is stable below 0.75 A, 15/s.
            MotionGains {
                approach: 16.0,
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
            Channel::Lateral,
            Concern::ShortOfTorqueDelay,
        ),
        (
            // A damping of √(A/k₁)/2 = 0.395.
            MotionGains {
                decay: 5.0,
                longitudinal: 8.0,
                ..good
            },
            Channel::Longitudinal,
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
    let good = base("lab-10kg").gains;
    let of = |name: &str, gains: MotionGains<f64>| {
        let found = margins::<f64, Libm>(&gains);
        println!(
            "{name:22} across {:.2} s damping {:.2} pose {:.2} s torque {:.2} s | arrival {:.2} s, bearing damping {:.2} pose {:.2} s",
            found.settling_s,
            found.lateral.damping,
            found.lateral.pose_delay_s,
            found.lateral.torque_delay_s,
            found.arrival_s,
            found.bearing.damping,
            found.bearing.pose_delay_s,
        );
        found
    };
    let plain = of("for_limits", good);
    // So stiff that it overshoots by more than a tenth; (A + k₃) k₃/c = 18 times make it unstable.
    let stiff = of(
        "across x 4",
        MotionGains {
            lateral: 4.0 * good.lateral,
            ..good
        },
    );
    let soft = of(
        "across / 1.5",
        MotionGains {
            lateral: good.lateral / 1.5,
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
    let mut page = Stated::of("docs/tuning.md");
    page.exactly(
        At::Phrase(
            "(damping # → #), or `decay` × 2 (→ #) | back on the path in # s instead of # s;",
        ),
        &[
            plain.lateral.damping,
            soft.lateral.damping,
            quick.lateral.damping,
            soft.settling_s,
            plain.settling_s,
        ],
    );
    page.exactly(
        At::Phrase("(survives poses # s old instead of # s) | arrives in # s instead of # s for"),
        &[
            calm.bearing.pose_delay_s,
            plain.bearing.pose_delay_s,
            calm.arrival_s,
            plain.arrival_s,
        ],
    );
    page.exactly(
        At::Phrase("(`turn_loop` × 2: # s → # s)"),
        &[plain.lateral.torque_delay_s, tight.lateral.torque_delay_s],
    );
    page.exactly(
        At::Phrase("`lateral` × 4 takes # s instead of # s"),
        &[stiff.settling_s, plain.settling_s],
    );
    // Too stiff is slow too: it overshoots by more than a tenth.
    assert!(stiff.settling_s > plain.settling_s);
    assert!(
        stiff.lateral.damping < plain.lateral.damping
            && stiff.lateral.pose_delay_s < plain.lateral.pose_delay_s
    );
    assert!(soft.lateral.damping > plain.lateral.damping && soft.settling_s > plain.settling_s);
    assert!(firm.lateral.damping > plain.lateral.damping);
    assert!(
        quick.lateral.damping > plain.lateral.damping
            && quick.bearing.damping >= plain.bearing.damping
    );
    assert!(
        calm.bearing.pose_delay_s > plain.bearing.pose_delay_s && calm.arrival_s > plain.arrival_s
    );
    // Its neuron goes with it: the damping stays, but for what the velocity loop's lag has of it.
    let damping = calm.bearing.damping / plain.bearing.damping;
    assert!((damping - 1.0).abs() < 0.1, "{damping}");
    assert!(tight.lateral.torque_delay_s < plain.lateral.torque_delay_s);
}

//! The paper's two cases at 1 ms in double precision, by the core: every figure that its text claims.

use controller_core::maths::Libm;
use controller_core::plain::PlainController;
use tests::check::assert_within;
use tests::core_loop::{Exact, Tick, hand_over, largest_torque_change, run};
use tests::oracle::Scenario;
use tests::tolerance::{
    HAND_OVER, OVERSHOOT, PARKED, SETTLED, SETTLING, START, TORQUE_CHANGE_RATIO, TRACKED,
    TWO_DECIMALS,
};

/// Control period \[s\].
const DT: f64 = 1e-3;
/// What the paper calls corrected: 5 cm and 0.05 rad.
const BAND: f64 = SETTLED;

/// Both cases with the neural controller.
fn cases() -> [(&'static str, Scenario, Vec<Tick<f64>>); 2] {
    [
        ("line", Scenario::paper_line()),
        ("curve", Scenario::paper_curve()),
    ]
    .map(|(name, scenario)| (name, scenario, run::<f64, Exact>(&scenario, DT)))
}

/// Instant from which the norm of the pose error stays in the band until the hand-over \[s\].
fn settling(ticks: &[Tick<f64>]) -> f64 {
    let tracking = &ticks[..hand_over(ticks)];
    let outside = tracking
        .iter()
        .rposition(|tick| tick.error().norm() >= BAND);
    tracking[outside.expect("the run starts outside") + 1].t
}

/// Figs. 3 and 4 under Eq. (15) and Eq. (16): about 5.0 s and about 5.2 s.
#[test]
fn both_cases_settle_when_the_paper_says() {
    for ((name, _, ticks), expected) in cases().into_iter().zip([4.98, 5.21]) {
        let settled = settling(&ticks);
        println!("{name}: neural settles at {settled:.3} s");
        assert_within(settled, expected, SETTLING, name);
    }
    for (scenario, expected) in [
        (Scenario::paper_line(), 5.06),
        (Scenario::paper_curve(), 5.37),
    ] {
        let settled = settling(&run::<f64, PlainController<f64, Libm>>(&scenario, DT));
        println!("plain settles at {settled:.3} s");
        assert_within(settled, expected, SETTLING, "Eq. (10) and Eq. (12)");
    }
}

/// Eq. (20) and Eq. (21) bring the robot to rest at the target, from behind.
#[test]
fn both_cases_park_within_a_millimetre_and_a_half_without_overshoot() {
    for (name, scenario, ticks) in cases() {
        let goal = scenario.switch.expect("a paper run parks").target;
        let last = ticks.last().expect("a run has ticks");
        let distance = (last.body.q - goal).xy().norm();
        println!(
            "{name}: {:.3} mm from the target at the end",
            1e3 * distance
        );
        assert!(distance < PARKED, "{name}: {distance}");
        assert!(last.body.twist.amax() < TRACKED, "{name}: still moving");
        let nearest = ticks[hand_over(&ticks)..]
            .iter()
            .map(|tick| tick.error().x)
            .fold(f64::INFINITY, f64::min);
        println!("{name}: smallest e_x while parking {:.4} mm", 1e3 * nearest);
        assert!(nearest > -OVERSHOOT, "{name}: past the target by {nearest}");
    }
}

/// Eq. (18) and Eq. (19): command, velocity and torque start from zero.
#[test]
fn both_cases_start_from_zero_torque_and_velocity() {
    for (name, _, ticks) in cases() {
        let (first, second) = (&ticks[0], &ticks[1]);
        println!("{name}: start torque {:.1e}", first.tau().amax());
        for (what, value) in [
            ("torque", first.tau().amax()),
            ("command", first.command().amax()),
            ("velocity", first.body.twist.amax()),
            ("velocity after the first tick", second.body.twist.amax()),
        ] {
            assert!(value <= START, "{name}: {what} {value:e}");
        }
        assert!(
            !first.report.is_bridging(0.0),
            "{name}: Eq. (18) is feasible"
        );
    }
}

/// Eq. (23): at its own tick, the new phase asks for the torque that the old one would have asked for.
#[test]
fn hand_over_changes_no_torque_in_its_own_tick() {
    for (name, _, ticks) in cases() {
        let tick = &ticks[hand_over(&ticks)];
        let went_on = tick.unswitched.expect("a copy went on tracking");
        let (new, old) = (&tick.report.wrench, &went_on.wrench);
        let step = &tick.wrench_step.expect("this tick hands over");
        let differences = [
            ("force", new.force - old.force),
            ("moment", new.moment - old.moment),
            ("reported force step", step.force),
            ("reported moment step", step.moment),
            ("v_c", tick.report.command.linear - went_on.command.linear),
            ("w_c", tick.report.command.angular - went_on.command.angular),
        ];
        for (what, difference) in differences {
            println!("{name}: {what} {difference:.1e}");
            assert!(
                difference.abs() <= HAND_OVER,
                "{name}: {what} {difference:e}"
            );
        }
        assert!(!tick.report.is_bridging(0.0) && !tick.relaxing, "{name}");
    }
}

/// Largest change of torque from tick to tick, Eq. (12) and Eq. (14) beside Eq. (16) and Eq. (21).
#[test]
fn neural_torque_changes_a_hundred_times_less_per_tick() {
    for (name, scenario, ticks) in cases() {
        let plain = largest_torque_change(&run::<f64, PlainController<f64, Libm>>(&scenario, DT));
        let neural = largest_torque_change(&ticks);
        let ratio = plain.component_div(&neural);
        println!(
            "{name}: per tick, plain {:.3} N, {:.3} N m; neural {:.4} N, {:.4} N m; ratio {:.0}, {:.0}",
            plain.x, plain.y, neural.x, neural.y, ratio.x, ratio.y
        );
        assert!(ratio.min() >= TORQUE_CHANGE_RATIO, "{name}: {ratio}");
    }
}

/// The error of Eq. (8) is small before the hand-over and is the distance to the real target after it.
#[test]
fn pose_error_is_small_at_the_hand_over_and_then_pulses() {
    for ((name, _, ticks), pulse) in cases().into_iter().zip([0.40, 0.20]) {
        let at = hand_over(&ticks);
        let tracked = ticks[at].unswitched.expect("a copy went on tracking").error;
        let norm = tracked.norm::<Libm>();
        let after = ticks[at].error();
        println!(
            "{name}: |e| {:.2} mm/mrad before, e = ({:.3}, {:.3}, {:.3}) after",
            1e3 * norm,
            after.x,
            after.y,
            after.z
        );
        assert!(norm < TRACKED, "{name}: {norm}");
        assert_within(after.x, pulse, TWO_DECIMALS, name);
    }
}

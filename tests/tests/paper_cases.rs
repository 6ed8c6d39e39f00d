//! The paper's two cases at 1 ms in double precision, by the core: every figure that its text claims.

use controller_core::maths::Libm;
use controller_core::paper::plain::PlainController;
use nalgebra::{Vector2, Vector3};
use tests::check::assert_within;
use tests::core_loop::{Controller, Exact, Tick, hand_over, largest_torque_change, run};
use tests::oracle::Scenario;
use tests::plant::MovingReference;
use tests::stated::{At, Stated};
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
            !first.report.has_transition_offset(0.0),
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
        assert!(
            !tick.report.has_transition_offset(0.0) && !tick.relaxing,
            "{name}"
        );
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

/// What README and derivation say of a run.
struct Figures {
    settled_s: f64,
    left_mm: f64,
    peak: Vector2<f64>,
    change: Vector2<f64>,
    start: Vector2<f64>,
    /// New law minus old, in the tick of the hand-over.
    hand_over: Vector2<f64>,
    /// Pose error after the hand-over.
    pulse: Vector3<f64>,
    /// From the hand-over until the norm of the pose error stays below 1 cm and 0.01 rad \[s\].
    parked_s: f64,
}

impl Figures {
    fn of<C: Controller<f64>>(scenario: &Scenario) -> Self {
        let ticks = run::<f64, C>(scenario, DT);
        let at = hand_over(&ticks);
        let old = ticks[at]
            .unswitched
            .expect("a copy went on tracking")
            .wrench;
        let goal = scenario.switch.expect("a paper run parks").target;
        let last = ticks.last().expect("a run has ticks");
        let far = ticks.iter().rposition(|tick| tick.error().norm() >= 0.01);
        Self {
            settled_s: settling(&ticks),
            left_mm: 1e3 * (last.body.q - goal).xy().norm(),
            peak: ticks
                .iter()
                .fold(Vector2::zeros(), |peak, tick| tick.tau().abs().sup(&peak)),
            change: largest_torque_change(&ticks),
            start: ticks[0].tau(),
            hand_over: ticks[at].tau() - Vector2::new(old.force, old.moment),
            pulse: ticks[at].error(),
            parked_s: ticks[far.expect("far at first") + 1].t - ticks[at].t,
        }
    }
}

/// To a digit: README has what `sim-host` makes of its own robot, derivation and errata what an independent reference does.
#[test]
fn documents_state_both_cases_as_they_are() {
    let (line, curve) = (Scenario::paper_line(), Scenario::paper_curve());
    let neural = [&line, &curve].map(Figures::of::<Exact>);
    let plain = [&line, &curve].map(Figures::of::<PlainController<f64, Libm>>);
    let all = [&neural[0], &plain[0], &neural[1], &plain[1]];
    let one = |of: fn(&Figures) -> f64| all.map(of).to_vec();
    let two = |of: fn(&Figures) -> Vector2<f64>| -> Vec<f64> {
        all.iter().flat_map(|run| [of(run).x, of(run).y]).collect()
    };
    let mut page = Stated::of("docs/paper.md");
    let cases = |label| At::Row("What the paper's cases give", label);
    page.to_a_digit(
        cases("settled within 5 cm, 0.05 rad [s] (paper: about 5.0 and 5.2)"),
        &one(|run| run.settled_s),
    );
    page.to_a_digit(cases("final position error [mm]"), &one(|run| run.left_mm));
    page.to_a_digit(cases("peak force, moment [N, N m]"), &two(|run| run.peak));
    page.to_a_digit(
        cases("largest change per tick [N, N m]"),
        &two(|run| run.change),
    );
    page.to_a_digit(cases("step at the start [N, N m]"), &two(|run| run.start));
    page.to_a_digit(
        cases("step at the hand-over [N, N m]"),
        &two(|run| run.hand_over),
    );

    let mut derivation = Stated::of("docs/derivation.md");
    let table = |label| At::Row("7. The gain set G", label);
    let by_law = [&neural[0], &neural[1], &plain[0], &plain[1]];
    derivation.to_a_digit(
        table("settling [s] (paper: about 5.0, 5.2)"),
        &by_law.map(|run| run.settled_s),
    );
    let starts: Vec<f64> = by_law
        .iter()
        .flat_map(|run| [run.start.x, run.start.y])
        .collect();
    derivation.to_a_digit(table("first torque [N, N m]"), &starts);
    derivation.to_a_digit(
        table("torque jump at P"),
        &[
            neural[0].hand_over.amax(),
            neural[1].hand_over.amax(),
            plain[0].hand_over.x.abs(),
            plain[1].hand_over.x.abs(),
            plain[1].hand_over.y.abs(),
        ],
    );
    let pulses: Vec<f64> = neural
        .iter()
        .flat_map(|run| run.pulse.iter().copied())
        .collect();
    derivation.to_a_digit(table("pulse of (e_x, e_y, e_θ) at P"), &pulses);
    derivation.to_a_digit(
        table("parked (norm < 1 cm) after P [s]"),
        &neural.each_ref().map(|run| run.parked_s),
    );
    let ratio = |k: usize| plain[k].peak.component_div(&neural[k].peak);
    derivation.to_a_digit(
        table("peak τ₁ [N], τ₂ [N m]"),
        &[
            neural[0].peak.x,
            neural[0].peak.y,
            neural[1].peak.x,
            neural[1].peak.y,
            ratio(0).x,
            ratio(0).y,
            ratio(1).x,
            ratio(1).y,
        ],
    );
    derivation.to_a_digit(
        At::Phrase("case 1 / 2 end # / # mm off"),
        &neural.each_ref().map(|run| run.left_mm),
    );
    // A hand-over before tracking has settled.
    let early = [line, curve].map(|mut scenario| {
        let switch = scenario.switch.as_mut().expect("a paper run parks");
        // P = 3.5 s, N = 4.5 s.
        let mut reference = MovingReference::start(&scenario.reference);
        reference.move_to(&scenario.reference, 4.5);
        (switch.at, switch.target) = (3.5, reference.q);
        let goal = switch.target;
        let ticks = run::<f64, Exact>(&scenario, DT);
        let last = ticks.last().expect("a run has ticks");
        1e3 * (last.body.q - goal).xy().norm()
    });
    derivation.to_a_digit(At::Phrase("(P = 3.5 s, N = 4.5 s) leaves # / # mm"), &early);
    let mut errata = Stated::of("docs/errata.md");
    errata.to_a_digit(
        At::Phrase("# / # mm for a switch at 3.5 s to the pose at 4.5 s"),
        &early,
    );
    errata.to_a_digit(
        At::Phrase("# mm (case 1) and # mm (case 2)"),
        &neural.each_ref().map(|run| run.left_mm),
    );
}

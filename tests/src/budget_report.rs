//! Tables in Markdown: what the back ends cost, how wrong they are, and what that does to the robot.

use std::fmt::Write;

use controller_core::maths::{Libm, Maths, Micromath, Single};
use controller_core::paper::neural::NeuralController;
use controller_core::shunting::{ExactMean, NeuronUpdate, RationalMean};
use tests::core_loop::{Exact, Tick, hand_over, run};
use tests::oracle::Scenario;

use super::budget_image::Rows;
use sim_host::pil::Footprint;

/// Control period \[s\].
const DT: f64 = 1e-3;
/// A hand-over in the middle of the approach \[s\].
const EARLY_S: f64 = 1.0;

/// How wrong a back end is, and what of it is seen.
struct Effect {
    /// Largest error of sine and cosine over ±π.
    sine: f64,
    /// Final position \[m\] and heading \[rad\] against double precision, the larger of both cases.
    position: f64,
    heading: f64,
    /// Torque step at the hand-over \[N, N m\], the larger of both, where the paper has it.
    step: f64,
    /// The same at a hand-over that comes early, while the robot still turns.
    early_step: f64,
}

fn cases() -> [Scenario; 2] {
    [Scenario::paper_line(), Scenario::paper_curve()]
}

fn sine_error<M: Maths<f32>>() -> f64 {
    const COUNT: i32 = 100_000;
    (-COUNT..=COUNT)
        .map(|at| {
            let x = at as f32 * (std::f32::consts::PI / COUNT as f32);
            let (sine, cosine) = M::sin_cos(x);
            let (exact_sine, exact_cosine) = f64::from(x).sin_cos();
            f64::max(
                (f64::from(sine) - exact_sine).abs(),
                (f64::from(cosine) - exact_cosine).abs(),
            )
        })
        .fold(0.0, f64::max)
}

/// The torque of the hand-over against that of a copy which went on tracking.
fn step_of(ticks: &[Tick<f32>]) -> f64 {
    let tick = &ticks[hand_over(ticks)];
    let old = tick.unswitched.expect("a copy went on tracking").wrench;
    let new = tick.report.wrench;
    f64::from(
        (new.force - old.force)
            .abs()
            .max((new.moment - old.moment).abs()),
    )
}

fn effect<M: Maths<f32> + PartialEq, U: NeuronUpdate<f32> + PartialEq>() -> Effect {
    let mut effect = Effect {
        sine: sine_error::<M>(),
        position: 0.0,
        heading: 0.0,
        step: 0.0,
        early_step: 0.0,
    };
    for scenario in cases() {
        let single = run::<f32, NeuralController<f32, M, U>>(&scenario, DT);
        let double = run::<f64, Exact>(&scenario, DT);
        let last = |q: Option<nalgebra::Vector3<f64>>| q.expect("a run has ticks");
        let difference = last(single.last().map(|tick| tick.body.q))
            - last(double.last().map(|tick| tick.body.q));
        effect.position = effect.position.max(difference.xy().norm());
        effect.heading = effect.heading.max(difference.z.abs());
        effect.step = effect.step.max(step_of(&single));
        let mut early = scenario;
        if let Some(switch) = &mut early.switch {
            switch.at = EARLY_S;
        }
        let early = run::<f32, NeuralController<f32, M, U>>(&early, DT);
        effect.early_step = effect.early_step.max(step_of(&early));
    }
    effect
}

/// Each back end: cost, error, effect.
pub fn back_ends(cost: &Rows) -> String {
    let rows: [(&str, &str, Option<Effect>); 5] = [
        (
            "**Single + RationalMean (default)**",
            "single+rational",
            Some(effect::<Single, RationalMean>()),
        ),
        (
            "Single + ExactMean",
            "single+exact",
            Some(effect::<Single, ExactMean>()),
        ),
        (
            "Libm + ExactMean",
            "libm+exact",
            Some(effect::<Libm, ExactMean>()),
        ),
        (
            "Micromath + RationalMean",
            "micromath+rational",
            Some(effect::<Micromath, RationalMean>()),
        ),
        ("f64, Libm + ExactMean", "f64-libm+exact", None),
    ];
    let mut text = String::from(
        "| back end | tracking | parking | hand-over | stack, B | error of sin, cos | final position, m | final heading, rad | torque step at the paper's hand-over, N, N m | at one after 1 s |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for (name, path, effect) in rows {
        let tick = |part: &str| cost.show(&format!("tick/{path}/{part}/ordinary"));
        let stack = |part: &str| cost.most(&format!("stack/{path}/{part}"));
        let stack = stack("track").max(stack("park"));
        let effect = effect.map_or_else(
            || "(what is compared with) | | | | |".to_owned(),
            |e| {
                format!(
                    "{:.1e} | {:.1e} | {:.1e} | {:.1e} | {:.1e} |",
                    e.sine, e.position, e.heading, e.step, e.early_step
                )
            },
        );
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {} | {stack} | {effect}",
            tick("track"),
            tick("park"),
            tick("hand-over")
        );
    }
    text
}

/// The default by kind of input.
pub fn inputs(cost: &Rows) -> String {
    let mut text = String::from(
        "| default back end | ordinary | heading one turn off | torque limited | large errors |\n| --- | --- | --- | --- | --- |\n",
    );
    for part in [
        "track",
        "track-with-reference",
        "park",
        "start",
        "hand-over",
        "monitor",
    ] {
        let show = |kind: &str| cost.show(&format!("tick/single+rational/{part}/{kind}"));
        let _ = writeln!(
            text,
            "| {part} | {} | {} | {} | {} |",
            show("ordinary"),
            show("wrapped"),
            show("saturated"),
            show("large")
        );
    }
    text
}

/// What a tick is made of, and what stands beside it.
pub fn parts(cost: &Rows) -> String {
    let mut text =
        String::from("| function | Single | Libm | Micromath |\n| --- | --- | --- | --- |\n");
    for function in [
        "sin_cos",
        "sin_cos_near",
        "sin_cos-beyond-1e4",
        "asin",
        "atan2",
        "sqrt",
        "exp_m1",
    ] {
        let show = |back_end: &str| cost.show(&format!("maths/{back_end}/{function}"));
        let _ = writeln!(
            text,
            "| {function} | {} | {} | {} |",
            show("single"),
            show("libm"),
            show("micromath")
        );
    }
    text.push_str("\n| part | instructions |\n| --- | --- |\n");
    for (name, row) in [
        ("angle wrap, inside (−π, π]", "wrap/inside"),
        ("angle wrap, one turn off", "wrap/one-turn-off"),
        ("angle wrap, beyond 1e4 rad", "wrap/beyond-1e4"),
        ("neuron, RationalMean", "neuron/rational"),
        ("neuron, ExactMean", "neuron/exact"),
        ("reference from numbers", "reference/new"),
        ("reference between two samples", "reference/interpolate"),
        ("odometry", "odometry/update"),
        ("localiser without a fix", "localiser/without-fix"),
        ("localiser with a fix", "localiser/with-fix"),
        ("motor, both wheels", "motor/commands"),
        ("motion law, following", "motion/follow"),
        ("motion law, searching for a manoeuvre", "motion/plan"),
        ("motion law, searches every 1 ms", "motion/search-1ms"),
        ("motion law, searches every 10 ms", "motion/search-10ms"),
        ("motion law, parking", "motion/park"),
        ("leading to a path's end, a tick of it", "motion/lead"),
        ("whole base, following", "base/follow"),
        ("whole base, searching for a manoeuvre", "base/plan"),
        ("whole base, parking", "base/park"),
        ("whole base, fixes, following", "base/follow-fused"),
        ("whole base, fixes, parking", "base/park-fused"),
        ("whole base, a tick with a fix", "base/with-fix"),
        ("a robot of `bases/` to duties, following", "shipped/follow"),
        ("the same, parking", "shipped/park"),
        ("the same, searching for a manoeuvre", "shipped/plan"),
        ("the same, by velocity", "shipped/velocity"),
        ("the same, a tick with a fix", "shipped/with-fix"),
        ("link: decode a tick's question", "wire/decode-tick"),
        ("link: encode a report", "wire/encode-report"),
        ("telemetry into the queue", "wire/telemetry-offer"),
    ] {
        let _ = writeln!(text, "| {name} | {} |", cost.show(row));
    }
    text
}

/// The controller beside others in the same harness.
pub fn peers(cost: &Rows, peers: &Rows) -> String {
    let mut text = String::from("| in the same harness | instructions |\n| --- | --- |\n");
    let tick = |part: &str| cost.show(&format!("tick/{part}/ordinary"));
    for (name, value) in [
        (
            "**this controller, tracking**",
            tick("single+rational/track"),
        ),
        ("**this controller, parking**", tick("single+rational/park")),
        ("plain backstepping, tracking", tick("plain-single/track")),
        ("plain backstepping, parking", tick("plain-single/park")),
        ("two PIDs of `pid`", peers.show("peer/pid-pair")),
        (
            "two biquads of `idsp`, transposed form",
            peers.show("peer/biquad-df2t-pair"),
        ),
        (
            "two biquads of `idsp`, direct form, clamped",
            peers.show("peer/biquad-df1-clamped-pair"),
        ),
        (
            "odometry, Ramsete, two PIDs with feed-forward",
            peers.show("peer/stack"),
        ),
    ] {
        let _ = writeln!(text, "| {name} | {value} |");
    }
    text
}

/// Every board and opt level.
pub fn images(all: &[(&str, &str, &Rows, &Rows, Footprint)]) -> String {
    let mut text = String::from(
        "| target, opt level | tracking | parking | start | hand-over | stack of a tick | pil: flash | RAM | stack |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for (board, level, cost, pil, size) in all {
        let tick = |part: &str| cost.show(&format!("tick/single+rational/{part}/ordinary"));
        let stack = cost
            .most("stack/single+rational/track")
            .max(cost.most("stack/single+rational/park"));
        let _ = writeln!(
            text,
            "| {board}, {level} | {} | {} | {} | {} | {stack} | {} | {} | {} |",
            tick("track"),
            tick("park"),
            tick("start"),
            tick("hand-over"),
            size.flash(),
            size.ram(),
            pil.most("stack/pil")
        );
    }
    text
}

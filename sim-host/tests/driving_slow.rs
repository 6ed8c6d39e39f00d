//! Driving slowly on bad floors: how evenly, and whether the base stands in between.

use controller_core::base::Order;
use controller_core::queue::ReferenceQueue;
use controller_core::safety::supervisor::State;
use controller_core::types::{Measured, Twist};
use protocol::Command;
use sim_host::closed_loop::ClosedLoop;
use sim_host::mission::{BaseSpec, Course, End, Mission};
use sim_host::precision::Precision;
use sim_host::trials::{Condition, setup};

/// What is ordered \[m/s\] or \[rad/s\], in either direction.
pub const ORDERS: [Twist<f64>; 4] = [
    Twist::new(0.02, 0.0),
    Twist::new(-0.02, 0.0),
    Twist::new(0.0, 0.05),
    Twist::new(0.0, -0.05),
];

/// Length of a window \[s\].
const WINDOW_S: f64 = 1.0;
/// A base is loose once it has this share of what is ordered, and stands below this share.
const LOOSE: f64 = 0.5;
const STANDS: f64 = 0.05;
/// After breaking loose the speed settles for as long \[s\].
const SETTLE_S: f64 = 2.0;

/// What came of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Slow {
    /// When the base broke loose \[s\].
    pub loose_s: f64,
    /// Largest deviation from what is ordered, as root of the mean square over a window, as a share of the order.
    pub rms: f64,
    /// The same of the speed that the encoders give.
    pub measured: f64,
    /// Mean true speed over the order, after settling.
    pub mean: f64,
    /// Longest standstill after breaking loose \[s\].
    pub stood_s: f64,
    /// It was still driving at the end.
    pub drives: bool,
}

/// A mission that only drives by velocity.
fn mission(base: &BaseSpec, longest_s: f64) -> Mission {
    Mission {
        name: "slow".to_owned(),
        description: String::new(),
        base: base.clone(),
        robot: base.robot,
        precision: Precision::F32,
        start: Measured::default(),
        course: Course::Drive,
        events: Vec::new(),
        period_s: base.period_s(),
        end: End::At(longest_s),
        setup: None,
    }
}

/// Drives with one order for a time.
pub fn drive(base: &BaseSpec, order: &Twist<f64>, seed: u64, longest_s: f64) -> Slow {
    let world = setup(base, Condition::Drawn, seed);
    let mission = mission(base, longest_s);
    let mut queue = ReferenceQueue::<f32, 2>::new();
    let mut closed = ClosedLoop::new(queue.split().1, &mission, &world, None).expect("valid");
    let asked = Order::Drive {
        twist: order.cast(),
        hold_heading: false,
    };
    let turns = order.angular != 0.0;
    let of = |twist: &Twist<f64>| if turns { twist.angular / order.angular } else { twist.linear / order.linear };
    let mut slow = Slow::default();
    let mut loose = false;
    let (mut standing, mut count, mut sum) = (0.0, 0, 0.0);
    let mut window: Vec<(f64, f64)> = Vec::new();
    let ticks = (WINDOW_S / mission.period_s).round() as usize;
    loop {
        closed.advance().expect("a world takes what a base commands");
        let t = 1.0e-6 * closed.world().now_us() as f64;
        if t > longest_s {
            break;
        }
        let report = closed.report();
        if report.state == State::Idle && report.measured.is_some() {
            closed.command(&Command::Arm).expect("no mirror").expect("idle");
        }
        let report = closed.tick(&asked).expect("no mirror");
        if std::env::var("TRACE").is_ok() && t < 8.0 {
            let r = *report; let m = r.motion.unwrap_or_default(); let d = match r.action { controller_core::base::WheelAction::Drive(d) => d, _ => Default::default() };
            let tr = closed.world().truth().twist; let tr = Twist::new(tr.linear, if turns {tr.angular} else {tr.linear}); let mm = r.measured.unwrap_or_default().twist; let mw = if turns {mm.angular} else {mm.linear};
            let c = closed.world().counts().unwrap();
            println!("{t:.3} true {:.4} meas {:.4} cmd {:.4} d {:.4} M {:.4} tr {:.4} tl {:.4} wr {:.3} wl {:.3} bey {:.4} {:.4} c {} {} lim {}", tr.angular, mw, m.command.linear, m.disturbance.moment, m.wrench.moment, m.torques.right, m.torques.left, d.speeds.right, d.speeds.left, d.beyond_coulomb.unwrap_or_default().right, d.beyond_coulomb.unwrap_or_default().left, c.right, c.left, m.limited.disturbance);
        }
        let report = closed.report();
        let believed = report.measured.map_or(0.0, |measured| of(&measured.twist.cast()));
        let truth = of(&closed.world().truth().twist);
        if !loose && truth > LOOSE {
            (loose, slow.loose_s) = (true, t);
        }
        if !loose {
            continue;
        }
        standing = if truth.abs() < STANDS { standing + mission.period_s } else { 0.0 };
        slow.stood_s = slow.stood_s.max(standing);
        if t < slow.loose_s + SETTLE_S {
            continue;
        }
        count += 1;
        sum += truth;
        window.push((truth - 1.0, believed - 1.0));
        if window.len() >= ticks {
            let last = &window[window.len() - ticks..];
            let rms = |of: fn(&(f64, f64)) -> f64| (last.iter().map(|w| of(w).powi(2)).sum::<f64>() / ticks as f64).sqrt();
            slow.rms = slow.rms.max(rms(|w| w.0));
            slow.measured = slow.measured.max(rms(|w| w.1));
        }
    }
    slow.mean = sum / f64::from(count.max(1));
    slow.drives = closed.report().state == State::Tracking;
    slow
}

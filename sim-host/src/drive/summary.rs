//! A run in a few lines, for people.

use super::metrics::{DriveMetrics, LimitUse};
use std::fmt::Write as _;

/// What came of a run, a line for each thing.
pub fn summary(metrics: &DriveMetrics) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let mut line = |name: &str, what: String| {
        let _ = writeln!(text, "{name:<11}{what}");
    };
    match &metrics.tracking {
        Some(t) => line(
            "tracking",
            format!(
                "from {:.2} s to {:.2} s: {:.2} mm RMS, {:.2} mm peak; {:.2} mrad RMS, {:.2} peak",
                t.from_s,
                t.to_s,
                1e3 * t.rms_m,
                1e3 * t.peak_m,
                1e3 * t.heading_rms_rad,
                1e3 * t.heading_peak_rad
            ),
        ),
        None if !metrics.has_path => {}
        None => line(
            "tracking",
            "none: never within 5 mm of a moving reference".into(),
        ),
    }
    if let (Some(hand_over), Some(way)) = (&metrics.run.hand_over, metrics.hand_over_distance_m) {
        line(
            "hand-over",
            format!(
                "at {:.2} s, {} mm to go; torque step {:.1e} N, {:.1e} N m; overshoot {:.2} mm",
                hand_over.time_s,
                tenths(1e3 * way),
                hand_over.torque_step.force_n.abs(),
                hand_over.torque_step.moment_nm.abs(),
                1e3 * hand_over.overshoot_m
            ),
        );
    }
    let last = &metrics.run.final_error;
    let final_error = format!(
        "final error {:.3} mm, {:.3} mrad",
        1e3 * last.position_m,
        1e3 * last.e_theta_rad.abs()
    );
    line(
        metrics.outcome,
        match metrics.parked_s {
            Some(time) => format!("from {time:.2} s on; {final_error}"),
            None => final_error,
        },
    );
    if let Some(stop) = &metrics.stopped {
        line(
            stop.state,
            format!("{} at {:.2} s", stop.cause, stop.time_s),
        );
    }
    let uses: Vec<_> = metrics.limits.iter().map(peak).collect();
    line("peaks", format!("of their limits: {}", uses.join(", ")));
    text
}

/// The peak of what is limited.
fn peak(of: &LimitUse) -> String {
    let (name, unit) = of.name.split_once(" [").unwrap_or((of.name, ""));
    let [peak, limit] = [of.peak, of.limit].map(short);
    let unit = unit.trim_end_matches(']');
    // Of the commands only accelerations are, and only there.
    let beyond = match peak > limit {
        true => " (beyond it for some ticks: braking went through rest, and jerk is limited)",
        false => "",
    };
    format!("{name} {peak} of {limit} {unit}{beyond}")
}

/// With one digit, and 0 without a sign.
fn tenths(value: f64) -> String {
    format!("{:.1}", (10.0 * value).round() / 10.0 + 0.0)
}

fn short(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::tenths;

    #[test]
    fn nothing_to_go_has_no_sign() {
        let written = [-0.04, -0.0, 0.0, -0.06, 12.34].map(tenths);
        assert_eq!(written, ["0.0", "0.0", "0.0", "-0.1", "12.3"]);
    }
}

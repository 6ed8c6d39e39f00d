//! A line drawn by hand as a trajectory file: smoothed, with headings along it, from rest to rest, in between at one speed.
//!
//! The file then goes the way of every file: fitted, retimed within the limits of the base, followed.

use controller_core::maths::{Libm, Maths};
use std::fmt::Write as _;

/// Way between two points of the line while it is smoothed \[m\].
const STEP_M: f64 = 0.02;
/// Points that are averaged on either side, and how often: corners are rounded to about 0.15 m, and a hand's shaking is gone.
const SMOOTHED: (usize, usize) = (5, 4);
/// Way between two samples of the file \[m\].
const SAMPLE_M: f64 = 0.08;
/// Shortest line that is followed \[m\].
const SHORTEST_M: f64 = 0.2;

/// A table of samples for a line of points \[m\] driven at a speed \[m/s\]; none if it is too short.
pub fn table(points: &[[f64; 2]], speed: f64) -> Option<String> {
    let mut line = evenly(points, STEP_M);
    if (line.len() as f64) * STEP_M < SHORTEST_M {
        return None;
    }
    for _ in 0..SMOOTHED.1 {
        line = averaged(&line, SMOOTHED.0);
    }
    let line = evenly(&line, SAMPLE_M);
    let mut text = "t,x,y,theta,v\n".to_owned();
    let (mut t, mut heading) = (0.0, None);
    for (n, point) in line.iter().enumerate() {
        let before = line.get(n.wrapping_sub(1)).unwrap_or(point);
        let after = line.get(n + 1).unwrap_or(point);
        let along = Libm::atan2(after[1] - before[1], after[0] - before[0]);
        let turned = heading.map_or(along, |last: f64| {
            last + controller_core::angle::wrap(along - last)
        });
        heading = Some(turned);
        let (is_first, is_last) = (n == 0, n + 1 == line.len());
        let at_end = n == 1 || is_last;
        // From rest and to rest: half as fast on the way there.
        t += distance(before, point) / (if at_end { 0.5 * speed } else { speed });
        let v = if is_first || is_last { 0.0 } else { speed };
        let [x, y] = point;
        // Writing to a string does not fail.
        let _ = writeln!(text, "{t:.6},{x:.6},{y:.6},{turned:.6},{v:.6}");
    }
    Some(text)
}

fn distance(a: &[f64; 2], b: &[f64; 2]) -> f64 {
    let [x, y] = [b[0] - a[0], b[1] - a[1]];
    Libm::sqrt(x * x + y * y)
}

/// Points on the line at equal ways, its ends among them; the ways are the nearest to `step` that fits.
fn evenly(points: &[[f64; 2]], step: f64) -> Vec<[f64; 2]> {
    let way: f64 = points.windows(2).map(|w| distance(&w[0], &w[1])).sum();
    let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
        return Vec::new();
    };
    let pieces = (way / step).round().max(1.0);
    let step = way / pieces;
    let mut line = vec![first];
    let (mut passed, mut next) = (0.0, step);
    for pair in points.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let length = distance(&a, &b);
        while next <= passed + length && (line.len() as f64) < pieces {
            let share = (next - passed) / length;
            line.push([a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]);
            next += step;
        }
        passed += length;
    }
    line.push(last);
    line
}

/// The mean of each point and its neighbours, fewer towards the ends, which stay.
fn averaged(line: &[[f64; 2]], reach: usize) -> Vec<[f64; 2]> {
    let last = line.len().saturating_sub(1);
    (0..line.len())
        .map(|n| {
            let reach = reach.min(n).min(last - n);
            let near = &line[n - reach..=n + reach];
            let mean = |axis: usize| near.iter().map(|p| p[axis]).sum::<f64>() / near.len() as f64;
            [mean(0), mean(1)]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sim_host::drive::{Retiming, fitted};
    use sim_host::scenario::BASES;

    /// A right angle, a hand's noise and uneven points, as browsers give them.
    fn shaken() -> Vec<[f64; 2]> {
        let along = (0..60).map(|n| [0.03 * f64::from(n), 0.004 * f64::from(n % 3)]);
        let up = (1..30).map(|n| [1.77 + 0.004 * f64::from(n % 2), 0.06 * f64::from(n)]);
        along.chain(up).collect()
    }

    #[test]
    fn a_shaken_line_with_a_corner_is_drivable_on_every_base() {
        for built_in in BASES {
            let base = built_in.base().expect("a base");
            let speed = 0.5 * base.limits.speed;
            let text = table(&shaken(), speed).expect("long enough");
            let (trajectory, _) = fitted(text.as_bytes(), &base, &Retiming::default())
                .unwrap_or_else(|error| panic!("{}: {error}", built_in.name));
            let last = trajectory.at(trajectory.duration());
            let [x, y] = *shaken().last().expect("points");
            let off = Libm::sqrt((last.x - x).powi(2) + (last.y - y).powi(2));
            // The importer's tolerance.
            assert!(
                off < 2.0e-3,
                "{}: ends {off} m beside the line",
                built_in.name
            );
            assert!(last.v.abs() < 1.0e-3, "{}: does not rest", built_in.name);
        }
    }

    #[test]
    fn a_click_is_no_line() {
        assert_eq!(table(&[[0.0, 0.0], [0.05, 0.0]], 0.5), None);
        assert_eq!(table(&[], 0.5), None);
    }
}

//! Fewer points for the same picture.

/// The points of a polyline that matter: no dropped point is further than `tolerance` from the
/// line that is left. Ramer (1972), Douglas and Peucker (1973).
///
/// Jumps and single-tick spikes survive, which taking every n-th point does not guarantee.
/// `scale` turns data units into the units of `tolerance`, usually pixels.
pub fn thin_out(points: &[(f64, f64)], scale: (f64, f64), tolerance: f64) -> Vec<(f64, f64)> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut keep = vec![false; points.len()];
    let last = points.len() - 1;
    keep[0] = true;
    keep[last] = true;
    // A stack instead of recursion: a trace has as many levels as a noisy signal likes.
    let mut spans = vec![(0, last)];
    while let Some((from, to)) = spans.pop() {
        let mut furthest = (from, tolerance);
        for (index, point) in points.iter().enumerate().take(to).skip(from + 1) {
            let distance = distance(*point, points[from], points[to], scale);
            if distance > furthest.1 {
                furthest = (index, distance);
            }
        }
        if furthest.0 > from {
            keep[furthest.0] = true;
            spans.push((from, furthest.0));
            spans.push((furthest.0, to));
        }
    }
    let kept = points.iter().zip(keep).filter(|(_, keep)| *keep);
    kept.map(|(point, _)| *point).collect()
}

/// Distance of `p` from the segment from `a` to `b`, after scaling.
fn distance(p: (f64, f64), a: (f64, f64), b: (f64, f64), scale: (f64, f64)) -> f64 {
    let minus = |p: (f64, f64), q: (f64, f64)| ((p.0 - q.0) * scale.0, (p.1 - q.1) * scale.1);
    let (along, to_p) = (minus(b, a), minus(p, a));
    let length2 = along.0 * along.0 + along.1 * along.1;
    let share = if length2 > 0.0 {
        ((to_p.0 * along.0 + to_p.1 * along.1) / length2).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (to_p.0 - share * along.0).hypot(to_p.1 - share * along.1)
}

#[cfg(test)]
mod tests {
    use super::thin_out;

    #[test]
    fn a_straight_line_needs_its_ends_only() {
        let points: Vec<_> = (0..1000)
            .map(|i| (f64::from(i), 2.0 * f64::from(i)))
            .collect();
        assert_eq!(thin_out(&points, (1.0, 1.0), 0.1), [points[0], points[999]]);
    }

    #[test]
    fn a_spike_of_one_tick_survives() {
        let spike = |i: i32| (f64::from(i), if i == 500 { 1.0 } else { 0.0 });
        let points: Vec<_> = (0..1000).map(spike).collect();
        let kept = thin_out(&points, (1.0, 100.0), 0.5);
        assert!(kept.contains(&(500.0, 1.0)) && kept.len() <= 6, "{kept:?}");
    }
}

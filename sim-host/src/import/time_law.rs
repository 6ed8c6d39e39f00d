//! From the squared rate of time to a smooth law of time.

use super::time_warp::{Tick, TimeWarp};

/// Smooths q without ever raising it: the least of a window, then two means over half of it each.
/// Accelerations that jumped with q′ then take `2 half` grid points to change.
pub(super) fn smoothed(q: &[f64], half: usize) -> Vec<f64> {
    let least = least_within(q, 2 * half);
    mean_within(&mean_within(&least, half), half)
}

/// The least value within `radius` places of each; by a monotone queue, so linear.
fn least_within(values: &[f64], radius: usize) -> Vec<f64> {
    let mut queue: std::collections::VecDeque<(usize, f64)> = std::collections::VecDeque::new();
    let mut coming = values.iter().copied().enumerate();
    let mut least = Vec::with_capacity(values.len());
    for i in 0..values.len() {
        while queue.back().is_none_or(|(j, _)| *j < i + radius) {
            let Some((j, value)) = coming.next() else {
                break;
            };
            while queue.back().is_some_and(|(_, last)| *last >= value) {
                queue.pop_back();
            }
            queue.push_back((j, value));
        }
        while queue.front().is_some_and(|(j, _)| j + radius < i) {
            queue.pop_front();
        }
        least.push(queue.front().map_or(1.0, |(_, value)| *value));
    }
    least
}

/// The mean within `radius` places of each; the ends are continued.
fn mean_within(values: &[f64], radius: usize) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let at = |i: isize| {
        let i = usize::try_from(i).unwrap_or(0).min(last);
        values.get(i).copied().unwrap_or(1.0)
    };
    let (r, width) = (radius as isize, (2 * radius + 1) as f64);
    // Each sum is taken afresh: a running one would lose the 1 of an unscaled part to rounding.
    (0..values.len() as isize)
        .map(|i| {
            let window = (i - r)..=(i + r);
            if window.clone().all(|j| at(j) == at(i)) {
                at(i)
            } else {
                window.map(at).sum::<f64>() / width
            }
        })
        .collect()
}

/// The law of time with q at grid points `ds` apart.
pub(super) fn law(q: &[f64], ds: f64) -> TimeWarp {
    let last = q.len().saturating_sub(1);
    let mut ticks: Vec<Tick> = Vec::with_capacity(q.len());
    for (i, &here) in q.iter().enumerate() {
        let before = q.get(i.saturating_sub(1)).copied().unwrap_or(here);
        let after = q.get((i + 1).min(last)).copied().unwrap_or(here);
        let span = ((i + 1).min(last) - i.saturating_sub(1)) as f64 * ds;
        let rate = here.sqrt();
        let t = ticks.last().map_or(0.0, |tick| {
            // Exact for q linear in s.
            tick.t + 2.0 * ds / (tick.rate + rate)
        });
        ticks.push(Tick {
            t,
            s: i as f64 * ds,
            rate,
            rate_dot: if span > 0.0 {
                0.5 * (after - before) / span
            } else {
                0.0
            },
        });
    }
    TimeWarp::new(ticks)
}

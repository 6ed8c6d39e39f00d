//! What tyres hold.

use super::log::Log;
use controller_core::wheels::WheelGeometry;

/// Time over which speeds are taken \[s\]: counts are then fine, and a glitch of one row is in two windows only.
const WINDOW_S: f64 = 0.25;
/// Share of the windows that says how hard a robot drove; the rest may be wheels that slide, or glitches.
const SHARE: f64 = 0.95;
/// Largest acceleration of a robot on tyres \[m/s²\]: 6 g, of mice that suck themselves to the floor of their maze (without suction
/// rubber holds 1 to 2 g).
pub(super) const MOST_M_S2: f64 = 60.0;

/// The acceleration along and across that all but a twentieth of the log keep \[m/s²\], by its wheel angles and these lengths; none
/// of a log that is too short.
pub(super) fn acceleration_m_s2(log: &Log, wheels: &WheelGeometry<f64>) -> Option<f64> {
    let mut rows = Vec::new();
    for (row, t) in log.t.iter().enumerate() {
        if rows.last().is_none_or(|last| t - log.t[*last] >= WINDOW_S) {
            rows.push(row);
        }
    }
    let twist = |pair: &[usize]| {
        let dt = log.t[pair[1]] - log.t[pair[0]];
        let [right, left] = [0, 1].map(|i| (log.angle[pair[1]][i] - log.angle[pair[0]][i]) / dt);
        let (right, left) = (wheels.radius_right_m * right, wheels.radius_left_m * left);
        let middle = 0.5 * (log.t[pair[0]] + log.t[pair[1]]);
        (
            middle,
            0.5 * (right + left),
            (right - left) / wheels.track_m,
        )
    };
    let twists: Vec<_> = rows.windows(2).map(twist).collect();
    let pairs = twists.windows(2);
    let mut all: Vec<f64> = pairs
        .map(|pair| {
            let ((t, v, w), (later, faster, turning)) = (pair[0], pair[1]);
            let across = 0.25 * (v + faster) * (w + turning);
            ((faster - v) / (later - t)).hypot(across)
        })
        .collect();
    all.sort_by(f64::total_cmp);
    let rank = (SHARE * all.len() as f64) as usize;
    all.get(rank).copied()
}

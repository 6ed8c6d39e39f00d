//! Least times from rest to rest, by optimal control.
//!
//! `parking.csv` has starts (x, y, θ) of a park at the origin, drawn evenly over distances of 0.1 to 3 m, and the least time of
//! each within the limits of the base files, jerk included: direct multiple shooting over a hundred intervals, an
//! interior-point solver, 17 first guesses each, the best three of 40 intervals refined. Feasible motions: upper bounds of the
//! true minimum. They are to be computed anew when a base file's limits change; [`Pool::of`] refuses those of other
//! limits.

use crate::mission::BaseSpec;
use controller_core::types::Pose;

/// A start with its least time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Where it starts; the goal is the origin.
    pub pose: Pose<f64>,
    /// Least time to rest exactly at the goal \[s\].
    pub minimum_s: f64,
    /// Turning, driving and turning with jerk-limited trapezoids \[s\].
    pub turn_drive_turn_s: f64,
}

/// Starts of a base.
#[derive(Clone, Debug, PartialEq)]
pub struct Pool(pub Vec<Start>);

/// Base, x, y, θ, least time, time of turning, driving and turning.
const STARTS: &str = include_str!("parking.csv");

/// Speed, turn rate, accel, brake, turn accel, jerk and turn jerk that the times are for.
const LIMITS: [(&str, [f64; 7]); 3] = [
    ("paper-30kg", [2.5, 3.0, 1.5, 1.5, 0.9, 20.0, 40.0]),
    ("lab-10kg", [1.2, 3.0, 1.0, 1.5, 6.0, 20.0, 80.0]),
    ("hobby-1kg", [0.8, 6.0, 1.5, 1.5, 15.0, 30.0, 300.0]),
];

impl Pool {
    /// The starts of a built-in base; none for one of other limits.
    pub fn of(name: &str, base: &BaseSpec) -> Option<Self> {
        let (_, limits) = LIMITS.iter().find(|(of, _)| *of == name)?;
        let own = &base.limits;
        let own = [
            own.speed,
            own.turn_rate,
            own.accel,
            own.brake,
            own.turn_accel,
            own.jerk,
            own.turn_jerk,
        ];
        (own == *limits).then(|| {
            Self(
                STARTS
                    .lines()
                    .filter_map(|line| start(line, name))
                    .collect(),
            )
        })
    }
}

fn start(line: &str, name: &str) -> Option<Start> {
    let numbers = line.strip_prefix(name)?.strip_prefix(',')?;
    let mut numbers = numbers
        .split(',')
        .map(|field| field.trim().parse::<f64>().ok());
    let mut next = || numbers.next().flatten();
    Some(Start {
        pose: Pose::new(next()?, next()?, next()?),
        minimum_s: next()?,
        turn_drive_turn_s: next()?,
    })
}

/// Time of a change of speed by `change` from a steady one to another, within an acceleration and a jerk \[s\].
pub fn change_s(change: f64, accel: f64, jerk: f64) -> f64 {
    let change = change.abs();
    if change >= accel * accel / jerk {
        change / accel + accel / jerk
    } else {
        2.0 * (change / jerk).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::Pool;
    use crate::scenario::BASES;

    #[test]
    fn every_base_has_starts_that_no_turning_and_driving_beats() {
        for built_in in BASES {
            let base = built_in.base().unwrap_or_else(|error| panic!("{error}"));
            let pool = Pool::of(built_in.name, &base).expect("the limits are those of the file");
            assert!(pool.0.len() >= 150, "{}", pool.0.len());
            for start in &pool.0 {
                let way = start.pose.x.hypot(start.pose.y);
                // No base is faster than its largest speed.
                assert!(start.minimum_s > way / base.limits.speed, "{start:?}");
                assert!(start.minimum_s < start.turn_drive_turn_s, "{start:?}");
            }
        }
    }
}

//! Where the robot was: the last poses of odometry.

use crate::scalar::Scalar;
use crate::types::Pose;

/// Poses are kept this far apart at least \[s\]: N of them reach as far back in a loop of 1 kHz as in one of 250 Hz.
pub const LEAST_APART_S: f64 = 0.004;

/// A ring of N poses, fixed in size, written at every tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct History<T, const N: usize> {
    entries: [Entry<T>; N],
    /// Index and number of the newest.
    newest: usize,
    filled: usize,
    /// Time from the one before it \[s\]; of the start one that leaves it alone.
    newest_s: T,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Entry<T> {
    pose: Pose<T>,
    /// Time since the entry before it \[s\]. Differences, since a clock of single precision loses its
    /// milliseconds in an hour.
    dt: T,
}

impl<T: Scalar, const N: usize> History<T, N> {
    /// Of a robot at the origin.
    pub(super) fn new() -> Self {
        Self {
            entries: [Entry::default(); N],
            newest: 0,
            filled: 1,
            newest_s: T::from_f64(LEAST_APART_S),
        }
    }

    /// Nothing is older than this pose.
    pub(super) fn begin(&mut self, pose: Pose<T>) {
        (self.newest, self.filled) = (0, 1);
        self.newest_s = T::from_f64(LEAST_APART_S);
        if let Some(first) = self.entries.first_mut() {
            *first = Entry { pose, dt: T::ZERO };
        }
    }

    pub(super) fn push(&mut self, pose: Pose<T>, dt: T) {
        if self.newest_s < T::from_f64(LEAST_APART_S) {
            return self.replace(pose, self.newest_s + dt);
        }
        self.newest_s = dt;
        self.newest = if self.newest + 1 < N {
            self.newest + 1
        } else {
            0
        };
        if let Some(entry) = self.entries.get_mut(self.newest) {
            *entry = Entry { pose, dt };
        }
        if self.filled < N {
            self.filled += 1;
        }
    }

    /// The newest pose, where it is too near to the one before it for another. Apart from what a loop of 250 Hz and less needs.
    #[cold]
    #[inline(never)]
    fn replace(&mut self, pose: Pose<T>, dt: T) {
        self.newest_s = dt;
        if let Some(entry) = self.entries.get_mut(self.newest) {
            *entry = Entry { pose, dt };
        }
    }

    /// The pose `age_s` ≥ 0 ago, on the chord between two ticks: off an arc by v w dt²/8, 15 µm at
    /// 0.4 m/s, 3 rad/s and 10 ms. `Err` is the age of the oldest pose.
    pub(super) fn at(&self, age_s: T) -> Result<Pose<T>, T> {
        let mut index = self.newest;
        let mut age = T::ZERO;
        for _ in 1..self.filled {
            let before = if index == 0 { N - 1 } else { index - 1 };
            let (Some(later), Some(earlier)) = (self.entries.get(index), self.entries.get(before))
            else {
                break;
            };
            let oldest = age + later.dt;
            if age_s <= oldest {
                let share = (age_s - age) / later.dt;
                return Ok(between(&later.pose, &earlier.pose, share));
            }
            age = oldest;
            index = before;
        }
        // The start itself, of which nothing is older.
        match self.entries.get(index) {
            Some(entry) if age_s <= age => Ok(entry.pose),
            _ => Err(age),
        }
    }
}

fn between<T: Scalar>(from: &Pose<T>, to: &Pose<T>, share: T) -> Pose<T> {
    Pose {
        x: from.x + share * (to.x - from.x),
        y: from.y + share * (to.y - from.y),
        theta: from.theta + share * (to.theta - from.theta),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At 1 kHz and 0.5 m/s 32 poses are 4 ms apart, but for the newest: they reach back for 121 to 124 ms, and every age in that time gives the pose of then.
    #[test]
    fn fast_ticks_are_remembered_for_as_long_as_slow_ones() {
        for ticks in [200, 201, 202, 203] {
            let mut history = History::<f64, 32>::new();
            history.begin(Pose::new(0.0, 0.0, 0.0));
            for tick in 1..=ticks {
                history.push(Pose::new(0.5e-3 * f64::from(tick), 0.0, 0.0), 1.0e-3);
            }
            let oldest = history.at(1.0).expect_err("too old");
            assert!((0.1205..0.1245).contains(&oldest), "{oldest}");
            for age in [0.0, 0.5e-3, 7.3e-3, 0.05, 0.12] {
                let pose = history.at(age).expect("remembered");
                let expected = 0.5 * (1.0e-3 * f64::from(ticks) - age);
                assert!((pose.x - expected).abs() < 1e-12, "{age}: {pose:?}");
            }
        }
    }

    /// Ticks that are no part of 4 ms, or a little longer than one: all but the newest pose are 4 ms apart at least.
    #[test]
    fn poses_are_as_far_apart_as_stated_however_long_ticks_are() {
        for tick_s in [
            0.3e-3, 0.97e-3, 1.01e-3, 2.02e-3, 3.0e-3, 4.0e-3, 4.1e-3, 1.0e-2,
        ] {
            let mut history = History::<f64, 32>::new();
            history.begin(Pose::default());
            for _ in 0..1000 {
                history.push(Pose::default(), tick_s);
                let apart = LEAST_APART_S.max(tick_s);
                let full = history.filled == 32;
                let oldest = history.at(10.0).expect_err("too old");
                assert!(
                    !full || oldest > 30.0 * apart + tick_s - 1e-9,
                    "{tick_s}: {oldest}"
                );
            }
        }
    }

    /// Nothing is forgotten of a start that is more recent than that.
    #[test]
    fn a_start_stays_the_oldest() {
        let mut history = History::<f64, 32>::new();
        history.begin(Pose::new(1.0, 0.0, 0.0));
        for tick in 1..=6 {
            history.push(Pose::new(1.0 + f64::from(tick), 0.0, 0.0), 1.0e-3);
            let start = history.at(1.0e-3 * f64::from(tick)).expect("the start");
            assert!((start.x - 1.0).abs() < 1e-9, "{start:?}");
        }
    }
}

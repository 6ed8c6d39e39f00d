//! Where the robot was: the last poses of odometry.

use crate::scalar::Scalar;
use crate::types::Pose;

/// A ring of N poses, fixed in size, written at every tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct History<T, const N: usize> {
    entries: [Entry<T>; N],
    /// Index and number of the newest.
    newest: usize,
    filled: usize,
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
        }
    }

    /// Nothing is older than this pose.
    pub(super) fn begin(&mut self, pose: Pose<T>) {
        (self.newest, self.filled) = (0, 1);
        if let Some(first) = self.entries.first_mut() {
            *first = Entry { pose, dt: T::ZERO };
        }
    }

    pub(super) fn push(&mut self, pose: Pose<T>, dt: T) {
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

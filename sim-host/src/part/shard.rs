//! Which part.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::str::FromStr;

/// Part `index` of `count` of anything in order, counted from 0: one behind the other they are the whole. Sizes differ by one
/// at most; what is not there is empty.
pub fn shard<T>(all: &[T], index: usize, count: usize) -> &[T] {
    all.get(places(all.len(), index, count)).unwrap_or_default()
}

fn places(length: usize, index: usize, count: usize) -> Range<usize> {
    let bound = |part: usize| match count {
        0 => 0,
        // Without overflow for any number of parts.
        _ => (length as u128 * part as u128 / count as u128) as usize,
    };
    bound(index)..bound(index.saturating_add(1))
}

/// A part as people write it, `3/8`: counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(try_from = "(usize, usize)", into = "(usize, usize)")]
pub struct Shard {
    /// From 0.
    index: usize,
    count: NonZeroUsize,
}

/// Not a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a part is i/n, for example 3/8: two whole numbers, i from 1 to n, n up to {MOST}")]
pub struct NoShard;

/// Most parts: more than any cluster has machines, and no more than a list of those that are missing can hold.
const MOST: usize = 100_000;

impl Shard {
    /// All of it.
    pub const WHOLE: Self = Self {
        index: 0,
        count: NonZeroUsize::MIN,
    };

    /// Part `number` of `count`, counted from 1.
    ///
    /// # Errors
    /// There is no such part.
    pub fn new(number: usize, count: usize) -> Result<Self, NoShard> {
        let count = NonZeroUsize::new(count).ok_or(NoShard)?;
        let index = number.checked_sub(1).ok_or(NoShard)?;
        match index < count.get() && count.get() <= MOST {
            true => Ok(Self { index, count }),
            false => Err(NoShard),
        }
    }

    /// Counted from 1.
    pub const fn number(&self) -> usize {
        self.index + 1
    }

    /// Of how many.
    pub const fn count(&self) -> usize {
        self.count.get()
    }

    /// Its places among so many.
    pub fn places(&self, length: usize) -> Range<usize> {
        places(length, self.index, self.count.get())
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number(), self.count)
    }
}

impl FromStr for Shard {
    type Err = NoShard;

    fn from_str(text: &str) -> Result<Self, NoShard> {
        let (number, count) = text.split_once('/').ok_or(NoShard)?;
        let whole = |text: &str| text.parse::<usize>().map_err(|_| NoShard);
        Self::new(whole(number)?, whole(count)?)
    }
}

impl TryFrom<(usize, usize)> for Shard {
    type Error = NoShard;

    fn try_from((number, count): (usize, usize)) -> Result<Self, NoShard> {
        Self::new(number, count)
    }
}

impl From<Shard> for (usize, usize) {
    fn from(shard: Shard) -> Self {
        (shard.number(), shard.count())
    }
}

#[cfg(test)]
mod tests {
    use super::{Shard, shard};

    /// Any number of parts, one behind the other, is the whole; none is longer than another by more than one.
    #[test]
    fn parts_make_the_whole() {
        for length in [0, 1, 7, 60] {
            let numbers: Vec<u64> = (100..100 + length).collect();
            for count in 1..70 {
                let parts: Vec<_> = (0..count).map(|i| shard(&numbers, i, count)).collect();
                assert_eq!(parts.concat(), numbers, "{count} parts of {length}");
                let sizes = parts.iter().map(|part| part.len());
                let (least, most) = (sizes.clone().min(), sizes.max());
                assert!(most <= least.map(|least| least + 1), "{count} of {length}");
            }
        }
        assert!(shard(&[1, 2], 2, 2).is_empty() && shard(&[1, 2], 0, 0).is_empty());
        assert!(shard(&[1, 2], usize::MAX, usize::MAX).is_empty());
    }

    #[test]
    fn what_people_write_is_counted_from_one() {
        for (text, places) in [("1/4", 0..2), ("2/4", 2..5), ("4/4", 7..10), ("1/1", 0..10)] {
            let shard: Shard = text.parse().expect("a part");
            assert_eq!(
                (shard.to_string().as_str(), shard.places(10)),
                (text, places)
            );
        }
        for text in [
            "", "0/4", "5/4", "1/0", "1", "a/b", "-1/4", "1/4/4", "1.5/4", " 1/4", "1/100001",
        ] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}

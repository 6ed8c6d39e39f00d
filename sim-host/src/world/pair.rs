//! Both wheels at once.

use std::ops::{Add, Div, Index, Mul, Sub};

/// A number of the right and the left wheel. What is reckoned of both is reckoned side by side, in vector registers where
/// there are some; each number has the bits that it would have alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pair(pub [f64; 2]);

impl Pair {
    /// The same number twice.
    #[inline(always)]
    pub const fn both(value: f64) -> Self {
        Self([value; 2])
    }

    #[inline(always)]
    pub fn map(self, one: impl Fn(f64) -> f64) -> Self {
        Self([one(self.0[0]), one(self.0[1])])
    }

    #[inline(always)]
    pub fn with(self, other: Self, one: impl Fn(f64, f64) -> f64) -> Self {
        Self([one(self.0[0], other.0[0]), one(self.0[1], other.0[1])])
    }

    #[inline(always)]
    pub fn abs(self) -> Self {
        self.map(f64::abs)
    }

    /// 0 instead of what is negative.
    #[inline(always)]
    pub fn or_zero(self) -> Self {
        self.map(|one| if one > 0.0 { one } else { 0.0 })
    }

    /// Whether `holds` of both.
    #[inline(always)]
    pub fn all(self, other: Self, holds: impl Fn(f64, f64) -> bool) -> bool {
        holds(self.0[0], other.0[0]) & holds(self.0[1], other.0[1])
    }
}

impl From<[f64; 2]> for Pair {
    fn from(pair: [f64; 2]) -> Self {
        Self(pair)
    }
}

impl Index<usize> for Pair {
    type Output = f64;

    #[inline(always)]
    fn index(&self, i: usize) -> &f64 {
        &self.0[i]
    }
}

macro_rules! lanes {
    ($($name:ident $call:ident $sign:tt),*) => {$(
        impl $name for Pair {
            type Output = Self;

            #[inline(always)]
            fn $call(self, other: Self) -> Self {
                self.with(other, |one, other| one $sign other)
            }
        }

        impl $name<f64> for Pair {
            type Output = Self;

            #[inline(always)]
            fn $call(self, other: f64) -> Self {
                self.map(|one| one $sign other)
            }
        }

        impl $name<Pair> for f64 {
            type Output = Pair;

            #[inline(always)]
            fn $call(self, other: Pair) -> Pair {
                other.map(|one| self $sign one)
            }
        }
    )*};
}

lanes!(Add add +, Sub sub -, Mul mul *, Div div /);

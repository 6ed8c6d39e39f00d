//! A move from rest to rest with a trapezoid of speed.

use crate::law::sqrt;

/// A trapezoid, or a triangle where the way is short.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Trapezoid {
    sign: f32,
    top: f32,
    up: f32,
    down: f32,
    /// Ends of speeding up, of the top speed, and of braking \[s\].
    ends: [f32; 3],
}

impl Trapezoid {
    /// Over a way, within a speed, an acceleration and a deceleration.
    pub(crate) fn new(way: f32, speed: f32, up: f32, down: f32) -> Self {
        let length = way.abs();
        let triangle = sqrt(2.0 * length * up * down / (up + down));
        let top = if triangle < speed { triangle } else { speed };
        if top <= 0.0 {
            return Self::default();
        }
        let (rise, fall) = (top / up, top / down);
        let flat = length / top - 0.5 * (rise + fall);
        let flat = if flat > 0.0 { flat } else { 0.0 };
        Self {
            sign: if way < 0.0 { -1.0 } else { 1.0 },
            top,
            up,
            down,
            ends: [rise, rise + flat, rise + flat + fall],
        }
    }

    /// How long it takes \[s\].
    pub(crate) const fn duration(&self) -> f32 {
        self.ends[2]
    }

    /// Way, speed and acceleration at a time.
    pub(crate) fn at(&self, t: f32) -> (f32, f32, f32) {
        let [rise, flat, end] = self.ends;
        let (way, speed, accel) = if t <= 0.0 {
            (0.0, 0.0, 0.0)
        } else if t < rise {
            (0.5 * self.up * t * t, self.up * t, self.up)
        } else if t < flat {
            (0.5 * self.top * rise + self.top * (t - rise), self.top, 0.0)
        } else {
            let all = 0.5 * self.top * (rise + end - flat) + self.top * (flat - rise);
            let left = if t < end { end - t } else { 0.0 };
            let accel = if t < end { -self.down } else { 0.0 };
            (all - 0.5 * self.down * left * left, self.down * left, accel)
        };
        (self.sign * way, self.sign * speed, self.sign * accel)
    }
}

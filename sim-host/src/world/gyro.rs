//! The gyro: true turns, with what is wrong with them.
//!
//! A sample is the mean of the true rate since the last one, as sensors that average have it, with bias, scale, noise and rounding;
//! it arrives `latency_s` later. Of several that arrive in a tick the base gets the mean, as of a sensor's FIFO, with the age of the newest.

use super::params::WorldParams;
use super::plant_fault::PlantFaults;
use super::random::{Random, Stream};
use super::sense_params::GyroParams;
use super::senses::moment_us;
use std::collections::VecDeque;

/// A sample of the gyro.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GyroSample {
    /// Mean turn rate \[rad/s\].
    pub rate: f64,
    /// Since its last moment \[s\].
    pub age_s: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Gyro {
    params: GyroParams,
    bias: f64,
    scale: f64,
    taken: u64,
    next_us: u64,
    last_theta: f64,
    /// Arrival and moment \[µs\], rate.
    on_the_way: VecDeque<(u64, u64, f64)>,
    /// What a stuck one says.
    last: f64,
    noise: Random,
    walk: Random,
}

impl Gyro {
    /// Bias and scale are drawn: anywhere within their limits.
    pub fn new(p: &WorldParams, theta: f64, seed: u64) -> Option<Self> {
        let params = p.gyro?;
        let mut draw = Random::new(seed, Stream::GyroDraw);
        let mut within = |limit: f64| limit * (2.0 * draw.uniform() - 1.0);
        Some(Self {
            bias: within(params.bias_limit),
            scale: 1.0 + within(params.scale_error),
            params,
            taken: 0,
            next_us: moment_us(0, params.rate_hz),
            last_theta: theta,
            on_the_way: VecDeque::new(),
            last: 0.0,
            noise: Random::new(seed, Stream::GyroNoise),
            walk: Random::new(seed, Stream::GyroWalk),
        })
    }

    /// The next moment at which a sample is taken \[µs\].
    pub const fn next_us(&self) -> u64 {
        self.next_us
    }

    /// Takes a sample at the moment [`next_us`](Self::next_us), where the robot truly has turned to `theta`.
    pub fn take(&mut self, theta: f64, faults: &PlantFaults) {
        let p = self.params;
        let moment = self.next_us;
        self.taken += 1;
        self.next_us = moment_us(self.taken, p.rate_hz);
        let period = 1.0 / p.rate_hz;
        let truth = (theta - self.last_theta) * p.rate_hz;
        self.last_theta = theta;
        // Drawn before anything is decided, so that no fault shifts the numbers after it.
        self.bias += p.bias_walk * period.sqrt() * self.walk.normal();
        let noise = p.noise_density * p.rate_hz.sqrt() * self.noise.normal();
        if faults.gyro_silent {
            return;
        }
        let factor = faults.gyro_scale.unwrap_or(1.0);
        let rate = factor * (self.scale * truth + self.bias + noise) + faults.gyro_bias;
        let rate = if p.resolution > 0.0 {
            (rate / p.resolution).round() * p.resolution
        } else {
            rate
        };
        let rate = rate.clamp(-p.range, p.range);
        self.last = if faults.gyro_stuck { self.last } else { rate };
        let rate = if faults.gyro_nan { f64::NAN } else { self.last };
        let latency = (p.latency_s * 1.0e6).round() as u64;
        self.on_the_way.push_back((moment + latency, moment, rate));
    }

    /// Carried to another heading, and not on its own axis: it has felt nothing of it.
    pub fn place(&mut self, theta: f64) {
        self.last_theta = theta;
    }

    /// What has arrived by the end of a tick.
    pub fn arrived(&mut self, now_us: u64) -> Option<GyroSample> {
        let (mut sum, mut count, mut newest) = (0.0, 0, 0);
        while let Some(&(arrival, moment, rate)) = self.on_the_way.front() {
            if arrival > now_us {
                break;
            }
            self.on_the_way.pop_front();
            (sum, count, newest) = (sum + rate, count + 1, moment);
        }
        (count > 0).then(|| GyroSample {
            rate: sum / f64::from(count),
            age_s: 1.0e-6 * (now_us - newest) as f64,
        })
    }

    /// The true bias \[rad/s\].
    pub fn bias(&self) -> f64 {
        self.bias
    }
}

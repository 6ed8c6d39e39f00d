//! A source of external poses: rare, late, noisy.

use std::collections::VecDeque;

use controller_core::localiser::Fix;
use controller_core::scalar::Scalar;
use controller_core::types::Pose;

use crate::random::Random;

/// A camera, say.
#[derive(Clone, Debug)]
pub struct Source {
    /// Time between fixes \[s\].
    pub period_s: f64,
    /// Time from a fix to its arrival \[s\].
    pub latency_s: f64,
    /// Standard deviation of each coordinate \[m\].
    pub noise_m: f64,
    /// Standard deviation of the heading \[rad\].
    pub noise_rad: f64,
    /// Of the noise.
    pub random: Random,
    /// Fixes taken so far.
    pub taken: u32,
    /// Fixes on their way, oldest first: when taken \[s\], and what was seen.
    pub under_way: VecDeque<(f64, Pose<f64>)>,
}

impl Source {
    /// 20 Hz, 20 ms late, 5 mm, 5 mrad.
    pub fn camera(seed: u64) -> Self {
        Self {
            period_s: 0.05,
            latency_s: 0.02,
            noise_m: 5e-3,
            noise_rad: 5e-3,
            random: Random(seed),
            taken: 0,
            under_way: VecDeque::new(),
        }
    }

    /// The same without noise.
    pub fn exact() -> Self {
        Self {
            noise_m: 0.0,
            noise_rad: 0.0,
            ..Self::camera(0)
        }
    }

    /// No fix ever comes.
    pub fn silent() -> Self {
        Self {
            latency_s: f64::INFINITY,
            ..Self::exact()
        }
    }

    /// At a tick: takes a fix of the true pose when it is time, and gives the one that arrives now.
    pub fn poll(&mut self, t: f64, truth: &Pose<f64>) -> Option<Fix<f64>> {
        // A tick's time is a product; 1 ns keeps it from being a tick late.
        let now = t + 1e-9;
        if now >= f64::from(self.taken) * self.period_s {
            self.taken += 1;
            let mut noise = |size: f64| size * self.random.normal();
            let pose = Pose::new(
                truth.x + noise(self.noise_m),
                truth.y + noise(self.noise_m),
                truth.theta + noise(self.noise_rad),
            );
            self.under_way.push_back((t, pose));
        }
        let &(taken_s, pose) = self.under_way.front()?;
        (now >= taken_s + self.latency_s).then(|| {
            self.under_way.pop_front();
            Fix {
                pose,
                age_s: t - taken_s,
            }
        })
    }
}

/// A fix in another scalar.
pub fn fix<T: Scalar>(fix: &Fix<f64>) -> Fix<T> {
    Fix {
        pose: crate::motion_base::pose(&fix.pose),
        age_s: T::from_f64(fix.age_s),
    }
}

//! What can be measured: counts, poses, voltage, currents, and when the next tick is.

use super::params::WorldParams;
use super::plant_fault::PlantFaults;
use super::random::{Random, Stream};
use super::sense_params::{EncoderParams, NoiseParams, PoseSourceParams, TickParams};
use controller_core::hal::WheelCounts;
use controller_core::types::Pose;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Everything that turns the truth into measurements.
#[derive(Clone, Debug)]
pub(super) struct Senses {
    encoder: EncoderParams,
    source: Option<PoseSourceParams>,
    noise: NoiseParams,
    tick: TickParams,
    /// Edges that each wheel has truly passed, and what the counters show.
    edges: [i64; 2],
    shown: [i64; 2],
    /// Poses on their way: arrival and moment \[µs\], pose.
    on_the_way: VecDeque<(u64, u64, Pose<f64>)>,
    /// Poses taken, and the moment of the next one \[µs\].
    taken: u64,
    next_us: Option<u64>,
    pub fix: Option<(Pose<f64>, f64)>,
    pub supply_v: f64,
    pub current_a: [f64; 2],
    random: Streams,
}

#[derive(Clone, Debug)]
struct Streams {
    tick: Random,
    glitch: Random,
    drop: Random,
    position: Random,
    heading: Random,
    supply: Random,
    current: Random,
}

impl Senses {
    pub fn new(p: &WorldParams, seed: u64) -> Self {
        let stream = |stream| Random::new(seed, stream);
        Self {
            encoder: p.encoder,
            source: p.pose_source,
            noise: p.noise,
            tick: p.tick,
            edges: [0; 2],
            shown: [0; 2],
            on_the_way: VecDeque::new(),
            taken: 0,
            next_us: p.pose_source.map(|source| moment_us(0, source.rate_hz)),
            fix: None,
            supply_v: p.battery.open_circuit_v.unwrap_or(p.battery.nominal_v),
            current_a: [0.0; 2],
            random: Streams {
                tick: stream(Stream::Tick),
                glitch: stream(Stream::Glitch),
                drop: stream(Stream::PoseDrop),
                position: stream(Stream::PosePosition),
                heading: stream(Stream::PoseHeading),
                supply: stream(Stream::Supply),
                current: stream(Stream::Current),
            },
        }
    }

    /// The next moment at which a pose is taken \[µs\].
    pub const fn next_pose_us(&self) -> Option<u64> {
        self.next_us
    }

    /// Takes a pose at the moment [`next_pose_us`](Self::next_pose_us).
    pub fn take_pose(&mut self, truth: Pose<f64>, faults: &PlantFaults) {
        let (Some(source), Some(moment)) = (self.source, self.next_us) else {
            return;
        };
        self.taken += 1;
        self.next_us = Some(moment_us(self.taken, source.rate_hz));
        // Drawn before anything is decided, so that no fault shifts the numbers after it.
        let dropped = self.random.drop.chance(source.drop_probability);
        let noise = [self.random.position.normal(), self.random.position.normal()];
        let turned = source.noise_rad * self.random.heading.normal();
        if dropped || faults.pose_silent {
            return;
        }
        let [dx, dy, dtheta] = faults.pose_jump;
        let mut pose = Pose::new(
            truth.x + source.noise_m * noise[0] + source.bias_m[0] + dx,
            truth.y + source.noise_m * noise[1] + source.bias_m[1] + dy,
            truth.theta + turned + source.bias_rad + dtheta,
        );
        if faults.pose_nan {
            pose = Pose::new(f64::NAN, f64::NAN, f64::NAN);
        }
        let latency = (source.latency_s * 1.0e6).round() as u64;
        self.on_the_way.push_back((moment + latency, moment, pose));
    }

    /// Poses on their way never arrive.
    pub fn forget_poses(&mut self) {
        self.on_the_way.clear();
    }

    /// The end of a tick: wheels have turned by `angle` \[rad\] since the start.
    pub fn measure(
        &mut self,
        now_us: u64,
        angle: [f64; 2],
        (supply_v, current_a): (f64, [f64; 2]),
        faults: &PlantFaults,
    ) {
        self.count(angle, faults);
        self.fix = None;
        while let Some(&(arrival, moment, pose)) = self.on_the_way.front() {
            if arrival > now_us {
                break;
            }
            self.on_the_way.pop_front();
            // Of several the newest is used: it makes the others worthless.
            self.fix = Some((pose, 1.0e-6 * (now_us - moment) as f64));
        }
        self.supply_v = supply_v + self.noise.supply_v * self.random.supply.normal();
        for (i, current_a) in current_a.into_iter().enumerate() {
            let noise = self.noise.current_a * self.random.current.normal();
            self.current_a[i] = current_a + faults.over_current_a[i] + noise;
        }
    }

    pub(super) const fn counts_per_turn(&self) -> f64 {
        self.encoder.counts_per_turn
    }

    fn count(&mut self, angle: [f64; 2], faults: &PlantFaults) {
        for (i, angle) in angle.into_iter().enumerate() {
            let edges = (angle / TAU * self.encoder.counts_per_turn).floor() as i64;
            let passed = edges - self.edges[i];
            self.edges[i] = edges;
            if !faults.encoder_stuck[i] {
                self.shown[i] += if faults.encoder_reversed[i] {
                    -passed
                } else {
                    passed
                };
            }
            let glitch = self.random.glitch.chance(self.encoder.glitch_probability);
            let forward = self.random.glitch.chance(0.5);
            if glitch {
                let counts = i64::from(self.encoder.glitch_counts);
                self.shown[i] += if forward { counts } else { -counts };
            }
        }
    }

    /// The counters; their low 32 bits are all that there is.
    pub fn counts(&self) -> WheelCounts {
        let [right, left] = self.shown.map(|count| count as i32);
        WheelCounts { right, left }
    }

    /// Length of the next tick \[µs\], at least 1.
    pub fn next_tick_us(&mut self, period_us: u32, late_us: u32) -> u32 {
        let jitter = f64::from(self.tick.jitter_us);
        let even = ((2.0 * self.random.tick.uniform() - 1.0) * jitter).round();
        let late = self.random.tick.chance(self.tick.late_probability);
        let lateness = self
            .random
            .tick
            .log_normal(self.tick.late_median_us, self.tick.late_spread);
        let lateness = if late { lateness.round() } else { 0.0 };
        // A cast of a float saturates, so the longest tick is some 71 minutes and no wrap.
        ((f64::from(period_us) + even + lateness).max(1.0) as u32).saturating_add(late_us)
    }
}

/// The moment of a sample after `taken` others \[µs\]: the n-th at n/rate, to the microsecond.
pub(super) fn moment_us(taken: u64, rate_hz: f64) -> u64 {
    ((taken + 1) as f64 * 1.0e6 / rate_hz).round() as u64
}

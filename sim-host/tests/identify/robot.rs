//! A robot that writes logs: motors, friction, body, encoders, a pose source. Shares nothing with
//! the model that is fitted: nonlinear friction through zero speed, forces on a body, small steps.

use rand::{RngExt as _, SeedableRng as _};
use rand_distr::{Distribution as _, StandardNormal};
use rand_pcg::Pcg64Mcg;
use sim_host::identify::{Drive, Fix, Log, Quantity};
use std::f64::consts::TAU;

/// Log period \[s\], and steps of the simulation in it.
pub const PERIOD: f64 = 0.01;
const SUBSTEPS: usize = 10;
/// Speed over which friction turns its sign \[rad/s\]: well below the 0.5 that is left out.
const SMOOTH: f64 = 0.05;

/// Pairs are right, left; at the wheel.
#[derive(Clone, Debug)]
pub struct Robot {
    pub radius: [f64; 2],
    pub track: f64,
    pub mass: f64,
    pub inertia: f64,
    pub wheel_inertia: f64,
    pub constant: [f64; 2],
    pub resistance: [f64; 2],
    pub viscous: [f64; 2],
    pub coulomb: [f64; 2],
    pub supply: f64,
}

/// What is recorded, and how badly.
#[derive(Clone, Copy, Debug)]
pub struct Recorder {
    pub drive: Drive,
    pub current_sd: Option<f64>,
    /// Metres and radians.
    pub pose_sd: Option<f64>,
    pub latency_s: f64,
    pub counts_per_turn: f64,
    pub duration_s: f64,
}

pub const RECORDER: Recorder = Recorder {
    drive: Drive::Voltage,
    current_sd: Some(0.05),
    pose_sd: Some(0.003),
    latency_s: 0.033,
    counts_per_turn: 2048.0,
    duration_s: 25.0,
};

impl Robot {
    /// A small robot of 10 kg, nothing alike on both sides, every number up to 20 % off by chance.
    pub fn draw(random: &mut Pcg64Mcg) -> Self {
        let mut off = |value: f64, by: f64| value * (1.0 + random.random_range(-by..by));
        Self {
            radius: [off(0.080, 0.02), off(0.081, 0.02)],
            track: off(0.35, 0.1),
            mass: off(10.0, 0.2),
            inertia: off(0.30, 0.2),
            wheel_inertia: off(0.004, 0.2),
            constant: [off(0.60, 0.1), off(0.62, 0.1)],
            resistance: [off(1.2, 0.2), off(1.1, 0.2)],
            viscous: [off(0.03, 0.2), off(0.04, 0.2)],
            coulomb: [off(0.25, 0.2), off(0.20, 0.2)],
            supply: 12.0,
        }
    }

    /// The true value; mass and inertia without the wheels'.
    pub fn truth(&self, quantity: Quantity) -> f64 {
        use Quantity as Q;
        match quantity {
            Q::RadiusRight => self.radius[0],
            Q::RadiusLeft => self.radius[1],
            Q::Track => self.track,
            Q::Mass => self.mass,
            Q::Inertia => self.inertia,
            Q::WheelInertia => self.wheel_inertia,
            Q::MotorConstantRight => self.constant[0],
            Q::MotorConstantLeft => self.constant[1],
            Q::ResistanceRight => self.resistance[0],
            Q::ResistanceLeft => self.resistance[1],
            Q::ViscousRight => self.viscous[0],
            Q::ViscousLeft => self.viscous[1],
            Q::CoulombRight => self.coulomb[0],
            Q::CoulombLeft => self.coulomb[1],
            Q::Supply => self.supply,
        }
    }

    /// Torque per command and torque by speed of a side, without friction.
    fn motor(&self, drive: Drive, i: usize) -> (f64, f64) {
        let (k, r) = (self.constant[i], self.resistance[i]);
        match drive {
            Drive::Torque => (1.0, 0.0),
            Drive::Voltage => (k / r, k * k / r),
            Drive::Duty => (k * self.supply / r, k * k / r),
        }
    }

    /// Derivative of x, y, heading, v, turn rate, and wheel angles.
    fn slope(&self, drive: Drive, s: &[f64; 7], command: [f64; 2]) -> [f64; 7] {
        let (v, w) = (s[3], s[4]);
        let half = 0.5 * self.track;
        let speed = [
            (v + half * w) / self.radius[0],
            (v - half * w) / self.radius[1],
        ];
        let mut force = [0.0; 2];
        for i in 0..2 {
            let (gain, drag) = self.motor(drive, i);
            let friction =
                self.viscous[i] * speed[i] + self.coulomb[i] * (speed[i] / SMOOTH).tanh();
            force[i] = (gain * command[i] - drag * speed[i] - friction) / self.radius[i];
        }
        // Newton's equations of body and wheels in v and turn rate.
        let j = [0, 1].map(|i| self.wheel_inertia / self.radius[i].powi(2));
        let (mass, inertia) = (
            self.mass + j[0] + j[1],
            self.inertia + half * half * (j[0] + j[1]),
        );
        let coupling = half * (j[0] - j[1]);
        let (along, moment) = (force[0] + force[1], half * (force[0] - force[1]));
        let det = mass * inertia - coupling * coupling;
        [
            v * s[2].cos(),
            v * s[2].sin(),
            w,
            (inertia * along - coupling * moment) / det,
            (mass * moment - coupling * along) / det,
            speed[0],
            speed[1],
        ]
    }

    fn advance(&self, drive: Drive, s: &[f64; 7], u: [f64; 2], h: f64) -> [f64; 7] {
        let add = |a: &[f64; 7], k: &[f64; 7], h: f64| std::array::from_fn(|i| a[i] + h * k[i]);
        let k1 = self.slope(drive, s, u);
        let k2 = self.slope(drive, &add(s, &k1, 0.5 * h), u);
        let k3 = self.slope(drive, &add(s, &k2, 0.5 * h), u);
        let k4 = self.slope(drive, &add(s, &k3, h), u);
        std::array::from_fn(|i| s[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }

    /// Records `drive_of(t)`, duties of both sides, with the noise of `random`.
    pub fn record(
        &self,
        recorder: &Recorder,
        random: &mut Pcg64Mcg,
        drive_of: impl Fn(f64) -> [f64; 2],
    ) -> Log {
        let rows = (recorder.duration_s / PERIOD) as usize;
        let mut noise = |sd: f64| -> f64 {
            let normal: f64 = StandardNormal.sample(random);
            sd * normal
        };
        let mut s = [
            0.3,
            -0.2,
            1.0,
            0.0,
            0.0,
            0.123 + noise(0.1),
            4.56 + noise(0.1),
        ];
        let mut fine = vec![s];
        let late = (recorder.latency_s / PERIOD * SUBSTEPS as f64).round() as usize;
        let step = TAU / recorder.counts_per_turn;
        // A stall torque of the motors at 12 V is near 6 N m.
        let full = match recorder.drive {
            Drive::Torque => 2.0,
            Drive::Voltage => 12.0,
            Drive::Duty => 1.0,
        };
        let mut log = Log {
            t: Vec::new(),
            drive: recorder.drive,
            command: Vec::new(),
            supply: None,
            angle: Vec::new(),
            step_rad: Some(step),
            current: recorder.current_sd.map(|_| Vec::new()),
            fixes: Vec::new(),
        };
        let mut before = [0.0; 2];
        for row in 0..rows {
            let t = row as f64 * PERIOD;
            let command = drive_of(t).map(|duty| full * duty);
            log.t.push(t);
            log.command.push(command);
            log.angle.push([5, 6].map(|i| (s[i] / step).floor() * step));
            if let (Some(currents), Some(sd)) = (&mut log.current, recorder.current_sd) {
                let slope = self.slope(recorder.drive, &s, before);
                currents.push([0, 1].map(|i| {
                    let (gain, drag) = self.motor(recorder.drive, i);
                    let torque = gain * before[i] - drag * slope[5 + i];
                    torque / self.constant[i] + noise(sd)
                }));
            }
            // Every fifth row, as of a camera of 20 Hz.
            if let Some(sd) = recorder.pose_sd
                && row % 5 == 0
                && row * SUBSTEPS >= late
            {
                let seen = fine[row * SUBSTEPS - late];
                log.fixes.push(Fix {
                    row,
                    pose: [0, 1, 2].map(|i| seen[i] + noise(sd)),
                    age_s: 0.0,
                });
            }
            for _ in 0..SUBSTEPS {
                s = self.advance(recorder.drive, &s, command, PERIOD / SUBSTEPS as f64);
                fine.push(s);
            }
            before = command;
        }
        log
    }
}

pub fn random(seed: u64) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(seed)
}

/// The drive that `docs/identify.md` recommends, as duties: steps straight on, turning on the spot,
/// backward in arcs, forward with both sides on their own.
pub fn recommended(t: f64) -> [f64; 2] {
    // A step every 0.3 to 1 s: shorter and longer than the motors' time constant.
    let steps = |t: f64, low: f64, high: f64| {
        let phase = (t * (1.0 + 0.12 * t)) % 2.0;
        if phase < 1.0 { low } else { high }
    };
    match t {
        t if t < 6.0 => [steps(t, 0.3, 0.8); 2],
        t if t < 6.5 => [0.0; 2],
        t if t < 11.5 => {
            let turn = steps(t - 6.5, 0.3, 0.7);
            [turn, -turn]
        }
        t if t < 12.0 => [0.0; 2],
        t if t < 18.0 => [-steps(t - 12.0, 0.7, 0.3), -steps(t - 11.6, 0.4, 0.6)],
        t if t < 18.5 => [0.0; 2],
        _ => [steps(t - 18.5, 0.8, 0.3), steps(t - 17.7, 0.5, 0.8)],
    }
}

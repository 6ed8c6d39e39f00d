//! Peak values of a trajectory.

use super::{Sample, Trajectory};
use std::fmt;

/// Peak values of a trajectory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// Seconds.
    pub duration_s: f64,
    /// Metres driven, forward and back.
    pub length_m: f64,
    /// Largest and smallest speed \[m/s\].
    pub speed_m_s: (f64, f64),
    /// Largest |w| \[rad/s\].
    pub turn_rate: f64,
    /// Largest |a| \[m/s²\].
    pub accel: f64,
    /// Largest |α| \[rad/s²\].
    pub angular_accel: f64,
    /// Largest |v w| \[m/s²\].
    pub lateral_accel: f64,
    /// Largest |w / v| while faster than 1 cm/s \[1/m\].
    pub curvature: f64,
}

impl Figures {
    fn include(&mut self, s: &Sample, before: Option<&Sample>) {
        if let Some(b) = before {
            self.length_m += 0.5 * (s.v.abs() + b.v.abs()) * (s.t - b.t);
        }
        self.speed_m_s.0 = self.speed_m_s.0.max(s.v);
        self.speed_m_s.1 = self.speed_m_s.1.min(s.v);
        self.turn_rate = self.turn_rate.max(s.w.abs());
        self.accel = self.accel.max(s.a.abs());
        self.angular_accel = self.angular_accel.max(s.alpha.abs());
        self.lateral_accel = self.lateral_accel.max((s.v * s.w).abs());
        if s.v.abs() > 0.01 {
            self.curvature = self.curvature.max((s.w / s.v).abs());
        }
    }
}

impl Trajectory {
    /// Peak values, from samples and from between them.
    pub fn figures(&self) -> Figures {
        let mut figures = Figures {
            duration_s: self.duration(),
            ..Figures::default()
        };
        let mut before: Option<Sample> = None;
        for pair in self.samples().windows(2) {
            let [from, to] = pair else { continue };
            for i in 0..=4 {
                let here = self.at(from.t + (to.t - from.t) * f64::from(i) / 4.0);
                figures.include(&here, before.as_ref());
                before = Some(here);
            }
        }
        figures
    }
}

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "duration   {:.3} s", self.duration_s)?;
        writeln!(f, "length     {:.3} m", self.length_m)?;
        let (fast, back) = self.speed_m_s;
        writeln!(f, "speed      {back:.3} to {fast:.3} m/s")?;
        writeln!(f, "turn rate  up to {:.3} rad/s", self.turn_rate)?;
        writeln!(
            f,
            "accel      up to {:.3} m/s², {:.3} rad/s²",
            self.accel, self.angular_accel
        )?;
        writeln!(f, "lateral    up to {:.3} m/s²", self.lateral_accel)?;
        writeln!(f, "curvature  up to {:.2} 1/m", self.curvature)
    }
}

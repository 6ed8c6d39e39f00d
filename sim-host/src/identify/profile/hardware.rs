//! Motors, battery and friction of a base's file.

use super::super::verdict::pushes;
use super::super::{Quantity as Q, Verdict};
use super::document::rounded;
use super::{Estimate, Update};

/// What the currents' torque explains: gear losses end up in it.
const MECHANICAL: [Q; 6] = [
    Q::Mass,
    Q::Inertia,
    Q::ViscousRight,
    Q::ViscousLeft,
    Q::CoulombRight,
    Q::CoulombLeft,
];

impl Update<'_> {
    pub(super) fn hardware(&mut self, gear: Option<f64>) {
        // A file that is begun here may get its motors here.
        if self.file.has_table("limits") && !self.file.has_table("motor") {
            self.notes.push(
                "[motor], [battery] and [friction] are left out: this base has no motors; copy these \
                 tables and [encoder] and [control] from a base of bases/ and update again"
                    .to_owned(),
            );
            return;
        }
        self.motor(gear);
        if let Some(Verdict::Identified { value, .. }) = self.found.of(Q::Supply) {
            self.file.set("battery", "nominal_v", *value);
        }
        self.friction();
        self.drivetrain("gear_efficiency", "efficiency");
        self.drivetrain("dead_band", "dead_band");
        self.losses();
    }

    fn motor(&mut self, gear: Option<f64>) {
        if let Some(gear) = gear {
            self.file.set("motor", "gear_ratio", gear);
        }
        let name = "[motor] resistance_ohm";
        if let Some(mean) = self.mean(name, Q::ResistanceRight, Q::ResistanceLeft) {
            self.file.set("motor", "resistance_ohm", mean.value);
        }
        let name = "[motor] kt_nm_per_a";
        let sides = self.both(name, Q::MotorConstantRight, Q::MotorConstantLeft);
        let Some([right, left]) = sides else { return };
        let mean = 0.5 * (right.value + left.value);
        let Some(gear) = self.file.number("motor", "gear_ratio") else {
            self.notes.push(format!(
                "{name} is left out: {mean:.4} N m/A at the wheel is gear_ratio times it; --known \
                 gear=..., or the key, tells it"
            ));
            return;
        };
        self.file.set("motor", "kt_nm_per_a", mean / gear);
        let strength = [right.value / mean, left.value / mean];
        let unlike = rounded(right.value) != rounded(left.value);
        if unlike || self.file.has("motor", "strength") {
            self.file.set_pair("motor", "strength", strength);
        }
    }

    fn friction(&mut self) {
        for (key, right, left) in [
            ("coulomb_nm", Q::CoulombRight, Q::CoulombLeft),
            ("viscous_nm_s", Q::ViscousRight, Q::ViscousLeft),
        ] {
            let name = format!("[friction] {key}");
            let Some(Estimate { value, half_width }) = self.mean(&name, right, left) else {
                continue;
            };
            if value >= 0.0 {
                self.file.set("friction", key, value);
            } else if !pushes(value, half_width) {
                self.notes.push(format!(
                    "{name} is 0: {value:.2e} ± {half_width:.1e} was found, and friction does not push"
                ));
                self.file.set("friction", key, 0.0);
            } else {
                self.notes.push(format!(
                    "{name} is left as it was: {value:.2e} ± {half_width:.1e} was found, and friction \
                     does not push"
                ));
            }
        }
        // 0 means no more than Coulomb's.
        let number = |key| self.file.number("friction", key);
        if let (Some(at_rest), Some(turning)) = (number("static_nm"), number("coulomb_nm"))
            && at_rest != 0.0
            && at_rest < turning
        {
            self.file.set("friction", "static_nm", turning);
            self.notes.push(format!(
                "[friction] static_nm was {at_rest}, less than coulomb_nm: it is raised to that. A log \
                 of turning wheels does not show it"
            ));
        }
    }

    /// Shares that the log shows for both motors, of which the file has one.
    fn drivetrain(&mut self, key: &'static str, name: &str) {
        let sides = ["right", "left"].map(|side| self.side_estimate(&format!("{name}_{side}")));
        let key_name = format!("[motor] {key}");
        let Some(sides) = self.pair(&key_name, sides) else {
            return;
        };
        let Estimate { value, half_width } = self.mean_of(&key_name, sides);
        let bounded = value.clamp(0.0, 1.0);
        if bounded != value {
            self.notes.push(format!(
                "{key_name} is {bounded}: {value:.4} ± {half_width:.4} was found"
            ));
        }
        self.file.set("motor", key, bounded);
    }

    fn losses(&mut self) {
        if ["right", "left"]
            .iter()
            .all(|side| self.side_estimate(&format!("efficiency_{side}")).is_some())
        {
            return;
        }
        let efficiency = self.file.number("motor", "gear_efficiency").unwrap_or(1.0);
        let fitted = |q: &Q| matches!(self.found.of(*q), Some(Verdict::Identified { .. }));
        if efficiency < 1.0 && MECHANICAL.iter().any(fitted) {
            self.notes.push(format!(
                "[motor] gear_efficiency is {efficiency}, but the fit has no gear losses: mass, inertia \
                 and friction hold them, up to 1/{efficiency} times too large. Set it to 1, or weigh \
                 the robot"
            ));
        }
    }
}

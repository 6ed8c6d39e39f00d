//! Chip against host, bit for bit.

use controller_core::paper::report::Phase;
use protocol::pil::Ticked;
use serde::Serialize;

/// Numbers and flags of a tick that are compared.
const SIGNALS: usize = 25;

/// What the comparison of chip and host has found so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Parity {
    /// Ticks compared, the start included.
    pub ticks: u64,
    /// Ticks with any difference.
    pub ticks_apart: u64,
    /// Numbers and flags compared.
    pub numbers: u64,
    /// Numbers and flags that differ.
    pub numbers_apart: u64,
    /// Bits in which they differ.
    pub bits_apart: u64,
    /// The first difference.
    pub first: Option<Difference>,
}

/// One signal that came out differently.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Tick of its run; 0 is the start.
    pub tick: u32,
    /// Name as in the CSV file.
    pub signal: &'static str,
    /// What the chip computed.
    pub chip: f32,
    /// What the host computed.
    pub host: f32,
}

impl Parity {
    /// Compares one tick, signal by signal: its name, what the chip computed, what the host did.
    ///
    /// Zeros of different sign differ; any two NaN are alike, because their payloads are open.
    pub fn compare(
        &mut self,
        tick: u32,
        signals: impl IntoIterator<Item = (&'static str, f32, f32)>,
    ) {
        let mut apart = false;
        for (signal, chip, host) in signals {
            let bits = if chip.is_nan() && host.is_nan() {
                0
            } else {
                (chip.to_bits() ^ host.to_bits()).count_ones()
            };
            self.numbers += 1;
            if bits > 0 {
                apart = true;
                self.numbers_apart += 1;
                self.bits_apart += u64::from(bits);
                self.first.get_or_insert(Difference {
                    tick,
                    signal,
                    chip,
                    host,
                });
            }
        }
        self.ticks += 1;
        self.ticks_apart += u64::from(apart);
    }

    /// Nothing differed, and something was compared.
    pub fn is_exact(&self) -> bool {
        self.ticks > 0 && self.numbers_apart == 0
    }

    /// Adds what another run found.
    pub fn merge(&mut self, other: &Self) {
        self.ticks += other.ticks;
        self.ticks_apart += other.ticks_apart;
        self.numbers += other.numbers;
        self.numbers_apart += other.numbers_apart;
        self.bits_apart += other.bits_apart;
        self.first = self.first.or(other.first);
    }
}

/// A tick of the paper's law on the chip beside that of the host: torques, commands, neuron states, every other term of
/// the report, flags.
pub fn pairs(chip: &Ticked, host: &Ticked) -> impl Iterator<Item = (&'static str, f32, f32)> {
    let both = signals(chip).into_iter().zip(signals(host));
    both.map(|((signal, chip), (_, host))| (signal, chip, host))
}

fn signals(ticked: &Ticked) -> [(&'static str, f32); SIGNALS] {
    let report = &ticked.report;
    let step = ticked.hand_over_step.unwrap_or_default();
    let flag = |set: bool| f32::from(u8::from(set));
    [
        ("tau_right", report.torques.right),
        ("tau_left", report.torques.left),
        ("tau1", report.wrench.force),
        ("tau2", report.wrench.moment),
        ("v_c", report.command.linear),
        ("w_c", report.command.angular),
        ("s1", report.neurons.s1),
        ("s2", report.neurons.s2),
        ("s3", report.neurons.s3),
        ("vdot_s", report.neurons.accel.linear),
        ("wdot_s", report.neurons.accel.angular),
        ("e_x", report.error.x),
        ("e_y", report.error.y),
        ("e_theta", report.error.theta),
        ("vdot_c", report.command_rate.linear),
        ("wdot_c", report.command_rate.angular),
        ("e_v", report.velocity_error.linear),
        ("e_w", report.velocity_error.angular),
        ("b_v", report.transition_offset.linear),
        ("b_w", report.transition_offset.angular),
        ("step_force", step.force),
        ("step_moment", step.moment),
        ("phase", flag(report.phase == Phase::Parking)),
        ("saturated", flag(report.saturated)),
        ("relaxing", flag(ticked.relaxing)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compared(change: impl FnOnce(&mut Ticked)) -> Parity {
        let host = Ticked::default();
        let mut chip = host;
        change(&mut chip);
        let mut parity = Parity::default();
        parity.compare(7, pairs(&chip, &host));
        parity
    }

    #[test]
    fn equal_reports_are_exact() {
        let parity = compared(|_| {});
        assert!(parity.is_exact());
        assert_eq!((parity.ticks, parity.numbers), (1, SIGNALS as u64));
        assert!(!Parity::default().is_exact());
    }

    #[test]
    fn one_bit_is_found_and_named() {
        let parity = compared(|chip| chip.report.neurons.s2 = f32::from_bits(1));
        assert!(!parity.is_exact());
        assert_eq!((parity.bits_apart, parity.ticks_apart), (1, 1));
        let first = parity.first.expect("a difference");
        assert_eq!((first.tick, first.signal), (7, "s2"));
    }

    #[test]
    fn sign_of_zero_counts_and_flags_count() {
        assert_eq!(
            compared(|chip| chip.report.torques.left = -0.0).bits_apart,
            1
        );
        assert!(!compared(|chip| chip.report.saturated = true).is_exact());
        assert!(!compared(|chip| chip.relaxing = true).is_exact());
    }

    #[test]
    fn nans_compare_by_class() {
        let mut host = Ticked::default();
        host.report.torques.right = f32::NAN;
        let mut chip = host;
        chip.report.torques.right = f32::from_bits(f32::NAN.to_bits() ^ 1);
        let mut parity = Parity::default();
        parity.compare(0, pairs(&chip, &host));
        assert!(parity.is_exact());
        chip.report.torques.right = 1.0;
        parity.compare(1, pairs(&chip, &host));
        assert!(!parity.is_exact());
    }
}

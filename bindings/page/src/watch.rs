//! A real board: what it sends, decoded as `sim-host monitor` does.

use protocol::tick_flags;
use sim_host::monitor::Monitor;

/// Reports of a board, as rows for the page.
#[derive(Debug, Default)]
pub struct Watch {
    monitor: Monitor,
    rows: Vec<f32>,
    first: Option<u32>,
}

/// Numbers of a report: tick since the first, pose, measured and commanded twist, torques, pose error, and three that are bits:
/// state, active faults, flags.
pub const WATCHED: usize = 16;

impl Watch {
    /// Takes bytes from the line.
    pub fn take(&mut self, bytes: &[u8]) {
        let (rows, first) = (&mut self.rows, &mut self.first);
        self.monitor.take(bytes, |report, _| {
            let since = report.tick.wrapping_sub(*first.get_or_insert(report.tick));
            let law = report.flags & tick_flags::LAW != 0;
            let of_law = |value: f32| if law { value } else { f32::NAN };
            rows.extend([
                since as f32,
                report.x,
                report.y,
                report.theta,
                report.v,
                report.w,
                of_law(report.v_c),
                of_law(report.w_c),
                report.tau_right,
                report.tau_left,
                of_law(report.e_x),
                of_law(report.e_y),
                of_law(report.e_theta),
                f32::from_bits(u32::from(crate::session::state_code(report.state))),
                f32::from_bits(report.active_faults),
                f32::from_bits(u32::from(report.flags)),
            ]);
        });
    }

    /// The rows since the last call.
    pub fn rows(&mut self) -> Vec<f32> {
        std::mem::take(&mut self.rows)
    }

    /// Everything said so far, for people.
    pub fn monitor(&self) -> &Monitor {
        &self.monitor
    }
}

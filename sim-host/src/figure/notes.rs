//! Words inside a panel.

use super::chart::{Chart, Upright};
use super::corner::Corner;
use super::font;
use super::style::SMALL_SIZE;

/// A panel with its axes fixed and its legend placed.
pub(super) struct Canvas {
    /// Axis limits.
    pub x: (f64, f64),
    pub y: (f64, f64),
    /// Width between the axes \[px\].
    pub width: f64,
    pub legend: Corner,
    /// Width and height of the legend, as shares of the panel's.
    pub legend_size: (f64, f64),
    /// When the robot began to park, and by what.
    pub parking: Option<(f64, &'static str)>,
    /// When the base began to stop, and why.
    pub stop: Option<(f64, String)>,
}

/// From a label to one below it, as a share of the panel's height.
const BELOW: f64 = 0.09;
/// Beside a label \[px\].
const AIR: f64 = 5.0;

impl Canvas {
    /// Marks where parking and a stop begin, beside their lines and away from the legend.
    pub fn mark(&self, chart: &mut Chart) {
        if let Some((time, name)) = self.parking {
            self.mark_time(chart, time, name, 0.0);
        }
        if let Some((time, name)) = &self.stop {
            // They may be close together.
            let below = if self.parking.is_some() { BELOW } else { 0.0 };
            self.mark_time(chart, *time, name, below);
        }
    }

    fn mark_time(&self, chart: &mut Chart, time: f64, name: &str, below: f64) {
        chart.uprights.push(Upright {
            at: time,
            dashes: &[2.0, 3.0],
            label: "",
        });
        // A time of the user's, without the noise of its last digits.
        let text = format!("{name} {} s", (time * 1.0e3).round() / 1.0e3);
        let half = 0.5 * font::width(&text, SMALL_SIZE) + AIR;
        let (across, up) = self.beside(time, half);
        self.write(chart, text, (across, up - below));
    }

    /// The middle of a label of this half width \[px\] at the upper end, beside an instant and clear of the legend.
    fn beside(&self, time: f64, half: f64) -> (f64, f64) {
        let aside = half / self.width;
        let place = self.across(time);
        let fits_left = place > 2.0 * aside;
        let fits_right = place < 1.0 - 2.0 * aside;
        let left = fits_left && (self.legend.right || !fits_right);
        let place = if left { place - aside } else { place + aside };
        let (wide, high) = self.legend_size;
        let hidden = if self.legend.right {
            place + aside > 1.0 - wide
        } else {
            place - aside < wide
        };
        let below = if hidden && self.legend.top { high } else { 0.0 };
        (place, 0.93 - below)
    }

    /// A remark at the upper or lower end, clear of the line of the parking and of the legend.
    pub fn remark(&self, chart: &mut Chart, text: String, above: bool) {
        let (place, right) = match self.parking.map(|(time, _)| self.across(time)) {
            Some(line) if line < 0.5 => (0.5 * (line + 1.0), true),
            Some(line) => (0.5 * line, false),
            None if self.legend.right => (0.36, false),
            None => (0.64, true),
        };
        let shares_corner = self.legend.right == right && self.legend.top == above;
        let height = if shares_corner {
            self.legend_size.1
        } else {
            0.0
        };
        let up = if above { 0.86 - height } else { 0.05 + height };
        self.write(chart, text, (place, up));
    }

    fn across(&self, time: f64) -> f64 {
        (time - self.x.0) / (self.x.1 - self.x.0)
    }

    fn write(&self, chart: &mut Chart, text: String, (across, up): (f64, f64)) {
        let x = self.x.0 + across * (self.x.1 - self.x.0);
        let y = self.y.0 + up * (self.y.1 - self.y.0);
        chart.words.push((text, (x, y)));
    }
}

#[cfg(test)]
mod tests {
    use super::{Canvas, Corner};

    /// Of "hand-over 14.29 s" [px].
    const HALF: f64 = 60.0;

    /// Wherever the hand-over and the legend are.
    #[test]
    fn no_label_is_behind_a_legend() {
        for (right, top) in [(true, true), (true, false), (false, true), (false, false)] {
            for percent in 0..=100 {
                let canvas = Canvas {
                    x: (0.0, 100.0),
                    y: (0.0, 1.0),
                    width: 450.0,
                    legend: Corner { right, top },
                    legend_size: (0.25, 0.2),
                    parking: None,
                    stop: None,
                };
                let (across, up) = canvas.beside(f64::from(percent), HALF);
                let half = HALF / canvas.width;
                let apart = if right {
                    across + half <= 0.75
                } else {
                    across - half >= 0.25
                };
                let clear = if top { up <= 0.75 } else { up >= 0.25 };
                assert!(apart || clear, "{right} {top} {percent}: {across} {up}");
                assert!(across - half >= -1e-9 && across + half <= 1.0 + 1e-9);
            }
        }
    }
}

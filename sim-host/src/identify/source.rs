//! The battery behind a logged supply.

use super::log::{Drive, Log};
use super::quantity::Stated;

/// What feeds the motors from a row to the next: shares of a voltage.
#[derive(Clone, Copy, Debug)]
pub(super) struct Feed {
    /// Duties; of logs without a supply the commands themselves.
    pub(super) share: [f64; 2],
    /// Voltage with a load of `drawn` \[V\], 1 of logs without a supply, and that load \[A\].
    supply: f64,
    drawn: f64,
    /// Time, -1/2 to 1/2 within the log.
    time: f64,
}

impl Feed {
    /// Duties of a battery with this voltage without load, in the middle of a log.
    #[cfg(test)]
    pub(super) fn unloaded(share: [f64; 2], supply: f64) -> Self {
        Self {
            share,
            supply,
            drawn: 0.0,
            time: 0.0,
        }
    }

    /// Voltage without load of a battery of this resistance that drains by so much more over the log.
    pub(super) fn open(&self, ohm: f64, drain: f64) -> f64 {
        self.supply + ohm * self.drawn - drain * self.time
    }
}

/// Rows as they are fed, and the resistance behind them.
#[derive(Clone, Debug)]
pub(super) struct Source {
    pub(super) feeds: Vec<Feed>,
    pub(super) ohm: Stated,
    /// Volts over the log by which the even course of the supply may be off.
    pub(super) drain: Stated,
    /// Share by which all of that course may be off (standard deviation); 0 of one that is not averaged.
    pub(super) level: f64,
}

/// No battery, or one whose current nobody knows.
const STIFF: Stated = Stated {
    value: 0.0,
    deviation: 0.0,
};

/// Batteries have 0.02 to 0.5 ohm: standard deviation about 0 of one behind logged voltages \[ohm\].
const SOFT_OHM: f64 = 0.3;

/// A driver draws its duty a, less the dead band, times its motor's current, so a battery of resistance R_b gives
/// V = V_0 - R_b (a_R i_R + a_L i_L). The log has all but V_0 and R_b at the end of each row, and both are their
/// regression, with a V_0 that drains evenly. Row by row the supply would be too noisy: wheels turn a hundred
/// radians within a stretch, and a count is 1e-3. Between rows the current moves, and V with it, which the motion's
/// fit takes into account.
///
/// Voltages without a supply are those at the end of their rows. With them as shares of 1 V all is the same, and R_b is
/// per square of the supply, which the motion shows in part.
///
/// Rows that are `limited` are left out, for a driver that holds a current draws another duty than it is asked for.
/// `noise` is the standard deviation of the currents, which would make R_b too small by its share of their variance.
pub(super) fn source(log: &Log, limited: &[bool], band: [f64; 2], noise: f64) -> Source {
    let Some(supply) = &log.supply else {
        // Of a row later than the end, for the noise of that is what is left of the fit. Of the last rows nobody knows.
        let ends = log.current.iter().flat_map(|all| all.iter().skip(2));
        let ends = ends.copied().map(Some).chain(std::iter::repeat(None));
        let plain = |(share, end): (&[f64; 2], Option<[f64; 2]>)| Feed {
            share: *share,
            supply: 1.0,
            drawn: end.map_or(0.0, |end| share[0] * end[0] + share[1] * end[1]),
            time: 0.0,
        };
        let largest = log.command.iter().flatten();
        let largest = largest.fold(0.0_f64, |most, volts| most.max(volts.abs()));
        let soft = Stated {
            value: 0.0,
            deviation: SOFT_OHM / largest.powi(2),
        };
        let currents_of_voltages =
            log.drive == Drive::Voltage && log.current.is_some() && largest > 0.0;
        return Source {
            feeds: log.command.iter().zip(ends).map(plain).collect(),
            ohm: if currents_of_voltages { soft } else { STIFF },
            drain: STIFF,
            level: 0.0,
        };
    };
    let duty: Vec<_> = (log.command.iter().zip(supply))
        .map(|(volts, supply)| volts.map(|v| v / supply))
        .collect();
    let (begin, end) = (log.t[0], log.t[log.t.len() - 1]);
    let feed = |(row, (supply, drawn)): (usize, (f64, f64))| Feed {
        share: duty[row],
        supply,
        drawn,
        time: (log.t[row] - begin) / (end - begin) - 0.5,
    };
    let Some(current) = &log.current else {
        let fed = supply.iter().map(|&supply| (supply, 0.0)).enumerate();
        return Source {
            feeds: fed.map(feed).collect(),
            ohm: STIFF,
            drain: STIFF,
            level: 0.0,
        };
    };
    let acting = |duty: &[f64; 2], i: usize| (duty[i].abs() - band[i]).max(0.0).copysign(duty[i]);
    // The current at the end of a row is that of the next; of the last row nobody knows.
    let ends = current.iter().skip(1).chain(current.last());
    let drawn: Vec<_> = (duty.iter().zip(ends))
        .map(|(duty, i)| acting(duty, 0) * i[0] + acting(duty, 1) * i[1])
        .collect();
    let acts = |row: &usize| limited.get(*row) != Some(&true);
    let rows: Vec<_> = (0..duty.len()).filter(acts).collect();
    let (even_drawn, drawn_off) = even(&log.t, &drawn, &rows);
    let (even_supply, supply_off) = even(&log.t, supply, &rows);
    let (mut both, mut own, mut blurred) = (0.0, 0.0, 0.0);
    for &row in &rows {
        let acting = [0, 1].map(|i| acting(&duty[row], i).powi(2));
        both += drawn_off[row] * supply_off[row];
        own += drawn_off[row].powi(2);
        blurred += noise.powi(2) * (acting[0] + acting[1]);
    }
    let value = -both / (own - blurred);
    let left = rows.iter();
    let left = left.map(|&row| (supply_off[row] + value * drawn_off[row]).powi(2));
    let count = rows.len() as f64;
    let spread = (left.sum::<f64>() / count).sqrt();
    let off = |value: f64, deviation: f64| match value.is_finite() && deviation.is_finite() {
        true => Stated { value, deviation },
        // Of a robot that stands.
        false => STIFF,
    };
    // Of a mean.
    let mean = even_supply.iter().sum::<f64>() / even_supply.len() as f64;
    let level = off(0.0, spread / count.sqrt() / mean).deviation;
    let fed = even_supply.into_iter().zip(even_drawn).enumerate();
    Source {
        feeds: fed.map(feed).collect(),
        ohm: off(value, spread / own.sqrt()),
        // Of a regression on times spread evenly over 1, whose variance is 1/12.
        drain: off(0.0, spread * (12.0 / count).sqrt()),
        level,
    }
}

/// The even course of values in time, by linear regression over `rows`, and deviations from it.
fn even(t: &[f64], values: &[f64], rows: &[usize]) -> (Vec<f64>, Vec<f64>) {
    let mean = |of: &[f64]| rows.iter().map(|&row| of[row]).sum::<f64>() / rows.len() as f64;
    let (mean_t, mean_value) = (mean(t), mean(values));
    let (mut both, mut own) = (0.0, 0.0);
    for &row in rows {
        both += (t[row] - mean_t) * (values[row] - mean_value);
        own += (t[row] - mean_t).powi(2);
    }
    let course: Vec<_> = (t.iter().map(|t| mean_value + both / own * (t - mean_t))).collect();
    let off = values.iter().zip(&course).map(|(value, even)| value - even);
    let off = off.collect();
    (course, off)
}

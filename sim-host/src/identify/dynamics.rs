//! Fit of the wheels' motion and current: the system of [`super::wheels`] is simulated over each
//! stretch and laid on the measured angles, which are never differentiated.

use super::drivetrain::{self, Before, Found};
use super::fit::{Fit, Linear, Model, ROUNDS, fit};
use super::log::Log;
use super::motor;
use super::quantity::Known;
use super::ride::{Carried, Course, Ride, State};
use super::source::{Feed, source};
use super::start::guess;
use super::stretches::Stretch;
use super::wheels::{DYNAMIC, Wheels};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// Step of a one-sided difference, as a share of the parameter's size.
const STEP: f64 = 1.0e-5;
/// Time over which residuals may be correlated \[s\].
const CORRELATED_S: f64 = 0.2;

struct Motion<'a> {
    log: &'a Log,
    speeds: &'a [[f64; 2]],
    stretches: &'a [Stretch],
    /// D_e of the wheels' system, where that is stated.
    stated: [Option<f64>; 2],
    scale: DVector<f64>,
    /// What drivers turn the commands into.
    feeds: Vec<Feed>,
    /// What is known of lags, losses, bands and battery before the fit.
    before: Before,
}

/// Fits E, D, s and, with currents, alpha and beta of the right, then of the left motor; with them
/// lags, losses and dead bands, which the fit that is given back allows for.
pub(super) fn dynamics(
    log: &Log,
    known: &Known,
    speeds: &[[f64; 2]],
    stretches: &[Stretch],
    limited: &[bool],
) -> Option<(Fit, Found)> {
    let guess = guess(log, speeds, stretches)?;
    let count = guess.value.len();
    let mut scale = scale(&guess.value).insert_rows(count, drivetrain::COUNT, 0.0);
    (scale.rows_mut(count, drivetrain::COUNT)).copy_from_slice(&drivetrain::TYPICAL);
    let first = source(log, limited, guess.band.map(Option::unwrap_or_default), 0.0);
    let mut model = Motion {
        log,
        speeds,
        stretches,
        stated: motor::stated(log.drive, known),
        scale: scale.clone(),
        before: Before::new(log, known, &first),
        feeds: first.feeds,
    };
    let mut level = first.level;
    let mut start = guess.value.insert_rows(count, drivetrain::COUNT, 0.0);
    (start.rows_mut(count, drivetrain::COUNT))
        .copy_from_slice(&model.before.start(guess.loss, guess.band));
    let rows = log.t.len() - 1;
    let correlated = (CORRELATED_S * rows as f64 / (log.t[rows] - log.t[0])).ceil() as usize;
    let angle = log.step_rad.map_or(1.0e-3, |step| step / 12.0_f64.sqrt());
    let largest = log.current.iter().flatten().flatten();
    let current = 0.02 * largest.fold(0.0_f64, |most, i| most.max(i.abs())) + 1.0e-6;
    let sigma = match log.current {
        Some(_) => vec![angle, current],
        None => vec![angle],
    };
    // The last round is that with the battery.
    let rounds = ROUNDS - usize::from(log.supply.is_some());
    let mut whole = fit(
        &model,
        start.clone(),
        &scale,
        sigma.clone(),
        correlated,
        rounds,
    )?;
    if let (Some(_), &[_, noise]) = (&log.supply, whole.sigma.as_slice()) {
        // Again with what the battery's regression lacked: dead band and noise.
        let band = model.before.of(whole.value.as_slice()).band;
        let again = source(log, limited, band, noise);
        model.before = Before::new(log, known, &again);
        (model.feeds, level) = (again.feeds, again.level);
        whole = fit(&model, whole.value, &scale, whole.sigma, correlated, 1)?;
    }
    let (wheels, _) = model.wheels(whole.value.as_slice())?;
    whole.information = blurred(&whole, model.by_level(&whole), level);
    let (found, train) = model.before.set_apart(whole);
    // Lags show where a command steps, which is where limits act.
    let shows_lags = !limited.contains(&true);
    let train = train.with_lags(shows_lags.then(|| wheels.largest_lag()));
    if train.early() {
        // No lag but something else that would pull mass and resistance along.
        let early = train;
        model.before = model.before.without_lag();
        let mut without = fit(&model, start, &scale, sigma, correlated, ROUNDS)?;
        without.information = blurred(&without, model.by_level(&without), level);
        let (found, train) = model.before.set_apart(without);
        return Some((found, train.but_for_lag(&early)));
    }
    Some((found, train))
}

/// Typical sizes: the inertias', dampings' and frictions' own of both sides.
fn scale(p: &DVector<f64>) -> DVector<f64> {
    let mean = |a: usize, b: usize| 0.5 * (p[a].abs() + p[b].abs());
    let (e, d) = (mean(0, 3), mean(4, 5));
    // Friction worth the drag at a speed of 1 rad/s.
    let s = mean(6, 7) + d;
    let mut scale = vec![e, e, e, e, d, d, s, s];
    scale.extend(p.iter().skip(DYNAMIC).map(|x| x.abs().max(1.0e-9)));
    DVector::from_vec(scale)
}

/// The information of a fit whose volts are all off by an unknown share of this standard `deviation`, g being what moves with it: the
/// covariance grows by deviation^2 g g^T, so that of the information H is left (Sherman and Morrison)
///
/// ```text
/// H - H g g^T H/(1/deviation^2 + g^T H g)
/// ```
fn blurred(fit: &Fit, by_level: DVector<f64>, deviation: f64) -> DMatrix<f64> {
    let h = &fit.information;
    if deviation == 0.0 {
        return h.clone();
    }
    let moved = h * &by_level;
    let weight = deviation.powi(-2) + by_level.dot(&moved);
    h - &moved * moved.transpose() / weight
}

impl Motion<'_> {
    /// How the fit moves with the level of the supply, by its share: the same motion and the same currents follow of volts that are
    /// larger by a share if E, D, s and the battery's volts are larger by it and alpha is less. No residual shows it, so that it is no
    /// parameter.
    fn by_level(&self, fit: &Fit) -> DVector<f64> {
        let mut by = fit.value.clone();
        let (count, train) = (by.len(), self.before.of(fit.value.as_slice()));
        for i in DYNAMIC..count {
            by[i] = match i {
                _ if i + 2 == count => train.source_ohm,
                _ if i + 1 == count => train.drain,
                // alpha, beta = k/R, alpha, beta; then lags and shares.
                _ if i + drivetrain::COUNT < count && (i - DYNAMIC).is_multiple_of(2) => -by[i],
                _ => 0.0,
            };
        }
        by
    }

    fn per_sample(&self) -> usize {
        if self.log.current.is_some() { 4 } else { 2 }
    }

    /// The system of these parameters, with its D_e.
    fn wheels(&self, global: &[f64]) -> Option<(Wheels, [f64; 2])> {
        let emf = [0, 1].map(|i| match (self.stated[i], &self.log.current) {
            (Some(stated), _) => stated,
            (None, Some(_)) => motor::measured(global, i),
            // Nine tenths and more in gear motors; the rest enters times the lag only.
            (None, None) => global[4 + i],
        });
        let alpha = match self.log.current {
            Some(_) => [0, 1].map(|i| motor::alpha_beta(global, i)[0]),
            None => [0.0; 2],
        };
        let wheels = Wheels::new(global, emf, alpha, self.before.of(global))?;
        Some((wheels, emf))
    }

    /// Goes along a stretch: at each sample the state, how it follows from the start's speed if that is asked for, and the
    /// currents.
    fn along<const CARRIED: bool>(
        &self,
        global: &[f64],
        stretch: &Stretch,
        local: &DVector<f64>,
        course: &mut Vec<Course>,
        mut at: impl FnMut(usize, &Sample),
    ) -> Option<()> {
        let (wheels, emf) = self.wheels(global)?;
        let mut ride = Ride::new(&wheels, stretch.sign, course);
        let (angle, speed) = (
            Vector2::new(local[0], local[1]),
            Vector2::new(local[2], local[3]),
        );
        // No stretch begins at the first row; jumps before it are forgotten within a row or two.
        let (state, carried) = ride.settled(angle, speed, &self.feeds[stretch.first - 1])?;
        let mut sample = Sample {
            state,
            carried,
            current: [0.0; 2],
            current_by_speed: Matrix2::zeros(),
        };
        for row in stretch.first..=stretch.last {
            if self.log.current.is_some() {
                // Measured with the angles, before the row's own command.
                for (i, emf) in emf.into_iter().enumerate() {
                    let [alpha, beta] = motor::alpha_beta(global, i);
                    // A back-EMF that is not that of the current: stated, or held within the damping.
                    let other = alpha * emf - beta;
                    sample.current[i] =
                        alpha * sample.state.torque[i] + other * sample.state.speed[i];
                    if CARRIED {
                        let by_speed = alpha * sample.carried.torque.row(i)
                            + other * sample.carried.speed.row(i);
                        sample.current_by_speed.set_row(i, &by_speed);
                    }
                }
            }
            at(row - stretch.first, &sample);
            if row < stretch.last {
                let h = self.log.t[row + 1] - self.log.t[row];
                let (state, carried) = ride.row::<CARRIED>(sample.state, &self.feeds[row], h)?;
                sample.state = state;
                if CARRIED {
                    sample.carried = Carried {
                        angle: sample.carried.angle + carried.angle * sample.carried.speed,
                        speed: carried.speed * sample.carried.speed,
                        torque: carried.torque * sample.carried.speed,
                    };
                }
            }
        }
        Some(())
    }

    /// Predicted angles and currents, sample by sample.
    fn simulated(
        &self,
        global: &[f64],
        stretch: &Stretch,
        local: &DVector<f64>,
        course: &mut Vec<Course>,
    ) -> DVector<f64> {
        let mut rows = Vec::with_capacity(self.rows(stretch));
        let whole = self.along::<false>(global, stretch, local, course, |_, sample| {
            self.predict(sample, &mut rows);
        });
        self.predicted(stretch, rows, whole)
    }

    fn rows(&self, stretch: &Stretch) -> usize {
        self.per_sample() * (stretch.last - stretch.first + 1)
    }

    fn predict(&self, sample: &Sample, rows: &mut Vec<f64>) {
        rows.extend(sample.state.angle.iter());
        if self.log.current.is_some() {
            rows.extend(sample.current);
        }
    }

    fn predicted(&self, stretch: &Stretch, rows: Vec<f64>, whole: Option<()>) -> DVector<f64> {
        match whole {
            Some(()) => DVector::from_vec(rows),
            // No system: no sum of squares, so the step is refused.
            None => DVector::from_element(self.rows(stretch), f64::NAN),
        }
    }

    fn measured(&self, stretch: &Stretch) -> DVector<f64> {
        let mut rows = Vec::new();
        for row in stretch.first..=stretch.last {
            rows.extend(self.log.angle[row]);
            rows.extend(self.log.current.iter().flat_map(|current| current[row]));
        }
        DVector::from_vec(rows)
    }

    /// Those with their derivatives by the start state. What a jump of the command does at once counts as free of it, which
    /// is good to some permille.
    fn simulated_by_start(
        &self,
        global: &[f64],
        stretch: &Stretch,
        local: &DVector<f64>,
        course: &mut Vec<Course>,
    ) -> (DVector<f64>, DMatrix<f64>) {
        let per = self.per_sample();
        let mut rows = Vec::with_capacity(self.rows(stretch));
        let mut by_start = DMatrix::zeros(self.rows(stretch), 4);
        let whole = self.along::<true>(global, stretch, local, course, |n, sample| {
            self.predict(sample, &mut rows);
            let current = sample.current_by_speed;
            for i in 0..2 {
                let at = per * n + i;
                by_start[(at, i)] = 1.0;
                for side in 0..2 {
                    by_start[(at, 2 + side)] = sample.carried.angle[(i, side)];
                    if per > 2 {
                        by_start[(at + 2, 2 + side)] = current[(i, side)];
                    }
                }
            }
        });
        (self.predicted(stretch, rows, whole), by_start)
    }

    /// Whether rows depend on a parameter at all: not on the battery's resistance where no current is known, nor on its drain
    /// without a supply.
    fn acts(&self, parameter: usize, count: usize) -> bool {
        match count - parameter {
            1 => self.log.supply.is_some(),
            2 => self.log.current.is_some(),
            _ => true,
        }
    }
}

/// A sample of a stretch.
struct Sample {
    state: State,
    /// Derivatives by the speed at the stretch's start.
    carried: Carried,
    current: [f64; 2],
    current_by_speed: Matrix2<f64>,
}

impl Model for Motion<'_> {
    fn windows(&self) -> usize {
        self.stretches.len()
    }

    fn kinds(&self) -> &[usize] {
        if self.log.current.is_some() {
            &[0, 0, 1, 1]
        } else {
            &[0, 0]
        }
    }

    fn states_of_kind(&self) -> &[usize] {
        if self.log.current.is_some() {
            &[4, 0]
        } else {
            &[4]
        }
    }

    fn prior(&self, count: usize) -> DVector<f64> {
        self.before.prior(count)
    }

    fn start(&self, window: usize) -> DVector<f64> {
        let first = self.stretches[window].first;
        let (angle, speed) = (self.log.angle[first], self.speeds[first]);
        DVector::from_vec(vec![angle[0], angle[1], speed[0], speed[1]])
    }

    fn residual(&self, global: &DVector<f64>, window: usize, local: &DVector<f64>) -> DVector<f64> {
        let stretch = &self.stretches[window];
        self.simulated(global.as_slice(), stretch, local, &mut Vec::new()) - self.measured(stretch)
    }

    fn linear(&self, global: &DVector<f64>, window: usize, local: &DVector<f64>) -> Linear {
        let stretch = &self.stretches[window];
        // Where motors turn from driving to braking moves nothing, for there v is 0; so derivatives hold that, and have
        // no jumps.
        let mut course = Vec::new();
        let (here, by_start) =
            self.simulated_by_start(global.as_slice(), stretch, local, &mut course);
        let mut by_global = DMatrix::zeros(here.len(), global.len());
        let mut moved = global.clone();
        for i in (0..global.len()).filter(|&i| self.acts(i, global.len())) {
            let step = STEP * self.scale[i];
            moved[i] = global[i] + step;
            let there = self.simulated(moved.as_slice(), stretch, local, &mut course);
            by_global.set_column(i, &((there - &here) / step));
            moved[i] = global[i];
        }
        Linear {
            global: by_global,
            local: by_start,
        }
    }
}

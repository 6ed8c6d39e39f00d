//! What a log can determine at all, whatever was driven: the rank of the model.

use super::log::Drive;
use super::physics::{CURRENTS, Chart, MEASURED, MOTION, POSES};
use super::quantity::{COUNT, Known, Quantity};
use nalgebra::DMatrix;

/// What a log has besides commands and encoders, and what is stated.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// What the commands are.
    pub drive: Drive,
    /// External poses.
    pub poses: bool,
    /// Motor currents.
    pub currents: bool,
    /// Stated values; of them only which there are counts.
    pub known: Known,
}

/// A robot with nothing equal, round or zero: what is not identifiable here is nowhere, but for
/// freaks. In the order of [`Quantity::ALL`].
const GENERIC: [f64; COUNT] = [
    0.11, 0.093, 0.47, 7.3, 0.31, 0.013, 0.91, 0.73, 1.37, 1.13, 0.057, 0.068, 0.21, 0.33, 11.7,
];
/// Rounding of the derivatives is 1e-9 of their size, what the model has is above 1e-3.
const RANK: f64 = 1.0e-6;

impl Given {
    /// Whether each quantity is determined by exact, rich data, in the order of [`Quantity::ALL`];
    /// stated ones are.
    pub fn determined(&self) -> [bool; COUNT] {
        let chart = Chart {
            drive: self.drive,
            viscous: 1.0,
            coulomb: 1.0,
        };
        // A stated wheel inertia is a scale for the others; one that is not stated, or nothing, is not.
        let wheels = self.known.get(Quantity::WheelInertia);
        let scales = wheels.is_some_and(|inertia| inertia > 0.0);
        let x = Quantity::ALL.map(|q| {
            let none = q == Quantity::WheelInertia && !scales;
            chart.coordinate(q, if none { 0.0 } else { GENERIC[q.index()] })
        });
        let mut j = chart.derivatives(&x);
        for row in 0..MEASURED {
            let there = MOTION.contains(&row)
                || (self.poses && POSES.contains(&row))
                || (self.currents && CURRENTS.contains(&row));
            let size = j.row(row).norm();
            let factor = if there && size > 0.0 { 1.0 / size } else { 0.0 };
            j.row_mut(row).scale_mut(factor);
        }
        for quantity in Quantity::ALL {
            if self.is_given(quantity) {
                j.column_mut(quantity.index()).fill(0.0);
            }
        }
        let null = null_space(j);
        Quantity::ALL.map(|q| self.is_given(q) || null.row(q.index()).norm() < 1.0e3 * RANK)
    }

    /// Stated, or not a part of the model.
    pub(super) fn is_given(&self, quantity: Quantity) -> bool {
        self.known.get(quantity).is_some()
            // Not stated: its share is within mass and inertia, as `meaning` says.
            || quantity == Quantity::WheelInertia
            || (quantity == Quantity::Supply && self.drive != Drive::Duty)
    }

    /// What would determine `quantity`: single additions to the log or to what is stated, or, if
    /// there are none, pairs. Found by trying.
    pub fn advice(&self, quantity: Quantity) -> Vec<String> {
        let additions: Vec<_> = self
            .additions()
            .into_iter()
            .filter(|(_, _, states)| !states.contains(&quantity))
            .collect();
        let works = |more: &[&Addition]| {
            let mut given = self.clone();
            for (_, column, states) in more {
                given.poses |= *column == Column::Poses;
                given.currents |= *column == Column::Currents;
                if *column == Column::Supply {
                    given.drive = Drive::Voltage;
                }
                for stated in states {
                    given.known.set(*stated, GENERIC[stated.index()]);
                }
            }
            given.determined()[quantity.index()]
        };
        let single: Vec<_> = additions
            .iter()
            .filter(|addition| works(&[addition]))
            .map(|(text, _, _)| text.clone())
            .collect();
        if !single.is_empty() {
            return single;
        }
        let mut pairs = Vec::new();
        for (n, first) in additions.iter().enumerate() {
            for second in &additions[n + 1..] {
                if works(&[first, second]) {
                    pairs.push(format!("{} with {}", first.0, second.0));
                }
            }
        }
        pairs
    }

    fn additions(&self) -> Vec<Addition> {
        use Quantity as Q;
        let column = |column, text: &str| (text.to_owned(), column, vec![]);
        let mut all = Vec::new();
        if !self.poses {
            all.push(column(
                Column::Poses,
                "the external pose (columns x, y, theta)",
            ));
        }
        if !self.currents {
            all.push(column(
                Column::Currents,
                "motor currents (columns current_right, current_left)",
            ));
        }
        if self.drive == Drive::Duty {
            all.push(column(Column::Supply, "the supply voltage (column supply)"));
        }
        for (name, states) in [
            ("mass", vec![Q::Mass]),
            ("inertia", vec![Q::Inertia]),
            ("radius", vec![Q::RadiusRight, Q::RadiusLeft]),
            ("track", vec![Q::Track]),
            ("resistance", vec![Q::ResistanceRight, Q::ResistanceLeft]),
            (
                "motor_constant",
                vec![Q::MotorConstantRight, Q::MotorConstantLeft],
            ),
            ("viscous", vec![Q::ViscousRight, Q::ViscousLeft]),
        ] {
            if !states.iter().all(|q| self.is_given(*q)) {
                all.push((format!("--known {name}=..."), Column::None, states));
            }
        }
        all
    }
}

type Addition = (String, Column, Vec<Quantity>);

#[derive(Clone, Copy, PartialEq)]
enum Column {
    Poses,
    Currents,
    Supply,
    None,
}

/// An orthonormal base of what `j` maps to nothing, as columns.
fn null_space(j: DMatrix<f64>) -> DMatrix<f64> {
    let (rows, columns) = j.shape();
    let square = j.resize_vertically(rows.max(columns), 0.0);
    let svd = square.svd(false, true);
    let largest = svd.singular_values.amax();
    let Some(v_t) = svd.v_t else {
        return DMatrix::zeros(columns, 0);
    };
    let null: Vec<_> = (0..columns)
        .filter(|&i| svd.singular_values[i] <= RANK * largest)
        .collect();
    v_t.select_rows(&null).transpose()
}

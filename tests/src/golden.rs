//! Reader of the recorded closed loops in `golden/`.

use std::path::Path;

use nalgebra::{Matrix2, Vector2, Vector3};
use serde::Deserialize;

use crate::oracle::{OracleLaw, Params, Reference, Reset, Scenario, Switch};

/// Column names every file must have, in this order.
pub const COLUMNS: [&str; 20] = [
    "t", "x", "y", "theta", "v", "w", "ex", "ey", "etheta", "s1", "s2", "s3", "vs", "ws", "vc",
    "wc", "tau1", "tau2", "bv", "bw",
];

/// How the loop of a file was closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Controller and robot as one differential equation.
    Continuous,
    /// Torque held over each sample.
    Sampled,
}

/// One golden file.
#[derive(Clone, Debug, Deserialize)]
pub struct Golden {
    /// File name without extension.
    pub name: String,
    /// What the file shows.
    pub note: String,
    /// How the loop was closed.
    pub kind: Kind,
    /// Sample time of a sampled loop \[s\].
    pub dt: Option<f64>,
    /// Control law.
    pub controller: OracleLaw,
    /// Constants of robot and law.
    pub params: Params,
    /// Reference motion.
    pub reference: Reference,
    /// Posture of the robot at t = 0.
    pub q0: [f64; 3],
    /// Linear velocity of the robot at t = 0 \[m/s\].
    pub v0: f64,
    /// Angular velocity of the robot at t = 0 \[rad/s\].
    pub w0: f64,
    /// End of the run \[s\].
    #[serde(rename = "T")]
    pub duration: f64,
    /// Switch to parking \[s\].
    #[serde(rename = "P")]
    pub switch_at: Option<f64>,
    /// Instant whose reference posture is the target \[s\].
    #[serde(rename = "N")]
    pub target_at: f64,
    /// Posture to park at.
    pub target: [f64; 3],
    /// Rule for the acceleration neurons at the switch.
    pub reset: Reset,
    /// Treatment of initial neurons outside their bounds; the oracle knows "none".
    pub fallback: String,
    /// Parking law; the oracle knows "paper".
    pub park: String,
    /// Largest difference of any column to a second integration.
    pub estimated_accuracy: f64,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Row just before the switch.
    pub switch_pre: Option<[f64; 20]>,
    /// Row just after the switch.
    pub switch_post: Option<[f64; 20]>,
    /// The trace.
    pub rows: Vec<[f64; 20]>,
}

impl Golden {
    /// Reads `golden/<name>.json`.
    pub fn read(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("golden")
            .join(name)
            .with_extension("json");
        let text = std::fs::read_to_string(&path)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let golden: Self = serde_json::from_str(&text)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert_eq!(golden.columns, COLUMNS, "{name}: columns");
        golden
    }

    /// The run that the file records, for the oracle.
    pub fn scenario(&self) -> Scenario {
        assert_eq!(self.fallback, "none", "{}: fallback", self.name);
        assert_eq!(self.park, "paper", "{}: parking law", self.name);
        Scenario {
            params: self.params,
            law: self.controller,
            reference: self.reference,
            q0: Vector3::from(self.q0),
            twist0: Vector2::new(self.v0, self.w0),
            duration: self.duration,
            switch: self.switch_at.map(|at| Switch {
                at,
                target: Vector3::from(self.target),
                reset: self.reset,
            }),
            effort: Matrix2::identity(),
        }
    }

    /// Times of the rows \[s\]; a continuous trace has the switch twice.
    pub fn times(&self) -> Vec<f64> {
        self.rows.iter().map(|row| row[0]).collect()
    }
}

/// Largest absolute difference of two rows and the name of its column; NaN counts as infinite.
pub fn largest_difference(a: &[f64; 20], b: &[f64; 20]) -> (f64, &'static str) {
    let mut largest = (0.0, COLUMNS[0]);
    for ((x, y), name) in a.iter().zip(b).zip(COLUMNS) {
        let difference = (x - y).abs();
        if difference.is_nan() {
            return (f64::INFINITY, name);
        }
        if difference > largest.0 {
            largest = (difference, name);
        }
    }
    largest
}

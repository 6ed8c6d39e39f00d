//! Linear model predictive control of the tracking error.

use crate::law::{Body, Gain, Job, Now, Rival, Wanted, error, gain, sin_cos};
use crate::plan::Plan;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus,
};
use controller_core::motion::Limits;

/// Steps of the horizon.
const STEPS: usize = 10;
/// Both inputs of all steps.
const INPUTS: usize = 2 * STEPS;
/// A step of the horizon \[s\].
const STEP_S: f64 = 0.1;

/// The tracking error, linearised about the reference of each step, within the limits on speeds and accelerations;
/// a convex quadratic program a tick, for the interior-point solver Clarabel. It parks along a plan of turns and a drive.
#[derive(Clone, Debug)]
pub struct Mpc {
    /// On x, y, heading, speed and turn rate.
    weights: [f64; 5],
    limits: Limits<f32>,
    period_s: f32,
    plan: Plan,
    last: [f64; 2],
}

type Vector = [f64; 3];
type Matrix = [Vector; 3];

impl Mpc {
    /// Weights of x and y \[1/m²\], heading \[1/rad²\], speed \[s²/m²\] and turn rate \[s²/rad²\], as the literature on it
    /// has them, over a horizon of 1 s in steps of 0.1 s.
    pub const GAINS: [Gain; 5] = [
        Gain {
            name: "x",
            usual: 1.0,
        },
        Gain {
            name: "y",
            usual: 1.0,
        },
        Gain {
            name: "heading",
            usual: 0.5,
        },
        Gain {
            name: "speed",
            usual: 0.1,
        },
        Gain {
            name: "turn rate",
            usual: 0.1,
        },
    ];

    /// With gains in the order of the list.
    pub fn new(body: &Body, gains: &[f32]) -> Self {
        let mut weights = [0.0; 5];
        for (at, weight) in weights.iter_mut().enumerate() {
            *weight = f64::from(gain(gains, at)).max(1.0e-6);
        }
        Self {
            weights,
            limits: body.limits,
            period_s: body.period_s,
            plan: Plan::new(body),
            last: [0.0; 2],
        }
    }

    /// e⁺ = A e − B u with u beside the reference's twist; u of the first step, if the program was solved.
    fn solve(&self, error: Vector, references: &[[f64; 2]]) -> Option<[f64; 2]> {
        let [q_x, q_y, q_heading, r_v, r_w] = self.weights;
        // What each step's error owes to the error now and to all inputs.
        let mut free = error;
        let mut forced = [[0.0; INPUTS]; 3];
        let mut hessian = vec![[0.0; INPUTS]; INPUTS];
        let mut slope = [0.0; INPUTS];
        for (step, reference) in references.iter().enumerate().take(STEPS) {
            let a = transition(reference);
            free = times(&a, &free);
            let mut next = [[0.0; INPUTS]; 3];
            for (row, of) in next.iter_mut().zip(&a) {
                for (column, sum) in row.iter_mut().enumerate() {
                    *sum = (0..3).map(|k| of[k] * forced[k][column]).sum();
                }
            }
            forced = next;
            forced[0][2 * step] -= STEP_S;
            forced[1][2 * step + 1] -= 0.5 * STEP_S * STEP_S * reference[0];
            forced[2][2 * step + 1] -= STEP_S;
            for (state, q) in [q_x, q_y, q_heading].into_iter().enumerate() {
                let row = &forced[state];
                for (i, entries) in hessian.iter_mut().enumerate() {
                    slope[i] += q * row[i] * free[state];
                    for (j, entry) in entries.iter_mut().enumerate() {
                        *entry += q * row[i] * row[j];
                    }
                }
            }
        }
        for step in 0..STEPS {
            hessian[2 * step][2 * step] += r_v;
            hessian[2 * step + 1][2 * step + 1] += r_w;
        }
        let (constraints, bounds) = self.constraints(references);
        let upper: Vec<Vec<f64>> = (0..INPUTS)
            .map(|i| {
                (0..INPUTS)
                    .map(|j| if i <= j { hessian[i][j] } else { 0.0 })
                    .collect()
            })
            .collect();
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .max_iter(30)
            .build()
            .ok()?;
        let cones = [NonnegativeConeT(bounds.len())];
        let mut solver = DefaultSolver::new(
            &CscMatrix::from(&upper),
            &slope,
            &CscMatrix::from(&constraints),
            &bounds,
            &cones,
            settings,
        )
        .ok()?;
        solver.solve();
        let solved = matches!(
            solver.solution.status,
            SolverStatus::Solved | SolverStatus::AlmostSolved
        );
        let u = &solver.solution.x;
        solved.then(|| [u[0], u[1]])
    }

    /// Speeds and accelerations within the limits: rows g with g u ≤ h.
    fn constraints(&self, references: &[[f64; 2]]) -> (Vec<Vec<f64>>, Vec<f64>) {
        let limits = &self.limits;
        let accel = limits.accel.min(limits.brake);
        let most = [f64::from(limits.speed), f64::from(limits.turn_rate)];
        let change = [
            STEP_S * f64::from(accel),
            STEP_S * f64::from(limits.turn_accel),
        ];
        let (mut rows, mut bounds) = (Vec::new(), Vec::new());
        for (step, reference) in references.iter().enumerate().take(STEPS) {
            for axis in 0..2 {
                let at = 2 * step + axis;
                for sign in [1.0, -1.0] {
                    let mut row = vec![0.0; INPUTS];
                    row[at] = sign;
                    rows.push(row);
                    // A reference at its limit leaves nothing, but never less.
                    bounds.push((most[axis] - sign * reference[axis]).max(0.0));
                    let mut row = vec![0.0; INPUTS];
                    row[at] = sign;
                    let before = match step {
                        0 => self.last[axis],
                        _ => {
                            row[at - 2] = -sign;
                            references[step - 1][axis]
                        }
                    };
                    rows.push(row);
                    bounds.push(change[axis] - sign * (reference[axis] - before));
                }
            }
        }
        (rows, bounds)
    }
}

/// e⁺ = A e over a step, e = (x, y, θ) of the reference in the robot's frame: A = 1 + F + F²/2 with
/// F = T ((0, w, 0), (−w, 0, v), (0, 0, 0)).
fn transition([v, w]: &[f64; 2]) -> Matrix {
    let (v, w) = (STEP_S * v, STEP_S * w);
    [
        [1.0 - 0.5 * w * w, w, 0.5 * w * v],
        [-w, 1.0 - 0.5 * w * w, v],
        [0.0, 0.0, 1.0],
    ]
}

fn times(a: &Matrix, x: &Vector) -> Vector {
    let row = |of: &Vector| of[0] * x[0] + of[1] * x[1] + of[2] * x[2];
    [row(&a[0]), row(&a[1]), row(&a[2])]
}

impl Rival for Mpc {
    fn advance(&mut self, now: &Now, job: &Job<'_>) -> Option<Wanted> {
        let reference = self.plan.reference(now, job)?;
        let e = error(reference.pose(), &now.pose);
        let mut ahead = Vec::with_capacity(STEPS);
        for step in 0..STEPS {
            let later = STEP_S as f32 * step as f32;
            let twist = *self.plan.ahead(job, self.period_s, later)?.twist();
            ahead.push([f64::from(twist.linear), f64::from(twist.angular)]);
        }
        let error = [f64::from(e.x), f64::from(e.y), f64::from(e.theta)];
        let twist = reference.twist();
        // Without a solution the reference alone.
        let u = self.solve(error, &ahead).unwrap_or_default();
        let forward = twist.linear * sin_cos(e.theta).1;
        let wanted = Wanted::of(forward + u[0] as f32, twist.angular + u[1] as f32);
        self.last = [
            f64::from(wanted.twist.linear),
            f64::from(wanted.twist.angular),
        ];
        Some(wanted.with(*reference.accel()))
    }
}

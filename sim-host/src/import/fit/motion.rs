//! Eq. (6) driven by piecewise constant jerk: the state of the reference, exact in θ, v and w,
//! by Gauss-Legendre quadrature in x and y.

use nalgebra::{SMatrix, SVector};

/// x, y, θ, v, w, a, α.
pub(in super::super) type State = SVector<f64, 7>;
/// Jerk in v and w.
pub(in super::super) type Jerk = SVector<f64, 2>;
/// Derivative of a state with respect to an earlier one.
pub(in super::super) type ByState = SMatrix<f64, 7, 7>;
/// Derivative of a state with respect to the jerk before it.
pub(in super::super) type ByJerk = SMatrix<f64, 7, 2>;

/// Abscissae and weights of four points on [0, 1]: exact to degree 7, so 1e-12 m over 25 ms at
/// 10 rad/s.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_9, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// The state `h` seconds later.
pub(in super::super) fn advance(z: &State, u: &Jerk, h: f64) -> State {
    let (mut x, mut y) = (z[0], z[1]);
    for (node, weight) in GAUSS {
        let (theta, v, _) = at(z, u, node * h);
        let (sin, cos) = libm::sincos(theta);
        x += weight * h * v * cos;
        y += weight * h * v * sin;
    }
    let (theta, v, w) = at(z, u, h);
    let (a, alpha) = (z[5] + u[0] * h, z[6] + u[1] * h);
    State::from([x, y, theta, v, w, a, alpha])
}

/// The way driven after `h` seconds, forward less backward \[m\].
pub(in super::super) fn travel(z: &State, u: &Jerk, h: f64) -> f64 {
    gained(z[3], z[5], u[0], h)
}

/// The integral of a rate over `s` seconds.
fn gained(rate: f64, accel: f64, jerk: f64, s: f64) -> f64 {
    s * (rate + s * (accel / 2.0 + s * jerk / 6.0))
}

/// θ, v and w after `s` seconds: polynomials.
fn at(z: &State, u: &Jerk, s: f64) -> (f64, f64, f64) {
    let theta = z[2] + gained(z[4], z[6], u[1], s);
    let v = z[3] + s * (z[5] + s * u[0] / 2.0);
    let w = z[4] + s * (z[6] + s * u[1] / 2.0);
    (theta, v, w)
}

/// [`advance`] with its derivatives.
pub(in super::super) fn linearise(z: &State, u: &Jerk, h: f64) -> (State, ByState, ByJerk) {
    let mut a = ByState::identity();
    let mut b = ByJerk::zeros();
    for (node, weight) in GAUSS {
        let s = node * h;
        let (theta, v, _) = at(z, u, s);
        let (sin, cos) = libm::sincos(theta);
        for (row, by_v, by_theta) in [(0, cos, -v * sin), (1, sin, v * cos)] {
            let (by_v, by_theta) = (weight * h * by_v, weight * h * by_theta);
            a[(row, 2)] += by_theta;
            a[(row, 3)] += by_v;
            a[(row, 4)] += by_theta * s;
            a[(row, 5)] += by_v * s;
            a[(row, 6)] += by_theta * s * s / 2.0;
            b[(row, 0)] += by_v * s * s / 2.0;
            b[(row, 1)] += by_theta * s * s * s / 6.0;
        }
    }
    a[(2, 4)] = h;
    a[(2, 6)] = h * h / 2.0;
    a[(3, 5)] = h;
    a[(4, 6)] = h;
    b[(2, 1)] = h * h * h / 6.0;
    b[(3, 0)] = h * h / 2.0;
    b[(4, 1)] = h * h / 2.0;
    b[(5, 0)] = h;
    b[(6, 1)] = h;
    (advance(z, u, h), a, b)
}

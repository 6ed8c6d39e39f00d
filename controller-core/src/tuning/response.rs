//! How an error goes to 0 in a linear loop: when it has a tenth left, how hard it is worked.

use crate::range::larger;
use crate::scalar::Scalar;
use crate::stability::Polynomial;

/// Least steps over the horizon. A rate of 30 times the slowest is integrated with 0.5 a step.
const STEPS: u32 = 800;
/// They are doubled at most so often.
const DOUBLINGS: u32 = 5;
/// The sum of all rates times a step: the fastest is inside the stable region of the method, 2.78.
const STABLE: f64 = 2.5;

/// Room for a loop of sixth order.
const ORDER: usize = 6;

/// What became of an error of 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Response<T> {
    /// When the error stayed below a tenth; the horizon if it did not within it \[s\].
    pub(crate) tenth_s: T,
    /// Largest second derivative of the error \[1/s²\].
    pub(crate) peak_second: T,
    /// Largest third derivative of the error \[1/s³\].
    pub(crate) peak_third: T,
}

/// The error y of p(d/dt) y = 0 from y = 1, with all derivatives 0 but the highest, −`push`.
///
/// That is how all loops of this crate start: at rest relative to the reference, with a command and
/// a torque that go on smoothly. Runge-Kutta of fourth order, a bounded number of steps.
pub(crate) fn response<T: Scalar>(p: &Polynomial<T>, push: T, horizon_s: T) -> Response<T> {
    let f = T::from_f64;
    let order = p.degree();
    let rates = order.checked_sub(1).map_or(T::ZERO, |k| p.coefficient(k)) / p.leading();
    let needed = horizon_s * rates / f(STABLE);
    let steps = (0..DOUBLINGS)
        .map(|doublings| STEPS << doublings)
        .find(|steps| f(f64::from(*steps)) >= needed)
        .unwrap_or(STEPS << DOUBLINGS);
    let h = horizon_s / f(f64::from(steps));
    let (half, sixth) = (T::HALF * h, h / f(6.0));
    let mut state: [T; ORDER] = core::array::from_fn(|k| match k {
        0 => T::ONE,
        k if k + 1 == order => -push,
        _ => T::ZERO,
    });
    let mut found = Response {
        tenth_s: T::ZERO,
        peak_second: T::ZERO,
        peak_third: T::ZERO,
    };
    let tenth = f(0.1);
    let mut t = T::ZERO;
    for _ in 0..steps {
        let k1 = slope(p, &state);
        let k2 = slope(p, &moved(&state, &k1, half));
        let k3 = slope(p, &moved(&state, &k2, half));
        let k4 = slope(p, &moved(&state, &k3, h));
        let before = value(&state, 0).abs();
        state = core::array::from_fn(|k| {
            let middle = value(&k2, k) + value(&k3, k);
            value(&state, k) + sixth * (value(&k1, k) + middle + middle + value(&k4, k))
        });
        let after = value(&state, 0).abs();
        // So written that NaN is not settled.
        let settled = after <= tenth;
        if !settled {
            found.tenth_s = t + h;
        } else if before > tenth {
            found.tenth_s = t + h * (before - tenth) / (before - after);
        }
        found.peak_second = larger(value(&state, 2).abs(), found.peak_second);
        found.peak_third = larger(value(&state, 3).abs(), found.peak_third);
        t += h;
    }
    found
}

fn slope<T: Scalar>(p: &Polynomial<T>, state: &[T; ORDER]) -> [T; ORDER] {
    let order = p.degree();
    let pulled = (0..order).fold(T::ZERO, |sum, k| sum + p.coefficient(k) * value(state, k));
    let highest = -pulled / p.leading();
    core::array::from_fn(|k| {
        if k + 1 < order {
            value(state, k + 1)
        } else if k + 1 == order {
            highest
        } else {
            T::ZERO
        }
    })
}

fn moved<T: Scalar>(state: &[T; ORDER], slope: &[T; ORDER], h: T) -> [T; ORDER] {
    core::array::from_fn(|k| value(state, k) + h * value(slope, k))
}

fn value<T: Scalar>(state: &[T; ORDER], k: usize) -> T {
    state.get(k).copied().unwrap_or(T::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn critically_damped_pair_is_known() {
        // y = (1 + t) e^(−t): a tenth at 3.8897; y'' is −1 at the start, where it is the push.
        let p = Polynomial::new([1.0, 2.0, 1.0]);
        let found = response::<f64>(&p, 0.0, 12.0);
        // Interpolation within a step of 20 ms.
        assert!((found.tenth_s - 3.8897).abs() < 1e-3, "{found:?}");
        // A loop that does not settle gives its horizon.
        let slow = response::<f64>(&p, 0.0, 2.0);
        assert!((slow.tenth_s - 2.0).abs() < 1e-9);
    }
}

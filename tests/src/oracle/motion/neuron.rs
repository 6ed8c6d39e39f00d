//! Section 1: the neuron in units of its output.

/// What stands for exp(−a) over a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Itself.
    Exponential,
    /// 1/(1 + a + a²/2).
    Rational,
}

/// ξ and the input u of the last tick, of Eq. (4) with B = D.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Neuron {
    /// ξ.
    pub xi: f64,
    /// u.
    pub u: f64,
}

impl Neuron {
    /// As near to `xi` as the bound allows, with a desired value.
    pub fn at(xi: f64, desired: f64, a: f64, b: f64) -> Self {
        Self {
            xi: xi.clamp(-b, b),
            u: a * desired / b,
        }
    }

    /// A tick towards a desired value: the solution for the mean of both inputs.
    pub fn after(&self, desired: f64, a: f64, b: f64, dt: f64, rule: Rule) -> Self {
        let u = a * desired / b;
        let mean = (self.u + u) / 2.0;
        let decay = a + mean.abs();
        let settled = b * mean / decay;
        let x = decay * dt;
        let kept = match rule {
            Rule::Exponential => (-x).exp(),
            Rule::Rational => 1.0 / (1.0 + x + x * x / 2.0),
        };
        Self {
            xi: settled + (self.xi - settled) * kept,
            u,
        }
    }

    /// Eq. (4).
    pub fn rate(&self, a: f64, b: f64) -> f64 {
        let (up, down) = (self.u.max(0.0), (-self.u).max(0.0));
        -a * self.xi + (b - self.xi) * up - (b + self.xi) * down
    }
}

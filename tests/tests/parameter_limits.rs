//! Every parameter is refused below, above and beside its range, by name and limit.

use controller_core::error::{Field, ParamError, Problem};
use controller_core::paper::params::Params;
use controller_core::scalar::Scalar;

/// A parameter, its accepted range, and how it is set.
type Limit<T> = (Field, f64, f64, fn(&mut Params<T>, T));

fn limits<T: Scalar>() -> [Limit<T>; 19] {
    const GAIN: (f64, f64) = (1e-6, 1e6);
    const NEURON: (f64, f64) = (1e-3, 1e4);
    [
        (Field::Mass, 1e-3, 1e5, |p, v| p.robot.mass_kg = v),
        (Field::Inertia, 1e-6, 1e6, |p, v| p.robot.inertia_kg_m2 = v),
        (Field::RadiusRight, 1e-3, 10.0, |p, v| {
            p.robot.wheels.radius_right_m = v
        }),
        (Field::RadiusLeft, 1e-3, 10.0, |p, v| {
            p.robot.wheels.radius_left_m = v
        }),
        (Field::Track, 1e-2, 100.0, |p, v| p.robot.wheels.track_m = v),
        (Field::K1, GAIN.0, GAIN.1, |p, v| p.tracking.k1 = v),
        (Field::K2, GAIN.0, GAIN.1, |p, v| p.tracking.k2 = v),
        (Field::K3, GAIN.0, GAIN.1, |p, v| p.tracking.k3 = v),
        (Field::Kd1, GAIN.0, GAIN.1, |p, v| p.tracking.k_d1 = v),
        (Field::Kd2, GAIN.0, GAIN.1, |p, v| p.tracking.k_d2 = v),
        (Field::K4, GAIN.0, GAIN.1, |p, v| p.parking.k4 = v),
        (Field::K5, GAIN.0, GAIN.1, |p, v| p.parking.k5 = v),
        (Field::Kc1, GAIN.0, GAIN.1, |p, v| p.parking.k_c1 = v),
        (Field::Kc2, GAIN.0, GAIN.1, |p, v| p.parking.k_c2 = v),
        (Field::DecayA, NEURON.0, NEURON.1, |p, v| p.neurons.a = v),
        (Field::UpperB, NEURON.0, NEURON.1, |p, v| p.neurons.b = v),
        (Field::LowerD, NEURON.0, NEURON.1, |p, v| p.neurons.d = v),
        (Field::MaxWheelTorque, 1e-6, 1e6, |p, v| {
            p.max_wheel_torque_nm = Some(v)
        }),
        (Field::MaxTick, 1e-6, 1e3, |p, v| p.max_tick_s = v),
    ]
}

fn check<T: Scalar>() {
    let f = T::from_f64;
    for (field, low, high, set) in limits::<T>() {
        let with = |value: f64| {
            let mut params = Params::<T>::paper();
            set(&mut params, f(value));
            params.validate().map(|_| ())
        };
        for accepted in [low, high, (low * high).sqrt()] {
            assert_eq!(with(accepted), Ok(()), "{field:?} = {accepted}");
        }
        let refused = |value: f64, problem: Problem| {
            assert_eq!(
                with(value),
                Err(ParamError { field, problem }),
                "{field:?} = {value}"
            );
        };
        for below in [0.999 * low, 0.0, -1.0, -1e30] {
            refused(below, Problem::Below(low));
        }
        for above in [1.001 * high, 1e30] {
            refused(above, Problem::Above(high));
        }
        for none in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            refused(none, Problem::NotFinite);
        }
    }
}

/// The constants of Eq. (3), Eq. (4), Eq. (10) to Eq. (16), Eq. (20) and Eq. (21), in either precision.
#[test]
fn every_parameter_is_refused_outside_its_range() {
    check::<f64>();
    check::<f32>();
}

/// A refusal can be read: the paper's name of the parameter and the limit.
#[test]
fn refusals_name_field_and_limit() {
    for (field, low, high, _) in limits::<f64>() {
        for (problem, limit) in [
            (Problem::Below(low), format!("{low:e}")),
            (Problem::Above(high), format!("{high:e}")),
            (Problem::NotFinite, "finite".to_string()),
        ] {
            let text = ParamError { field, problem }.to_string();
            assert!(
                text.starts_with(field.name()) && text.contains(&limit),
                "{text}"
            );
        }
    }
    let problem = Problem::Singular;
    let text = ParamError {
        field: Field::WheelMatrix,
        problem,
    }
    .to_string();
    assert!(
        text.contains("B-bar") && text.contains("inverted"),
        "{text}"
    );
}

/// Names are distinct, so that a scenario file's key is known from the message.
#[test]
fn field_names_are_distinct() {
    let mut names: Vec<_> = limits::<f64>().iter().map(|limit| limit.0.name()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), limits::<f64>().len());
}

/// The paper's own parameters are accepted, and given back as they were.
#[test]
fn recommended_parameters_are_accepted() {
    let params = Params::<f64>::paper();
    let accepted = params.validate().expect("the paper's robot");
    assert_eq!(accepted.params(), &params);
    assert!(Params::<f32>::paper().validate().is_ok());
}

//! Bad inputs give their own fault and leave the controller as it was, bit for bit, in either phase of either controller.

use controller_core::error::{Input, StepFault};
use controller_core::maths::{Libm, Maths, Single};
use controller_core::paper::demand::Demand;
use controller_core::paper::neural::NeuralController;
use controller_core::paper::plain::PlainController;
use controller_core::paper::report::Phase;
use controller_core::reference::Reference;
use controller_core::scalar::Scalar;
use controller_core::types::{Accel, Measured, Pose, Twist};
use tests::core_loop::{Controller, Exact};
use tests::core_params::{core_params, spoiled as spoil_reference};
use tests::oracle::{Params, Reset};

/// Longest accepted tick in these tests \[s\].
const MAX_TICK: f64 = 0.5;

fn reference<T: Scalar>() -> Reference<T>
where
    Libm: Maths<T>,
{
    let f = T::from_f64;
    Reference::new_with::<Libm>(
        Pose::new(f(0.1), f(0.2), f(0.3)),
        Twist::new(f(0.4), f(0.1)),
        Accel::new(f(0.05), f(-0.05)),
    )
}

fn good<T: Scalar>() -> Measured<T>
where
    Libm: Maths<T>,
{
    let f = T::from_f64;
    Measured {
        pose: Pose::new(f(-0.3), f(0.6), f(0.2)),
        twist: Twist::new(f(0.1), f(-0.2)),
    }
}

/// A controller after some ticks in either phase.
fn under_way<T: Scalar, C: Controller<T>>(phase: Phase) -> C
where
    Libm: Maths<T>,
{
    let mut params = core_params::<T>(&Params::recommended(), Reset::Corrected);
    params.max_tick_s = T::from_f64(MAX_TICK);
    let params = params.validate().expect("in range");
    let (mut controller, _) = C::begin(&params, &reference(), &good()).expect("finite");
    let dt = T::from_f64(0.01);
    let mut tick = |demand| controller.tick(dt, &demand, &good()).expect("a good tick");
    tick(Demand::Track(reference()));
    if phase == Phase::Parking {
        let goal = *reference().pose();
        tick(Demand::HandOver {
            reference: reference(),
            goal,
        });
        assert_eq!(tick(Demand::Park).phase, phase);
    }
    controller
}

/// Asserts the fault and that nothing changed, not even the sign of a zero.
fn assert_refused<T: Scalar, C: Controller<T>>(
    before: &C,
    dt: T,
    demand: &Demand<T>,
    measured: &Measured<T>,
    expected: StepFault,
) where
    Libm: Maths<T>,
{
    let mut after = *before;
    let found = after.tick(dt, demand, measured).expect_err("a bad tick");
    assert_eq!(found, expected, "{dt:?} {demand:?} {measured:?}");
    assert_eq!(&after, before);
    assert_eq!(format!("{after:?}"), format!("{before:?}"));
}

/// Every copy of `value` with one of its numbers replaced.
fn spoiled<V: Copy, T: Copy>(value: V, bad: T, fields: &[fn(&mut V, T)]) -> Vec<V> {
    fields
        .iter()
        .map(|set| {
            let mut copy = value;
            set(&mut copy, bad);
            copy
        })
        .collect()
}

fn spoiled_poses<T: Scalar>(bad: T) -> Vec<Pose<T>>
where
    Libm: Maths<T>,
{
    spoiled(
        *reference().pose(),
        bad,
        &[|p, v| p.x = v, |p, v| p.y = v, |p, v| p.theta = v],
    )
}

/// Demands that fit the phase.
fn fitting<T: Scalar>(phase: Phase) -> Vec<Demand<T>>
where
    Libm: Maths<T>,
{
    let goal = *reference().pose();
    match phase {
        Phase::Tracking => vec![
            Demand::Track(reference()),
            Demand::HandOver {
                reference: reference(),
                goal,
            },
        ],
        Phase::Parking => vec![Demand::Park],
    }
}

fn refuses_everything_bad<T: Scalar, C: Controller<T>>()
where
    Libm: Maths<T>,
{
    let f = T::from_f64;
    let dt = f(0.01);
    let bad_numbers = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY].map(f);
    for phase in [Phase::Tracking, Phase::Parking] {
        let controller = under_way::<T, C>(phase);
        for demand in fitting(phase) {
            for bad in bad_numbers {
                for pose in spoiled_poses(bad) {
                    let measured = Measured { pose, ..good() };
                    let fault = StepFault::NotFinite(Input::Pose);
                    assert_refused(&controller, dt, &demand, &measured, fault);
                }
                for twist in [Twist::new(bad, T::ZERO), Twist::new(T::ZERO, bad)] {
                    let measured = Measured { twist, ..good() };
                    let fault = StepFault::NotFinite(Input::Twist);
                    assert_refused(&controller, dt, &demand, &measured, fault);
                }
            }
            let too_long = StepFault::TickTooLong {
                max_tick_us: 500_000,
            };
            for (dt, fault) in [
                (0.0, StepFault::TickNotPositive),
                (-0.0, StepFault::TickNotPositive),
                (-0.01, StepFault::TickNotPositive),
                (f64::NEG_INFINITY, StepFault::TickNotPositive),
                (f64::NAN, StepFault::NotFinite(Input::Tick)),
                (0.500_001, too_long),
                (f64::INFINITY, too_long),
            ] {
                assert_refused(&controller, f(dt), &demand, &good(), fault);
            }
            let mut accepted = controller;
            accepted
                .tick(f(MAX_TICK), &demand, &good())
                .expect("the longest tick");
            // Far away in every direction: finite, but its torque is not.
            let far = Measured {
                pose: Pose::new(-T::MAX, -T::MAX, f(0.2)),
                ..good()
            };
            assert_refused(&controller, dt, &demand, &far, StepFault::Overflow);
        }
    }
    refuses_bad_demands::<T, C>(dt, &bad_numbers);
    refuses_bad_starts::<T, C>(&bad_numbers);
}

fn refuses_bad_demands<T: Scalar, C: Controller<T>>(dt: T, bad_numbers: &[T])
where
    Libm: Maths<T>,
{
    let (tracking, parking) = (
        under_way::<T, C>(Phase::Tracking),
        under_way::<T, C>(Phase::Parking),
    );
    let goal = *reference().pose();
    for bad in bad_numbers {
        for reference in spoil_reference(&reference(), *bad) {
            let fault = StepFault::NotFinite(Input::Reference);
            for demand in [
                Demand::Track(reference),
                Demand::HandOver { reference, goal },
            ] {
                assert_refused(&tracking, dt, &demand, &good(), fault);
            }
        }
        for goal in spoiled_poses(*bad) {
            let demand = Demand::HandOver {
                reference: reference(),
                goal,
            };
            let fault = StepFault::NotFinite(Input::Goal);
            assert_refused(&tracking, dt, &demand, &good(), fault);
        }
    }
    let wrong = StepFault::WrongPhase;
    assert_refused(&tracking, dt, &Demand::Park, &good(), wrong);
    for demand in fitting(Phase::Tracking) {
        assert_refused(&parking, dt, &demand, &good(), wrong);
    }
}

fn refuses_bad_starts<T: Scalar, C: Controller<T>>(bad_numbers: &[T])
where
    Libm: Maths<T>,
{
    let params = core_params::<T>(&Params::recommended(), Reset::Corrected);
    let params = params.validate().expect("in range");
    let fault = |reference: &Reference<T>, measured: &Measured<T>| {
        C::begin(&params, reference, measured)
            .map(|_| ())
            .expect_err("a bad start")
    };
    for bad in bad_numbers {
        for reference in spoil_reference(&reference(), *bad) {
            assert_eq!(
                fault(&reference, &good()),
                StepFault::NotFinite(Input::Reference)
            );
        }
        for pose in spoiled_poses(*bad) {
            let found = fault(&reference(), &Measured { pose, ..good() });
            assert_eq!(found, StepFault::NotFinite(Input::Pose));
        }
        let twist = Twist::new(*bad, T::ZERO);
        let found = fault(&reference(), &Measured { twist, ..good() });
        assert_eq!(found, StepFault::NotFinite(Input::Twist));
    }
    let far = Measured {
        pose: Pose::new(-T::MAX, -T::MAX, T::ZERO),
        ..good()
    };
    let [away, ..] = &spoil_reference(&reference(), T::MAX)[..] else {
        panic!("seven references")
    };
    let away = *away;
    assert_eq!(fault(&away, &far), StepFault::Overflow);
}

/// The controller of Eq. (15) to Eq. (23).
#[test]
fn neural_controller_refuses_bad_inputs_unchanged() {
    refuses_everything_bad::<f64, Exact>();
    refuses_everything_bad::<f32, NeuralController<f32>>();
    refuses_everything_bad::<f32, NeuralController<f32, Single>>();
}

/// The controller of Eq. (10) to Eq. (14).
#[test]
fn plain_controller_refuses_bad_inputs_unchanged() {
    refuses_everything_bad::<f64, PlainController<f64, Libm>>();
    refuses_everything_bad::<f32, PlainController<f32, Libm>>();
}

/// Every fault says what it is about.
#[test]
fn faults_say_what_is_wrong() {
    for (fault, word) in [
        (StepFault::NotFinite(Input::Pose), "Pose"),
        (StepFault::NotFinite(Input::Twist), "Twist"),
        (StepFault::NotFinite(Input::Reference), "Reference"),
        (StepFault::NotFinite(Input::Goal), "Goal"),
        (StepFault::NotFinite(Input::Tick), "Tick"),
        (StepFault::TickNotPositive, "not positive"),
        (
            StepFault::TickTooLong {
                max_tick_us: 500_000,
            },
            "500000 us",
        ),
        (StepFault::WrongPhase, "phase"),
        (StepFault::Overflow, "too large"),
    ] {
        assert!(fault.to_string().contains(word), "{fault}");
    }
}

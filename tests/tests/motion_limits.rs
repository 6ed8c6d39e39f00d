//! Never a command or a torque beyond a limit, whatever comes in.

use controller_core::error::StepFault;
use controller_core::maths::{Libm, Maths, Single};
use controller_core::motion::{Limits, MotionController, MotionReport, SaturationPolicy, Task};
use controller_core::reference::Reference;
use controller_core::scalar::Scalar;
use controller_core::shunting::{ExactMean, NeuronUpdate, RationalMean};
use controller_core::types::{Accel, Measured, Pose, Twist};
use proptest::prelude::*;
use tests::core_draw::{cases, decades, finite};
use tests::motion_base::Base;
use tests::stated::{At, Stated};
use tests::tolerance::MOTION_LIMIT;

/// One tick's inputs: time, three words, twelve numbers.
#[derive(Clone, Debug)]
struct Tick {
    dt: f64,
    follow: bool,
    declared: bool,
    values: Vec<f64>,
}

/// Ordinary, zero, an end of the range, or anything finite.
fn value<T: Scalar>(wild: u32) -> BoxedStrategy<f64> {
    prop_oneof![
        20 => -5.0..5.0,
        2 => Just(0.0),
        wild => finite::<T>(),
        wild => prop_oneof![Just(T::MAX.to_f64()), Just(-T::MAX.to_f64())],
    ]
    .boxed()
}

fn ticks<T: Scalar>() -> impl Strategy<Value = Vec<Tick>> {
    // Sequences without a wild value reach deeper; half of all are such.
    prop_oneof![Just(0), Just(2)].prop_flat_map(|wild| {
        let tick = (
            decades(-4.0, -0.4),
            any::<bool>(),
            any::<bool>(),
            prop::collection::vec(value::<T>(wild), 12),
        )
            .prop_map(|(dt, follow, declared, values)| Tick {
                dt,
                follow,
                declared,
                values,
            });
        prop::collection::vec(tick, 1..60)
    })
}

fn bases() -> impl Strategy<Value = Base> {
    let policy = prop_oneof![
        Just(SaturationPolicy::KeepCurvature),
        Just(SaturationPolicy::TurnFirst),
        Just(SaturationPolicy::DriveFirst)
    ];
    let range = || decades(-1.0, 1.0);
    let accels = (
        range(),
        range(),
        range(),
        decades(0.0, 2.0),
        decades(0.0, 2.0),
    );
    (
        (range(), range(), range()),
        accels,
        decades(-2.0, 2.0),
        policy,
    )
        .prop_map(
            |(
                (speed, turn_rate, rim_speed),
                (accel, brake, turn_accel, jerk, turn_jerk),
                torque,
                policy,
            )| Base {
                limits: Limits {
                    speed,
                    turn_rate,
                    rim_speed,
                    accel,
                    brake,
                    turn_accel,
                    jerk,
                    turn_jerk,
                    wheel_torque_nm: torque,
                    policy,
                },
                ..Base::STANDARD
            },
        )
}

fn inputs<T: Scalar, M: Maths<T>>(tick: &Tick) -> (Task<T>, Measured<T>) {
    let f = |i: usize| T::from_f64(tick.values[i]);
    let goal = Pose::new(f(0), f(1), f(2));
    let task = if tick.follow {
        let (twist, accel) = (Twist::new(f(3), f(4)), Accel::new(f(5), f(6)));
        Task::Follow(Reference::new_with::<M>(goal, twist, accel))
    } else {
        Task::Park(goal)
    };
    let measured = Measured {
        pose: Pose::new(f(7), f(8), f(9)),
        twist: Twist::new(f(10), f(11)),
    };
    (task, measured)
}

/// Checks a report against the limits and against the one before.
fn check<T: Scalar>(
    limits: &Limits<T>,
    report: &MotionReport<T>,
    last: &MotionReport<T>,
    dt: Option<T>,
) -> Result<(), TestCaseError> {
    let torque = limits.wheel_torque_nm;
    prop_assert!(report.torques.right.abs() <= torque, "{report:?}");
    prop_assert!(report.torques.left.abs() <= torque, "{report:?}");
    let command = &report.command;
    prop_assert!(command.linear.abs() <= limits.speed, "{report:?}");
    prop_assert!(command.angular.abs() <= limits.turn_rate, "{report:?}");
    // Two products and a sum, each rounded.
    let rim =
        command.linear.abs() + T::from_f64(0.5 * Base::STANDARD.track) * command.angular.abs();
    let rounded = T::from_f64(1.0 + MOTION_LIMIT) * limits.rim_speed;
    prop_assert!(rim <= rounded, "{report:?}");
    let rate = &report.command_rate;
    let (accel, brake) = (limits.accel, limits.brake);
    let either = if accel > brake { accel } else { brake };
    prop_assert!(rate.linear.abs() <= either, "{report:?}");
    prop_assert!(rate.angular.abs() <= limits.turn_accel, "{report:?}");
    let Some(dt) = dt else { return Ok(()) };
    let slack = T::from_f64(1.0 + MOTION_LIMIT);
    let jerk = (rate.linear - last.command_rate.linear).abs();
    prop_assert!(jerk <= slack * limits.jerk * dt + T::from_f64(MOTION_LIMIT) * either);
    let jerk = (rate.angular - last.command_rate.angular).abs();
    let rounding = T::from_f64(MOTION_LIMIT) * limits.turn_accel;
    prop_assert!(jerk <= slack * limits.turn_jerk * dt + rounding);
    // A saturated torque sets the command back to what was achieved: no slewing then.
    if last.limited.torque {
        return Ok(());
    }
    let change = command.linear - last.command.linear;
    let speeds_up = change * last.command.linear >= T::ZERO;
    let most = if speeds_up { accel } else { brake };
    let rounding = T::from_f64(MOTION_LIMIT) * limits.speed;
    prop_assert!(
        change.abs() <= slack * most * dt + rounding,
        "{last:?} {report:?}"
    );
    let change = (command.angular - last.command.angular).abs();
    let rounding = T::from_f64(MOTION_LIMIT) * limits.turn_rate;
    prop_assert!(change <= slack * limits.turn_accel * dt + rounding);
    Ok(())
}

/// Every tick either keeps all limits or is refused and changes nothing.
fn stays_within<T, M, U>(base: &Base, ticks: &[Tick]) -> Result<(), TestCaseError>
where
    T: Scalar,
    M: Maths<T> + PartialEq,
    U: NeuronUpdate<T> + PartialEq,
{
    let motion = base.params::<T, M>().validate().expect("valid");
    let limits = motion.params().limits;
    let (task, measured) = inputs::<T, M>(&ticks[0]);
    let started = MotionController::<T, M, U>::start(&motion, &task, &measured);
    let mut controller = match started {
        Ok(controller) => controller,
        Err(fault) => {
            prop_assert_eq!(fault, StepFault::Overflow);
            return Ok(());
        }
    };
    check(&limits, controller.report(), &MotionReport::default(), None)?;
    for tick in &ticks[1..] {
        if tick.declared {
            controller.declare_jump();
        }
        let before = controller;
        let (task, measured) = inputs::<T, M>(tick);
        let dt = T::from_f64(tick.dt);
        match controller.step(dt, &task, &measured) {
            Ok(report) => check(&limits, report, before.report(), Some(dt))?,
            Err(fault) => {
                prop_assert_eq!(fault, StepFault::Overflow);
                prop_assert_eq!(controller, before);
            }
        }
    }
    Ok(())
}

/// Sequences in each precision.
const SEQUENCES: u32 = 5000;

#[test]
fn as_many_sequences_are_drawn_as_stated() {
    Stated::of("docs/motion.md").exactly(
        At::Phrase("# random sequences of inputs, finite but of any size"),
        &[2.0 * f64::from(SEQUENCES)],
    );
}

proptest! {
    #![proptest_config(cases(SEQUENCES))]

    #[test]
    fn no_input_drives_double_precision_past_a_limit(
        base in bases(),
        ticks in ticks::<f64>(),
    ) {
        stays_within::<f64, Libm, ExactMean>(&base, &ticks)?;
    }

    #[test]
    fn no_input_drives_single_precision_past_a_limit(
        base in bases(),
        ticks in ticks::<f32>(),
    ) {
        stays_within::<f32, Single, RationalMean>(&base, &ticks)?;
    }
}

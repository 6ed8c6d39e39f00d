//! Between what travels and what the core computes with. Conversions change no bit.

use controller_core::error::{Input, StepFault};
use controller_core::paper::demand::Demand;
use controller_core::paper::params::{Params, ParkingGains, Reset, TrackingGains};
use controller_core::robot::Robot;
use controller_core::shunting::NeuronParams;
use controller_core::types::Measured;
use controller_core::wheels::WheelGeometry;

use super::{ParameterSet, Refusal, WireDemand, WireMeasured, WireReset};

impl From<&Params<f32>> for ParameterSet {
    fn from(params: &Params<f32>) -> Self {
        let Params {
            robot,
            tracking,
            parking,
            neurons,
            ..
        } = params;
        Self {
            mass: robot.mass_kg,
            inertia: robot.inertia_kg_m2,
            radius_right: robot.wheels.radius_right_m,
            radius_left: robot.wheels.radius_left_m,
            track: robot.wheels.track_m,
            k1: tracking.k1,
            k2: tracking.k2,
            k3: tracking.k3,
            k_d1: tracking.k_d1,
            k_d2: tracking.k_d2,
            k4: parking.k4,
            k5: parking.k5,
            k_c1: parking.k_c1,
            k_c2: parking.k_c2,
            a: neurons.a,
            b: neurons.b,
            d: neurons.d,
            reset: match params.reset {
                Reset::TorqueContinuous => WireReset::TorqueContinuous,
                Reset::Printed => WireReset::Printed,
                Reset::Zero => WireReset::Zero,
            },
            max_wheel_torque: params.max_wheel_torque_nm,
            max_tick: params.max_tick_s,
        }
    }
}

impl From<&ParameterSet> for Params<f32> {
    fn from(set: &ParameterSet) -> Self {
        Self {
            robot: Robot {
                mass_kg: set.mass,
                inertia_kg_m2: set.inertia,
                wheels: WheelGeometry {
                    radius_right_m: set.radius_right,
                    radius_left_m: set.radius_left,
                    track_m: set.track,
                },
            },
            tracking: TrackingGains {
                k1: set.k1,
                k2: set.k2,
                k3: set.k3,
                k_d1: set.k_d1,
                k_d2: set.k_d2,
            },
            parking: ParkingGains {
                k4: set.k4,
                k5: set.k5,
                k_c1: set.k_c1,
                k_c2: set.k_c2,
            },
            neurons: NeuronParams {
                a: set.a,
                b: set.b,
                d: set.d,
            },
            reset: match set.reset {
                WireReset::TorqueContinuous => Reset::TorqueContinuous,
                WireReset::Printed => Reset::Printed,
                WireReset::Zero => Reset::Zero,
            },
            max_wheel_torque_nm: set.max_wheel_torque,
            max_tick_s: set.max_tick,
        }
    }
}

impl From<&Measured<f32>> for WireMeasured {
    fn from(measured: &Measured<f32>) -> Self {
        Self {
            pose: (&measured.pose).into(),
            twist: (&measured.twist).into(),
        }
    }
}

impl From<&WireMeasured> for Measured<f32> {
    fn from(wire: &WireMeasured) -> Self {
        Self {
            pose: (&wire.pose).into(),
            twist: (&wire.twist).into(),
        }
    }
}

impl From<&Demand<f32>> for WireDemand {
    fn from(demand: &Demand<f32>) -> Self {
        match demand {
            Demand::Track(reference) => Self::Track(reference.into()),
            Demand::HandOver { reference, goal } => Self::HandOver {
                reference: reference.into(),
                goal: goal.into(),
            },
            Demand::Park => Self::Park,
        }
    }
}

impl From<&WireDemand> for Demand<f32> {
    fn from(wire: &WireDemand) -> Self {
        match wire {
            WireDemand::Track(reference) => Self::Track(reference.into()),
            WireDemand::HandOver { reference, goal } => Self::HandOver {
                reference: reference.into(),
                goal: goal.into(),
            },
            WireDemand::Park => Self::Park,
        }
    }
}

impl From<StepFault> for Refusal {
    fn from(fault: StepFault) -> Self {
        match fault {
            StepFault::NotFinite(Input::Pose) => Self::Pose,
            StepFault::NotFinite(Input::Twist) => Self::Twist,
            StepFault::NotFinite(Input::Reference) => Self::Reference,
            StepFault::NotFinite(Input::Goal) => Self::Goal,
            StepFault::NotFinite(Input::Tick) => Self::Tick,
            StepFault::TickNotPositive => Self::TickNotPositive,
            StepFault::TickTooLong { .. } => Self::TickTooLong,
            StepFault::WrongPhase => Self::WrongPhase,
            StepFault::Overflow => Self::Overflow,
            _ => Self::Other,
        }
    }
}

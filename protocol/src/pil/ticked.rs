//! The report of a tick, with what the controller says beside it.

use controller_core::paper::neural::NeuralController;
use controller_core::paper::report::{NeuronStates, Phase, StepReport};
use controller_core::pose_error::PoseError;
use controller_core::types::{Accel, Twist, WheelTorques, Wrench};

use super::{Report, report_flags};

/// Everything a controller reports of one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ticked {
    /// Ticks since the controller was started.
    pub tick: u32,
    /// Executed instructions of the step, 0 where nobody counts.
    pub instructions: u32,
    /// The core's report.
    pub report: StepReport<f32>,
    /// An acceleration neuron is outside its bounds, on its way back.
    pub relaxing: bool,
    /// In the tick of the hand-over: the step that it put into the wrench.
    pub hand_over_step: Option<Wrench<f32>>,
}

impl Ticked {
    /// What `controller` has just done; `handed_over` if this very tick changed from tracking to parking.
    pub fn of(controller: &NeuralController, handed_over: bool) -> Self {
        Self {
            tick: 0,
            instructions: 0,
            report: *controller.report(),
            relaxing: controller.is_relaxing(),
            hand_over_step: if handed_over {
                controller.hand_over_step()
            } else {
                None
            },
        }
    }
}

impl From<&Ticked> for Report {
    fn from(ticked: &Ticked) -> Self {
        let report = &ticked.report;
        let flag = |condition, bit| if condition { bit } else { 0 };
        let step = ticked.hand_over_step.unwrap_or_default();
        Self {
            tick: ticked.tick,
            instructions: ticked.instructions,
            phase: match report.phase {
                Phase::Tracking => 0,
                Phase::Parking => 1,
            },
            flags: flag(report.saturated, report_flags::SATURATED)
                | flag(ticked.relaxing, report_flags::RELAXING)
                | flag(ticked.hand_over_step.is_some(), report_flags::HANDED_OVER),
            e_x: report.error.x,
            e_y: report.error.y,
            e_theta: report.error.theta,
            s1: report.neurons.s1,
            s2: report.neurons.s2,
            s3: report.neurons.s3,
            vdot_s: report.neurons.accel.linear,
            wdot_s: report.neurons.accel.angular,
            v_c: report.command.linear,
            w_c: report.command.angular,
            vdot_c: report.command_rate.linear,
            wdot_c: report.command_rate.angular,
            e_v: report.velocity_error.linear,
            e_w: report.velocity_error.angular,
            offset_v: report.transition_offset.linear,
            offset_w: report.transition_offset.angular,
            force: report.wrench.force,
            moment: report.wrench.moment,
            tau_right: report.torques.right,
            tau_left: report.torques.left,
            step_force: step.force,
            step_moment: step.moment,
        }
    }
}

impl From<&Report> for Ticked {
    fn from(wire: &Report) -> Self {
        let has = |bit| wire.flags & bit != 0;
        Self {
            tick: wire.tick,
            instructions: wire.instructions,
            report: StepReport {
                phase: if wire.phase == 0 {
                    Phase::Tracking
                } else {
                    Phase::Parking
                },
                error: PoseError {
                    x: wire.e_x,
                    y: wire.e_y,
                    theta: wire.e_theta,
                },
                neurons: NeuronStates {
                    s1: wire.s1,
                    s2: wire.s2,
                    s3: wire.s3,
                    accel: Accel::new(wire.vdot_s, wire.wdot_s),
                },
                command: Twist::new(wire.v_c, wire.w_c),
                command_rate: Accel::new(wire.vdot_c, wire.wdot_c),
                velocity_error: Twist::new(wire.e_v, wire.e_w),
                transition_offset: Twist::new(wire.offset_v, wire.offset_w),
                wrench: Wrench {
                    force: wire.force,
                    moment: wire.moment,
                },
                torques: WheelTorques {
                    right: wire.tau_right,
                    left: wire.tau_left,
                },
                saturated: has(report_flags::SATURATED),
            },
            relaxing: has(report_flags::RELAXING),
            hand_over_step: has(report_flags::HANDED_OVER).then_some(Wrench {
                force: wire.step_force,
                moment: wire.step_moment,
            }),
        }
    }
}

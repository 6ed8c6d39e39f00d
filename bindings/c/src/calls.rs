//! The functions of the header.
//!
//! Each checks its arguments before it changes anything: after an error the base, and what the pointers point to, are as they
//! were, but that a base stops by [`twb_emergency_stop`] whatever else is wrong. What stands in Safety holds of every pointer of a
//! type: NULL and misaligned ones are refused, any other one points to its type (a `twb_base`: to memory that only these calls
//! access).

#![allow(unsafe_code)]

use core::ffi::c_char;
use core::mem::MaybeUninit;
use core::slice;

use controller_core::base::{
    self, BaseController, BaseParams, DriveCommand, ValidBaseParams, WheelAction,
};
use controller_core::hal::WheelCounts;
use controller_core::safety::supervisor::{self, Event};
use controller_core::types::WheelTorques;
use protocol::{BaseTick, decode_robot};

use crate::abi::{self, Action, Order, Pose, Report, Sensed, Status, Wheels, action, device};
use crate::memory::{self, Base, Body, Handle, checked, read};
use crate::{convert, names};

/// The code of a result.
const fn code(result: Result<(), Status>) -> i32 {
    match result {
        Ok(()) => 0,
        Err(status) => status as i32,
    }
}

/// Works on a base; what it answers.
///
/// # Safety
/// Of `base`, as the [module](self) says.
unsafe fn with(base: *const Base, work: impl FnOnce(&mut Body) -> Result<(), Status>) -> i32 {
    // SAFETY: of the caller.
    code(unsafe { Handle::new(base) }.and_then(|handle| handle.with_apart(work)))
}

/// An event of the host.
///
/// # Safety
/// As [`with`].
unsafe fn on(base: *mut Base, event: Event) -> i32 {
    // SAFETY: of the caller.
    unsafe {
        with(base, |body| match body.controller.on(event) {
            supervisor::Action::Refuse => Err(Status::Refused),
            _ => Ok(()),
        })
    }
}

/// Bytes to parameters that were validated.
#[inline(never)]
fn robot(blob: &[u8]) -> Result<ValidBaseParams<f32>, Status> {
    let params: BaseParams<f32> = decode_robot(blob)?;
    params.validate().map_err(|_| Status::RobotContent)
}

/// A base that is disarmed, at `start`.
#[inline(never)]
fn make(place: &mut MaybeUninit<Body>, params: &ValidBaseParams<f32>, start: Pose) {
    place.write(Body {
        controller: BaseController::new(params, (&start).into()),
        ticks: 0,
        start,
        answer: device::OK,
    });
}

/// The version of calls and structs.
#[unsafe(no_mangle)]
pub extern "C" fn twb_api() -> u32 {
    abi::API
}

/// Makes a base of the caller's memory, disarmed, at `start`.
///
/// # Safety
/// Of `base` and `start`, as the [module](self) says; `robot` is NULL or points to `length` bytes. Not from within another call on
/// the same base.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn twb_init(
    base: *mut Base,
    size: usize,
    api: u32,
    blob: *const u8,
    length: usize,
    start: *const Pose,
) -> i32 {
    let result = || {
        // SAFETY: of the caller.
        let (handle, at) = unsafe { (Handle::new(base)?, read(start)?) };
        let blob = checked(blob)?;
        if api != abi::API || size < memory::SIZE {
            return Err(Status::Api);
        }
        if length > protocol::MAX_ROBOT_BLOB {
            return Err(Status::RobotLength);
        }
        let start: controller_core::types::Pose<f32> = (&at).into();
        if !start.is_near() {
            return Err(Status::NotFinite);
        }
        // SAFETY: of the caller; the length is a blob's, so that no address wraps around.
        let robot = robot(unsafe { slice::from_raw_parts(blob.as_ptr(), length) });
        let params = robot.as_ref().map_err(|status| *status)?;
        let period_us = params.detectors().params().period_us;
        // SAFETY: of the caller.
        unsafe { handle.put(period_us, |place| make(place, params, at)) };
        Ok(())
    };
    code(result())
}

/// Enables the outputs.
///
/// # Safety
/// As the [module](self) says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn twb_arm(base: *mut Base) -> i32 {
    // SAFETY: of the caller.
    unsafe { on(base, Event::Arm) }
}

/// A controlled stop; at rest the base is disarmed.
///
/// # Safety
/// As the [module](self) says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn twb_disarm(base: *mut Base) -> i32 {
    // SAFETY: of the caller.
    unsafe { on(base, Event::Stop) }
}

/// Acknowledges a fault.
///
/// # Safety
/// As the [module](self) says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn twb_reset(base: *mut Base) -> i32 {
    // SAFETY: of the caller.
    unsafe { on(base, Event::Reset) }
}

/// The button, also from an interrupt within another call.
///
/// # Safety
/// As the [module](self) says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn twb_emergency_stop(
    base: *mut Base,
    brake: u32,
    action: *mut Action,
) -> i32 {
    let result = || {
        // SAFETY: of the caller.
        let handle = unsafe { Handle::new(base) }?;
        // Before anything else is looked at: a button that is wired wrong still stops.
        let done = handle.stop(brake != 0)?;
        let out = checked(action)?;
        // SAFETY: of the caller.
        unsafe { out.write(without_duties(&done, 0)) };
        convert::flag(brake).map(|_| ())
    };
    code(result())
}

/// One tick.
///
/// # Safety
/// As the [module](self) says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn twb_tick(
    base: *mut Base,
    dt_us: u32,
    order: *const Order,
    sensed: *const Sensed,
    action: *mut Action,
) -> i32 {
    // SAFETY: of the caller.
    code(unsafe { tick(base, dt_us, order, sensed, action) })
}

/// A tick. A function, since only those can be asked to be in line whatever their size: a call of what is done in every tick
/// takes some 20 instructions.
///
/// # Safety
/// As the [module](self) says.
#[inline(always)]
unsafe fn tick(
    base: *mut Base,
    dt_us: u32,
    order: *const Order,
    sensed: *const Sensed,
    action: *mut Action,
) -> Result<(), Status> {
    // All at once, for most calls are right; in turn only to say what is wrong. A base is aligned twice as strictly as the rest.
    const { assert!(align_of::<Base>() == 2 * align_of::<u32>()) };
    let addresses = base as usize | (order as usize | sensed as usize | action as usize) << 1;
    let aligned = addresses & (align_of::<Base>() - 1) == 0;
    if !aligned || base.is_null() || order.is_null() || sensed.is_null() || action.is_null() {
        return Err(first_refusal(base, order, sensed, action));
    }
    // SAFETY: neither NULL nor misaligned, the rest is the caller's; nobody else looks at them during the call. Order and sensors are not
    // copied, which would take longer than all that is done with them.
    unsafe {
        let handle = Handle::new_unchecked(base);
        let body = handle.open()?;
        let result = tick_of(body, dt_us, &*order, &*sensed, action);
        handle.close(|stop| action.write(without_duties(stop, 0)));
        result
    }
}

/// A tick of an open base.
///
/// # Safety
/// `action` may be written.
#[inline(always)]
unsafe fn tick_of(
    body: &mut Body,
    dt_us: u32,
    order: &Order,
    sensed: &Sensed,
    action: *mut Action,
) -> Result<(), Status> {
    let mut place = MaybeUninit::uninit();
    let order = convert::order(order, &mut place)?;
    let mut found = base::Sensed::of_counts(WheelCounts::default());
    convert::sensed(sensed, &mut body.answer, &mut found)?;
    body.controller.tick(dt_us, order, &found);
    body.ticks = body.ticks.wrapping_add(1);
    // SAFETY: of the caller.
    unsafe { drive(body, found.supply_v, action) };
    Ok(())
}

/// What is wrong with the first of a tick's pointers that something is wrong with.
#[cold]
#[inline(never)]
fn first_refusal(
    base: *const Base,
    order: *const Order,
    sensed: *const Sensed,
    action: *const Action,
) -> Status {
    let sound = || -> Result<(), Status> {
        checked(base)?;
        checked(order)?;
        checked(sensed)?;
        checked(action)?;
        Ok(())
    };
    sound().err().unwrap_or(Status::Null)
}

/// An action without duties; `flags` are those of a drive.
#[inline]
fn without_duties(from: &WheelAction<f32>, flags: u32) -> Action {
    let mut to = Action {
        kind: convert::kind(from),
        ..Action::default()
    };
    if let WheelAction::Drive(drive) = from {
        // SAFETY: it is an action.
        unsafe { write_drive(drive, flags, &raw mut to) };
    }
    to
}

/// Writes all of a drive but its duties. The friction is cleared before it is written, for a choice between both would be made number by
/// number.
///
/// # Safety
/// `out` may be written.
#[inline]
unsafe fn write_drive(drive: &DriveCommand<f32>, flags: u32, out: *mut Action) {
    // SAFETY: of the caller; field by field, since the memory need not hold an action yet.
    unsafe {
        (*out).kind = action::DRIVE;
        (*out).flags = flags | (u32::from(drive.beyond_coulomb.is_some()) * action::BEYOND_COULOMB);
        (*out).torque = (&drive.torques).into();
        (*out).desired = (&drive.desired).into();
        (*out).speed = (&drive.speeds).into();
        (*out).beyond_coulomb = Wheels::default();
        if let Some(beyond) = &drive.beyond_coulomb {
            (*out).beyond_coulomb = beyond.into();
        }
    }
}

/// Writes the action, with the duties of motors on bridges; the base notes what those can exert, as under the control task of a
/// board.
///
/// # Safety
/// `out` may be written.
#[inline]
unsafe fn drive(body: &mut Body, supply_v: Option<f32>, out: *mut Action) {
    let report = body.controller.report();
    let (WheelAction::Drive(drive), Some(motor)) = (&report.action, body.controller.base().motor())
    else {
        let speeds = body.controller.base().driver().speeds();
        let flags = u32::from(speeds.is_some()) * action::SPEEDS;
        // SAFETY: of the caller.
        unsafe { out.write(without_duties(&report.action, flags)) };
        return;
    };
    let observed = drive.observed(supply_v);
    // What is only copied, before the motors take up the registers.
    // SAFETY: of the caller.
    unsafe { write_drive(drive, action::DUTY, out) };
    let commands = motor.commands(&drive.torques, &observed);
    // SAFETY: of the caller.
    unsafe {
        (*out).duty = Wheels {
            right: commands.right.duty,
            left: commands.left.duty,
        };
    }
    if let Some(exerted) = commands.exerted() {
        // SAFETY: of the caller.
        unsafe { limited(body, commands.is_invalid(), exerted, out) };
    }
}

/// What the motors cannot do. Apart, so that a tick does not carry it along.
///
/// # Safety
/// `out` is an action.
#[cold]
#[inline(never)]
unsafe fn limited(body: &mut Body, invalid: bool, exerted: WheelTorques<f32>, out: *mut Action) {
    let exerted = if invalid {
        // SAFETY: of the caller.
        unsafe { out.write(without_duties(&WheelAction::Release, 0)) };
        body.answer = device::OTHER;
        WheelTorques::default()
    } else {
        // SAFETY: of the caller.
        unsafe { (*out).flags |= action::LIMITED };
        exerted
    };
    // What is no number is not noted: the estimates go on with the commanded torques.
    let _ = body.controller.note_exerted(&exerted);
}

/// What the wheels really exert until the next tick.
///
/// # Safety
/// As the [module](self) says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn twb_note_exerted(base: *mut Base, torque: *const Wheels) -> i32 {
    // SAFETY: of the caller.
    match unsafe { read(torque) } {
        Err(status) => status as i32,
        Ok(Wheels { right, left }) => {
            let torques = WheelTorques { right, left };
            // SAFETY: of the caller.
            unsafe {
                with(base, |body| {
                    if !right.is_finite() || !left.is_finite() {
                        return Err(Status::NotFinite);
                    }
                    body.controller
                        .note_exerted(&torques)
                        .map_err(|_| Status::NotFinite)
                })
            }
        }
    }
}

/// Puts the base elsewhere on the map.
///
/// # Safety
/// As the [module](self) says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn twb_set_pose(base: *mut Base, pose: *const Pose) -> i32 {
    // SAFETY: of the caller.
    match unsafe { read(pose) } {
        Err(status) => status as i32,
        // SAFETY: of the caller.
        Ok(pose) => unsafe {
            with(base, |body| {
                body.controller
                    .set_pose((&pose).into())
                    .map_err(|_| Status::NotFinite)?;
                body.start = pose;
                Ok(())
            })
        },
    }
}

/// A sound frame came from the host.
///
/// # Safety
/// As the [module](self) says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn twb_host_seen(base: *mut Base) -> i32 {
    // SAFETY: of the caller.
    unsafe {
        with(base, |body| {
            body.controller.frame_seen();
            Ok(())
        })
    }
}

/// Before each tick of a base with a link to its host.
///
/// # Safety
/// As the [module](self) says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn twb_watch_host(base: *mut Base, dt_us: u32) -> i32 {
    // SAFETY: of the caller.
    unsafe {
        with(base, |body| {
            body.controller.watch_link(dt_us);
            Ok(())
        })
    }
}

/// The time between ticks that the robot's file states.
///
/// # Safety
/// As the [module](self) says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn twb_period_us(base: *const Base, period_us: *mut u32) -> i32 {
    let result = || {
        let out = checked(period_us)?;
        // SAFETY: of the caller.
        unsafe { out.write(Handle::new(base)?.period_us()?) };
        Ok(())
    };
    code(result())
}

/// Everything about the last tick.
///
/// # Safety
/// As the [module](self) says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn twb_get_report(base: *const Base, report: *mut Report) -> i32 {
    match checked(report) {
        Err(status) => status as i32,
        Ok(out) => {
            // SAFETY: of the caller.
            unsafe {
                with(base, |body| {
                    out.write(of(body));
                    Ok(())
                })
            }
        }
    }
}

fn of(body: &Body) -> Report {
    let controller = &body.controller;
    let supervisor = controller.supervisor();
    let report = controller.report();
    let (ignored, _) = supervisor.ignored();
    let tick = BaseTick::of(body.ticks, report, ignored);
    // Of this instant: an emergency stop and a reset need no tick.
    let (cause, cause_fault) = convert::cause(supervisor.cause());
    let latched = supervisor.latched();
    Report {
        tick: tick.tick,
        state: convert::state(supervisor.state()),
        cause,
        cause_fault,
        latched_fault: latched.map_or(0, |fault| fault.kind().code().into()),
        active_faults: tick.active_faults,
        ignored,
        changes: supervisor.changes(),
        late_ticks: controller.late_ticks(),
        flags: u32::from(tick.flags)
            | if report.refused {
                Report::ORDER_REFUSED
            } else {
                0
            },
        outcome: tick.outcome as u32,
        retries: tick.retries.into(),
        action: convert::kind(&report.action),
        pose: report.measured.map_or(body.start, |_| Pose {
            x: tick.x,
            y: tick.y,
            theta: tick.theta,
        }),
        twist: abi::Twist {
            v: tick.v,
            w: tick.w,
        },
        error: Pose {
            x: tick.e_x,
            y: tick.e_y,
            theta: tick.e_theta,
        },
        command: abi::Twist {
            v: tick.v_c,
            w: tick.w_c,
        },
        velocity_error: abi::Twist {
            v: tick.e_v,
            w: tick.e_w,
        },
        load_force: tick.load_force,
        load_moment: tick.load_moment,
        torque: Wheels {
            right: tick.tau_right,
            left: tick.tau_left,
        },
        curvature_bias: report.curvature_bias,
        turn_bias: report.turn_bias,
        tyre_slip: report.tyre_slip,
        motor_bias: report.motor_bias,
        gyro_bias: report.gyro.bias,
        gyro_slid: report.gyro.slid,
    }
}

/// What a call's answer means.
#[unsafe(no_mangle)]
pub extern "C" fn twb_status_text(status: i32) -> *const c_char {
    names::status(status).as_ptr()
}

/// The name of a state.
#[unsafe(no_mangle)]
pub extern "C" fn twb_state_name(state: u32) -> *const c_char {
    names::state(state).as_ptr()
}

/// The name of a cause.
#[unsafe(no_mangle)]
pub extern "C" fn twb_cause_name(cause: u32) -> *const c_char {
    names::cause(cause).as_ptr()
}

/// The name of the fault with this code, from 1 on.
#[unsafe(no_mangle)]
pub extern "C" fn twb_fault_name(fault: u32) -> *const c_char {
    names::fault(fault).as_ptr()
}

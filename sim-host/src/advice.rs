//! What a user should know of a scenario or a base before the robot finds out.
//!
//! What front ends say is [`of_base`] where a base is loaded, and [`of_job`] of what is to be run.

use crate::job::Job;
use crate::mission::{BaseSpec, Change, Course, Drivers, Hardware, Mission, Route};
use crate::motion::ReferenceMotion;
use crate::numbers::digits;
use crate::scenario::{ControlLaw, Scenario};
use crate::trials;
use crate::world::MotorParams;
use controller_core::maths::Libm;
use controller_core::paper::stability::{
    longitudinal_tracking_is_stable, max_stable_speed, parking_is_stable,
};
use controller_core::tuning::motion::margins;
use controller_core::wheels::WheelGeometry;
use std::f64::consts::TAU;
use std::fmt;

/// A sentence for the owner of a file. Its `Display` is the line for people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Advice {
    /// What to change in a base's file, which it names.
    Note(String),
    /// What can be, but hardly is meant.
    Warning {
        /// Of which base or scenario.
        of: String,
        /// The sentence.
        text: String,
    },
}

impl Advice {
    fn warnings(of: &str, texts: Vec<String>) -> impl Iterator<Item = Self> {
        texts.into_iter().map(move |text| Self::Warning {
            of: of.to_owned(),
            text,
        })
    }

    /// The sentence alone.
    pub fn text(&self) -> &str {
        match self {
            Self::Note(text) | Self::Warning { text, .. } => text,
        }
    }
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Note(text) => write!(f, "note: {text}"),
            Self::Warning { of, text } => write!(f, "warning: {of}: {text}"),
        }
    }
}

/// What is to be said of a base, whatever it is to do.
pub fn of_base(base: &BaseSpec) -> Vec<Advice> {
    let notes = base.notes.iter().cloned().map(Advice::Note);
    notes
        .chain(Advice::warnings(&base.name, base_warnings(base)))
        .collect()
}

/// What is to be said of a scenario with a controller of the paper.
pub fn of_scenario(scenario: &Scenario) -> Vec<Advice> {
    Advice::warnings(&scenario.name, warnings(scenario)).collect()
}

/// What is to be said of a mission beside what [`of_base`] says of its base.
pub fn of_mission(mission: &Mission) -> Vec<Advice> {
    Advice::warnings(&mission.name, mission_warnings(mission)).collect()
}

/// All that is to be said of a job, its base included.
pub fn of_job(job: &Job) -> Vec<Advice> {
    match job {
        Job::Scenario(scenario) => of_scenario(scenario),
        Job::Mission { mission, .. } => {
            let mut advice = of_base(&mission.base);
            advice.extend(of_mission(mission));
            advice
        }
    }
}

/// Warnings about headings, gains and speeds, each one sentence.
///
/// Those about gains come from the linearised loop of the neural law; plain backstepping has no such limits.
pub fn warnings(scenario: &Scenario) -> Vec<String> {
    let goal = scenario.hand_over.as_ref();
    let mut headings = vec![("start.theta", scenario.start.pose.theta)];
    headings.extend(of_motion(
        &scenario.motion,
        goal.map(|plan| (plan.hand_over_s, plan.goal.theta)),
    ));
    let mut warnings: Vec<_> = heading_warning(&headings).into_iter().collect();
    if scenario.controller.kind == ControlLaw::Plain {
        return warnings;
    }
    let params = &scenario.params;
    let speed = scenario.motion.largest_speed();
    match max_stable_speed::<f64, Libm>(params) {
        Some(limit) if speed > limit => warnings.push(format!(
            "the reference reaches {speed:.3} m/s; above {limit:.3} m/s these gains let the robot \
             weave about the path: lower k2 (as 1/v_r²), or raise A or k3"
        )),
        Some(_) => {}
        None => warnings.push(
            "with these gains the heading loop is unstable at every speed: raise A or kd2, or \
             lower k3"
                .to_owned(),
        ),
    }
    if !longitudinal_tracking_is_stable(params) {
        warnings.push(
            "with these gains tracking is unstable along the path: lower k1, or raise A or kd1"
                .to_owned(),
        );
    }
    if scenario.hand_over.is_some() && !parking_is_stable(params) {
        warnings.push(
            "with these gains parking is unstable: lower k4 and k5, or raise A, kc1 and kc2"
                .to_owned(),
        );
    }
    warnings
}

/// The longest period with which the default law is stable, linearised, with a base's gains \[s\]: a torque is held for a tick, and so comes half
/// of one late. Some robots weave and still park with half as much again.
pub fn longest_period_s(base: &BaseSpec) -> f64 {
    2.0 * margins::<f64, Libm>(&base.motion().gains)
        .worst()
        .torque_delay_s
}

/// A warning about a period that is too long for a base's gains, if it is.
pub fn period_warning(base: &BaseSpec, period_s: f64) -> Option<String> {
    let longest_s = longest_period_s(base);
    (period_s > longest_s).then(|| {
        format!(
            "with a period of {period_s} s the robot weaves or runs off: these gains take at most {longest_s:.3} s; choose a shorter period, or \
             slower gains"
        )
    })
}

/// Warnings about a mission, each one sentence.
fn mission_warnings(mission: &Mission) -> Vec<String> {
    let Mission { base, period_s, .. } = mission;
    // The base's own is said of the base.
    let period = (*period_s != base.period_s()).then(|| period_warning(base, *period_s));
    period
        .flatten()
        .into_iter()
        .chain(heading_warning(&headings(mission)))
        .collect()
}

/// Keys of headings \[rad\] that a scenario's file states, and what they are. Those of a trajectory file its importer compares with its motion.
fn headings(mission: &Mission) -> Vec<(&'static str, f64)> {
    let start = ("start.theta", mission.start.pose.theta);
    let mut headings = match &mission.course {
        Course::Park(goal) => vec![start, ("goal.theta", goal.theta)],
        Course::Drive => vec![start],
        Course::Follow {
            route: Route::Motion(motion),
            hand_over,
        } => {
            let goal = hand_over.map(|rule| (rule.end_s, rule.goal.theta));
            [start].into_iter().chain(of_motion(motion, goal)).collect()
        }
        Course::Follow {
            route: Route::File(_),
            ..
        } => Vec::new(),
    };
    headings.extend(
        mission
            .events
            .iter()
            .filter_map(|event| match event.change {
                Change::Goal(pose) => Some(("event.goal.theta", pose.theta)),
                Change::Jump(pose) => Some(("event.jump.theta", pose.theta)),
                Change::Follow | Change::Drive(_) => None,
            }),
    );
    headings
}

/// Of a reference, and of a goal beside it at a time; one that the reference itself turns to is no statement of a user.
fn of_motion(motion: &ReferenceMotion, goal: Option<(f64, f64)>) -> Vec<(&'static str, f64)> {
    let theta = |time_s: f64| motion.at(time_s).pose().theta;
    let goal = goal.filter(|(time_s, heading)| (heading - theta(*time_s)).abs() > TAU);
    let goal = goal.map(|(_, heading)| ("hand_over.target.theta", heading));
    [("reference.start.theta", theta(0.0))]
        .into_iter()
        .chain(goal)
        .collect()
}

/// A warning about the first heading of more than a turn, which are degrees mostly.
fn heading_warning(headings: &[(&str, f64)]) -> Option<String> {
    let (key, heading) = headings.iter().find(|(_, heading)| heading.abs() > TAU)?;
    let [radians, degrees] = [*heading, heading.to_radians()].map(digits);
    Some(format!(
        "{key} = {radians} is more than a turn: headings are in rad, and {radians}° are {degrees} rad"
    ))
}

/// What rubber holds on a dry floor at best \[m/s²\]: 2 g.
const RUBBER_M_S2: f64 = 20.0;
/// A goal is said to be reached within this at most \[rad\]: more is another direction.
const HEADING_RAD: f64 = 0.5;

/// Warnings about a base that can be, but hardly is meant as its file has it; each one sentence.
fn base_warnings(base: &BaseSpec) -> Vec<String> {
    let mut warnings = Vec::new();
    // Wheels turn the rotors of their motors along.
    let (robot, limits) = (&base.robot_with_rotors(), &base.limits);
    let wheels = &robot.wheels;
    let radius_m = wheels.radius_right_m.max(wheels.radius_left_m);
    for (key, accel, force_n) in [
        ("accel", limits.accel, 0.5 * robot.mass_kg * limits.accel),
        (
            "turn_accel",
            limits.turn_accel,
            robot.inertia_kg_m2 * limits.turn_accel / wheels.track_m,
        ),
    ] {
        let torque_nm = force_n * radius_m;
        if torque_nm > limits.wheel_torque_nm {
            warnings.push(format!(
                "limits.{key} = {accel} takes {torque_nm:.3} N m of each wheel, which limits.wheel_torque = {} does not \
                 give: the base accelerates more slowly than that",
                limits.wheel_torque_nm
            ));
        }
    }
    for (key, accel) in [("accel", limits.accel), ("brake", limits.brake)] {
        if accel > RUBBER_M_S2 {
            warnings.push(format!(
                "limits.{key} = {accel} is more than the {RUBBER_M_S2} m/s² that rubber holds on a dry floor: the wheels slide"
            ));
        }
    }
    if let Some(hardware) = base.hardware.as_ref() {
        warnings.extend(stuck(hardware, limits.wheel_torque_nm));
        warnings.extend(wide_dead_band(hardware, limits.wheel_torque_nm));
        warnings.extend(coarse_encoders(hardware, wheels));
        warnings.extend(arrives_anywhere(hardware, wheels));
    }
    warnings.extend(period_warning(base, base.period_s()));
    warnings
}

/// What the whole supply drives through a motor at rest \[A\].
fn stall_a(hardware: &Hardware, motor: &MotorParams) -> f64 {
    hardware.battery.nominal_v / motor.resistance_ohm
}

/// What a current gives a wheel at rest \[N m\].
fn at_rest_nm(motor: &MotorParams, current_a: f64) -> f64 {
    motor.gear_ratio * motor.gear_efficiency * motor.kt_nm_per_a * current_a
}

/// A warning about friction that wheels hardly break away from, or do not.
fn stuck(hardware: &Hardware, wheel_torque_nm: f64) -> Option<String> {
    let static_nm = hardware.friction.static_nm;
    let given_nm = hardware
        .drivers
        .motor()
        .map(|motor| at_rest_nm(motor, motor.current_limit_a.min(stall_a(hardware, motor))));
    if let Some(given_nm) = given_nm.filter(|given_nm| static_nm >= *given_nm) {
        return Some(format!(
            "friction.static_nm = {static_nm} N m is not less than the {given_nm:.3} N m that a motor gives at rest: the base does not move"
        ));
    }
    (static_nm >= wheel_torque_nm).then(|| {
        format!(
            "friction.static_nm = {static_nm} N m is not less than limits.wheel_torque = {wheel_torque_nm} N m: wheels break loose with a jerk or \
             not at all"
        )
    })
}

/// What a dead band takes of a motor's torque at rest is compensated, but for what it is wrong by, and for a fifth in the middle, where a motor gives
/// nothing (`controller-core/src/motor/dead_band.rs`). Of 360 runs of `verify` each, bases of 1, 10 and 30 kg with 0.75 to 1 of their torque limit fail in
/// 0 to 3, with 1 to 1.2 in 1 to 23, with 1.25 to 2 in 6 to 155.
pub(crate) fn wide_dead_band(hardware: &Hardware, wheel_torque_nm: f64) -> Option<String> {
    let Drivers::Bridges(motor) = &hardware.drivers else {
        return None;
    };
    let taken_nm = motor.dead_band * at_rest_nm(motor, stall_a(hardware, motor));
    (taken_nm > wheel_torque_nm).then(|| {
        format!(
            "motor.dead_band = {} takes {taken_nm:.3} N m of a motor at rest, more than limits.wheel_torque = {wheel_torque_nm} N m: the base hardly \
             parks; most of so wide a dead band is friction of the gear: state that as friction.static_nm, and see `identify`",
            motor.dead_band
        )
    })
}

/// One count more on one wheel turns the base out of what `verify` asks for. Bases of 1 and 10 kg with 90 counts a turn, 17 and 15 mrad each, fail
/// in 10 of 72 runs, none with 180.
pub(crate) fn coarse_encoders(hardware: &Hardware, wheels: &WheelGeometry<f64>) -> Option<String> {
    let counts = hardware.counts_per_turn;
    let way_m = TAU * wheels.radius_right_m.max(wheels.radius_left_m) / counts;
    let turn_rad = way_m / wheels.track_m;
    (turn_rad > trials::HEADING_RAD || way_m > trials::DISTANCE_M).then(|| {
        format!(
            "[encoder] counts_per_turn = {counts}: one count is {:.1} mm of a wheel's way and turns the base by {:.1} mrad",
            1e3 * way_m,
            1e3 * turn_rad
        )
    })
}

/// Warnings about what is measured so badly that a base takes places far from its goal for it.
fn arrives_anywhere(hardware: &Hardware, wheels: &WheelGeometry<f64>) -> Vec<String> {
    let arrival = |hardware: &Hardware| {
        let localiser = hardware.localiser::<f64>(wheels);
        Some(localiser.validate_with::<Libm>().ok()?.arrival())
    };
    let (Some(source), Some(now)) = (hardware.pose_source, arrival(hardware)) else {
        return Vec::new();
    };
    // If finer encoders mend it they are what is coarse.
    let fine = arrival(&Hardware {
        counts_per_turn: 1.0e3 * hardware.counts_per_turn,
        ..*hardware
    });
    let key = |mended: bool, key: &str, noise: f64| match mended {
        true => format!("encoder.counts_per_turn = {}", hardware.counts_per_turn),
        false => format!("pose_source.{key} = {noise}"),
    };
    let mut warnings = Vec::new();
    let half_m = 0.5 * wheels.track_m;
    if now.distance_m > half_m {
        let mended = fine.is_some_and(|fine| fine.distance_m <= half_m);
        warnings.push(format!(
            "{}: the base takes any place within {:.3} m for its goal, and half of its track is {half_m} m",
            key(mended, "noise_m", source.noise_m),
            now.distance_m,
        ));
    }
    if now.heading_rad > HEADING_RAD {
        let mended = fine.is_some_and(|fine| fine.heading_rad <= HEADING_RAD);
        warnings.push(format!(
            "{}: the base takes any heading within {:.2} rad for its goal's",
            key(mended, "noise_rad", source.noise_rad),
            now.heading_rad
        ));
    }
    warnings
}

//! Every tolerance of the tests, with its reason.

/// Continuous golden traces, any column (m, rad, m/s, rad/s, N, N m).
///
/// The files themselves are converged to 3.4e-8 at worst (a torque of the plain curve) and the oracle's fixed step to
/// 2e-8 (the kinks of S⁺ and S⁻ at the curve's steepest moment): twice their sum.
pub const GOLDEN_CONTINUOUS: f64 = 1e-7;

/// Sampled golden traces, any column.
///
/// The samples are exact but for the posture's quadrature; the file's ten digits leave 5e-9 on a torque above 10.
pub const GOLDEN_SAMPLED: f64 = 1e-8;

/// Two formulas that are equal on paper, for values of order 100 in double precision.
pub const ALGEBRA: f64 = 1e-12;

/// Quadrature of the reference against another integration of it: Simpson's rule at 1 ms has 1e-14, and the targets
/// in the golden files carry 15 digits.
pub const REFERENCE_POSTURE: f64 = 1e-12;

/// Torque step at a switch that ought to have none: rounding of two torques below 100 N.
pub const TORQUE_STEP: f64 = 1e-12;

/// Central difference along the flow with a step of 1e-5 s or 1e-6 s: at most 1e-9 of truncation or rounding, for
/// functions of order 10 with third derivatives up to 1e3.
pub const FLOW_DERIVATIVE: f64 = 1e-8;

/// A figure quoted with one decimal: half a unit of it, and the next digit.
pub const ONE_DECIMAL: f64 = 0.055;

/// A figure quoted with two decimals: half a unit of it, and the next digit.
pub const TWO_DECIMALS: f64 = 0.0055;

/// Rise of a function that never rises, evaluated by the formula for its rate: rounding of terms of order 100.
pub const ROUNDING_RISE: f64 = 1e-12;

/// Torque step too small for the paper's figures, whose axes span tens of N and N m: a line's width.
pub const INVISIBLE_TORQUE_STEP: f64 = 0.02;

/// Share of 20,000 random states: three standard errors.
pub const STATE_SHARE: f64 = 0.01;

/// The core's continuous rates against the golden traces, any column: as for the oracle, which uses the same step.
pub const CORE_CONTINUOUS: f64 = 1e-7;

/// Order of convergence of a loop with held torque between ticks of 10 ms and 1.25 ms: 1, less or more a tenth for
/// the next term.
pub const FIRST_ORDER_LOW: f64 = 0.9;
/// See [`FIRST_ORDER_LOW`].
pub const FIRST_ORDER_HIGH: f64 = 1.1;

/// How many times closer to the continuous loop the mean of two inputs is than the held one, at 10 ms; an independent reference: 2.2.
pub const MEAN_BEATS_HELD: f64 = 2.0;

/// Settling times quoted with two decimals \[s\]: the paper's own "about" is five times as wide.
pub const SETTLING: f64 = 0.02;

/// Final position error with the paper's parking \[m\]; an independent reference has 0.94 mm and 1.24 mm.
pub const PARKED: f64 = 1.5e-3;

/// Torque and velocity at a start that ought to have none \[N, N m, m/s, rad/s\]: rounding of gains of 90 times
/// velocities of 1.
pub const START: f64 = 1e-12;

/// Torque step at a sampled hand-over \[N, N m\]: rounding of torques of 100 N leaves 1e-13, the arcsine as much.
pub const HAND_OVER: f64 = 1e-9;

/// Largest change of torque per tick, plain to neural, at 1 ms; an independent reference has 140 and 143 at least.
pub const TORQUE_CHANGE_RATIO: f64 = 100.0;

/// Pose error left at the hand-over (m, rad): an independent reference has 4.0e-3 and 4.4e-3.
pub const TRACKED: f64 = 5e-3;

/// Movement past the target that does not count as overshoot \[m\]: what is left of rounding and of the sample.
pub const OVERSHOOT: f64 = 1e-4;

/// Single against double precision over a whole run (m, rad): an independent reference has 1e-7 within 5 m; 1e-5 is a hundred times finer than any pose source.
pub const SINGLE_POSE: f64 = 1e-5;

/// micromath against double precision over a whole run (m, rad): its sine is wrong by 1.1e-3, which at 4 m from the
/// origin shows as 4.4 mm of position error wherever the heading turns.
pub const MICROMATH_POSE: f64 = 5e-3;

/// Torque step at the hand-over in single precision \[N, N m\]: velocities rounded to 6e-8 times gains of 90, a few times.
pub const SINGLE_HAND_OVER: f64 = 1e-4;

/// The same with micromath: its sine of s₃ misses the arcsine's argument by 1.1e-3, times k₅ k_c2 = 90.
pub const MICROMATH_HAND_OVER: f64 = 0.1;

/// Two formulas of one neuron in double precision, relative to the range of its state and its rate: some tens of
/// roundings, and exponents of up to 20 that multiply one each.
pub const NEURON_ALGEBRA: f64 = 1e-14;

/// A thousand Runge-Kutta steps over up to 20 time constants, relative to the range of the state: (1/50)^5 · 20 · 50 / 120.
pub const NEURON_RUNGE_KUTTA: f64 = 1e-8;

/// Shortfall of the rational share relative to the exact one up to a = 0.1 and up to a = 1: a²/6 and its next
/// terms, as documented.
pub const RATIONAL_SHARE: (f64, f64) = (1.7e-3, 5.1e-2);

/// Orders of the neuron's update between 10 ms and 5 ms: less or more a twentieth for the next term.
pub const MEAN_ORDER: f64 = 0.05;

/// Wheel map there and back, relative to the sizes involved: a dozen roundings in double precision.
pub const WHEELS_DOUBLE: f64 = 1e-14;

/// The same in single precision.
pub const WHEELS_SINGLE: f64 = 5e-6;

/// Wrapped angles, as documented: in double precision a unit in the last place of the angle, in single precision half a
/// unit in the last place of π and the reduction.
pub const WRAP: (f64, f64) = (2.3e-16, 4e-7);

/// Wrapped angles beyond 1e5 rad in double precision, as documented: exact but for rounding near π.
pub const WRAP_FAR: f64 = 1e-15;

/// Central difference of the pose error over 2 µs, at distances of up to 20 m: rounding of 4e-15/1e-6.
pub const ERROR_DIFFERENCE: f64 = 2e-8;

/// Closed form of a circle against Simpson's rule at 1 ms over 10 s and 20 m: 10,000 sums of up to 20, on a
/// straight line all rounded the same way.
pub const CONSTANT_TWIST: f64 = 1e-11;

/// A start and a hand-over in units of the scalar's rounding of the terms that cancel there.
pub const ROUNDINGS: f64 = 64.0;

/// Neurons this near to a bound, relative to it, may count as in or out: what single precision can tell.
pub const NEAR_BOUND: f64 = 1e-4;

/// Step of a torque at the hand-over with a reset that jumps, against its formula \[N, N m\]: rounding of torques up to 1e4.
pub const RESET_JUMP: f64 = 1e-9;

/// Central difference of a command over 20 µs along the flow, relative where the rate exceeds 1: truncation with third
/// derivatives of 1e5 at gains three times the usual ones.
pub const COMMAND_RATE: f64 = 1e-5;

/// Ratio of the largest torque changes per tick at 2 ms and 1 ms: 2 if torque is Lipschitz, 1 if it jumps.
pub const HALVES: f64 = 0.05;

/// A limiting speed quoted with three decimals \[m/s\]: a unit of them.
pub const LIMIT_SPEED: f64 = 1e-3;

/// Distance from a stability limit, relative to it, at which eigenvalues of a badly scaled matrix still tell the side.
pub const NEAR_LIMIT: f64 = 1e-3;

/// Peak of a function of the state quoted with two decimals for the continuous loop, in the loop sampled at 1 ms: half a
/// percent more.
pub const SAMPLED_PEAK: f64 = 0.02;

/// Interpolated reference between samples 0.1 s apart (m, rad, m/s, rad/s): h⁴/384 times fourth derivatives of 8.
pub const INTERPOLATED: f64 = 2.1e-6;

/// Its accelerations \[m/s², rad/s²\]: h³ times a hundredth of fourth derivatives of 6.
pub const INTERPOLATED_TWIST: f64 = 1e-4;

/// An interpolated value at the end of its span: a few roundings of lengths of some metres.
pub const ROUNDED_END: f64 = 1e-14;

/// A robot that follows samples 0.1 s apart against one that follows the true reference (m, rad): errors of the
/// reference of 2e-6, passed through gains of 6.
pub const INTERPOLATED_ERROR: f64 = 2e-5;

/// A transition offset after up to 80 ticks, relative to its first value: that many roundings.
pub const TRANSITION_OFFSET: f64 = 1e-13;

/// Slack for a transition offset that began as rounding \[m/s, rad/s\].
pub const TRANSITION_OFFSET_FLOOR: f64 = 1e-15;

/// Wheel torque of a tick against the same by the oracle's B̄ \[N m\]: rounding of torques below 100 N m.
pub const LIMITED: f64 = 1e-12;

/// The paper's "corrected" (m, rad), read as 5 cm and 0.05 rad.
pub const SETTLED: f64 = 0.05;

/// Distance of a robot to a slalom that asks for up to 1.5 rad/s² \[m\]: the lag of its neurons, 0.1 to 0.2 expected.
pub const FOLLOWED: f64 = 0.2;

/// Real part of an eigenvalue too near to 0 to tell its sign \[1/s\]: rounding of matrices with entries up to 1e6.
pub const EIGENVALUE: f64 = 1e-9;

/// How many times closer a neuron is with the mean of a sine's two values than with the held one, at 10 ms; an independent reference: 105.
pub const MEAN_GAIN: f64 = 90.0;

/// The same for the rational share, whose own a²/6 is of the size of the mean's error there: 46.6 measured.
pub const RATIONAL_GAIN: f64 = 45.0;

/// A neuron after an endless tick: its pull is 5ε short of the bound, and 2ε of the way are left. For states below 1.
pub const SETTLED_NEURON: f64 = 8.0 * f64::EPSILON;

/// Distance of the motion controller to a steady reference once settled, in the last fifth of a run \[m\]: held torques
/// at 10 ms cost at most some tenths of a millimetre on a circle of 2 m/s and 1 rad/s.
pub const MOTION_SETTLED_LATE: f64 = 2e-3;

/// The same lateral offset from 0.1 to 2 m/s, slowest to fastest: required is 2.
pub const MOTION_SETTLING_RATIO: f64 = 2.0;

/// Distance to a reference that accelerates by up to 0.4 m/s² and 0.8 rad/s², root mean square \[m\]: required is
/// 1 to 3 mm at 10 ms.
pub const FED_FORWARD_RMS: f64 = 3e-3;

/// Movement past the goal that does not count as overshoot \[m\]: the tolerance in which the robot may come to rest.
pub const MOTION_OVERSHOOT: f64 = 5e-4;

/// Parked (m, rad): required is 1 mm and 1 mrad.
pub const ARRIVED: f64 = 1e-3;

/// A command and its rate against limits of slewing, relative: some roundings in single precision.
pub const MOTION_LIMIT: f64 = 1e-5;

/// Change of the wrench in a tick against L dt, relative, in double and in single precision: rounding of velocities of
/// 2 m/s times loop gains, over a change that is a hundredth of them at 1 ms.
pub const MOTION_RATE: (f64, f64) = (1e-9, 5e-3);

/// Lateral error after parking from a hand-over \[m\]: required is 0.1 mm.
pub const PARKED_ACROSS: f64 = 1e-4;

/// The motion controller in single against double precision until it parks (m, rad): poses are rounded to 2.4e-7 at
/// 3 m, and loops of 5 per second pass that on a few times.
pub const MOTION_SINGLE_POSE: f64 = 1e-5;

/// Gauss' rule at 10 ms against Simpson's at 1 ms over 1,000 ticks of up to 5 cm (m, rad): sums of rounding, and
/// truncation of 1e-15 each.
pub const MOTION_PLANT: f64 = 1e-11;

/// The default law against its oracle in the same tick, over 1 and the number's size: a rounding of 2e-16 of numbers up to 100,
/// divided by ticks of 1 ms and multiplied by jerk and loop gains of up to 50, a thousand of them in a row where a memory keeps them.
/// Wheels at their limit set the command back, which passes on what is wrong with a_c (1 + σ)/(κ dt) times, up to 420, and the governor's
/// quotient by dt brings it back into a_c: a second time before the oracle takes over, and the disturbance estimate forgets it.
pub const MOTION_ORACLE: (f64, f64) = (1e-9, 1e-9);

/// The localiser against its oracle (m, rad, m/s, rad/s, rad/m, s): 6,000 sums of numbers up to 1,000, rounded to 1e-13 each; speeds
/// pass the rounding of a lag, which is neutral inside a count, on by the loop's 100/s over a track of 0.15 m. An acceleration that is
/// learnt takes predictions from edge to edge of a count, and each edge passes on what is wrong with it some times over: 1.3e-7 at
/// most in 576,000 ticks.
pub const LOCALISER_ORACLE: f64 = 1e-6;

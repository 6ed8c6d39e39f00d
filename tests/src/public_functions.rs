// Not a module: `panic_link` makes a program of it. Every public function of the core, for every number type, back end and neuron
// update: a pointer to each goes where the compiler does not look, so that nothing is known about its arguments.

use controller_core::{
    angle, base::*, error::Field, gyro, hal, localiser::*, maths::*, motion::*, motor, neuron::Neuron, odometry::*, paper, pose_error::*,
    queue, reference::*, robot::*, safety, safety::supervisor as sv, shunting::*, single, torque, tuning, types::*, wheels::*,
};

macro_rules! keep {
    ($($function:expr),* $(,)?) => { $( black_box($function as *const ()); )* };
}

macro_rules! numbers {
    ($name:ident, $T:ty, $M:ty) => {
        fn $name() {
            type T = $T;
            type M = $M;
            keep![
                angle::wrap::<T>,
                pose_error::<T, M>, pose_error_rate::<T>, tracking_error::<T, M>, PoseError::<T>::norm::<M>,
                pose_rate::<T, M>, constraint_residual::<T, M>, acceleration::<T>, wrench_for::<T>, Robot::<T>::paper, Robot::<T>::with_wheel_inertia,
                torque::wrench::<T>,
                excitatory::<T>, inhibitory::<T>,
                Shunting::<T>::new, Shunting::<T>::decay, Shunting::<T>::upper, Shunting::<T>::lower, Shunting::<T>::contains,
                Shunting::<T>::rate, Shunting::<T>::equilibrium,
                Neuron::<T>::new, Neuron::<T>::state,
                WheelMap::<T>::from_geometry, WheelMap::<T>::from_matrix, WheelMap::<T>::torques, WheelMap::<T>::wrench,
                WheelMap::<T>::wheel_speeds, WheelMap::<T>::twist, limit_torques::<T>,
                Pose::<T>::new, Pose::<T>::is_finite, Pose::<T>::is_near, Pose::<T>::check, Twist::<T>::minus, Twist::<T>::new, Twist::<T>::is_finite,
                Accel::<T>::new, Accel::<T>::is_finite, Measured::<T>::is_finite, Pose::<T>::cast::<f32>, Pose::<T>::cast::<f64>,
                Reference::<T>::new_with::<M>, Reference::<T>::at_rest_with::<M>, Reference::<T>::cast_with::<f32, Single>,
                Reference::<T>::new, Reference::<T>::at_rest, Reference::<T>::with_left, Reference::<T>::left_m,
                Reference::<T>::pose, Reference::<T>::heading, Reference::<T>::twist, Reference::<T>::stands, Reference::<T>::accel,
                Reference::<T>::is_finite, ConstantTwist::<T>::at::<M>, ParkingPlan::<T>::along::<M>, ParkingPlan::<T>::is_due,
                queue::interpolate::<T, M>,
                OdometryParams::<T>::delay_s, OdometryParams::<T>::travel_per_count_m, OdometryParams::<T>::track_m,
                Odometry::<T>::new, Odometry::<T>::update::<M>, Odometry::<T>::update_with_accel::<M>, Odometry::<T>::back_emf_speeds,
                Odometry::<T>::set_pose, Odometry::<T>::pose,
                FusionParams::<T>::for_source, LocaliserParams::<T>::validate_with::<M>, LocaliserParams::<T>::validate,
                ValidLocaliserParams::<T>::params, ValidLocaliserParams::<T>::with_robot,
                ValidLocaliserParams::<T>::filtered_noise_m, ValidLocaliserParams::<T>::filtered_noise_rad,
                ValidLocaliserParams::<T>::largest_step, ValidLocaliserParams::<T>::pose_noise_m, ValidLocaliserParams::<T>::arrival,
                filtered_share::<T>,
                Localiser::<T, 4>::start, Localiser::<T, 4>::update::<M>, Localiser::<T, 4>::update_with_accel::<M>, Localiser::<T, 4>::update_with::<M>, Localiser::<T, 4>::uncarried_s,
                Localiser::<T, 4>::set_pose, Localiser::<T, 4>::back_emf_speeds, Localiser::<T, 4>::pose, Localiser::<T, 4>::fix_age_s,
                Localiser::<T, 4>::curvature_bias, Localiser::<T, 4>::turn_bias, Localiser::<T, 4>::tyre_slip, Localiser::<T, 4>::localisation,
                gyro::GyroParams::<T>::icm_42688_p, gyro::GyroParams::<T>::check, gyro::GyroParams::<T>::validate,
                gyro::ValidGyroParams::<T>::params, gyro::GyroHeading::<T>::new, gyro::GyroHeading::<T>::advance,
                gyro::GyroHeading::<T>::carries, gyro::GyroHeading::<T>::slides_now, gyro::GyroHeading::<T>::heading_variance,
                gyro::GyroHeading::<T>::bias_variance, gyro::GyroHeading::<T>::report,
                Arrival::<T>::exact, check_goal::<T>, check_order::<T>, Limits::<T>::least_rim_speed, Limits::<T>::reachable, MotionGains::<T>::for_limits::<M>,
                MotionGains::<T>::slow_for,
                ValidMotionParams::<T>::hand_over_distance, ValidMotionParams::<T>::parking_is_due::<M>, Remaining::<T>::with_error,
                PathEnd::<T>::lead::<M>,
                MotionParams::<T>::new, MotionParams::<T>::new_with::<M>, MotionParams::<T>::for_period::<M>, MotionParams::<T>::with_pose_noise, MotionParams::<T>::validate,
                ValidMotionParams::<T>::params, ValidMotionParams::<T>::gains, ValidMotionParams::<T>::wheels,
                ValidMotionParams::<T>::force_rate_limit, ValidMotionParams::<T>::moment_rate_limit,
                ValidMotionParams::<T>::largest_force, ValidMotionParams::<T>::largest_moment, ValidMotionParams::<T>::disturbance_bound,
                share::<T>, Task::<T>::cast_with::<f32, Single>,
                motor::Motor::<T>::params, motor::Motor::<T>::max_torque_nm, motor::Motor::<T>::no_load_speed_rad_s,
                motor::Motor::<T>::short_current_a, motor::Motor::<T>::command, motor::MotorParams::<T>::validate, motor::MotorParams::<T>::rotor_at_wheel_kg_m2,
                motor::DriverParams::<T>::validate, motor::DriverParams::<T>::motor, motor::Driver::<T>::motor, motor::Driver::<T>::speeds, motor::SpeedParams::<T>::validate, motor::SpeedParams::<T>::way_to_push_m, WheelGeometry::<T>::force_n, motor::SpeedOutput::<T>::params, motor::SpeedOutput::<T>::command,
                motor::Decay::<T>::time_constant_s, motor::Decay::<T>::distance, motor::electrical_brake::<T>, motor::coast::<T>,
                safety::DetectorParams::<T>::validate, safety::DetectorParams::<T>::for_base, safety::SupplyDetectorParams::<T>::for_nominal, safety::ValidDetectorParams::<T>::params,
                safety::Monitor::<T>::new, safety::Monitor::<T>::check, safety::Monitor::<T>::late_ticks,
                safety::StopPlan::<T>::new::<M>, safety::StopPlan::<T>::duration_s, safety::StopPlan::<T>::at,
                safety::StopPlan::<T>::task::<M>, safety::controlled_stop::<T, M>, safety::controlled_stop_distance::<T, M>,
                BaseParams::<T>::new, BaseParams::<T>::with_gains, BaseParams::<T>::validate,
                BaseParams::<T>::new_with::<M>, BaseParams::<T>::validate_with::<M>, ValidBaseParams::<T>::motion,
                ValidBaseParams::<T>::localisation, ValidBaseParams::<T>::motor, ValidBaseParams::<T>::driver, ValidBaseParams::<T>::policy,
                ValidBaseParams::<T>::detectors, Sensed::<T>::of_counts, WheelAction::<T>::torques,
                paper::backstepping::tracking_command::<T>, paper::backstepping::tracking_command_rate::<T>,
                paper::backstepping::parking_command::<T>, paper::backstepping::parking_command_rate::<T>,
                paper::demand::Demand::<T>::cast_with::<f32, Single>,
                paper::hand_over::pose_neurons::<T, M>, paper::hand_over::acceleration_neurons::<T>,
                paper::lyapunov::pose_energy::<T, M>, paper::lyapunov::ideal_pose_energy_rate::<T, M>,
                paper::lyapunov::velocity_energy::<T>, paper::lyapunov::dissipates::<T>, paper::lyapunov::neuron_energy::<T>,
                paper::lyapunov::neuron_energy_rate::<T>, paper::lyapunov::forgetting_rate::<T>, paper::lyapunov::passive_storage::<T>,
                paper::neural_law::LawOutput::<T>::state_rate, paper::neural_law::LawOutput::<T>::tracking_wrench,
                paper::neural_law::LawOutput::<T>::parking_wrench, paper::neural_law::tracking_law::<T, M>,
                paper::neural_law::parking_law::<T, M>, paper::params::Params::<T>::paper, paper::params::Params::<T>::cast::<f32>,
                paper::params::Params::<T>::validate, paper::params::ValidParams::<T>::params, paper::params::ValidParams::<T>::shunting,
                paper::params::ValidParams::<T>::wheels, paper::parking::command::<T>, paper::parking::command_rate::<T>,
                paper::tracking::command::<T>, paper::tracking::command_rate::<T>, paper::tracking::start::<T>,
                paper::plain::PlainController::<T, M>::start, paper::plain::PlainController::<T, M>::step,
                paper::plain::PlainController::<T, M>::report, paper::plain::PlainController::<T, M>::hand_over_step,
                paper::report::StepReport::<T>::has_transition_offset,
                paper::stability::longitudinal_tracking_is_stable::<T>, paper::stability::parking_is_stable::<T>,
                paper::stability::max_stable_speed::<T, M>, paper::stability::max_proven_speed::<T, M>,
                paper::tuning::margins::<T, M>, paper::tuning::PaperMargins::<T>::worst, paper::tuning::PaperMargins::<T>::warnings,
                paper::tuning::DesignSpec::<T>::for_tolerance::<M>, paper::tuning::DesignSpec::<T>::settling,
                paper::tuning::gains::<T, M>,
                tuning::disturbance_bandwidth::<T>, tuning::disturbance_damping::<T, M>, tuning::LoopMargins::<T>::worse,
                tuning::LoopMargins::<T>::is_stable, tuning::motion::margins::<T, M>, tuning::motion::MotionMargins::<T>::worst,
                tuning::motion::MotionMargins::<T>::warnings, tuning::motion::MotionDesignSpec::<T>::settling,
                tuning::motion::gains::<T, M>,
            ];
        }
    };
}

macro_rules! controllers {
    ($name:ident, $T:ty, $M:ty, $U:ty) => {
        fn $name() {
            type T = $T;
            type M = $M;
            type U = $U;
            keep![
                Shunting::<T>::step::<U, M>, Neuron::<T>::advance::<U, M>,
                MotionController::<T, M, U>::start, MotionController::<T, M, U>::step, MotionController::<T, M, U>::declare_jump, MotionController::<T, M, U>::declare_slide,
                MotionController::<T, M, U>::note_applied, MotionController::<T, M, U>::note_not_driven,
                MotionController::<T, M, U>::report, MotionController::<T, M, U>::motion,
                BaseController::<T, M, U, 4>::new, BaseController::<T, M, U, 4>::tick, BaseController::<T, M, U, 4>::report,
                BaseController::<T, M, U, 4>::base, BaseController::<T, M, U, 4>::supervisor, BaseController::<T, M, U, 4>::on,
                BaseController::<T, M, U, 4>::emergency_stop, BaseController::<T, M, U, 4>::emergency_stop_by,
                BaseController::<T, M, U, 4>::frame_seen, BaseController::<T, M, U, 4>::watch_link,
                BaseController::<T, M, U, 4>::set_pose, BaseController::<T, M, U, 4>::reconfigure,
                BaseController::<T, M, U, 4>::late_ticks, BaseController::<T, M, U, 4>::note_exerted,
                paper::neural::NeuralController::<T, M, U>::start, paper::neural::NeuralController::<T, M, U>::step,
                paper::neural::NeuralController::<T, M, U>::report, paper::neural::NeuralController::<T, M, U>::hand_over_step,
                paper::neural::NeuralController::<T, M, U>::is_relaxing, paper::neural::NeuralController::<T, M, U>::state,
            ];
        }
    };
}

numbers!(single_numbers, f32, Single);
numbers!(libm_numbers, f32, Libm);
numbers!(micromath_numbers, f32, Micromath);
numbers!(double_numbers, f64, Libm);
controllers!(single_rational, f32, Single, RationalMean);
controllers!(single_mean, f32, Single, ExactMean);
controllers!(single_held, f32, Single, ExactHeld);
controllers!(libm_rational, f32, Libm, RationalMean);
controllers!(libm_mean, f32, Libm, ExactMean);
controllers!(micromath_rational, f32, Micromath, RationalMean);
controllers!(micromath_mean, f32, Micromath, ExactMean);
controllers!(double_rational, f64, Libm, RationalMean);
controllers!(double_mean, f64, Libm, ExactMean);

fn is_short(remaining: &Remaining<f32>, command: &Twist<f32>, distance: fn(f32) -> f32) -> bool {
    remaining.is_short::<Single>(command, 0.25, distance)
}

type Drives = hal::BySpeed<&'static mut dyn hal::WheelSpeedDrive<Error = hal::ErrorKind>>;
type Base = BaseController<f32>;

fn others() {
    keep![
        is_short, Field::name, tuning::DesignParameter::name, hal::accepts, hal::accepts_speeds, Drives::new, Drives::drive, Drives::drive_mut, Drives::asked, Base::apply::<Drives>, hal::Widened::new, hal::Widened::update,
        motor::MotorLimited::torque, motor::Motor::<f32>::commands, DriveCommand::<f32>::observed, motor::WheelCommands::exerted, motor::WheelCommands::is_invalid,
        single::asin, single::atan2, single::exp_m1, single::inverse_sqrt, single::sin_cos, single::sin_cos_near, single::sqrt, single::wrap,
        safety::Side::of, safety::Fault::kind, safety::FaultKind::code, safety::FaultKind::name, safety::FaultKind::from_code,
        safety::FaultKind::breaks_measurement, safety::PolicyParams::get, safety::PolicyParams::with, safety::PolicyParams::validate,
        safety::ValidPolicyParams::response, safety::ValidPolicyParams::params,
        safety::ActiveFaults::add, safety::ActiveFaults::add_some, safety::ActiveFaults::add_all, safety::ActiveFaults::is_empty,
        safety::ActiveFaults::iter, safety::ActiveFaults::get, safety::ActiveFaults::worst, safety::ActiveFaults::ignored,
        safety::Response::passing, safety::Response::latched, safety::Response::and, safety::Silence::after, safety::Silence::us,
        safety::Silence::exceeds, sv::SupervisorParams::validate, sv::Supervisor::new, sv::Supervisor::on,
        sv::Supervisor::on_active_faults, sv::Supervisor::tick, sv::Supervisor::rests, sv::Supervisor::output, sv::Supervisor::state,
        sv::Supervisor::cause, sv::Supervisor::latched, sv::Supervisor::changes, sv::Supervisor::ignored,
        sv::Supervisor::emergency_stop, sv::Then::or, sv::Then::state, sv::State::drives, sv::State::is_live,
        sv::OutputMode::has_torque, sv::OutputMode::severity, sv::next,
    ];
}

fn run() {
    single_numbers();
    libm_numbers();
    micromath_numbers();
    double_numbers();
    single_rational();
    single_mean();
    single_held();
    libm_rational();
    libm_mean();
    micromath_rational();
    micromath_mean();
    double_rational();
    double_mean();
    others();
}

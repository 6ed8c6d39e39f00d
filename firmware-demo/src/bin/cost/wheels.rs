//! Between the wheels and the law: counts to poses, torques to duties.

use core::hint::black_box;

use controller_core::hal::{Observed, WheelCounts};
use controller_core::localiser::{Fix, FixOutcome, FusionParams, Localiser, LocaliserParams};
use controller_core::maths::Single;
use controller_core::motor::{MotorParams, WheelFriction};
use controller_core::odometry::{Calibration, Odometry, OdometryParams};
use controller_core::types::{Pose, WheelSpeeds, WheelTorques};
use controller_core::wheels::WheelGeometry;
use firmware_demo::board::Meter;

use crate::inputs::Inputs;
use crate::print::{Row, complain};

const COUNT: u32 = 1000;

const ODOMETRY: OdometryParams<f32> = OdometryParams {
    wheels: WheelGeometry {
        radius_right_m: 0.1,
        radius_left_m: 0.1,
        track_m: 0.5,
    },
    calibration: Calibration::NOMINAL,
    counts_per_turn: 4096.0,
    bandwidth: 50.0,
};

/// Pose and twist from encoder counts.
#[inline(never)]
pub fn odometry(meter: &mut Meter) {
    let mut counts = WheelCounts::default();
    let Ok(mut odometry) = Odometry::<f32>::new(&ODOMETRY, Pose::default(), counts) else {
        return complain(&["odometry"], "params", 1);
    };
    let mut inputs = Inputs::new(6);
    let dt = black_box(1.0e-3);
    let mut row = Row::new();
    let mut measured = None;
    for _ in 0..COUNT {
        // At most 8 counts a tick: 1.2 m/s.
        counts.right = counts.right.wrapping_add(inputs.bits() as i32 >> 28);
        counts.left = counts.left.wrapping_add(inputs.bits() as i32 >> 28);
        let cost = meter
            .measure(|| measured = Some(odometry.update::<Single>(counts, dt)))
            .1;
        row.add(cost);
        measured = black_box(measured);
    }
    row.print(&["odometry", "update"]);
}

/// The pose from encoders and fixes: a tick without a fix, and with one of 20 ms ago.
#[inline(never)]
pub fn localiser(meter: &mut Meter) {
    let params = LocaliserParams {
        odometry: ODOMETRY,
        fusion: Some(FusionParams::for_source(5.0e-3_f32, 5.0e-3, 20.0)),
        gyro: None,
    };
    let Ok(localisation) = params.validate() else {
        return complain(&["localiser"], "params", 1);
    };
    let mut counts = WheelCounts::default();
    let Ok(mut localiser) = Localiser::<f32, 32>::start(&localisation, Pose::default(), counts)
    else {
        return complain(&["localiser"], "start", 1);
    };
    let mut inputs = Inputs::new(9);
    let dt = black_box(1.0e-3);
    let (mut without, mut with) = (Row::new(), Row::new());
    let mut faults = 0_u32;
    let mut estimate = None;
    for tick in 0..COUNT {
        counts.right = counts.right.wrapping_add(inputs.bits() as i32 >> 28);
        counts.left = counts.left.wrapping_add(inputs.bits() as i32 >> 28);
        let at = *localiser.pose();
        let fix = Fix {
            pose: Pose::new(at.x + inputs.real::<f32>(0.01), at.y, at.theta),
            age_s: black_box(20.0e-3),
        };
        let given = (tick % 4 == 3 && tick > 40).then_some(&fix);
        let cost = meter
            .measure(|| estimate = localiser.update::<Single>(counts, dt, given).ok())
            .1;
        estimate = black_box(estimate);
        match (&estimate, given) {
            (Some(_), None) => without.add(cost),
            (Some(seen), Some(_)) if seen.fix == FixOutcome::Fused => with.add(cost),
            _ => faults += 1,
        }
    }
    without.print(&["localiser", "without-fix"]);
    with.print(&["localiser", "with-fix"]);
    complain(&["localiser"], "faults", faults);
}

/// Both wheels' torques to their duties, with everything there is to compensate.
#[inline(never)]
pub fn motor(meter: &mut Meter) {
    let params = MotorParams {
        gear_ratio: 30.0,
        gear_efficiency: 0.8,
        torque_constant_nm_per_a: 0.0085,
        resistance_ohm: 2.2,
        supply_v: 12.0,
        max_current_a: 2.0,
        friction: WheelFriction {
            coulomb_nm: 0.02,
            stiction_nm: 0.0,
            viscous_nm_s: 1.0e-3,
            blend_rad_s: 0.2,
        },
        dead_band: 0.03,
        rotor_inertia_kg_m2: 0.0,
    };
    let Ok(motor) = params.validate() else {
        return complain(&["motor"], "params", 1);
    };
    let motor = black_box(motor);
    let mut inputs = Inputs::new(9);
    let mut row = Row::new();
    let mut driven = ([0.0; 2], None);
    for _ in 0..COUNT {
        let mut pair = |scale| [inputs.real::<f32>(scale), inputs.real::<f32>(scale)];
        let ([right, left], [[r, l], [dr, dl]]) = (pair(0.3), [pair(20.0), pair(20.0)]);
        let torques = WheelTorques { right, left };
        let observed = Observed {
            speeds: WheelSpeeds { right: r, left: l },
            desired: WheelSpeeds {
                right: dr,
                left: dl,
            },
            beyond_coulomb: None,
            supply_v: black_box(11.0 + inputs.real::<f32>(1.0)),
        };
        // What a driver makes of them.
        let cost = meter
            .measure(|| {
                let commands = motor.commands(&torques, &observed);
                let duties = [commands.right.duty, commands.left.duty];
                driven = (duties, commands.exerted());
            })
            .1;
        row.add(cost);
        driven = black_box(driven);
    }
    row.print(&["motor", "commands"]);
}

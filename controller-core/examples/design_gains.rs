//! Gains of both laws from what an owner wants, and how far they are from trouble.

#[allow(dead_code)] // Only its limits are used here.
mod plant;

use controller_core::maths::Libm;
use controller_core::paper::params::Params;
use controller_core::paper::tuning as paper;
use controller_core::tuning::LoopMargins;
use controller_core::tuning::motion::{self, MotionDesignSpec};
use controller_core::{MotionParams, Robot};
use plant::LIMITS;

fn main() -> Result<(), Box<dyn core::error::Error>> {
    // The default law: a lateral offset has a tenth left after 3 s.
    let base = MotionParams::<f64>::new(Robot::paper(), LIMITS.cast());
    let gains = motion::gains::<f64, Libm>(&MotionDesignSpec::settling(3.0), &base)?;
    let margins = motion::margins::<f64, Libm>(&gains);
    println!("default law: settles in {:.2} s", margins.settling_s);
    show(&margins.worst());
    for warning in margins.warnings() {
        println!("  warning: {warning}");
    }

    // The paper's law at 0.4 m/s: 0.5 m beside the path becomes 5 cm within 5 s.
    let params = Params::<f64>::paper();
    let spec = paper::DesignSpec::settling(5.0, 0.4);
    let designed = paper::gains::<f64, Libm>(&params, &spec)?;
    println!("paper's law at 0.4 m/s:");
    show(&paper::margins::<f64, Libm>(&designed, 0.4).worst());

    // What the base cannot do is refused, with the nearest value that it can.
    match motion::gains::<f64, Libm>(&MotionDesignSpec::settling(0.6), &base) {
        Err(error) => println!("0.6 s: {error}"),
        Ok(_) => return Err("0.6 s is beyond the limits of this base".into()),
    }
    Ok(())
}

fn show(margins: &LoopMargins<f64>) {
    println!(
        "  damping {:.2}; stable with poses {:.2} s and torques {:.2} s late, and {:.1} times the mass",
        margins.damping, margins.pose_delay_s, margins.torque_delay_s, margins.heavier
    );
}

#[test]
fn both_laws_get_gains() {
    main().expect("a specification that can be had");
}

//! The paper's curve and parking at its end, by encoders of 2,048 counts and fixes of 5 mm and 5 mrad,
//! 20 a second, 20 ms late.

use controller_core::localiser::{FusionParams, LocaliserParams, ValidLocaliserParams};
use controller_core::maths::Libm;
use controller_core::motion::{Parking, ValidMotionParams};
use controller_core::types::Pose;
use sim_host::mission::BaseSpec as File;
use tests::encoded::{bases, odometry};
use tests::fixes::Source;
use tests::ideal::on_all_cores;
use tests::localised::{End, SPEED, localisation, mission, park};

/// The base with what its localisation says of noise and arrival.
fn suited(file: &File, localisation: &ValidLocaliserParams<f64>) -> ValidMotionParams<f64> {
    let mut params = file.motion();
    params.pose_noise_m = localisation.pose_noise_m();
    params.arrival = localisation.arrival();
    params.validate().expect("valid")
}

/// 10 ms and 5 ms in turn.
fn tick(seed: &u64) -> f64 {
    if seed.is_multiple_of(2) { 0.01 } else { 0.005 }
}

fn print(name: &str, runs: &[End]) -> (End, usize) {
    let (all, lost) = End::worst(runs);
    println!(
        "{name}: at most {:.2} mm, {:.2} mrad, parked by {:.2} s, torque at rest {:.4} %, left {}, lost {lost}",
        1e3 * all.off.0,
        1e3 * all.off.1,
        all.parked_s,
        100.0 * all.rest,
        all.left_goal
    );
    (all, lost)
}

/// 40 seeds a base: the true pose is within 5 mm and 10 mrad, and the wheels are quiet.
#[test]
fn noisy_fixes_park_within_5_mm_and_10_mrad() {
    for (name, file) in bases() {
        let localisation = localisation(&file, 5e-3, 5e-3);
        let motion = suited(&file, &localisation);
        let arrival = localisation.arrival();
        println!(
            "{name}: filtered {:.2} mm {:.2} mrad, noise {:.2} mm, arrival {:.2} mm {:.2} mrad",
            1e3 * localisation.filtered_noise_m(),
            1e3 * localisation.filtered_noise_rad(),
            1e3 * localisation.pose_noise_m(),
            1e3 * arrival.distance_m,
            1e3 * arrival.heading_rad
        );
        let seeds: Vec<u64> = (0..40).collect();
        let runs = on_all_cores(&seeds, |seed| {
            let mut source = Source::camera(0x5EED_1000 + seed);
            mission(&motion, &localisation, &file, &mut source, tick(seed))
        });
        let (all, lost) = print(name, &runs);
        assert_eq!(lost, 0, "{name}");
        assert!(all.off.0 < 5e-3 && all.off.1 < 0.01, "{name}: {all:?}");
        assert!(all.rest < 0.01, "{name}: {all:?}");
        // Noise of the pose alone does not push a robot off its goal.
        assert_eq!(all.left_goal, 0, "{name}");
    }
}

/// Without fixes the same robots park by their encoders alone.
#[test]
fn encoders_alone_park() {
    for (name, file) in bases() {
        let params = LocaliserParams {
            odometry: odometry(&file, SPEED),
            fusion: None,
            gyro: None,
        };
        let localisation = params.validate_with::<Libm>().expect("valid");
        let motion = suited(&file, &localisation);
        let runs = on_all_cores(&[0, 1], |seed| {
            // Not a fix ever: the source's first is an hour away.
            let mut source = Source::camera(*seed);
            source.latency_s = 3600.0;
            mission(&motion, &localisation, &file, &mut source, tick(seed))
        });
        let (all, lost) = print(name, &runs);
        assert_eq!(lost, 0, "{name}");
        // A count of 0.3 mm, and what its half turns the heading by over 4 m.
        assert!(all.off.0 < 3e-3 && all.off.1 < 3e-3, "{name}: {all:?}");
        assert!(all.rest < 0.01, "{name}: {all:?}");
    }
}

/// The noise radius of parking by feedback in standard deviations of the filtered noise, whatever the filter's bandwidth: 3 park every run, and
/// sooner than 1. Within the radius the law gives up the goal's direction; with 1 it still aims where that is noise of
/// 1 rad. It was a claim here that 1 loses runs: it does not any more (none of 48), it is only later.
#[test]
fn three_sigma_of_filtered_noise_are_enough() {
    let (name, file) = bases()[1].clone();
    for (bandwidth, noise) in [(0.2, 10e-3), (0.8, 5e-3), (3.0, 2.5e-3)] {
        let mut fusion = FusionParams::for_source(noise, noise, 20.0);
        fusion.bandwidth = bandwidth;
        fusion.heading_bandwidth = bandwidth;
        let params = LocaliserParams {
            odometry: odometry(&file, SPEED),
            fusion: Some(fusion),
            gyro: None,
        };
        let localisation = params.validate_with::<Libm>().expect("valid");
        let sigma = localisation.filtered_noise_m();
        let (mut lost, mut times) = (Vec::new(), Vec::new());
        for share in [0.2, 0.3, 0.4, 0.6] {
            let mut params = *suited(&file, &localisation).params();
            params.pose_noise_m = share * sigma;
            params.arrival.parking = Parking::Feedback;
            let motion = params.validate().expect("valid");
            let seeds: Vec<u64> = (0..16).collect();
            let runs = on_all_cores(&seeds, |seed| {
                let mut source = Source::camera(0x5EED_2000 + seed);
                source.noise_m = noise;
                source.noise_rad = noise;
                mission(&motion, &localisation, &file, &mut source, 0.01)
            });
            let label = format!("{name}, {bandwidth} rad/s, radius {:.1} sigma", 5.0 * share);
            lost.push(print(&label, &runs).1);
            times.push(runs.iter().map(|run| run.parked_s).sum::<f64>() / runs.len() as f64);
        }
        assert_eq!(lost, [0; 4]);
        let [one, .., three] = &times[..] else {
            panic!("four radii")
        };
        assert!(one > three, "{times:?}");
    }
}

/// From rest a little beside the goal, where the law gives up the direction: inside the tolerance.
#[test]
fn starts_beside_the_goal_end_inside_the_tolerance() {
    for (name, file) in bases() {
        let localisation = localisation(&file, 5e-3, 5e-3);
        let motion = suited(&file, &localisation);
        let seeds: Vec<u64> = (0..24).collect();
        let runs = on_all_cores(&seeds, |seed| {
            let start = Pose::new(0.0, 0.5e-3 * *seed as f64, 0.0);
            let mut source = Source::camera(0x5EED_3000 + seed);
            park(
                &motion,
                &localisation,
                &file,
                start,
                &mut source,
                tick(seed),
            )
        });
        let (all, lost) = print(name, &runs);
        // Who is between the radius and twice it may still be at it; most are done.
        assert!(lost <= 1, "{name}: {lost}");
        assert!(all.off.0 < 5e-3, "{name}: {all:?}");
    }
}

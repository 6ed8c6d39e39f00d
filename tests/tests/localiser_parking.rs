//! The paper's curve and parking at its end, by encoders and noisy, late, rare fixes.

use tests::encoded::{bases, motion};
use tests::fixes::Source;
use tests::localised::{localisation, mission};
use tests::motion_loop::both_cores;

/// Sweep.
#[test]
fn sweep() {
    for (factor, tol) in [(0.2, 4.0), (0.4, 4.0), (0.6,4.0), (0.6, 5.0), (0.8, 5.0), (1.0, 5.0), (1.0,7.0), (2.0, 7.0)] {
        for (name, file) in bases() {
            let l = localisation(&file, 5e-3, 5e-3);
            let sigma = l.filtered_noise_m();
            let mut params = motion(&file);
            params.pose_noise_m = factor * sigma;
            params.arrival.distance_m = tol * sigma;
            params.arrival.heading_rad = 6.0 * l.filtered_noise_rad();
            let m = params.validate().expect("valid");
            let seeds: Vec<u64> = (0..24).collect();
            let runs = both_cores(&seeds, |seed| {
                let dt = if seed % 2 == 0 { 0.01 } else { 0.005 };
                mission(&m, &l, &file, &mut Source::camera(0x5EED_1000 + seed), dt)
            });
            let far = runs.iter().map(|r| r.left.0).fold(0.0, f64::max);
            let turned = runs.iter().map(|r| r.left.1).fold(0.0, f64::max);
            let late = runs.iter().map(|r| r.parked_s).fold(0.0, f64::max);
            let rest = runs.iter().map(|r| r.rest).fold(0.0, f64::max);
            let lost = runs.iter().filter(|r| !r.parked).count();
            let left: u32 = runs.iter().map(|r| r.parks_left).sum();
            println!("{factor} {tol} {name}: sigma {:.2} mm, far {:.2} mm {:.2} mrad, parked {late:.2} s, rest {:.3} %, lost {lost}, left {left}", 1e3*sigma, 1e3 * far, 1e3*turned, 100.0*rest);
        }
    }
}

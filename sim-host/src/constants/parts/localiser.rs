//! Encoders and poses.

use super::{Writer, wheels};
use controller_core::localiser::{FusionParams, LocaliserParams};
use controller_core::odometry::{Calibration, OdometryParams};

pub(super) fn localiser(out: &mut Writer, params: &LocaliserParams<f32>) {
    let LocaliserParams {
        odometry: of_odometry,
        fusion: of_fusion,
    } = params;
    let OdometryParams {
        wheels: of_wheels,
        calibration,
        counts_per_turn,
        bandwidth,
    } = of_odometry;
    let Calibration { right, left, track } = calibration;
    out.open("localiser: localiser::LocaliserParams {");
    out.open("odometry: odometry::OdometryParams {");
    wheels(out, of_wheels);
    out.line("// Factors on the lengths above.");
    out.open("calibration: odometry::Calibration {");
    for (name, factor) in [("right", right), ("left", left), ("track", track)] {
        out.number(name, *factor, "");
    }
    out.close("},");
    out.number("counts_per_turn", *counts_per_turn, "Of a wheel.");
    out.number("bandwidth", *bandwidth, "Of the speed estimate [rad/s].");
    out.close("},");
    match of_fusion {
        None => out.field("fusion", "None", "Odometry alone."),
        Some(params) => fusion(out, params),
    }
    out.close("},");
}

fn fusion(out: &mut Writer, params: &FusionParams<f32>) {
    let FusionParams {
        noise_m,
        noise_rad,
        rate_hz,
        bandwidth,
        heading_bandwidth,
        gate,
        relocalise_after,
        drift,
        slide_m_s,
        stale_s,
    } = params;
    out.open("fusion: Some(localiser::FusionParams {");
    out.number("noise_m", *noise_m, "Of a pose [m, standard deviation].");
    out.number("noise_rad", *noise_rad, "[rad, standard deviation]");
    out.number("rate_hz", *rate_hz, "[Hz]");
    out.number(
        "bandwidth",
        *bandwidth,
        "Of the position's correction [rad/s].",
    );
    out.number("heading_bandwidth", *heading_bandwidth, "[rad/s]");
    out.number("gate", *gate, "Standard deviations.");
    out.field(
        "relocalise_after",
        &relocalise_after.to_string(),
        "Outliers that agree.",
    );
    out.number("drift", *drift, "Of the travel of a wheel.");
    out.number("slide_m_s", *slide_m_s, "Of a wheel over the floor [m/s].");
    out.number("stale_s", *stale_s, "[s]");
    out.close("}),");
}

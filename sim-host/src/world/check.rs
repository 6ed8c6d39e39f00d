//! Ranges of all parameters: outside them the equations have no meaning or the solver no digits.

use super::error::WorldError;
use super::params::{FloorParams, LEAST_LOOP_S, MotorParams, WorldParams};
use super::sense_params::{GyroParams, PoseSourceParams};

const TINY: f64 = 1.0e-9;
const HUGE: f64 = 1.0e9;
const ENDLESS: f64 = f64::INFINITY;
/// Below a hundredth of full grip nothing is left to integrate but noise.
const LEAST_MU: f64 = 1.0e-3;

type Row<'a> = (&'a str, f64, f64, f64);

impl WorldParams {
    /// Whether a plant can have all of these.
    ///
    /// # Errors
    /// The first one out of its range, with its key.
    pub fn check(&self) -> Result<(), WorldError> {
        let p = self;
        let b = &p.body;
        rows(
            "body",
            &[
                ("mass_kg", b.mass_kg, 1.0e-3, 1.0e6),
                ("inertia_com_kg_m2", b.inertia_com_kg_m2, TINY, HUGE),
                ("com_ahead_m", b.com_ahead_m, -10.0, 10.0),
                ("radius_right_m", b.radius_right_m, 1.0e-3, 10.0),
                ("radius_left_m", b.radius_left_m, 1.0e-3, 10.0),
                ("track_m", b.track_m, 1.0e-3, 100.0),
                ("wheel_inertia_kg_m2", b.wheel_inertia_kg_m2, 1.0e-12, HUGE),
                ("load_share", b.load_share, 0.01, 1.0),
                ("load_right", b.load_right, 0.05, 0.95),
            ],
        )?;
        if let Some(motor) = &p.motor {
            check_motor(motor)?;
        }
        let (battery, friction) = (&p.battery, &p.friction);
        let open = battery.open_circuit_v.unwrap_or(battery.nominal_v);
        rows(
            "battery",
            &[
                ("nominal_v", battery.nominal_v, 0.1, 1.0e3),
                ("open_circuit_v", open, 0.0, 1.0e3),
                ("internal_ohm", battery.internal_ohm, 0.0, 1.0e3),
            ],
        )?;
        rows(
            "friction",
            &[
                ("coulomb_nm", friction.coulomb_nm, 0.0, HUGE),
                // At rest it holds at least what it takes when turning; 0 means the same.
                ("static_nm", friction.static_nm, 0.0, HUGE),
                ("viscous_nm_s", friction.viscous_nm_s, 0.0, HUGE),
                ("rolling", friction.rolling, 0.0, 1.0),
            ],
        )?;
        if friction.static_nm != 0.0 {
            row(
                "friction",
                ("static_nm", friction.static_nm, friction.coulomb_nm, HUGE),
            )?;
        }
        check_floor(&p.floor)?;
        for (n, push) in p.push.iter().enumerate() {
            let table = format!("push[{n}]");
            rows(
                &table,
                &[
                    ("force_x_n", push.force_x_n, -HUGE, HUGE),
                    ("force_y_n", push.force_y_n, -HUGE, HUGE),
                    ("moment_nm", push.moment_nm, -HUGE, HUGE),
                ],
            )?;
            window(&table, "time_s", push.time_s)?;
        }
        check_senses(p)
    }
}

fn check_motor(m: &MotorParams) -> Result<(), WorldError> {
    rows(
        "motor",
        &[
            ("gear_ratio", m.gear_ratio, 1.0e-3, 1.0e5),
            ("gear_efficiency", m.gear_efficiency, 0.05, 1.0),
            ("kt_nm_per_a", m.kt_nm_per_a, 1.0e-6, 1.0e3),
            ("resistance_ohm", m.resistance_ohm, 1.0e-4, 1.0e6),
            ("inductance_h", m.inductance_h, 0.0, 10.0),
            ("rotor_inertia_kg_m2", m.rotor_inertia_kg_m2, 0.0, 1.0e3),
            ("current_limit_a", m.current_limit_a, 1.0e-6, ENDLESS),
            ("dead_band", m.dead_band, 0.0, 0.99),
            ("strength", m.strength[0], 0.01, 100.0),
            ("strength", m.strength[1], 0.01, 100.0),
        ],
    )
}

fn check_floor(f: &FloorParams) -> Result<(), WorldError> {
    rows(
        "floor",
        &[
            ("mu", f.mu, LEAST_MU, ENDLESS),
            // 40°: no floor, and the load of a wheel still far from 0.
            ("slope_rad", f.slope_rad, 0.0, 0.7),
            ("downhill_rad", f.downhill_rad, -10.0, 10.0),
            ("slip_stiffness", f.slip_stiffness, 0.0, 1.0e6),
            ("relaxation_m", f.relaxation_m, 1.0e-4, 10.0),
        ],
    )?;
    for (n, patch) in f.patch.iter().enumerate() {
        let table = format!("floor.patch[{n}]");
        row(&table, ("mu", patch.mu, LEAST_MU, ENDLESS))?;
        window(&table, "x_m", patch.x_m)?;
        window(&table, "y_m", patch.y_m)?;
        window(&table, "time_s", patch.time_s)?;
    }
    Ok(())
}

fn check_senses(p: &WorldParams) -> Result<(), WorldError> {
    let (e, t) = (&p.encoder, &p.tick);
    rows(
        "encoder",
        &[
            ("counts_per_turn", e.counts_per_turn, 1.0, 1.0e7),
            ("glitch_probability", e.glitch_probability, 0.0, 1.0),
            ("glitch_counts", f64::from(e.glitch_counts), 0.0, 1.0e6),
        ],
    )?;
    if let Some(source) = &p.pose_source {
        check_source(source)?;
    }
    if let Some(gyro) = &p.gyro {
        check_gyro(gyro)?;
    }
    rows(
        "noise",
        &[
            ("supply_v", p.noise.supply_v, 0.0, 1.0e3),
            ("current_a", p.noise.current_a, 0.0, 1.0e3),
        ],
    )?;
    rows(
        "tick",
        &[
            ("jitter_us", f64::from(t.jitter_us), 0.0, 1.0e5),
            ("late_probability", t.late_probability, 0.0, 1.0),
            ("late_median_us", t.late_median_us, 0.0, 1.0e6),
            ("late_spread", t.late_spread, 0.0, 3.0),
        ],
    )?;
    row("", ("speed_loop_s", p.speed_loop_s, LEAST_LOOP_S, 100.0))?;
    row("", ("substep_us", f64::from(p.substep_us), 1.0, 10_000.0))
}

fn check_source(s: &PoseSourceParams) -> Result<(), WorldError> {
    rows(
        "pose_source",
        &[
            ("rate_hz", s.rate_hz, 1.0e-3, 1.0e4),
            ("latency_s", s.latency_s, 0.0, 10.0),
            ("noise_m", s.noise_m, 0.0, 100.0),
            ("noise_rad", s.noise_rad, 0.0, 10.0),
            ("drop_probability", s.drop_probability, 0.0, 1.0),
            ("bias_m", s.bias_m[0], -1.0e3, 1.0e3),
            ("bias_m", s.bias_m[1], -1.0e3, 1.0e3),
            ("bias_rad", s.bias_rad, -10.0, 10.0),
        ],
    )
}

fn check_gyro(g: &GyroParams) -> Result<(), WorldError> {
    rows(
        "gyro",
        &[
            ("rate_hz", g.rate_hz, 1.0, 1.0e4),
            ("latency_s", g.latency_s, 0.0, 0.1),
            ("noise_density", g.noise_density, 0.0, 1.0),
            ("bias_limit", g.bias_limit, 0.0, 10.0),
            ("bias_walk", g.bias_walk, 0.0, 1.0),
            ("scale_error", g.scale_error, 0.0, 0.5),
            ("range", g.range, 1.0e-3, ENDLESS),
            ("resolution", g.resolution, 0.0, 1.0),
        ],
    )
}

fn rows(table: &str, rows: &[Row<'_>]) -> Result<(), WorldError> {
    rows.iter().try_for_each(|&one| row(table, one))
}

fn row(table: &str, (key, value, low, high): Row<'_>) -> Result<(), WorldError> {
    // NaN is in no range.
    if (low..=high).contains(&value) {
        return Ok(());
    }
    let dot = if table.is_empty() { "" } else { "." };
    Err(WorldError {
        key: format!("{table}{dot}{key}"),
        value,
        low,
        high,
    })
}

fn window(table: &str, key: &str, [from, to]: [f64; 2]) -> Result<(), WorldError> {
    row(table, (key, from, -ENDLESS, ENDLESS))?;
    row(table, (key, to, from, ENDLESS))
}

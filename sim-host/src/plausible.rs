//! Robots that cannot be, whatever they are for. What is wrong are mostly units.

use crate::numbers::{digits, least, most, refused};
use controller_core::wheels::WheelGeometry;
use std::f64::consts::PI;
use std::fmt;

/// Density of air at sea level \[kg/m³\], ISO 2533. No robot is lighter than the air between its wheels.
const AIR_KG_M3: f64 = 1.225;
/// Density of steel \[kg/m³\], EN 1993-1-1.
const STEEL_KG_M3: f64 = 7850.0;
/// Length, width and height of the largest body, over the larger of the track and a wheel's diameter. A body of solid steel on
/// wheels a third of its length apart is more than any robot.
const SPAN: f64 = 3.0;

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The mass.
    Mass,
    /// The yaw inertia.
    Inertia,
}

/// A body that no robot on its wheels has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impossible {
    /// Which number.
    pub quantity: Quantity,
    /// The number \[kg, kg m²\].
    pub value: f64,
    /// The limit that it is beyond.
    limit: f64,
    wheels: WheelGeometry<f64>,
}

impl fmt::Display for Impossible {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            quantity,
            value,
            limit,
            wheels,
        } = self;
        let (track, radius) = (digits(wheels.track_m), digits(radius(wheels)));
        let (told, least, most) = (refused(*value, *limit), least(*limit), most(*limit));
        match quantity {
            Quantity::Mass if value < limit => {
                write!(
                    f,
                    "{told} kg is less than the air between its wheels weighs, {least} kg"
                )
            }
            Quantity::Mass => write!(
                f,
                "{told} kg is more than solid steel weighs that is {SPAN} times as long, wide and high as such wheels \
                 and their distance, {most} kg"
            ),
            Quantity::Inertia if value < limit => write!(
                f,
                "{told} kg m² is less than its mass has as a column of solid steel {SPAN} times as high as such wheels \
                 and their distance, {least} kg m²"
            ),
            Quantity::Inertia => write!(
                f,
                "{told} kg m² is more than its mass has {SPAN} times as far out as such wheels and their distance, \
                 {most} kg m²"
            ),
        }?;
        write!(
            f,
            " (wheels of radius {radius} m, {track} m apart); lengths are in m, masses in kg"
        )
    }
}

impl std::error::Error for Impossible {}

fn radius(wheels: &WheelGeometry<f64>) -> f64 {
    wheels.radius_right_m.max(wheels.radius_left_m)
}

/// Whether a robot on these wheels can have this mass \[kg\] and, if it is known, this yaw inertia \[kg m²\].
///
/// # Errors
/// The first that it cannot.
pub fn body(
    wheels: &WheelGeometry<f64>,
    mass_kg: f64,
    inertia_kg_m2: Option<f64>,
) -> Result<(), Impossible> {
    let diameter = 2.0 * radius(wheels);
    let edge = SPAN * wheels.track_m.max(diameter);
    let least = AIR_KG_M3 * wheels.track_m * diameter.powi(2);
    let most = STEEL_KG_M3 * edge.powi(3);
    let beyond = |quantity, value, limit| {
        Err(Impossible {
            quantity,
            value,
            limit,
            wheels: *wheels,
        })
    };
    if mass_kg < least {
        return beyond(Quantity::Mass, mass_kg, least);
    }
    if mass_kg > most {
        return beyond(Quantity::Mass, mass_kg, most);
    }
    // Of a round column m = ρ π r² h, and its inertia is m r²/2.
    let least = mass_kg.powi(2) / (2.0 * PI * STEEL_KG_M3 * edge);
    let most = mass_kg * edge.powi(2);
    match inertia_kg_m2 {
        Some(inertia) if inertia < least => beyond(Quantity::Inertia, inertia, least),
        Some(inertia) if inertia > most => beyond(Quantity::Inertia, inertia, most),
        _ => Ok(()),
    }
}

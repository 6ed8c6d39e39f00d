//! From wheel torques to what a motor driver takes: current, voltage, duty; or wheel speeds.
//!
//! # Torque to duty
//!
//! [`Motor::command`] inverts a brushed DC motor behind a gear and a switching bridge, from the wheel
//! back to the pin:
//!
//! ```text
//! σ  = sat(ω*/ω_b)                             sense of motion, blended     ω* desired, not measured
//! τ′ = τ + τ_c σ + b ω*                        Coulomb and viscous friction
//! i  = (c_m τ′ + c_h σ |τ′|)/(g k_t)           gear: 1/η driving, η braking; |i| ≤ i_max
//! u  = R i + g k_t ω                           back-EMF of the measured speed; |u| ≤ (1 − d₀) U
//! d  = u/U                                     U as measured: a battery sags
//! D  = d + d₀ sgn d                            beyond the dead band, by a ramp near zero
//! ```
//!
//! | symbol | name | unit |
//! | --- | --- | --- |
//! | τ, τ′ | torque demanded of the wheel; with its friction | N m |
//! | ω, ω* | speed of the wheel, measured and desired | rad/s |
//! | τ_c, b, ω_b | Coulomb and viscous friction at the wheel, half width of the blend | N m, N m s, rad/s |
//! | g, η | motor turns per wheel turn; efficiency of the gear | |
//! | c_m, c_h | (1/η + η)/2 and (1/η − η)/2 | |
//! | k_t | torque constant; in SI units the same number as the back-EMF constant | N m/A = V s/rad |
//! | R, i, U | winding and bridge, current, supply | Ω, A, V |
//! | d₀ | dead band | |
//!
//! Left out: the winding's inductance (L/R of a small motor is below a tick) and the inertia of rotor
//! and gear, which belongs to the mass and inertia of the base: [`Robot::with_wheel_inertia`](crate::robot::Robot::with_wheel_inertia).
//!
//! d = u/U holds for a bridge that shorts the motor while its PWM is low. One that lets it coast then
//! (fast decay) gives more than u at light load, and is no linear actuator.
//!
//! # Which speed is used where
//!
//! Back-EMF is compensated from the measured speed: it is there whatever was desired. A duty holds for a tick, over which the
//! speed goes on: ω is the speed in the middle of it, measured plus half a tick of the commanded acceleration
//! ([`DriveCommand::speeds`](crate::base::DriveCommand::speeds)). With the speed at its begin a base of 10 kg lost a tenth of its
//! acceleration to it. The compensation needs no exact k_t: what is left of it after compensation is damping or a little negative damping, which
//! the velocity loop outweighs.
//!
//! Friction and gear loss are compensated from the desired speed. With the measured speed their
//! compensation would be positive feedback with a slope of τ_c/ω_b: noise of the speed estimate at
//! rest would come out as torque that moves the wheel the way of the noise, and any overestimate of
//! τ_c would make a wheel run by itself. The desired speed is smooth and exactly zero at rest. The price:
//! while the wheel goes the other way than desired, the compensation has the wrong sign; that is no more than
//! 2 τ_c, for as long as the velocity loop needs to turn the wheel round.
//!
//! # Speed output
//!
//! [`SpeedOutput`] is for drivers that close their own speed loop; [`DriverParams`] says which kind a base has.
//!
//! # Stopping
//!
//! [`electrical_brake`] and [`coast`] say how a base slows down with its motors shorted or released.

mod command;
mod dead_band;
mod driver;
mod gear;
mod pair;
mod params;
mod speed;
mod stopping;

pub use command::{MotorCommand, MotorLimited, WheelDemand};
pub use driver::{Driver, DriverParams};
pub use pair::WheelCommands;
pub use params::{MAX_SUPPLY_SHARE, MIN_SUPPLY_SHARE, Motor, MotorParams, WheelFriction};
pub use speed::{SpeedLimited, SpeedOutput, SpeedParams, SpeedState, WheelSpeedCommand};
pub use stopping::{Decay, Slowing, coast, electrical_brake};

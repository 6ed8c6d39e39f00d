//! What a base has to offer to be driven: wheel torques, encoders, a gyro if it has one, a clock.
//!
//! In the manner of `embedded-hal`: an associated error with a generic kind, implementations for
//! `&mut T`, and contracts stated at the methods. Torques reach wheels through here and nowhere
//! else; they come from [`crate::motion::MotionReport::torques`].
//!
//! Wheels are stopped in two ways, and hardware that can distinguishes them: *released* they are free to coast, *braked*
//! their motors are shorted. How far a base goes either way: [`crate::motor::coast`], [`crate::motor::electrical_brake`].

use crate::types::{WheelSpeeds, WheelTorques};
use core::fmt;

/// An error of a driver, reduced to what a supervisor can act on.
pub trait Error: fmt::Debug {
    /// The kind.
    fn kind(&self) -> ErrorKind;
}

/// What a supervisor can act on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ErrorKind {
    /// The driver did not answer, or answered nonsense.
    Bus,
    /// The driver switched off for too much current.
    OverCurrent,
    /// The supply is too low to drive the motors.
    UnderVoltage,
    /// A torque above [`WheelDrive::max_torque_nm`] or a speed above [`WheelSpeedDrive::max_speed_rad_s`] was refused, or
    /// one that is not finite.
    OutOfRange,
    /// Anything else.
    Other,
}

impl fmt::Display for ErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Bus => "the driver does not answer",
            Self::OverCurrent => "the driver saw too much current",
            Self::UnderVoltage => "the supply is too low",
            Self::OutOfRange => "the torque or speed is out of range",
            Self::Other => "the driver failed",
        })
    }
}

impl Error for ErrorKind {
    fn kind(&self) -> ErrorKind {
        *self
    }
}

impl Error for core::convert::Infallible {
    fn kind(&self) -> ErrorKind {
        match *self {}
    }
}

/// Common error type of the traits below.
pub trait ErrorType {
    /// What the driver's methods fail with.
    type Error: Error;
}

impl<D: ErrorType + ?Sized> ErrorType for &mut D {
    type Error = D::Error;
}

/// What a motor command needs to know beside the torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observed {
    /// In the middle of the tick, for the back-EMF: measured, and half a tick of the commanded acceleration.
    pub speeds: WheelSpeeds<f32>,
    /// Commanded by the controller, for friction.
    pub desired: WheelSpeeds<f32>,
    /// Friction beyond the Coulomb part of the parameters, as the base has found it \[N m\]; `None` where it has not: stiction
    /// then goes by the measured speed.
    pub beyond_coulomb: Option<WheelTorques<f32>>,
    /// Measured at the bridges \[V\]; NaN where nothing measures it. What is not believable is replaced by the nominal
    /// supply, and reported: [`crate::motor::MotorCommand::limited`].
    pub supply_v: f32,
}

impl Default for Observed {
    /// Standing still, supply unknown.
    fn default() -> Self {
        Self {
            speeds: WheelSpeeds::default(),
            desired: WheelSpeeds::default(),
            beyond_coulomb: None,
            supply_v: f32::NAN,
        }
    }
}

/// A pair of driven wheels that takes torques.
pub trait WheelDrive: ErrorType {
    /// Largest torque of either wheel \[N m\], positive and finite.
    fn max_torque_nm(&self) -> f32;

    /// Tells how fast the wheels turn and are to turn, and the supply; called before every [`set_torques`](Self::set_torques).
    /// A driver that controls its current by itself need not know.
    fn observe(&mut self, _observed: &Observed) {}

    /// What the wheels exert since the last [`set_torques`](Self::set_torques) if that is less than the command, because current or supply did
    /// not suffice; `None` where it is the command, or not known.
    fn exerted(&self) -> Option<WheelTorques<f32>> {
        None
    }

    /// Sets both wheels at once; they hold until the next call.
    ///
    /// # Errors
    /// A torque that is NaN, infinite or above [`max_torque_nm`](Self::max_torque_nm) in magnitude is
    /// refused with [`ErrorKind::OutOfRange`] and leaves both wheels as they were: limiting is the
    /// controller's business, which then knows of it. Otherwise what the hardware reports; the wheels'
    /// state is then unknown, and the caller calls [`release`](Self::release).
    fn set_torques(&mut self, torques: WheelTorques<f32>) -> Result<(), Self::Error>;

    /// Makes both wheels safe: no torque, free to coast. Must work at any time, also after errors
    /// and twice in a row.
    ///
    /// # Errors
    /// What the hardware reports; an implementation tries everything it can before it fails.
    fn release(&mut self) -> Result<(), Self::Error>;

    /// Brakes both wheels electrically: motors shorted, so that they resist in proportion to their speed. They do not hold
    /// on a slope. Must work at any time, also after errors and twice in a row.
    ///
    /// A driver that cannot brake releases, and says so in its documentation.
    ///
    /// # Errors
    /// What the hardware reports; an implementation tries everything it can before it fails.
    fn brake(&mut self) -> Result<(), Self::Error>;
}

impl<D: WheelDrive + ?Sized> WheelDrive for &mut D {
    fn max_torque_nm(&self) -> f32 {
        (**self).max_torque_nm()
    }
    fn observe(&mut self, observed: &Observed) {
        (**self).observe(observed);
    }
    fn exerted(&self) -> Option<WheelTorques<f32>> {
        (**self).exerted()
    }
    fn set_torques(&mut self, torques: WheelTorques<f32>) -> Result<(), Self::Error> {
        (**self).set_torques(torques)
    }
    fn release(&mut self) -> Result<(), Self::Error> {
        (**self).release()
    }
    fn brake(&mut self) -> Result<(), Self::Error> {
        (**self).brake()
    }
}

/// Both torques are finite and within the limit: the check that every [`WheelDrive`] makes.
pub fn accepts(torques: &WheelTorques<f32>, max_torque_nm: f32) -> bool {
    torques.right.abs() <= max_torque_nm && torques.left.abs() <= max_torque_nm
}

/// A pair of driven wheels that takes speeds and controls them by itself.
///
/// [`crate::motor::SpeedOutput`] makes such speeds, and says what is lost against a [`WheelDrive`].
pub trait WheelSpeedDrive: ErrorType {
    /// Largest speed of either wheel \[rad/s\], positive and finite.
    fn max_speed_rad_s(&self) -> f32;

    /// Sets both wheels at once; they hold until the next call.
    ///
    /// # Errors
    /// As [`WheelDrive::set_torques`], for [`max_speed_rad_s`](Self::max_speed_rad_s).
    fn set_speeds(&mut self, speeds: WheelSpeeds<f32>) -> Result<(), Self::Error>;

    /// As [`WheelDrive::release`]: no speed is held, the wheels are free to coast.
    ///
    /// # Errors
    /// What the hardware reports; an implementation tries everything it can before it fails.
    fn release(&mut self) -> Result<(), Self::Error>;

    /// As [`WheelDrive::brake`]. A speed of 0 is something else: the driver then holds the wheel with all its torque.
    ///
    /// # Errors
    /// What the hardware reports; an implementation tries everything it can before it fails.
    fn brake(&mut self) -> Result<(), Self::Error>;
}

impl<D: WheelSpeedDrive + ?Sized> WheelSpeedDrive for &mut D {
    fn max_speed_rad_s(&self) -> f32 {
        (**self).max_speed_rad_s()
    }
    fn set_speeds(&mut self, speeds: WheelSpeeds<f32>) -> Result<(), Self::Error> {
        (**self).set_speeds(speeds)
    }
    fn release(&mut self) -> Result<(), Self::Error> {
        (**self).release()
    }
    fn brake(&mut self) -> Result<(), Self::Error> {
        (**self).brake()
    }
}

/// Drivers that close their own speed loop, as the wheels of a base whose [`DriverParams`](crate::motor::DriverParams) say so: what the base desires goes out,
/// and of torques nothing is asked and nothing known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BySpeed<D> {
    drive: D,
    desired: WheelSpeeds<f32>,
    asked: Call<WheelSpeeds<f32>>,
}

impl<D: WheelSpeedDrive> BySpeed<D> {
    /// Of a pair of drivers.
    pub const fn new(drive: D) -> Self {
        let (right, left) = (0.0, 0.0);
        Self {
            drive,
            desired: WheelSpeeds { right, left },
            asked: Call::Release,
        }
    }

    /// What was asked of the drivers last; after an error not what they do.
    pub const fn asked(&self) -> &Call<WheelSpeeds<f32>> {
        &self.asked
    }

    /// The drivers.
    pub const fn drive(&self) -> &D {
        &self.drive
    }

    /// The drivers.
    pub const fn drive_mut(&mut self) -> &mut D {
        &mut self.drive
    }
}

impl<D: ErrorType> ErrorType for BySpeed<D> {
    type Error = D::Error;
}

impl<D: WheelSpeedDrive> WheelDrive for BySpeed<D> {
    /// Any: torques are not its business.
    fn max_torque_nm(&self) -> f32 {
        f32::MAX
    }

    fn observe(&mut self, observed: &Observed) {
        self.desired = observed.desired;
    }

    /// Sets the speeds that were observed last.
    fn set_torques(&mut self, _: WheelTorques<f32>) -> Result<(), Self::Error> {
        self.asked = Call::Set(self.desired);
        self.drive.set_speeds(self.desired)
    }

    fn release(&mut self) -> Result<(), Self::Error> {
        self.asked = Call::Release;
        self.drive.release()
    }

    fn brake(&mut self) -> Result<(), Self::Error> {
        self.asked = Call::Brake;
        self.drive.brake()
    }
}

/// What was asked of a pair of driven wheels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Call<V> {
    /// To exert these torques, or to hold these speeds.
    Set(V),
    /// To coast.
    #[default]
    Release,
    /// To brake electrically.
    Brake,
}

/// Both speeds are finite and within the limit: the check that every [`WheelSpeedDrive`] makes.
pub fn accepts_speeds(speeds: &WheelSpeeds<f32>, max_speed_rad_s: f32) -> bool {
    speeds.right.abs() <= max_speed_rad_s && speeds.left.abs() <= max_speed_rad_s
}

/// Positions of both wheels in counts; positive counts drive forward, and both wrap around at the
/// ends of `i32`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WheelCounts {
    /// Right wheel.
    pub right: i32,
    /// Left wheel.
    pub left: i32,
}

/// A pair of encoders.
pub trait WheelEncoders: ErrorType {
    /// Both positions, read as close together as the hardware allows.
    ///
    /// A counter narrower than 32 bits is widened by the implementation: between two calls a wheel
    /// turns less than half its range.
    ///
    /// # Errors
    /// What the hardware reports.
    fn counts(&mut self) -> Result<WheelCounts, Self::Error>;
}

impl<E: WheelEncoders + ?Sized> WheelEncoders for &mut E {
    fn counts(&mut self) -> Result<WheelCounts, Self::Error> {
        (**self).counts()
    }
}

/// What a gyro measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GyroReading<T = f32> {
    /// Turn rate about the vertical, counter-clockwise seen from above \[rad/s\]: the mean since the last reading, as of all
    /// samples in a sensor's FIFO, or the last sample.
    pub rate: T,
    /// The heading, where the sensor fuses one by itself \[rad\]: from any zero, wrapped or not. Its steps are then taken
    /// instead of the rate's integral, and no bias is taken from them.
    pub heading: Option<T>,
    /// How long before this tick it was valid \[s\], 0 to 0.1: delay of the sensor's filter, and time since the sample.
    pub age_s: T,
}

/// A gyro about the vertical.
pub trait YawGyro: ErrorType {
    /// What has come since the last call, `None` if nothing has: with the mean rate of all samples, as of a FIFO, and the age of the
    /// newest; [`GyroParams::latency_s`](crate::gyro::GyroParams::latency_s) where the hardware knows no better.
    ///
    /// The sign and the scale are the implementation's: rad/s, counter-clockwise seen from above. The bias is left in; the base learns it.
    ///
    /// # Errors
    /// What the hardware reports. To a base that is as no reading: it finds that the gyro is silent.
    fn reading(&mut self) -> Result<Option<GyroReading<f32>>, Self::Error>;
}

impl<G: YawGyro + ?Sized> YawGyro for &mut G {
    fn reading(&mut self) -> Result<Option<GyroReading<f32>>, Self::Error> {
        (**self).reading()
    }
}

/// The gyro of a base that has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoGyro;

impl ErrorType for NoGyro {
    type Error = core::convert::Infallible;
}

impl YawGyro for NoGyro {
    fn reading(&mut self) -> Result<Option<GyroReading<f32>>, Self::Error> {
        Ok(None)
    }
}

/// A clock that only goes forward and wraps around at the end of `u32` (every 71 minutes).
pub trait Clock {
    /// Microseconds since some instant.
    fn now_us(&self) -> u32;
}

impl<C: Clock + ?Sized> Clock for &mut C {
    fn now_us(&self) -> u32 {
        (**self).now_us()
    }
}

/// Widens a counter of `u16`, such as a timer in encoder mode, to `i32`.
///
/// ```
/// use controller_core::hal::Widened;
/// let mut wheel = Widened::new(65_530);
/// assert_eq!(wheel.update(4), 10); // ten counts forward, through the rollover
/// assert_eq!(wheel.update(65_530), 0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Widened {
    last: u16,
    total: i32,
}

impl Widened {
    /// Starts at total 0 with the counter at `raw`.
    pub const fn new(raw: u16) -> Self {
        Self {
            last: raw,
            total: 0,
        }
    }

    /// The total after the counter moved to `raw`, by less than 32,768 counts either way.
    pub fn update(&mut self, raw: u16) -> i32 {
        let moved = raw.wrapping_sub(self.last) as i16;
        self.last = raw;
        self.total = self.total.wrapping_add(i32::from(moved));
        self.total
    }
}

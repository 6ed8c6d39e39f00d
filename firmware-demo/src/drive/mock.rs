//! Wheels that only remember what was applied, and fail on demand.

use controller_core::hal::{
    Call, ErrorKind, ErrorType, WheelDrive, WheelSpeedDrive, accepts, accepts_speeds,
};
use controller_core::types::{WheelSpeeds, WheelTorques};
use protocol::pil::WheelOutput;

/// When the driver fails, by the number of calls before, from 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Script {
    /// First call that fails.
    pub from: u32,
    /// How many fail; 0 for none.
    pub count: u32,
    /// With what; `None` as a driver that does not answer.
    pub kind: Option<ErrorKind>,
}

impl Script {
    /// No call fails.
    pub(super) const NEVER: Self = Self {
        from: 0,
        count: 0,
        kind: None,
    };

    /// Counted from call `calls`.
    pub(super) const fn after(self, calls: u32) -> Self {
        Self {
            from: calls.saturating_add(self.from),
            ..self
        }
    }

    /// What call `at` fails with.
    pub(super) fn failure(&self, at: u32) -> Option<ErrorKind> {
        let fails = at >= self.from && at.wrapping_sub(self.from) < self.count;
        fails.then(|| self.kind.unwrap_or(ErrorKind::Bus))
    }
}

/// Remembers every call: the last `N` of them one by one, all of them by number.
#[derive(Clone, Debug)]
pub struct Mock<V, const N: usize = 8> {
    max: f32,
    script: Script,
    calls: [Call<V>; N],
    next: usize,
    sets: u32,
    releases: u32,
    brakes: u32,
    output: Call<V>,
}

/// Wheels that take torques.
pub type MockDrive<const N: usize = 8> = Mock<WheelTorques<f32>, N>;

/// Wheels that take speeds.
pub type MockSpeedDrive<const N: usize = 8> = Mock<WheelSpeeds<f32>, N>;

impl<V: Copy, const N: usize> Mock<V, N> {
    /// Released wheels that never fail; `max` is their largest torque \[N m\] or speed \[rad/s\].
    pub const fn new(max: f32) -> Self {
        Self {
            max,
            script: Script::NEVER,
            calls: [Call::Release; N],
            next: 0,
            sets: 0,
            releases: 0,
            brakes: 0,
            output: Call::Release,
        }
    }

    /// Fails as `script` says, counted from now.
    pub const fn fail(&mut self, script: Script) {
        self.script = script.after(self.calls());
    }

    /// Calls so far.
    pub const fn calls(&self) -> u32 {
        self.sets
            .saturating_add(self.releases)
            .saturating_add(self.brakes)
    }

    /// Calls of `set_torques` or `set_speeds` so far.
    pub const fn sets(&self) -> u32 {
        self.sets
    }

    /// Calls of `release` so far.
    pub const fn releases(&self) -> u32 {
        self.releases
    }

    /// Calls of `brake` so far.
    pub const fn brakes(&self) -> u32 {
        self.brakes
    }

    /// What was applied to the wheels; `None` when they are free or braked.
    pub const fn applied(&self) -> Option<V> {
        match self.output {
            Call::Set(applied) => Some(applied),
            Call::Release | Call::Brake => None,
        }
    }

    /// What the wheels do now.
    pub const fn output(&self) -> Call<V> {
        self.output
    }

    /// The last calls, newest first.
    pub fn last_calls(&self) -> impl Iterator<Item = &Call<V>> {
        let (newer, older) = self.calls.split_at_checked(self.next).unwrap_or_default();
        let known = usize::try_from(self.calls()).unwrap_or(usize::MAX);
        newer.iter().rev().chain(older.iter().rev()).take(known)
    }

    fn record(&mut self, call: Call<V>) -> Result<(), ErrorKind> {
        let at = self.calls();
        if let Some(place) = self.calls.get_mut(self.next) {
            *place = call;
        }
        self.next = self.next.wrapping_add(1);
        if self.next >= N {
            self.next = 0;
        }
        self.script.failure(at).map_or(Ok(()), Err)
    }

    fn set(&mut self, value: V, accepted: bool) -> Result<(), ErrorKind> {
        let answer = self.record(Call::Set(value));
        self.sets = self.sets.saturating_add(1);
        if !accepted {
            return Err(ErrorKind::OutOfRange);
        }
        answer?;
        self.output = Call::Set(value);
        Ok(())
    }

    fn free(&mut self) -> Result<(), ErrorKind> {
        let answer = self.record(Call::Release);
        self.releases = self.releases.saturating_add(1);
        answer?;
        self.output = Call::Release;
        Ok(())
    }

    fn short(&mut self) -> Result<(), ErrorKind> {
        let answer = self.record(Call::Brake);
        self.brakes = self.brakes.saturating_add(1);
        answer?;
        self.output = Call::Brake;
        Ok(())
    }
}

impl<V, const N: usize> ErrorType for Mock<V, N> {
    type Error = ErrorKind;
}

impl<const N: usize> WheelDrive for MockDrive<N> {
    fn max_torque_nm(&self) -> f32 {
        self.max
    }
    fn set_torques(&mut self, torques: WheelTorques<f32>) -> Result<(), ErrorKind> {
        self.set(torques, accepts(&torques, self.max))
    }
    fn release(&mut self) -> Result<(), ErrorKind> {
        self.free()
    }
    fn brake(&mut self) -> Result<(), ErrorKind> {
        self.short()
    }
}

impl<const N: usize> WheelSpeedDrive for MockSpeedDrive<N> {
    fn max_speed_rad_s(&self) -> f32 {
        self.max
    }
    fn set_speeds(&mut self, speeds: WheelSpeeds<f32>) -> Result<(), ErrorKind> {
        self.set(speeds, accepts_speeds(&speeds, self.max))
    }
    fn release(&mut self) -> Result<(), ErrorKind> {
        self.free()
    }
    fn brake(&mut self) -> Result<(), ErrorKind> {
        self.short()
    }
}

impl<const N: usize> super::DriveOutput for MockDrive<N> {
    fn output(&self) -> WheelOutput {
        match self.output {
            Call::Set(WheelTorques { right, left }) => WheelOutput::Torque { right, left },
            Call::Release => WheelOutput::Release,
            Call::Brake => WheelOutput::Brake,
        }
    }
}

//! Wheels that only remember what they were told, and fail on demand.

use controller_core::hal::{ErrorKind, ErrorType, WheelDrive, accepts};
use controller_core::types::WheelTorques;

/// One call.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Call {
    /// Torques were set, or would have been.
    Set(WheelTorques<f32>),
    /// The wheels were made safe.
    #[default]
    Release,
}

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

/// Remembers every call: the last `N` of them one by one, all of them by number.
#[derive(Clone, Debug)]
pub struct MockDrive<const N: usize = 8> {
    max_torque_nm: f32,
    script: Script,
    calls: [Call; N],
    next: usize,
    sets: u32,
    releases: u32,
    told: Option<WheelTorques<f32>>,
}

impl<const N: usize> MockDrive<N> {
    /// Released wheels that never fail.
    pub const fn new(max_torque_nm: f32) -> Self {
        Self {
            max_torque_nm,
            script: Script {
                from: 0,
                count: 0,
                kind: None,
            },
            calls: [Call::Release; N],
            next: 0,
            sets: 0,
            releases: 0,
            told: None,
        }
    }

    /// Fails as `script` says, counted from now.
    pub const fn fail(&mut self, script: Script) {
        self.script = Script {
            from: self.calls().saturating_add(script.from),
            ..script
        };
    }

    /// Calls so far.
    pub const fn calls(&self) -> u32 {
        self.sets.saturating_add(self.releases)
    }

    /// Calls of `set_torques` so far.
    pub const fn sets(&self) -> u32 {
        self.sets
    }

    /// Calls of `release` so far.
    pub const fn releases(&self) -> u32 {
        self.releases
    }

    /// What the wheels do now; `None` when they are free.
    pub const fn told(&self) -> Option<WheelTorques<f32>> {
        self.told
    }

    /// The last calls, newest first.
    pub fn last_calls(&self) -> impl Iterator<Item = &Call> {
        let (newer, older) = self.calls.split_at_checked(self.next).unwrap_or_default();
        let known = usize::try_from(self.calls()).unwrap_or(usize::MAX);
        newer.iter().rev().chain(older.iter().rev()).take(known)
    }

    fn record(&mut self, call: Call) -> Result<(), ErrorKind> {
        let at = self.calls();
        if let Some(place) = self.calls.get_mut(self.next) {
            *place = call;
        }
        self.next = self.next.wrapping_add(1);
        if self.next >= N {
            self.next = 0;
        }
        let Script { from, count, kind } = self.script;
        if at >= from && at.wrapping_sub(from) < count {
            Err(kind.unwrap_or(ErrorKind::Bus))
        } else {
            Ok(())
        }
    }
}

impl<const N: usize> ErrorType for MockDrive<N> {
    type Error = ErrorKind;
}

impl<const N: usize> WheelDrive for MockDrive<N> {
    fn max_torque_nm(&self) -> f32 {
        self.max_torque_nm
    }

    fn set_torques(&mut self, torques: WheelTorques<f32>) -> Result<(), ErrorKind> {
        let answer = self.record(Call::Set(torques));
        self.sets = self.sets.saturating_add(1);
        if !accepts(&torques, self.max_torque_nm) {
            return Err(ErrorKind::OutOfRange);
        }
        answer?;
        self.told = Some(torques);
        Ok(())
    }

    fn release(&mut self) -> Result<(), ErrorKind> {
        let answer = self.record(Call::Release);
        self.releases = self.releases.saturating_add(1);
        answer?;
        self.told = None;
        Ok(())
    }
}

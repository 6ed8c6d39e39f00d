//! A gyro with scripted readings, which fails on demand.

use controller_core::hal::{ErrorKind, ErrorType, GyroReading, YawGyro};

use super::mock::Script;

/// Gives each reading once.
#[derive(Clone, Copy, Debug, Default)]
pub struct MockGyro {
    next: Option<GyroReading<f32>>,
    script: Script,
    calls: u32,
}

impl MockGyro {
    /// Nothing measured yet, and never failing.
    pub const fn new() -> Self {
        Self {
            next: None,
            script: Script::NEVER,
            calls: 0,
        }
    }

    /// The next call gives this; what was not asked for meanwhile is lost.
    pub const fn measure(&mut self, reading: GyroReading<f32>) {
        self.next = Some(reading);
    }

    /// Fails as `script` says, counted from now.
    pub const fn fail(&mut self, script: Script) {
        self.script = script.after(self.calls);
    }
}

impl ErrorType for MockGyro {
    type Error = ErrorKind;
}

impl YawGyro for MockGyro {
    fn reading(&mut self) -> Result<Option<GyroReading<f32>>, ErrorKind> {
        let at = self.calls;
        self.calls = at.saturating_add(1);
        match self.script.failure(at) {
            Some(kind) => Err(kind),
            None => Ok(self.next.take()),
        }
    }
}

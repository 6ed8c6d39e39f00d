//! What the host does: commands, trajectories, goals.

use super::*;

impl Runner<'_, '_> {
    /// Sends the base to a goal.
    pub(super) fn park(&mut self, goal: Pose<f64>) {
        self.intent = Intent::Park(goal);
        self.host.follow_no_more();
        self.host.ask(park(&goal));
    }

    /// Arms a base that waits, and gives it a goal.
    pub(super) fn wake(&mut self) {
        if self.manner().silent {
            return;
        }
        if self.state() == State::Fault {
            self.host.ask_in_vain(Command::Arm);
            self.host.ask(Command::ResetFault);
        }
        if matches!(self.state(), State::Idle | State::Stopped | State::Fault) {
            self.host.ask(Command::Arm);
        }
        self.park(self.goal_ahead());
    }

    /// The stop of a plan.
    pub(super) fn stop_by_host(&mut self) {
        self.stop_at = None;
        if let Some((_, button)) = self.plan.stop {
            self.host.stop(if button { BUTTON } else { Command::Stop });
            self.intent = Intent::Quiet;
        }
    }

    pub(super) fn goal_ahead(&self) -> Pose<f64> {
        let ahead = 0.6 * self.limit_speed;
        let measured = self.board.report().measured;
        let at = measured.map_or(Pose::default(), |measured| measured.pose);
        let (x, y, theta) = (f64::from(at.x), f64::from(at.y), f64::from(at.theta));
        Pose::new(x + ahead * theta.cos(), y + ahead * theta.sin(), theta)
    }

    /// For how long a trajectory has been under way \[s\].
    pub(super) fn followed(&self) -> f64 {
        self.host
            .followed_since()
            .map_or(0.0, |since| self.t - 1.0e-6 * since as f64)
    }

    pub(super) fn park_ahead(&mut self) {
        let path = &self.plan.path;
        let way = path.way(self.followed());
        let speed = path.speed;
        let ahead = speed * speed / path.accel + 0.3 * self.limit_speed;
        self.park(path.pose(way + ahead));
    }

    /// Share of the poses that reach the base, and how much later than they say \[s\].
    pub(super) fn poses(&self) -> (f64, f64) {
        /// A pose's frame with its delimiters.
        const BYTES: i32 = 27;
        let mut manner = Manner::default();
        for injection in self.upsets() {
            injection.hinder(&mut manner);
        }
        // Behind a flood a pose finds the queue full, before it does not: either every other time.
        let share: f64 = if manner.flood > 0 { 0.5 } else { 1.0 };
        let share = share.min((1.0 - manner.line.damaged).powi(BYTES));
        (share, 1.0e-6 * manner.line.delay_us as f64)
    }

    /// What is wrong with host and line now.
    pub(super) fn manner(&self) -> Manner {
        let mut manner = Manner::default();
        for injection in self.active_upsets() {
            injection.hinder(&mut manner);
        }
        manner
    }

    /// Frames onto the line, and what has arrived into the base.
    pub(super) fn exchange(&mut self) {
        let (now_us, manner) = (self.board.world().now_us(), self.manner());
        self.host
            .speak(&manner, now_us, &self.plan.path, self.board.world());
        self.received = Received::default();
        while let Some(sent) = self.host.arrived(now_us) {
            if sent.intact {
                self.received.any = true;
            }
            for byte in &sent.bytes {
                if let Some(Ok(frame)) = self.reader.push(*byte) {
                    self.received.read(&frame.message);
                }
            }
            if sent.intact && stops(&sent.what) {
                let button = sent.what != Command::Stop || self.received.stop == Some(true);
                self.received.stop = Some(button);
            }
            if self.mutation == Mutation::LosesStops && stops(&sent.what) {
                continue;
            }
            for byte in sent.bytes {
                if let Some(answer) = self.board.receive(byte) {
                    self.host.answer(&manner, now_us, &answer);
                }
            }
        }
    }

    /// Answers of the tick, and what the host makes of them.
    pub(super) fn answers(&mut self) -> Checked<()> {
        let (now_us, manner) = (self.board.world().now_us(), self.manner());
        while let Some(answer) = self.board.pending() {
            self.host.answer(&manner, now_us, &answer);
        }
        while let Some(answered) = self.host.hear(now_us) {
            self.answered(&answered)?;
        }
        Ok(())
    }

    fn answered(&mut self, answered: &Answered) -> Checked<()> {
        let Answered {
            command,
            result,
            has_to_fail,
        } = answered;
        if *has_to_fail {
            self.refused = true;
            return match result {
                Ok(()) => Err(format!("{command:?} is taken")),
                Err(_) => Ok(()),
            };
        }
        let Err(reason) = result else {
            return Ok(());
        };
        let state = self.state();
        // A base that trouble stopped meanwhile refuses rightly, and so does one that a second frame reached.
        let waits = matches!(state, State::Idle | State::Stopped);
        match command {
            Command::Stop | Command::EmergencyStop { .. } => {
                Err(format!("{command:?} is refused: {reason}"))
            }
            Command::Arm if waits => Err(format!("Arm is refused in {state:?}: {reason}")),
            Command::ResetFault if state == State::Fault => {
                Err(format!("ResetFault is refused: {reason}"))
            }
            Command::Park { .. } if *reason != RejectReason::State => {
                Err(format!("a goal is refused: {reason}"))
            }
            _ => Ok(()),
        }
    }
}

impl Received {
    fn read(&mut self, command: &Command) {
        self.read = true;
        match command {
            Command::Arm | Command::ResetFault => {
                self.frees = true;
                self.reset |= *command == Command::ResetFault;
                self.stop = None;
            }
            Command::Park { .. } | Command::Sample(_) => self.frees = true,
            _ => {}
        }
    }
}

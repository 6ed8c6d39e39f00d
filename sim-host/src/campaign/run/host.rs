//! What the host of a run does: commands, trajectories, goals.

use super::Checked;
use super::mutation::Mutation;
use crate::campaign::check::Received;
use crate::campaign::expected::no_number;
use crate::campaign::fault_injection::{FaultInjection, What};
use crate::campaign::host::{Answered, Course, Host, Manner, park};
use crate::campaign::plan::Plan;
use crate::closed_loop::Board;
use crate::monitor::stops;
use controller_core::safety::supervisor::State;
use controller_core::types::Pose;
use protocol::{Command, Decoder, MAX_CONTENT, RejectReason};

/// The button.
pub(super) const BUTTON: Command = Command::EmergencyStop { brake: true };

/// What the host wants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Intent {
    Quiet,
    Follow,
    Park(Pose<f64>),
}

/// The host of a plan, and what of its frames reached the base.
pub(super) struct HostOfRun<'a> {
    plan: &'a Plan,
    limit_speed: f64,
    host: Host,
    /// Of the bytes that reach the base, beside its own.
    reader: Decoder<Command, MAX_CONTENT>,
    pub(super) intent: Intent,
    /// What reached the base for this tick.
    pub(super) received: Received,
    /// Time by which a stop is due \[s\].
    stop_at_s: Option<f64>,
    /// Something was refused that had to be.
    pub(super) refused: bool,
}

impl<'a> HostOfRun<'a> {
    pub(super) fn new(plan: &'a Plan, limit_speed: f64) -> Self {
        Self {
            plan,
            limit_speed,
            host: Host::new(plan.setup.seed),
            reader: Decoder::new(),
            intent: Intent::Quiet,
            received: Received::default(),
            stop_at_s: None,
            refused: false,
        }
    }

    pub(super) fn arm(&mut self) {
        self.host.ask(Command::Arm);
    }

    pub(super) fn stop(&mut self, command: Command) {
        self.host.stop(command);
    }

    /// Everything is answered.
    pub(super) fn is_content(&self) -> bool {
        self.host.is_content()
    }

    pub(super) const fn waits_to_stop(&self) -> bool {
        self.stop_at_s.is_some()
    }

    pub(super) fn follow(&mut self) {
        self.intent = Intent::Follow;
        self.host.follow();
    }

    /// Sends the base to a goal.
    pub(super) fn park(&mut self, goal: Pose<f64>) {
        self.intent = Intent::Park(goal);
        self.host.follow_no_more();
        self.host.ask(park(&goal));
    }

    /// The host's part of an injection that begins.
    pub(super) fn injure(&mut self, injection: &FaultInjection) {
        match injection.what {
            What::EmergencyStop => self.host.stop(BUTTON),
            What::OrderNan { park } => self
                .host
                .ask_in_vain(no_number(park, self.plan.orders.is_some())),
            _ => {}
        }
    }

    /// The trouble began at `t` \[s\]: the plan's stop comes so long after it.
    pub(super) fn plan_stop(&mut self, t: f64) {
        self.stop_at_s = self.plan.stop.map(|(after, _)| t + after);
    }

    /// The stop of the plan, if it is due; whether it was.
    pub(super) fn stops_when_due(&mut self, t: f64) -> bool {
        let due = self.stop_at_s.is_some_and(|at| t >= at);
        if due {
            self.stop_at_s = None;
            if let Some((_, button)) = self.plan.stop {
                self.host.stop(if button { BUTTON } else { Command::Stop });
                self.intent = Intent::Quiet;
            }
        }
        due
    }

    /// Arms a base that waits, and gives it a goal ahead of its pose.
    pub(super) fn wake(&mut self, board: &Board<'_>, manner: &Manner) {
        if manner.silent {
            return;
        }
        let state = board.report().state;
        if state == State::Fault {
            self.host.ask_in_vain(Command::Arm);
            self.host.ask(Command::ResetFault);
        }
        if matches!(state, State::Idle | State::Stopped | State::Fault) {
            self.host.ask(Command::Arm);
        }
        self.park_before(board);
    }

    /// Gives a goal ahead of the base's pose.
    fn park_before(&mut self, board: &Board<'_>) {
        let measured = board.report().measured;
        let at = measured.map_or(Pose::default(), |measured| measured.pose);
        let ahead = 0.6 * self.limit_speed;
        let (x, y, theta) = (f64::from(at.x), f64::from(at.y), f64::from(at.theta));
        self.park(Pose::new(
            x + ahead * theta.cos(),
            y + ahead * theta.sin(),
            theta,
        ));
    }

    /// The base is fast enough for a stop that does not end at once: as the slowest trajectory is. Velocity orders may be to stand.
    pub(super) fn has_it_drive(&self, board: &Board<'_>) -> bool {
        let speed = board.world().truth().twist.linear.abs();
        let any = self.plan.orders.is_none() || !self.plan.target.is_a_stop();
        any || speed > 0.3 * self.limit_speed
    }

    /// For how long a trajectory has been under way \[s\].
    pub(super) fn followed_s(&self, t: f64) -> f64 {
        let since = self.host.followed_since();
        since.map_or(0.0, |since| t - 1.0e-6 * since as f64)
    }

    /// Leaves the trajectory for a goal on it, or orders for one ahead.
    pub(super) fn park_ahead(&mut self, t: f64, board: &Board<'_>) {
        if self.plan.orders.is_some() {
            return self.park_before(board);
        }
        let path = &self.plan.path;
        let way = path.way(self.followed_s(t));
        let speed = path.speed;
        let ahead = speed * speed / path.accel + 0.3 * self.limit_speed;
        self.park(path.pose(way + ahead));
    }

    /// Frames onto the line, and what has arrived into the base.
    pub(super) fn exchange(&mut self, board: &mut Board<'_>, manner: &Manner, mutation: &Mutation) {
        let now_us = board.world().now_us();
        let course = match &self.plan.orders {
            Some(orders) => Course::Orders(orders),
            None => Course::Path(&self.plan.path),
        };
        self.host.speak(manner, now_us, course, board.world());
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
            if *mutation == Mutation::LosesStops && stops(&sent.what) {
                continue;
            }
            for byte in sent.bytes {
                if let Some(answer) = board.receive(byte) {
                    self.host.answer(manner, now_us, &answer);
                }
            }
        }
    }

    /// Answers of the tick, and what the host makes of them.
    pub(super) fn answers(&mut self, board: &mut Board<'_>, manner: &Manner) -> Checked<()> {
        let now_us = board.world().now_us();
        while let Some(answer) = board.pending() {
            self.host.answer(manner, now_us, &answer);
        }
        while let Some(answered) = self.host.hear(now_us) {
            self.refused |= answered.has_to_fail;
            judge(&answered, board.report().state)?;
        }
        Ok(())
    }
}

/// Whether an answer is right for a base in this state.
fn judge(answered: &Answered, state: State) -> Checked<()> {
    let Answered {
        command,
        result,
        has_to_fail,
    } = answered;
    let reason = match (result, has_to_fail) {
        (Ok(()), true) => return Err(format!("{command:?} is taken")),
        (Ok(()), false) | (Err(_), true) => return Ok(()),
        (Err(reason), false) => reason,
    };
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

impl Received {
    fn read(&mut self, command: &Command) {
        self.read = true;
        match command {
            Command::Arm | Command::ResetFault => {
                self.frees = true;
                self.reset |= *command == Command::ResetFault;
                self.stop = None;
            }
            Command::EmergencyStop { .. } => self.button = true,
            Command::Park { .. } | Command::Sample(_) | Command::Drive { .. } => self.frees = true,
            _ => {}
        }
    }
}

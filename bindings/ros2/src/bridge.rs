//! What is said to the base, and when: orders of ROS in, commands of the wire out. No I/O, and time is an argument.

use crate::course::Samples;
use crate::lifecycle::{Stage, Transition};
use controller_core::error::StepFault;
use controller_core::motion::check_order;
use controller_core::safety::supervisor::{Cause, State};
use controller_core::safety::{Fault, Timeout};
use protocol::{Command, FieldParams, Frame, Origin, RejectReason, Telemetry, WirePose, WireTwist};
use sim_host::monitor::{AHEAD_S, Questions};
use sim_host::trace::cause;
use std::collections::VecDeque;

/// Signs of life in the time in which a base takes a silent host for gone.
const BEATS: u64 = 5;
/// And at least so often \[µs\].
const LONGEST_BEAT_US: u64 = 100_000;
/// Longest time for a transition \[µs\]: a base that drives comes to rest in it.
const TRANSITION_US: u64 = 8_000_000;
/// Longest time that a goal waits for a base that is about to be ready \[µs\].
const WAIT_US: u64 = 5_000_000;
/// A velocity that is held is repeated so often \[µs\].
const REPEAT_US: u64 = sim_host::teleop::ORDER_PERIOD.as_micros() as u64;

/// A live base sends 50 ticks a second; after so long without \[µs\] nothing is known of its state.
pub const SILENCE_US: u64 = 500_000;
/// Velocities whose answers are waited for: more than come in the time that a line takes.
const UNDER_WAY: usize = 16;

/// How it is to be.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// What the base gets when it is configured; none leaves it as it is.
    pub field: Option<FieldParams>,
    /// The base's patience with a silent host.
    pub patience: Timeout,
    /// For how long a velocity is repeated \[µs\].
    pub hold_us: u64,
}

/// What a question was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Purpose {
    /// A transition: what comes of it decides over it.
    Transition,
    /// To be ready again.
    Ready,
    /// What somebody ordered.
    Order,
    /// Somebody's request to leave the fault.
    Reset,
}

/// What happened that others have to know.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A transition ended; without success the stage is that before.
    Transition {
        /// Which.
        transition: Transition,
        /// From.
        from: Stage,
        /// Whether it was done, or why not.
        result: Result<Stage, String>,
    },
    /// The base does not do it.
    Refused(String),
    /// The base does what was ordered; what was refused before is past.
    Taken,
    /// What came of a reset.
    Reset(Result<(), String>),
}

/// Where the base is to go, when it is ready.
#[derive(Clone, Debug)]
enum Target {
    Park(WirePose),
    Follow(Box<Samples>),
}

/// A transition under way.
#[derive(Clone, Copy, Debug)]
struct Under {
    transition: Transition,
    from: Stage,
    to: Stage,
    step: Step,
    until_us: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// Until the base says who it is.
    Hello,
    /// Until it has answered.
    Answer,
    /// Until it stands.
    Rest,
}

/// The bridge, but for ROS and the line.
#[derive(Debug)]
pub struct Bridge {
    settings: Settings,
    stage: Stage,
    under: Option<Under>,
    questions: Questions<Purpose>,
    said: VecDeque<Command>,
    events: VecDeque<Event>,
    /// As far as the base has said.
    state: Option<(State, Cause)>,
    /// When that was confirmed last, or asked for.
    known_us: u64,
    /// The base's ticks, as it has counted them last.
    tick: Option<u32>,
    /// The base has the parameters that it is to have. One that starts again has its own.
    has_field: bool,
    greeted: bool,
    /// Of the last sign of life.
    beat_us: Option<u64>,
    /// The last velocity, when it came, and when it was sent.
    velocity: Option<(WireTwist, u64, u64)>,
    /// The numbers of the last velocities without an answer.
    unanswered: VecDeque<u16>,
    target: Option<(Target, u64)>,
    /// Samples under way, and since when.
    stream: Option<(Box<Samples>, u64)>,
    /// A goal or the end of a path has been sent and is not reached.
    bound: bool,
    /// Arming was refused in this state, or a stop asked for: nothing more is.
    refused: bool,
}

impl Bridge {
    /// Unconfigured.
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            stage: Stage::Unconfigured,
            under: None,
            questions: Questions::default(),
            said: VecDeque::new(),
            events: VecDeque::new(),
            state: None,
            known_us: 0,
            tick: None,
            has_field: false,
            greeted: false,
            beat_us: None,
            velocity: None,
            unanswered: VecDeque::new(),
            target: None,
            stream: None,
            bound: false,
            refused: false,
        }
    }

    /// Where it is in its life.
    pub const fn stage(&self) -> Stage {
        self.stage
    }

    /// The supervisor's state, as far as it is known.
    pub const fn state(&self) -> Option<(State, Cause)> {
        self.state
    }

    /// Why the base does nothing before a reset, if it is in a fault.
    fn fault(&self) -> Option<String> {
        match &self.state {
            Some((State::Fault, why)) => Some(format!(
                "the base is in a fault ({}), which `reset_fault` leaves",
                cause(why)
            )),
            _ => None,
        }
    }

    /// Whether the base has to be reset.
    pub const fn is_in_fault(&self) -> bool {
        matches!(self.state, Some((State::Fault, _)))
    }

    /// What leads towards an active node, if the base is not in a fault.
    pub const fn onward(&self) -> Option<Transition> {
        match self.stage {
            _ if self.is_in_fault() => None,
            Stage::Unconfigured => Some(Transition::Configure),
            Stage::Inactive => Some(Transition::Activate),
            Stage::Active | Stage::Finalized => None,
        }
    }

    /// The next thing that happened.
    pub fn event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// Begins a transition; what comes of it is an event.
    pub fn change(&mut self, transition: Transition, now_us: u64) {
        let from = self.stage;
        let fails = |why: &str| Event::Transition {
            transition,
            from,
            result: Err(why.to_owned()),
        };
        let Some(to) = transition.from(from) else {
            self.events.push_back(fails("it does not lead from here"));
            return;
        };
        if let Some(under) = self.under {
            if transition != Transition::ShutDown {
                self.events.push_back(fails("another one is under way"));
                return;
            }
            self.end(&under, Err("shut down".to_owned()));
        }
        let step = match transition {
            Transition::Configure => Step::Hello,
            Transition::Activate => {
                self.arm(Purpose::Transition);
                Step::Answer
            }
            Transition::Deactivate => {
                self.stop();
                Step::Answer
            }
            Transition::ShutDown if from == Stage::Active => {
                self.stop();
                Step::Answer
            }
            Transition::ShutDown | Transition::CleanUp => {
                let under = Under {
                    transition,
                    from,
                    to,
                    step: Step::Rest,
                    until_us: now_us,
                };
                self.end(&under, Ok(()));
                return;
            }
        };
        self.under = Some(Under {
            transition,
            from,
            to,
            step,
            until_us: now_us + TRANSITION_US,
        });
    }

    /// Arms the base, with its parameters first where it may have others.
    fn arm(&mut self, purpose: Purpose) {
        if let Some(field) = self.settings.field
            && (!self.has_field || self.state.is_none())
        {
            self.questions.ask(Command::SetParameters(field), purpose);
        }
        self.questions.ask(Command::Arm, purpose);
    }

    /// Says something that needs no answer, by the numbers of the questions: answers cannot be mistaken.
    pub fn say(&mut self, command: Command) {
        self.said.push_back(command);
    }

    /// Leaves a latched fault. The base stays without torque until it is armed, which an active bridge does.
    pub fn reset(&mut self) {
        self.questions.ask(Command::ResetFault, Purpose::Reset);
    }

    /// Drives by velocity, in place of what the base does now. Whether it is to: one that is none changes nothing.
    pub fn drive(&mut self, twist: WireTwist, now_us: u64) -> bool {
        if self.stage != Stage::Active || self.under.is_some() {
            return false;
        }
        // The base would refuse it too, but a velocity is said, not asked.
        if let Err(why) = check_order::<f32>(&(&twist).into()) {
            self.refuse(match why {
                StepFault::OutOfRange(_) => "a velocity beyond 100 m/s or 100 rad/s",
                _ => "a velocity that is not a number",
            });
            return false;
        }
        self.supersede();
        self.velocity = Some((twist, now_us, now_us));
        self.order(twist);
        true
    }

    /// Parks.
    pub fn park(&mut self, goal: WirePose, now_us: u64) {
        self.aim(Target::Park(goal), now_us);
    }

    /// Follows a path and parks at its end.
    pub fn follow(&mut self, samples: Samples, now_us: u64) {
        self.aim(Target::Follow(Box::new(samples)), now_us);
    }

    /// Something that somebody sent and that is not driven.
    pub fn refuse(&mut self, why: impl Into<String>) {
        self.events.push_back(Event::Refused(why.into()));
    }

    fn aim(&mut self, target: Target, now_us: u64) {
        if self.stage != Stage::Active || self.under.is_some() {
            self.refuse("a goal for a node that is not active");
            return;
        }
        self.supersede();
        // References are taken by a base that stands only.
        let drives = matches!(self.state, Some((State::Tracking | State::Parking, _)));
        if drives && matches!(target, Target::Follow(_)) {
            self.questions.ask(Command::Stop, Purpose::Order);
        }
        self.target = Some((target, now_us + WAIT_US));
    }

    /// What was ordered before does not count any more.
    fn supersede(&mut self) {
        self.velocity = None;
        self.target = None;
        self.bound = false;
        if self.stream.take().is_some() {
            self.questions.clear();
        }
    }

    fn stop(&mut self) {
        self.supersede();
        self.questions.clear();
        self.questions.ask(Command::Stop, Purpose::Transition);
    }

    fn order(&mut self, twist: WireTwist) {
        self.say(Command::Drive {
            twist,
            hold_heading: false,
        });
    }

    /// A frame of the base, which came now.
    pub fn hear(&mut self, frame: &Frame<Telemetry>, now_us: u64) {
        match &frame.message {
            Telemetry::Hello(_) => self.greeted = true,
            Telemetry::State { tick, state, cause } => {
                self.counted(*tick, now_us);
                self.turned(*state, *cause);
            }
            Telemetry::Tick(tick) => {
                self.counted(tick.tick, now_us);
                // A change whose own message was lost.
                if self.state.is_none_or(|(state, _)| state != tick.state) {
                    self.turned(tick.state, Cause::Host);
                }
            }
            // Said at power-on, or by a base that is disarmed.
            Telemetry::Origin(origin) if *origin != Origin::Host => {
                self.has_field = false;
                self.tick = None;
                self.turned(State::Idle, Cause::PowerOn);
            }
            Telemetry::Ack | Telemetry::Nack(_) => {
                if let Some((command, purpose, result)) = self.questions.answered(frame) {
                    self.answered(&command, purpose, result, now_us);
                } else if let Some(at) = self.unanswered.iter().position(|n| *n == frame.sequence) {
                    // Those before it were answered too, or their answers are lost.
                    self.unanswered.drain(..=at);
                    self.driven(&frame.message, now_us);
                }
            }
            _ => {}
        }
    }

    /// Ticks that count back are of a base that has started again, whose own word of it was lost.
    fn counted(&mut self, tick: u32, now_us: u64) {
        self.known_us = now_us;
        let before = self.tick.replace(tick);
        if before.is_some_and(|before| tick.wrapping_sub(before).cast_signed() < 0) {
            self.has_field = false;
        }
    }

    /// What became of a velocity.
    fn driven(&mut self, answer: &Telemetry, now_us: u64) {
        if self.stage != Stage::Active || self.under.is_some() {
            return;
        }
        match answer {
            Telemetry::Nack(why) => {
                self.refuse(format!("the velocity is refused: {why}"));
                if *why == RejectReason::State {
                    self.doubt(now_us);
                }
            }
            _ => self.events.push_back(Event::Taken),
        }
    }

    /// What the base was taken for it is not, if that was one that takes orders.
    fn doubt(&mut self, now_us: u64) {
        let takes = |(state, _): (State, Cause)| {
            matches!(state, State::Armed | State::Parked) || state.drives()
        };
        if self.state.is_some_and(takes) {
            self.forget_state(now_us);
        }
    }

    /// Nothing is known of the state: arming, which moves nothing, shows it.
    fn forget_state(&mut self, now_us: u64) {
        self.state = None;
        self.known_us = now_us;
        self.refused = false;
    }

    fn turned(&mut self, state: State, cause: Cause) {
        // It says so again where it refuses something for its state: that is no reason to ask it again.
        if self.state.replace((state, cause)) != Some((state, cause)) {
            self.refused = false;
        }
        if state == State::Parked {
            self.bound = false;
        }
        let goes_on = matches!(state, State::Armed | State::Parked) || state.drives();
        if !goes_on && self.bound {
            self.bound = false;
            if self.stream.take().is_some() {
                // Nobody waits for its samples any more.
                self.questions.clear();
            }
            self.refuse(format!("the goal is given up: {cause:?}"));
        }
    }

    fn answered(
        &mut self,
        command: &Command,
        purpose: Purpose,
        result: Result<(), RejectReason>,
        now_us: u64,
    ) {
        let sets = matches!(command, Command::SetParameters(_));
        if sets && result.is_ok() {
            self.has_field = true;
        }
        if *command == Command::Arm && result.is_ok() {
            self.state = Some((State::Armed, Cause::Host));
            self.known_us = now_us;
        }
        match purpose {
            Purpose::Reset => {
                let result = result.map_err(|why| why.to_string());
                self.refused = false;
                if result.is_ok() {
                    self.state = Some((State::Idle, Cause::Host));
                }
                self.events.push_back(Event::Reset(result));
            }
            Purpose::Ready => match (command, result) {
                (_, Ok(())) => {}
                // It is armed, or in a fault: arming shows which.
                (Command::SetParameters(_), Err(RejectReason::State)) => {}
                (command, Err(why)) => {
                    self.refused = true;
                    if sets {
                        // Not armed with others than it is to have.
                        self.questions.clear();
                        self.refuse(format!("{}: {why}", name(command)));
                    }
                }
            },
            Purpose::Order => match result {
                Ok(()) => self.events.push_back(Event::Taken),
                Err(why) => {
                    self.supersede();
                    self.refuse(format!("{}: {why}", name(command)));
                    if why == RejectReason::State {
                        self.doubt(now_us);
                    }
                }
            },
            Purpose::Transition => self.advance(command, result),
        }
    }

    fn advance(&mut self, command: &Command, result: Result<(), RejectReason>) {
        let fault = self.fault();
        let Some(under) = &mut self.under else {
            return;
        };
        let configures = under.transition == Transition::Configure;
        match (command, result) {
            (Command::Stop, _) => under.step = Step::Rest,
            // Arming is still to be answered.
            (Command::SetParameters(_), Ok(())) if !configures => {}
            // It comes to rest still.
            (Command::SetParameters(_), Err(RejectReason::State)) if fault.is_none() => {
                if configures {
                    under.step = Step::Rest;
                }
            }
            (_, result) => {
                let under = *under;
                let why = |why| match (why, command) {
                    (RejectReason::State, _) if fault.is_some() => fault.unwrap_or_default(),
                    (RejectReason::State, Command::Arm) => {
                        "the base does not arm: it still moves".to_owned()
                    }
                    (why, command) => format!("{}: {why}", name(command)),
                };
                self.end(&under, result.map_err(why));
            }
        }
    }

    fn end(&mut self, under: &Under, result: Result<(), String>) {
        self.under = None;
        self.questions.clear();
        self.said.clear();
        self.supersede();
        if result.is_ok() {
            self.stage = under.to;
        }
        if self.stage == Stage::Unconfigured {
            self.greeted = false;
            self.has_field = false;
        }
        self.events.push_back(Event::Transition {
            transition: under.transition,
            from: under.from,
            result: result.map(|()| under.to),
        });
    }

    /// What time brings.
    pub fn step(&mut self, now_us: u64) {
        if let Some(under) = self.under {
            self.go_on(under, now_us);
        }
        if self.stage == Stage::Active && self.under.is_none() {
            let speaks = self.state.is_none_or(|(state, _)| state.is_live());
            if speaks && now_us >= self.known_us + SILENCE_US {
                self.forget_state(now_us);
            }
            self.be_ready();
            self.set_out(now_us);
            self.stream(now_us);
            self.repeat(now_us);
        }
        let beats = match self.settings.patience {
            Timeout::AfterUs(us) => (u64::from(us) / BEATS).min(LONGEST_BEAT_US),
            Timeout::Off => LONGEST_BEAT_US,
        };
        let is_due = self.beat_us.is_none_or(|beat| now_us >= beat + beats);
        let speaks = self.under.is_some() || self.stage == Stage::Active;
        if speaks && is_due {
            self.say(Command::Heartbeat);
        }
    }

    fn go_on(&mut self, under: Under, now_us: u64) {
        if now_us >= under.until_us {
            let why = match under.step {
                Step::Hello => "the base does not answer",
                Step::Answer => "the base answered, and then no more",
                Step::Rest => "the base does not come to rest, or it is in a fault",
            };
            self.end(&under, Err(why.to_owned()));
            return;
        }
        match under.step {
            Step::Hello if self.greeted => {
                self.stop();
                self.set_step(Step::Answer);
            }
            Step::Rest if under.transition == Transition::Configure => {
                if !self.questions.is_empty() {
                    return;
                }
                match self.settings.field {
                    Some(field) => {
                        let command = Command::SetParameters(field);
                        self.questions.ask(command, Purpose::Transition);
                        self.set_step(Step::Answer);
                    }
                    None => self.end(&under, Ok(())),
                }
            }
            Step::Rest => {
                let rests = self.state.is_none_or(|(state, _)| !state.is_live());
                if rests {
                    self.end(&under, Ok(()));
                }
            }
            _ => {}
        }
    }

    fn set_step(&mut self, step: Step) {
        if let Some(under) = &mut self.under {
            under.step = step;
        }
    }

    /// Arms the base again where that moves nothing and hides nothing: after a stop for want of orders or of this host, or
    /// one that was ordered here. A stop by any other fault stays until somebody activates the node anew.
    fn be_ready(&mut self) {
        let lacks_field = self.settings.field.is_some() && !self.has_field;
        let again = match self.state {
            None | Some((State::Idle, _)) => true,
            Some((state, _)) if state.is_live() && lacks_field => {
                // It was armed before it was known that it had started again.
                let stops = matches!(state, State::Stopping(_) | State::Braking(_));
                if self.questions.is_empty() && !stops && !self.refused {
                    self.supersede();
                    self.refused = true;
                    self.questions.ask(Command::Stop, Purpose::Ready);
                }
                false
            }
            Some((State::Stopped, cause)) => matches!(
                cause,
                Cause::LinkLost
                    | Cause::Host
                    | Cause::GoalUnreachable
                    | Cause::Fault(Fault::CommandStale)
            ),
            _ => false,
        };
        if again && !self.refused && self.questions.is_empty() {
            self.arm(Purpose::Ready);
        }
    }

    /// Sends the base on its way as soon as it is ready.
    fn set_out(&mut self, now_us: u64) {
        let Some((target, until_us)) = &self.target else {
            return;
        };
        if now_us >= *until_us {
            self.target = None;
            self.refuse("the base was not ready for a goal");
            return;
        }
        let Some((state, _)) = self.state else { return };
        let stands = matches!(state, State::Armed | State::Parked);
        let is_ready = self.questions.is_empty()
            && match target {
                Target::Park(_) => stands || state.drives(),
                Target::Follow(_) => stands,
            };
        if !is_ready {
            return;
        }
        self.bound = true;
        match self.target.take() {
            Some((Target::Park(goal), _)) => {
                self.questions.ask(Command::Park { goal }, Purpose::Order);
            }
            Some((Target::Follow(samples), _)) => self.stream = Some((samples, now_us)),
            None => {}
        }
    }

    fn stream(&mut self, now_us: u64) {
        let Some((samples, since_us)) = &mut self.stream else {
            return;
        };
        let until_s = 1.0e-6 * now_us.saturating_sub(*since_us) as f64 + AHEAD_S;
        while let Some(sample) = samples.until(until_s) {
            self.questions.ask(Command::Sample(sample), Purpose::Order);
        }
        if samples.is_over() && self.questions.is_empty() {
            self.stream = None;
        }
    }

    fn repeat(&mut self, now_us: u64) {
        let Some((twist, came_us, sent_us)) = self.velocity else {
            return;
        };
        if now_us > came_us + self.settings.hold_us {
            self.velocity = None;
        } else if now_us >= sent_us + REPEAT_US {
            self.velocity = Some((twist, came_us, now_us));
            self.order(twist);
        }
    }

    /// The next command to be sent now, with its number. Every one is a sign of life.
    pub fn due(&mut self, now_us: u64) -> Option<(u16, Command)> {
        let due = match self.questions.due(now_us) {
            Some(due) => {
                self.questions.sent(now_us);
                due
            }
            None => (self.questions.number(), self.said.pop_front()?),
        };
        if matches!(due.1, Command::Drive { .. }) {
            if self.unanswered.len() == UNDER_WAY {
                self.unanswered.pop_front();
            }
            self.unanswered.push_back(due.0);
        }
        self.beat_us = Some(now_us);
        Some(due)
    }
}

fn name(command: &Command) -> &'static str {
    match command {
        Command::Park { .. } => "the goal is refused",
        Command::Sample(_) => "the path is refused",
        Command::SetParameters(_) => "the parameters of the base file are refused",
        Command::Arm => "arming is refused",
        _ => "a command is refused",
    }
}

#[cfg(test)]
mod tests;

//! The loop: the line on one side, ROS on the other, the bridge in between.

use crate::args::Args;
use crate::bridge::{Bridge, Event, SILENCE_US, Settings};
use crate::clock::TickClock;
use crate::course::{Refused, Samples, goal};
use crate::lifecycle::{
    Changed, CurrentState, Stage, States, Transition, TransitionEvent, Transitions, Triggered,
};
use crate::node::{Ros, newest, publish};
use crate::wheels::Wheels;
use controller_core::error::ParamError;
use controller_core::safety::supervisor::State;
use controller_core::wheels::WheelMap;
use protocol::{BaseTick, Command, FieldParams, Hello, Telemetry, WireTwist};
use ros2_client::RmwRequestId;
use sim_host::advice::of_base;
use sim_host::closed_loop;
use sim_host::constants::period_us;
use sim_host::datalog::Sample;
use sim_host::datalog::messages::{diagnosis, header, joints, odometry, transform, value};
use sim_host::job::{JobError, RobotFile};
use sim_host::mission::BaseSpec;
use sim_host::monitor::{LatestTelemetry, Monitor, MonitorError, Port, Received};
use sim_host::plain_text::written_out;
use sim_host::ros::messages::{DiagnosticArray, DiagnosticStatus, TfMessage, Time};
use std::error::Error;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Longest wait for the base before ROS is looked at: what an order may be late.
const PATIENCE: Duration = Duration::from_millis(4);
/// Between two diagnostics, and two questions for the base's counters \[µs\].
const DIAGNOSTICS_US: u64 = 1_000_000;
/// A board's, until it has said its own.
const PERIOD_US: u32 = Hello::OURS.period_us;

/// Why there is no bridge.
#[derive(Debug, thiserror::Error)]
pub enum BridgeError {
    /// The base's file.
    #[error(transparent)]
    Base(#[from] JobError),
    /// What the base's file comes to.
    #[error("the base's file: {0}")]
    Params(#[from] ParamError),
    /// The line.
    #[error(transparent)]
    Line(#[from] MonitorError),
    /// The line has ended.
    #[error("the base is gone: the line has ended")]
    Gone,
    /// It does not get ready.
    #[error("{0}")]
    NotReady(String),
    /// ROS.
    #[error("ROS: {0}")]
    Ros(Box<dyn Error>),
}

/// Runs until `stop` is set; then the base is stopped.
///
/// # Errors
/// [`BridgeError`].
pub fn run(args: &Args, stop: &AtomicBool) -> Result<(), BridgeError> {
    let base = RobotFile::load(&args.base)?.base;
    for advice in of_base(&base) {
        eprintln!("{}", written_out(&advice.to_string()));
    }
    let params = closed_loop::params(&base, period_us(&base))?;
    let field = FieldParams::from(&params);
    let settings = Settings {
        field: (!args.keep_parameters).then_some(field),
        patience: field.timeouts.command,
        hold_us: (1.0e6 * args.hold).round() as u64,
    };
    let wheels = Wheels::new(WheelMap::from_geometry(&base.robot.wheels)?);
    let port = Port::open(&args.port, args.baud)?;
    let ros = Ros::new(args).map_err(BridgeError::Ros)?;
    let loops = Loop {
        args,
        base,
        port,
        ros,
        monitor: Monitor::default(),
        bridge: Bridge::new(settings),
        began: Instant::now(),
        clock: TickClock::new(PERIOD_US),
        wheels,
        published: Published::default(),
        fitted: None,
        active_us: 0,
        asked: None,
        resets: Vec::new(),
        waits: false,
    };
    loops.run(stop)
}

/// What was published last, and what was not.
#[derive(Debug, Default)]
struct Published {
    /// Period of the base's clock in which odometry was.
    period: Option<i64>,
    /// Of the last report on the base's clock \[ns\], and when it came \[µs\].
    report: Option<(i64, u64)>,
    diagnosis: Option<(DiagnosticStatus, u64)>,
    lost: u64,
    /// The last thing that was not done.
    problem: String,
}

struct Loop<'a> {
    args: &'a Args,
    base: BaseSpec,
    port: Port,
    ros: Ros,
    monitor: Monitor,
    bridge: Bridge,
    began: Instant,
    clock: TickClock,
    wheels: Wheels,
    published: Published,
    /// A path that is being made samples of.
    fitted: Option<Receiver<Result<Samples, Refused>>>,
    /// Since when the node is active \[µs\].
    active_us: u64,
    /// Who asked for the transition under way.
    asked: Option<RmwRequestId>,
    /// Who asked for resets.
    resets: Vec<RmwRequestId>,
    /// Until the base is reset, to go on by itself.
    waits: bool,
}

impl Loop<'_> {
    fn now_us(&self) -> u64 {
        u64::try_from(self.began.elapsed().as_micros()).unwrap_or(u64::MAX)
    }

    fn run(mut self, stop: &AtomicBool) -> Result<(), BridgeError> {
        if !self.args.managed {
            self.bridge.change(Transition::Configure, self.now_us());
        }
        let mut ending = false;
        let mut counters_us = 0;
        loop {
            self.listen()?;
            self.orders();
            self.requests();
            let now_us = self.now_us();
            if stop.load(Ordering::Relaxed) && !ending {
                ending = true;
                self.bridge.change(Transition::ShutDown, now_us);
            }
            if self.waits
                && !ending
                && let Some(transition) = self.bridge.onward()
            {
                self.waits = false;
                self.bridge.change(transition, now_us);
            }
            if now_us >= counters_us && self.bridge.stage() == Stage::Active {
                self.bridge.say(Command::GetCounters);
                counters_us = now_us + DIAGNOSTICS_US;
            }
            self.bridge.step(now_us);
            while let Some((sequence, command)) = self.bridge.due(now_us) {
                self.port.send(sequence, &command)?;
            }
            while let Some(event) = self.bridge.event() {
                self.tell(event, ending)?;
            }
            self.diagnose(now_us);
            if self.bridge.stage() == Stage::Finalized {
                return Ok(());
            }
        }
    }

    /// What the base says.
    fn listen(&mut self) -> Result<(), BridgeError> {
        let mut buffer = [0; 4096];
        let count = match self.port.receive(&mut buffer, PATIENCE)? {
            Received::Silence => return Ok(()),
            Received::End => return Err(BridgeError::Gone),
            Received::Bytes(count) => count,
        };
        let bytes = buffer.get(..count).unwrap_or_default();
        let (now_us, bridge) = (self.now_us(), &mut self.bridge);
        let mut ticks = Vec::new();
        let mut hello = None;
        self.monitor.take_frames(bytes, |frame, latest| {
            bridge.hear(frame, now_us);
            match &frame.message {
                Telemetry::Tick(tick) => ticks.push((*tick, *latest)),
                Telemetry::Hello(said) => hello = Some(said.period_us),
                _ => {}
            }
        });
        for (tick, latest) in ticks {
            self.report(&tick, &latest, now_us);
        }
        if let Some(period_us) = hello
            && self.published.report.is_none()
        {
            self.clock = TickClock::new(period_us);
        }
        Ok(())
    }

    /// A tick, in messages.
    fn report(&mut self, tick: &BaseTick, latest: &LatestTelemetry, now_us: u64) {
        let (stamp_ns, base_ns) = self.clock.stamp(tick.tick, unix_ns() as i64);
        let before = self.published.report.replace((base_ns, now_us));
        let since_ns = before.map_or(0, |(before, _)| (base_ns - before).max(0));
        let mut sample = Sample::of_board(1.0e-9 * base_ns as f64, tick, latest);
        let Some(measured) = sample.measured else {
            return;
        };
        sample.wheels = Some(
            self.wheels
                .advance(1.0e-9 * since_ns as f64, &measured.twist),
        );
        // Counted on the base's clock, so that the line's delays lose none.
        let period = base_ns / (1_000_000_000 / i64::from(self.args.rate));
        if self.published.period == Some(period) || self.bridge.stage() != Stage::Active {
            return;
        }
        self.published.period = Some(period);
        let stamp = Time::of_ns(u64::try_from(stamp_ns).unwrap_or(0));
        let (odom, base) = (&self.args.odom_frame, &self.args.base_frame);
        let lost = &mut self.published.lost;
        let message = odometry(header(stamp, odom), base, &measured);
        publish(&self.ros.odom, message, lost);
        let transforms = vec![transform(header(stamp, odom), base, &measured.pose)];
        publish(&self.ros.tf, TfMessage { transforms }, lost);
        let message = joints(header(stamp, ""), &sample);
        publish(&self.ros.joint_states, message, lost);
    }

    /// What is ordered.
    fn orders(&mut self) {
        let now_us = self.now_us();
        if let Some(path) = newest(&self.ros.trajectory) {
            let (frame, base) = (self.args.odom_frame.clone(), self.base.clone());
            let (sender, receiver) = channel();
            // It takes longer than a base waits for a sign of life.
            thread::spawn(move || {
                // Nobody waits for a path that was superseded.
                let _ = sender.send(Samples::of(&path, &frame, &base));
            });
            self.fitted = Some(receiver);
        }
        match self.fitted.as_ref().map(Receiver::try_recv) {
            None | Some(Err(TryRecvError::Empty)) => {}
            Some(fitted) => {
                self.fitted = None;
                match fitted {
                    Ok(Ok(samples)) => self.bridge.follow(samples, now_us),
                    Ok(Err(why)) => self.bridge.refuse(format!("path: {why}")),
                    Err(_) => self.bridge.refuse("path: it cannot be fitted"),
                }
            }
        }
        if let Some(message) = newest(&self.ros.goal_pose) {
            match goal(&message, &self.args.odom_frame) {
                Ok(goal) => {
                    self.fitted = None;
                    self.bridge.park(goal, now_us);
                }
                Err(why) => self.bridge.refuse(format!("goal: {why}")),
            }
        }
        // What comes at the same time as a goal prevails: a stick in somebody's hand.
        if let Some(twist) = self.ros.cmd_vel.newest() {
            let twist = WireTwist {
                v: twist.linear.x as f32,
                w: twist.angular.z as f32,
            };
            if self.bridge.drive(twist, now_us) {
                self.fitted = None;
            }
        }
    }

    /// What is asked.
    fn requests(&mut self) {
        let stage = self.bridge.stage();
        let ros = &self.ros;
        answer(&ros.get_state, || CurrentState {
            state: stage.message(),
        });
        answer(&ros.get_available_states, || States {
            states: Stage::ALL.map(Stage::message).into(),
        });
        answer(&ros.get_available_transitions, || Transitions {
            transitions: Transition::all(Some(stage)),
        });
        answer(&ros.get_transition_graph, || Transitions {
            transitions: Transition::all(None),
        });
        while let Ok(Some((id, request))) = ros.change_state.receive_request() {
            let transition = Transition::of(&request.transition);
            match transition.filter(|_| self.asked.is_none()) {
                Some(transition) => {
                    self.asked = Some(id);
                    self.bridge.change(transition, self.now_us());
                }
                None => send(&ros.change_state, id, Changed { success: false }),
            }
        }
        while let Ok(Some((id, _))) = ros.reset_fault.receive_request() {
            self.resets.push(id);
            self.bridge.reset();
        }
    }

    /// What happened, to those who want to know.
    fn tell(&mut self, event: Event, ending: bool) -> Result<(), BridgeError> {
        match event {
            Event::Transition {
                transition,
                from,
                result,
            } => {
                if let Some(id) = self.asked.take() {
                    let success = result.is_ok();
                    send(&self.ros.change_state, id, Changed { success });
                }
                match result {
                    Ok(to) => {
                        let event = TransitionEvent {
                            timestamp: unix_ns(),
                            description: transition.event(from, to),
                        };
                        publish(&self.ros.transition_event, event, &mut self.published.lost);
                        eprintln!("{}", to.label());
                        if to == Stage::Active {
                            self.published.problem.clear();
                            self.active_us = self.now_us();
                        }
                        if to == Stage::Inactive
                            && transition == Transition::Configure
                            && !self.args.managed
                        {
                            self.bridge.change(Transition::Activate, self.now_us());
                        }
                    }
                    Err(why) if !self.args.managed && !ending && self.bridge.is_in_fault() => {
                        self.waits = true;
                        self.problem(why);
                    }
                    // Nobody manages it who could try again.
                    Err(why) if !self.args.managed && !ending => {
                        return Err(BridgeError::NotReady(why));
                    }
                    Err(why) if ending && transition == Transition::ShutDown => {
                        return Err(BridgeError::NotReady(why));
                    }
                    Err(why) => self.problem(why),
                }
            }
            Event::Refused(why) => self.problem(why),
            Event::Taken => self.published.problem.clear(),
            Event::Reset(result) => {
                for id in std::mem::take(&mut self.resets) {
                    let answer = Triggered {
                        success: result.is_ok(),
                        message: result.clone().err().unwrap_or_default(),
                    };
                    send(&self.ros.reset_fault, id, answer);
                }
            }
        }
        Ok(())
    }

    fn problem(&mut self, why: String) {
        // A velocity may be refused for one reason twenty times a second.
        if self.published.problem != why {
            eprintln!("{why}");
        }
        self.published.problem = why;
    }

    /// When something changed, and once a second.
    fn diagnose(&mut self, now_us: u64) {
        let status = self.diagnosis(now_us);
        let said = self.published.diagnosis.as_ref();
        let changed = |(before, at): &(DiagnosticStatus, u64)| {
            (before.level, &before.message) != (status.level, &status.message)
                || now_us >= at + DIAGNOSTICS_US
        };
        if !said.is_none_or(changed) {
            return;
        }
        let message = DiagnosticArray {
            header: header(Time::of_ns(unix_ns()), ""),
            status: vec![status.clone()],
        };
        publish(&self.ros.diagnostics, message, &mut self.published.lost);
        self.published.diagnosis = Some((status, now_us));
    }

    fn diagnosis(&self, now_us: u64) -> DiagnosticStatus {
        let latest = self.monitor.latest();
        let state = self.bridge.state().map(|(state, _)| state);
        let tick = BaseTick {
            // A base that is not armed sends no ticks.
            state: state.unwrap_or_default(),
            ..latest.report.unwrap_or_default()
        };
        let sample = Sample::of_board(0.0, &tick, latest);
        let mut status = diagnosis(&self.base.name, &sample.status);
        status.name = format!("{}: base", self.args.name);
        let live = state.is_none_or(State::is_live);
        let heard_us = self.published.report.map_or(0, |(_, at)| at);
        let silent = now_us > heard_us.max(self.active_us) + SILENCE_US;
        match self.bridge.stage() {
            Stage::Active if live && silent => {
                status.level = 3;
                status.message = "no reports of the base".to_owned();
            }
            Stage::Active => {}
            stage => {
                let said = match state {
                    Some(_) => &status.message,
                    None => "what the base does is not known",
                };
                status.message = format!("{}: {said}", stage.label());
            }
        }
        let frames = self.monitor.frames();
        let counters = latest.counters.unwrap_or_default();
        status.values.extend([
            value("stage", self.bridge.stage().label()),
            value("problem", self.published.problem.clone()),
            value("reports", self.monitor.reports().to_string()),
            value("frames_rejected_here", frames.rejected().to_string()),
            value(
                "frames_rejected_there",
                counters.frames_rejected.to_string(),
            ),
            value("reports_dropped", counters.reports_dropped.to_string()),
            value("late_ticks", counters.overruns.to_string()),
            value("messages_lost", self.published.lost.to_string()),
        ]);
        status
    }
}

/// The clock of this machine, since 1970 \[ns\]; 63 bits last until 2262.
fn unix_ns() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| since.as_nanos() as u64)
}

/// Answers what was asked of a service that needs no base.
fn answer<Req, Resp>(server: &ros2_client::Server<Req, Resp>, make: impl Fn() -> Resp)
where
    Req: ros2_client::Message + Clone + 'static,
    Resp: ros2_client::Message + Clone + 'static,
{
    while let Ok(Some((id, _))) = server.receive_request() {
        send(server, id, make());
    }
}

fn send<Req, Resp>(server: &ros2_client::Server<Req, Resp>, id: RmwRequestId, response: Resp)
where
    Req: ros2_client::Message + Clone + 'static,
    Resp: ros2_client::Message + Clone + 'static,
{
    if let Err(error) = server.send_response(id, response) {
        eprintln!("an answer that cannot be sent: {error}");
    }
}

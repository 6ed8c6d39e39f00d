//! Robots in a world, tick by tick, and all that was done to them: a run is its inputs, and the same inputs give the same bits.

use crate::drawn;
use crate::input::{self, FAULTS, Floor, Input, Setting, pose};
use controller_core::queue::ReferenceQueue;
use controller_core::safety::supervisor::State;
use controller_core::types::{Pose, Twist};
use protocol::Command;
use sim_host::drive::FileRun;
use sim_host::mission::{BaseSpec, Course, VelocityOrder};
use sim_host::run::{Live, LiveLaw};
use sim_host::scenario::BASES;
use sim_host::trials::{self, Condition};
use sim_host::world::{PatchParams, WorldKeys, WorldSetup};

/// Version of the bytes that [`Session::share`] gives.
const SHARED: u8 = 1;
/// Noise of a motion capture of a room \[m, rad\]: a few tenths of a millimetre over markers some 0.5 m apart.
const CAPTURE: (f64, f64) = (2.0e-4, 4.0e-4);
/// Longest run that a link plays again \[ticks\]: ten hours at 10 ms.
const MAX_TICKS: u32 = 3_600_000;
/// So many of the newest rows wait for somebody to take them, at most twice as many.
const MAX_ROWS: usize = 60_000;
/// A drawn line is driven at this share of the base's speed.
const DRAWN_SPEED: f64 = 0.6;

/// The laws in the order of their columns in a row.
pub const LAWS: [LiveLaw; 3] = [LiveLaw::Default, LiveLaw::Neural, LiveLaw::Plain];
/// Numbers of one robot in a row: true pose, believed pose, true twist, commanded twist, torques asked for right and left, and
/// two that are bits: state, active faults.
pub const PER_ROBOT: usize = 14;
/// Numbers in a row: time \[s\], then those of each law; not a number where it does not drive.
pub const PER_ROW: usize = 1 + LAWS.len() * PER_ROBOT;

struct Robot {
    law: LiveLaw,
    live: Live<'static>,
}

/// The world of the page.
pub struct Session {
    setting: Setting,
    base: BaseSpec,
    /// The default law's first; it is always there.
    robots: Vec<Robot>,
    /// Inputs so far, each with the tick before which it came.
    log: Vec<(u32, Input)>,
    ticks: u32,
    hash: u64,
    rows: Vec<f32>,
    /// What was ordered last, for laws that join.
    course: Option<Course>,
    patches: Vec<PatchParams>,
    faults: u32,
    host: bool,
    /// Name and text of the robot's file, if it is none of the list.
    own: Option<(String, String)>,
}

/// The base of a [`Setting`] that keeps the robot of a file.
pub const OWN: u8 = u8::MAX;

/// FNV-1a.
const HASH_START: u64 = 0xcbf2_9ce4_8422_2325;
const HASH_FACTOR: u64 = 0x0000_0100_0000_01b3;

impl Session {
    /// A base of the list at the origin.
    ///
    /// # Errors
    /// What is wrong with it, for people.
    pub fn new(setting: Setting) -> Result<Self, String> {
        let built_in = BASES.get(usize::from(setting.base));
        let built_in = built_in.ok_or("there is no such base")?;
        let base = match setting.gyro {
            true => built_in.with_gyro(),
            false => built_in.base(),
        };
        let base = base.map_err(|error| error.to_string())?;
        Self::with(setting, base, Pose::default(), Input::Begin(setting))
    }

    /// A robot by its file.
    fn of_file(setting: Setting, name: &str, text: &str) -> Result<Self, String> {
        let base = BaseSpec::parse(name, text).map_err(|error| error.to_string())?;
        let (name, text) = (name.to_owned(), text.to_owned());
        let setting = Setting {
            base: OWN,
            ..setting
        };
        let input = Input::Robot {
            setting,
            name: name.clone(),
            text: text.clone(),
        };
        Ok(Self {
            own: Some((name, text)),
            ..Self::with(setting, base, Pose::default(), input)?
        })
    }

    fn with(
        setting: Setting,
        base: BaseSpec,
        start: Pose<f64>,
        input: Input,
    ) -> Result<Self, String> {
        let base = seen_by(base, setting.floor);
        let live = live(&base, &setting, start, LiveLaw::Default)?;
        let robot = Robot {
            law: LiveLaw::Default,
            live,
        };
        Ok(Self {
            setting,
            base,
            robots: vec![robot],
            log: vec![(0, input)],
            ticks: 0,
            hash: HASH_START,
            rows: Vec::new(),
            course: None,
            patches: Vec::new(),
            faults: 0,
            host: true,
            own: None,
        })
    }

    /// Does what somebody did on the page, before the next tick.
    ///
    /// # Errors
    /// Why it cannot be done, for people; nothing has changed then.
    pub fn apply(&mut self, input: Input) -> Result<(), String> {
        match &input {
            Input::Begin(setting) => {
                *self = match (setting.base, &self.own) {
                    (OWN, Some((name, text))) => Self::of_file(*setting, name, text)?,
                    _ => Self::new(*setting)?,
                };
                return Ok(());
            }
            Input::Robot {
                setting,
                name,
                text,
            } => {
                *self = Self::of_file(*setting, name, text)?;
                return Ok(());
            }
            Input::Laws(mask) => self.choose(*mask)?,
            Input::Goal(at) => self.order(Course::Park(pose(*at))),
            Input::Place(at, announced) => {
                for robot in &mut self.robots {
                    let placed = robot.live.place(pose(*at), *announced);
                    refused_or_not(placed.map_err(|error| error.to_string())?)?;
                }
            }
            Input::Line(points) => {
                let points: Vec<[f64; 2]> = points
                    .iter()
                    .map(|point| point.map(|mm| 1.0e-3 * f64::from(mm)))
                    .collect();
                let speed = DRAWN_SPEED * self.base.limits.speed;
                let table = drawn::table(&points, speed).ok_or("the line is too short")?;
                self.follow("line", table.as_bytes())?;
            }
            Input::File { name, bytes } => {
                let start = self.follow(name, bytes)?;
                for robot in &mut self.robots {
                    let placed = robot.live.place(start, true);
                    refused_or_not(placed.map_err(|error| error.to_string())?)?;
                }
            }
            Input::Drive { speed, turn_rate } => {
                let order = VelocityOrder {
                    twist: Twist::new(1.0e-3 * f64::from(*speed), 1.0e-3 * f64::from(*turn_rate)),
                    hold_heading: false,
                };
                self.course = None;
                for robot in &mut self.robots {
                    robot.live.drive(order);
                }
            }
            Input::Stop => self.command(&Command::Stop)?,
            Input::EmergencyStop => self.command(&Command::EmergencyStop { brake: true })?,
            Input::Arm => {
                for robot in &mut self.robots {
                    // Only one of the two fits: a reset where something latched, arming elsewhere.
                    for command in [Command::ResetFault, Command::Arm] {
                        let answer = robot.live.command(&command);
                        let _ = answer.map_err(|error| error.to_string())?;
                    }
                }
            }
            Input::Push {
                force,
                moment,
                duration,
            } => {
                let [x, y] = force.map(|tenths| 0.1 * f64::from(tenths));
                let wrench = [x, y, 0.01 * f64::from(*moment)];
                for robot in &mut self.robots {
                    let world = robot.live.world_mut();
                    world.push(wrench, 1.0e-3 * f64::from(*duration));
                }
            }
            Input::Ice([x0, x1, y0, y1], grip) => {
                let edges = |from: i16, to: i16| {
                    [from.min(to), from.max(to)].map(|mm| 1.0e-3 * f64::from(mm))
                };
                self.patches.push(PatchParams {
                    mu: 0.01 * f64::from((*grip).max(1)),
                    x_m: edges(*x0, *x1),
                    y_m: edges(*y0, *y1),
                    time_s: [f64::NEG_INFINITY, f64::INFINITY],
                });
                self.lay_patches();
            }
            Input::Thaw => {
                self.patches.clear();
                self.lay_patches();
            }
            Input::Fault(index, there) => {
                let (fault, _) = FAULTS.get(usize::from(*index)).ok_or("no such fault")?;
                let bit = 1 << index;
                self.faults = match there {
                    true => self.faults | bit,
                    false => self.faults & !bit,
                };
                for robot in &mut self.robots {
                    let world = robot.live.world_mut();
                    match there {
                        true => world.inject(*fault),
                        false => world.heal(*fault),
                    }
                }
            }
            Input::Host(alive) => {
                self.host = *alive;
                for robot in &mut self.robots {
                    robot.live.set_host(*alive);
                }
            }
        }
        // Of orders in the same tick only the last is ever obeyed: what a finger drags makes no long log.
        if let Some((tick, last)) = self.log.last_mut()
            && *tick == self.ticks
            && match (&last, &input) {
                (Input::Goal(_), Input::Goal(_)) | (Input::Drive { .. }, Input::Drive { .. }) => {
                    true
                }
                // One that is announced is a command to the base, which one that is not does not take back.
                (Input::Place(_, before), Input::Place(_, now)) => before == now,
                _ => false,
            }
        {
            *last = input;
        } else {
            self.log.push((self.ticks, input));
        }
        Ok(())
    }

    fn order(&mut self, course: Course) {
        self.course = Some(course.clone());
        for robot in &mut self.robots {
            robot.live.order(course.clone());
        }
    }

    fn command(&mut self, command: &Command) -> Result<(), String> {
        for robot in &mut self.robots {
            let answer = robot.live.command(command);
            refused_or_not(answer.map_err(|error| error.to_string())?)?;
        }
        Ok(())
    }

    /// Follows a file, as `sim-host run FILE --base ...` does; where it begins.
    fn follow(&mut self, name: &str, bytes: &[u8]) -> Result<Pose<f64>, String> {
        let run = FileRun {
            period_s: self.base.period_s(),
            ..FileRun::default()
        };
        let mission = run.mission(name, bytes, &self.base);
        let (mission, _) = mission.map_err(|error| format!("{name}: {error}"))?;
        self.order(mission.course);
        Ok(mission.start.pose)
    }

    fn lay_patches(&mut self) {
        for robot in &mut self.robots {
            robot.live.world_mut().patches().clone_from(&self.patches);
        }
    }

    /// Laws that join begin at rest where the default one is, with its order.
    fn choose(&mut self, mask: u8) -> Result<(), String> {
        let wanted = |law: LiveLaw| match law {
            LiveLaw::Default => true,
            LiveLaw::Neural => mask & 1 != 0,
            LiveLaw::Plain => mask & 2 != 0,
        };
        self.robots.retain(|robot| wanted(robot.law));
        for law in LAWS.into_iter().filter(|law| wanted(*law)) {
            if self.robots.iter().any(|robot| robot.law == law) {
                continue;
            }
            let start = self.main().world().truth().pose;
            let mut live = live(&self.base, &self.setting, start, law)?;
            live.world_mut().patches().clone_from(&self.patches);
            for (index, (fault, _)) in FAULTS.iter().enumerate() {
                if self.faults >> index & 1 == 1 {
                    live.world_mut().inject(*fault);
                }
            }
            live.set_host(self.host);
            if let Some(course) = &self.course {
                live.order(course.clone());
            }
            self.robots.push(Robot { law, live });
        }
        Ok(())
    }

    /// Lets ticks pass.
    ///
    /// # Errors
    /// What the simulator did not expect.
    pub fn advance(&mut self, ticks: u32) -> Result<(), String> {
        for _ in 0..ticks {
            let mut row = [f32::NAN; PER_ROW];
            row[0] = self.ticks as f32 * self.base.period_s() as f32;
            for robot in &mut self.robots {
                robot.live.tick().map_err(|error| error.to_string())?;
                let at = LAWS.iter().position(|law| *law == robot.law);
                let first = 1 + PER_ROBOT * at.unwrap_or_default();
                let numbers = numbers(&robot.live);
                if let Some(place) = row.get_mut(first..first + PER_ROBOT) {
                    place.copy_from_slice(&numbers);
                }
                self.hash = bits(self.hash, &robot.live);
            }
            self.ticks += 1;
            self.rows.extend(row);
            if self.rows.len() >= 2 * MAX_ROWS * PER_ROW {
                self.rows.drain(..MAX_ROWS * PER_ROW);
            }
        }
        Ok(())
    }

    /// The rows since the last call, [`PER_ROW`] numbers each; of very many only the newest.
    pub fn rows(&mut self) -> Vec<f32> {
        std::mem::take(&mut self.rows)
    }

    /// Everything that was done, and when: what [`Session::replay`] takes.
    ///
    /// # Errors
    /// A run that is too long for it, for people.
    pub fn share(&self) -> Result<Vec<u8>, String> {
        short_enough(self.ticks)?;
        let mut bytes = vec![SHARED];
        input::count(&mut bytes, self.ticks);
        let mut before = 0;
        for (tick, input) in &self.log {
            input::count(&mut bytes, tick - before);
            before = *tick;
            input.encode(&mut bytes);
        }
        Ok(bytes)
    }

    /// The run that was shared, at the tick at which it was.
    ///
    /// # Errors
    /// Bytes that are no run, or inputs that cannot be.
    pub fn replay(shared: &[u8]) -> Result<Self, String> {
        const DAMAGED: &str = "the link is damaged, or of another version";
        let Some((&SHARED, mut rest)) = shared.split_first() else {
            return Err(DAMAGED.to_owned());
        };
        let ticks = input::count_of(&mut rest).ok_or(DAMAGED)?;
        short_enough(ticks)?;
        let mut session: Option<Self> = None;
        while !rest.is_empty() {
            let since = input::count_of(&mut rest).ok_or(DAMAGED)?;
            let input = Input::decode(&mut rest).ok_or(DAMAGED)?;
            match &mut session {
                Some(session) => {
                    let last = session.log.last().map_or(0, |(tick, _)| *tick);
                    let due = last.saturating_add(since).min(ticks);
                    session.advance(due.saturating_sub(session.ticks))?;
                    session.apply(input)?;
                }
                None => {
                    let mut first = Self::new(Setting::default())?;
                    first.apply(input)?;
                    session = Some(first);
                }
            }
        }
        let mut session = session.ok_or(DAMAGED)?;
        session.advance(ticks.saturating_sub(session.ticks))?;
        Ok(session)
    }

    /// Of every tick so far: true pose, torques asked for, state, of all robots, bit by bit.
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// Ticks so far.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// The robot of the default law.
    pub fn main(&self) -> &Live<'static> {
        &self.robots[0].live
    }

    /// All robots with their laws.
    pub fn robots(&self) -> impl Iterator<Item = (LiveLaw, &Live<'static>)> {
        self.robots.iter().map(|robot| (robot.law, &robot.live))
    }

    /// The base, as it is believed to be.
    pub fn base(&self) -> &BaseSpec {
        &self.base
    }

    /// What the run began with.
    pub fn setting(&self) -> &Setting {
        &self.setting
    }

    /// Where the present order ends; none while driving by velocity.
    pub fn goal(&self) -> Option<Pose<f64>> {
        match self.course.as_ref()? {
            Course::Park(goal) => Some(*goal),
            Course::Follow { hand_over, .. } => hand_over.map(|rule| rule.goal),
            Course::Drive => None,
        }
    }

    /// Places with another grip.
    pub fn patches(&self) -> &[PatchParams] {
        &self.patches
    }

    /// The faults that are in: bit n for the n-th of [`FAULTS`].
    pub fn faults(&self) -> u32 {
        self.faults
    }

    /// Whether there is a host that gives orders.
    pub fn host(&self) -> bool {
        self.host
    }

    /// The way that the default law's robot follows: x, y \[m\] of some of its points.
    pub fn path(&self) -> Vec<f32> {
        let references = self.main().references();
        let every = references.len().div_ceil(MAX_PATH).max(1);
        let last = references.len().saturating_sub(1);
        references
            .iter()
            .enumerate()
            .filter(|(n, _)| n % every == 0 || *n == last)
            .flat_map(|(_, reference)| [reference.pose().x as f32, reference.pose().y as f32])
            .collect()
    }
}

/// The most points of a way that are drawn.
const MAX_PATH: usize = 1000;

impl Default for Setting {
    /// The 10 kg base as its file has it.
    fn default() -> Self {
        Self {
            base: 1,
            gyro: false,
            floor: Floor::File,
            seed: 1,
        }
    }
}

fn live(
    base: &BaseSpec,
    setting: &Setting,
    start: Pose<f64>,
    law: LiveLaw,
) -> Result<Live<'static>, String> {
    // As long as the page lives: nobody can say when a robot is the last one. 200 bytes each.
    let queue = Box::leak(Box::new(ReferenceQueue::new()));
    let world = world(base, setting);
    Live::new(queue, base, &world, start, law).map_err(|error| error.to_string())
}

fn world(base: &BaseSpec, setting: &Setting) -> WorldSetup {
    let seed = u64::from(setting.seed);
    match setting.floor {
        Floor::Bad => trials::setup(base, Condition::Drawn, seed),
        Floor::File | Floor::Fine => WorldSetup {
            world: WorldKeys::default(),
            seed,
        },
    }
}

/// The base with the pose source of its world, as it knows it.
fn seen_by(mut base: BaseSpec, floor: Floor) -> BaseSpec {
    if floor == Floor::Fine
        && let Some(hardware) = &mut base.hardware
        && let Some(source) = &mut hardware.pose_source
    {
        (source.noise_m, source.noise_rad) = CAPTURE;
    }
    base
}

/// Whether a run of so many ticks can be played again.
fn short_enough(ticks: u32) -> Result<(), String> {
    match ticks {
        0..=MAX_TICKS => Ok(()),
        _ => Err(format!(
            "the run is too long to be played again: {ticks} ticks, {MAX_TICKS} are the most"
        )),
    }
}

fn refused_or_not<E: std::fmt::Display>(answer: Result<(), E>) -> Result<(), String> {
    answer.map_err(|reason| format!("the base refuses: {reason}"))
}

fn numbers(live: &Live<'_>) -> [f32; PER_ROBOT] {
    let (truth, report) = (live.world().truth(), live.report());
    let believed = report.measured.map(|measured| measured.pose);
    let believed = believed.unwrap_or(Pose::new(f32::NAN, f32::NAN, f32::NAN));
    let command = report.motion.map(|motion| motion.command);
    let command = command.unwrap_or(Twist::new(f32::NAN, f32::NAN));
    let torques = report.action.torques().unwrap_or_default();
    let faults = report.active_faults.iter();
    let faults = faults.fold(0, |bits, fault| bits | 1_u32 << (fault.kind().code() - 1));
    [
        truth.pose.x as f32,
        truth.pose.y as f32,
        truth.pose.theta as f32,
        believed.x,
        believed.y,
        believed.theta,
        truth.twist.linear as f32,
        truth.twist.angular as f32,
        command.linear,
        command.angular,
        torques.right,
        torques.left,
        f32::from_bits(u32::from(state_code(report.state))),
        f32::from_bits(faults),
    ]
}

fn bits(hash: u64, live: &Live<'_>) -> u64 {
    let (pose, report) = (live.world().truth().pose, live.report());
    let torques = report.action.torques().unwrap_or_default();
    let torques = u64::from(torques.right.to_bits()) << 32 | u64::from(torques.left.to_bits());
    [
        pose.x.to_bits(),
        pose.y.to_bits(),
        pose.theta.to_bits(),
        torques,
        u64::from(state_code(report.state)),
    ]
    .into_iter()
    .fold(hash, |hash, word| (hash ^ word).wrapping_mul(HASH_FACTOR))
}

/// The index of a state in [`State::ALL`].
pub fn state_code(state: State) -> u8 {
    let index = State::ALL.iter().position(|other| *other == state);
    index.unwrap_or_default() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOAL: Input = Input::Goal([1000, 500, 7000]);

    fn session(base: u8, floor: Floor) -> Session {
        Session::new(Setting {
            base,
            floor,
            ..Setting::default()
        })
        .expect("a base of the list")
    }

    fn state(session: &Session) -> State {
        session.main().report().state
    }

    fn shared(session: &Session) -> Vec<u8> {
        session.share().expect("short enough")
    }

    fn played_again(session: &Session) -> Session {
        Session::replay(&shared(session)).expect("a run")
    }

    #[test]
    fn a_robot_that_is_carried_in_both_ways_in_one_tick_plays_again_with_the_same_bits() {
        const PLACES: [Input; 4] = [
            Input::Place([1000, 1000, 10_000], true),
            Input::Place([1100, 1000, 10_000], true),
            Input::Place([1150, 1000, 10_000], false),
            Input::Place([1200, 1000, 10_000], false),
        ];
        let mut session = session(1, Floor::File);
        session.advance(50).expect("ticks");
        for place in PLACES {
            session.apply(place).expect("placed");
        }
        // Of each way only the last one.
        assert_eq!(session.log.len(), 3);
        session.advance(300).expect("ticks");
        assert_eq!(played_again(&session).hash(), session.hash());
    }

    #[test]
    fn a_run_that_is_too_long_to_be_played_again_is_not_shared() {
        let mut session = session(1, Floor::File);
        session.ticks = MAX_TICKS;
        assert!(session.share().is_ok());
        session.ticks += 1;
        let told = |why: &String| why.contains("too long") && why.contains("3600001");
        assert!(session.share().is_err_and(|why| told(&why)));
        let mut link = vec![SHARED];
        input::count(&mut link, MAX_TICKS + 1);
        assert!(Session::replay(&link).is_err_and(|why| told(&why)));
    }

    #[test]
    fn every_base_parks_on_every_floor_and_plays_again_with_the_same_bits() {
        for base in 0..BASES.len() as u8 {
            for floor in [Floor::Fine, Floor::File, Floor::Bad] {
                let mut session = session(base, floor);
                session.advance(17).expect("ticks");
                session.apply(GOAL).expect("a goal");
                session.apply(Input::Laws(3)).expect("laws");
                // 20 s of the quickest base: `verify` parks the last of 2,502 runs after 17.4 s.
                session.advance(4000).expect("ticks");
                assert_eq!(state(&session), State::Parked, "base {base}, {floor:?}");
                let truth = session.main().world().truth().pose;
                // The bound of `verify`.
                let off = (truth.x - 1.0).hypot(truth.y - 0.5);
                assert!(off < 5.0e-3, "base {base}, {floor:?}: {off} m");
                let again = played_again(&session);
                assert_eq!(again.ticks(), session.ticks());
                assert_eq!(again.hash(), session.hash());
                assert_eq!(session.robots().count(), 3);
            }
        }
    }

    #[test]
    fn other_inputs_other_bits() {
        let run = |goal: Input, seed: u16| {
            let mut session = Session::new(Setting {
                seed,
                ..Setting::default()
            })
            .expect("a base");
            session.apply(goal).expect("a goal");
            session.advance(100).expect("ticks");
            session.hash()
        };
        let first = run(GOAL, 1);
        assert_eq!(first, run(GOAL, 1));
        assert_ne!(first, run(Input::Goal([1000, 500, 7001]), 1));
        assert_ne!(first, run(GOAL, 2));
    }

    #[test]
    fn a_dragged_goal_is_one_input_in_a_tick_and_an_order_that_is_refused_is_none() {
        let mut session = session(1, Floor::File);
        session.advance(5).expect("ticks");
        let before = shared(&session).len();
        for x in 0..100 {
            session.apply(Input::Goal([x, 0, 0])).expect("a goal");
        }
        assert_eq!(shared(&session).len(), before + 8);
        let held = shared(&session);
        let refused = [
            Input::Begin(Setting {
                base: 9,
                ..Setting::default()
            }),
            Input::Line(vec![[0, 0], [10, 10]]),
            Input::File {
                name: "a.json".to_owned(),
                bytes: b"{}".to_vec(),
            },
            Input::Fault(200, true),
        ];
        for input in refused {
            let why = session.apply(input.clone());
            assert!(why.is_err_and(|why| !why.is_empty()), "{input:?}");
            assert_eq!(shared(&session), held, "{input:?}");
        }
    }

    /// Along the axes and aslant, with the points of a browser and two only.
    #[test]
    fn a_straight_line_is_followed_to_its_end() {
        for (x, y) in [(1700, 0), (0, 1700), (-1200, 900)] {
            for pieces in [1, 17] {
                let mut session = session(1, Floor::File);
                let point = |n| [(x * n / pieces) as i16, (y * n / pieces) as i16];
                let points = (0..=pieces).map(point).collect();
                session.apply(Input::Line(points)).expect("a line");
                session.advance(3000).expect("ticks");
                assert_eq!(state(&session), State::Parked, "{x} {y} {pieces}");
                let pose = session.main().world().truth().pose;
                let (dx, dy) = (pose.x - 1e-3 * f64::from(x), pose.y - 1e-3 * f64::from(y));
                // The tolerance of its noisy poses.
                assert!(
                    dx.abs().max(dy.abs()) < 0.02,
                    "{pose:?} for {x} {y} {pieces}"
                );
            }
        }
    }

    #[test]
    fn what_is_no_run_is_refused() {
        let mut session = session(2, Floor::Bad);
        for input in [GOAL, Input::Laws(1), Input::Host(false)] {
            session.apply(input).expect("done");
            session.advance(3).expect("ticks");
        }
        let whole = shared(&session);
        for cut in 0..whole.len() {
            // Cut between two inputs it is a shorter run.
            if let Ok(shorter) = Session::replay(&whole[..cut]) {
                assert_eq!(shorter.ticks(), session.ticks());
            }
        }
        assert!(Session::replay(&[]).is_err());
        assert!(Session::replay(&[SHARED + 1, 0]).is_err());
        assert!(Session::replay(&[SHARED, 0xff, 0xff, 0xff, 0xff, 0xf]).is_err());
        assert!(Session::replay(&[SHARED, 1, 0, 77]).is_err());
    }
}

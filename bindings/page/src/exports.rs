//! What the page calls. Bytes go through two buffers, one each way; numbers are returned. Only this file knows of the page.

#![allow(unsafe_code)] // Names that the page can find, and nothing else: no pointer is followed here.

use crate::input::{FAULTS, Floor, Input, MAX_FILE};
use crate::session::{PER_ROBOT, PER_ROW, Session, state_code};
use crate::watch::{WATCHED, Watch};
use controller_core::safety::FaultKind;
use controller_core::safety::supervisor::State;
use sim_host::run::LiveLaw;
use sim_host::scenario::BASES;
use sim_host::trace::{cause, fix_name, state_name};
use std::cell::RefCell;
use std::fmt::Write as _;

#[derive(Default)]
struct Page {
    session: Option<Session>,
    watch: Watch,
    input: Vec<u8>,
    output: Vec<u8>,
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
}

fn page<T>(call: impl FnOnce(&mut Page) -> T) -> T {
    PAGE.with_borrow_mut(call)
}

/// 1 if it went well; else 0, with why as text in the output.
fn outcome(page: &mut Page, result: Result<(), String>) -> u32 {
    match result {
        Ok(()) => 1,
        Err(why) => {
            page.output = why.into_bytes();
            0
        }
    }
}

impl Page {
    fn session(&mut self) -> Result<&mut Session, String> {
        self.session
            .as_mut()
            .ok_or_else(|| "nothing runs".to_owned())
    }

    fn numbers(&mut self, numbers: &[f32]) -> u32 {
        self.output.clear();
        self.output
            .extend(numbers.iter().flat_map(|n| n.to_le_bytes()));
        numbers.len() as u32
    }
}

/// Room for `length` bytes of input; 0 if that is too much.
#[unsafe(no_mangle)]
extern "C" fn input(length: u32) -> u32 {
    page(|page| {
        if length as usize > 2 * MAX_FILE {
            return 0;
        }
        page.input.clear();
        page.input.resize(length as usize, 0);
        page.input.as_ptr() as usize as u32
    })
}

/// Where the output is.
#[unsafe(no_mangle)]
extern "C" fn output() -> u32 {
    page(|page| page.output.as_ptr() as usize as u32)
}

/// Bytes of output.
#[unsafe(no_mangle)]
extern "C" fn output_length() -> u32 {
    page(|page| page.output.len() as u32)
}

/// What the page has to know once, as JSON.
#[unsafe(no_mangle)]
extern "C" fn about() {
    page(|page| {
        let list = |names: Vec<String>| format!("[{}]", names.join(","));
        let bases = BASES.iter().map(|base| quoted(base.name)).collect();
        let faults = FAULTS.iter().map(|(_, name)| quoted(name)).collect();
        let kinds = (1..=32).filter_map(FaultKind::from_code);
        let kinds = kinds.map(|kind| quoted(kind.name())).collect();
        let states = State::ALL.iter().map(|state| quoted(state_name(*state)));
        page.output = format!(
            "{{\"bases\":{},\"faults\":{},\"kinds\":{},\"states\":{},\"row\":{PER_ROW},\"robot\":{PER_ROBOT},\"watched\":{WATCHED}}}",
            list(bases),
            list(faults),
            list(kinds),
            list(states.collect()),
        )
        .into_bytes();
    });
}

/// The input's bytes are an [`Input`].
#[unsafe(no_mangle)]
extern "C" fn apply() -> u32 {
    page(|page| {
        let decoded = Input::decode(&mut page.input.as_slice());
        let result = match (decoded, &mut page.session) {
            (None, _) => Err("not an input".to_owned()),
            (Some(input), Some(session)) => session.apply(input),
            (Some(input), None) => Session::new(Default::default()).and_then(|mut session| {
                session.apply(input)?;
                page.session = Some(session);
                Ok(())
            }),
        };
        outcome(page, result)
    })
}

/// The input's bytes are a shared run.
#[unsafe(no_mangle)]
extern "C" fn replay() -> u32 {
    page(|page| {
        let result = Session::replay(&page.input).map(|session| page.session = Some(session));
        outcome(page, result)
    })
}

/// The run as bytes.
#[unsafe(no_mangle)]
extern "C" fn share() -> u32 {
    page(|page| {
        let shared = page.session().and_then(|session| session.share());
        let result = shared.map(|bytes| page.output = bytes);
        outcome(page, result)
    })
}

/// Lets ticks pass.
#[unsafe(no_mangle)]
extern "C" fn advance(ticks: u32) -> u32 {
    page(|page| {
        let result = page.session().and_then(|session| session.advance(ticks));
        outcome(page, result)
    })
}

/// Rows since the last call; how many numbers.
#[unsafe(no_mangle)]
extern "C" fn rows() -> u32 {
    page(|page| {
        let rows = page.session.as_mut().map_or(Vec::new(), Session::rows);
        page.numbers(&rows)
    })
}

/// The way that is followed; how many numbers.
#[unsafe(no_mangle)]
extern "C" fn path() -> u32 {
    page(|page| {
        let path = page.session.as_ref().map_or(Vec::new(), Session::path);
        page.numbers(&path)
    })
}

/// Everything else about the present, as JSON.
#[unsafe(no_mangle)]
extern "C" fn status() {
    page(|page| {
        let status = page.session.as_ref().map_or("null".to_owned(), status_of);
        page.output = status.into_bytes();
    });
}

fn status_of(session: &Session) -> String {
    let live = session.main();
    let (world, report) = (live.world(), live.report());
    let truth = world.truth();
    let [right, left] = world.slipping();
    let currents = world.currents();
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = write!(
        text,
        "{{\"ticks\":{},\"hash\":\"{:016x}\",\"x\":{},\"y\":{},\"theta\":{},\"period\":{},\"state\":{},\"cause\":{},\"faults\":[",
        session.ticks(),
        session.hash(),
        number(truth.pose.x),
        number(truth.pose.y),
        number(truth.pose.theta),
        session.base().period_s(),
        quoted(state_name(report.state)),
        quoted(&cause(&report.cause)),
    );
    list(
        &mut text,
        report
            .active_faults
            .iter()
            .map(|fault| quoted(&fault.to_string())),
    );
    let base = session.base();
    let limits = &base.limits;
    let _ = write!(
        text,
        "],\"slipping\":[{right},{left}],\"supply\":{},\"currents\":[{},{}],\"fix\":{},\"injected\":{},\"host\":{},\"base\":{{\"name\":{},\"index\":{},\"track\":{},\"radius\":{},\"speed\":{},\"turn_rate\":{},\"torque\":{},\"mass\":{},\"gyro\":{},\"floor\":{},\"seed\":{}}},\"patches\":[",
        number(world.supply_v()),
        number(currents[0]),
        number(currents[1]),
        quoted(fix_name(&report.fix)),
        session.faults(),
        session.host(),
        quoted(&base.name),
        session.setting().base,
        base.robot.wheels.track_m,
        base.robot.wheels.radius_right_m,
        limits.speed,
        limits.turn_rate,
        limits.wheel_torque_nm,
        base.robot.mass_kg,
        base.hardware
            .is_some_and(|hardware| hardware.gyro.is_some()),
        match session.setting().floor {
            Floor::Fine => 0,
            Floor::File => 1,
            Floor::Bad => 2,
        },
        session.setting().seed,
    );
    list(
        &mut text,
        session.patches().iter().map(|patch| {
            let [x0, x1] = patch.x_m;
            let [y0, y1] = patch.y_m;
            format!("[{x0},{x1},{y0},{y1},{}]", patch.mu)
        }),
    );
    text.push_str("],\"laws\":[");
    list(
        &mut text,
        session.robots().map(|(law, live)| {
            let name = match law {
                LiveLaw::Default => "default",
                LiveLaw::Neural => "neural",
                LiveLaw::Plain => "plain",
            };
            let state = state_code(live.report().state);
            format!(
                "{{\"law\":\"{name}\",\"state\":{state},\"refused\":{}}}",
                live.has_refused()
            )
        }),
    );
    text.push_str("],\"goal\":");
    match session.goal() {
        Some(pose) => {
            let _ = write!(
                text,
                "[{},{},{}]",
                number(pose.x),
                number(pose.y),
                number(pose.theta)
            );
        }
        None => text.push_str("null"),
    }
    text.push('}');
    text
}

fn list(text: &mut String, items: impl Iterator<Item = String>) {
    for (n, item) in items.enumerate() {
        if n > 0 {
            text.push(',');
        }
        text.push_str(&item);
    }
}

/// What is no number is none in JSON either.
fn number(value: f64) -> String {
    if value.is_finite() {
        // A nanometre, a nanoradian: what people read.
        format!("{value:.9}")
    } else {
        "null".to_owned()
    }
}

fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            '\n' => quoted.push_str("\\n"),
            letter if letter < ' ' => quoted.push(' '),
            letter => quoted.push(letter),
        }
    }
    quoted.push('"');
    quoted
}

/// The input's bytes are a board's.
#[unsafe(no_mangle)]
extern "C" fn board_take() {
    page(|page| page.watch.take(&page.input));
}

/// A board is watched from now on.
#[unsafe(no_mangle)]
extern "C" fn board_forget() {
    page(|page| page.watch = Watch::default());
}

/// Reports since the last call; how many numbers.
#[unsafe(no_mangle)]
extern "C" fn board_rows() -> u32 {
    page(|page| {
        let rows = page.watch.rows();
        page.numbers(&rows)
    })
}

/// What the board said, as JSON.
#[unsafe(no_mangle)]
extern "C" fn board_status() {
    page(|page| {
        let monitor = page.watch.monitor();
        let (state, why) = match &monitor.latest().state {
            Some((state, why)) => (state_name(*state).to_owned(), cause(why)),
            None => (String::new(), String::new()),
        };
        let frames = monitor.frames();
        let hello = monitor.latest().hello.filter(|hello| hello.period_us > 0);
        let period = hello.map_or(f64::NAN, |hello| 1.0e-6 * f64::from(hello.period_us));
        page.output = format!(
            "{{\"reports\":{},\"period\":{},\"good\":{},\"bad\":{},\"state\":{},\"cause\":{},\"line\":{}}}",
            monitor.reports(),
            number(period),
            frames.good,
            frames.rejected(),
            quoted(&state),
            quoted(&why),
            quoted(&monitor.line()),
        )
        .into_bytes();
    });
}

//! Texts of the codes, as C takes them.

use core::ffi::CStr;

use controller_core::safety::FaultKind;

const UNKNOWN: &CStr = c"unknown";

/// Of the calls' answers, by the negative code.
static STATUS: [&CStr; 14] = [
    c"ok",
    c"a pointer is NULL",
    c"a pointer is not aligned",
    c"the base is not initialised",
    c"called from within another call on the same base",
    c"header and archive are of different versions, or the memory is too small",
    c"the bytes are no robot",
    c"the robot has another length than it states",
    c"the robot is damaged",
    c"the robot is of another version",
    c"the robot has parameters out of range",
    c"a number is not finite",
    c"a value that the header does not have",
    c"the base's state does not allow it",
];

/// Of the states, by the place in `State::ALL`.
static STATE: [&CStr; 11] = [
    c"idle",
    c"armed",
    c"tracking",
    c"parking",
    c"parked",
    c"stopping",
    c"stopping for a fault",
    c"braking",
    c"braking for a fault",
    c"stopped",
    c"fault",
];

/// Of the causes.
static CAUSE: [&CStr; 10] = [
    c"power on",
    c"host",
    c"references",
    c"trajectory ended",
    c"reached",
    c"goal unreachable",
    c"link lost",
    c"emergency stop",
    c"demanded",
    c"fault",
];

const WIDTH: usize = 18;

/// A name with zeros behind it; one that is too long does not compile.
const fn padded(name: &str) -> [u8; WIDTH] {
    let bytes = name.as_bytes();
    assert!(bytes.len() < WIDTH);
    let mut text = [0; WIDTH];
    let mut at = 0;
    while at < bytes.len() {
        text[at] = bytes[at];
        at += 1;
    }
    text
}

/// Of the faults, from code 1 on: the core's names, which files have as well.
static FAULT: [[u8; WIDTH]; FaultKind::COUNT] = {
    let mut names = [[0; WIDTH]; FaultKind::COUNT];
    let mut at = 0;
    while at < FaultKind::COUNT {
        let kind = FaultKind::ALL[at];
        assert!(kind.code() as usize == at + 1);
        names[at] = padded(kind.name());
        at += 1;
    }
    names
};

fn of<'a>(texts: &[&'a CStr], at: usize) -> &'a CStr {
    texts.get(at).copied().unwrap_or(UNKNOWN)
}

/// Of what a call answered.
pub fn status(code: i32) -> &'static CStr {
    match usize::try_from(code.wrapping_neg()) {
        Ok(at) => of(&STATUS, at),
        Err(_) => UNKNOWN,
    }
}

/// Of a state.
pub fn state(code: u32) -> &'static CStr {
    of(&STATE, code as usize)
}

/// Of a cause.
pub fn cause(code: u32) -> &'static CStr {
    of(&CAUSE, code as usize)
}

/// Of a fault: its name in robots' files.
pub fn fault(code: u32) -> &'static CStr {
    let place = code.wrapping_sub(1) as usize;
    let name = FAULT
        .get(place)
        .map(|name| CStr::from_bytes_until_nul(name));
    match name {
        Some(Ok(name)) => name,
        _ => UNKNOWN,
    }
}

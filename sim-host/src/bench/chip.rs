//! Instructions of a tick on the chip.

use super::{LawKind, Track};

/// Law; following, parking: most of the executed instructions of a tick on the emulated Cortex-M4F, counted by
/// `boards/cost-peers`; a test compares. Of rivals the law alone: what limits and drives is the same for all.
const COUNTED: &str = include_str!("chip.csv");
/// Those of our own laws, limits and velocity loop included.
const BUDGETS: &str = include_str!("../../../firmware-demo/budgets.toml");
/// The chip and its optimisation there.
const SECTION: &str = "[cortex-m4f.3]";

/// Most instructions of a tick, following or parking as the track has it; none of a law that no chip runs here.
pub fn instructions(kind: LawKind, track: Track) -> Option<u32> {
    let parks = track == Track::Parking;
    let of = |follow, park| if parks { park } else { follow };
    match kind {
        // Parking, most is a tick that searches for a manoeuvre; at the 10 ms of a base it does more of that than at 1 ms.
        LawKind::Default | LawKind::HeadingHeld => {
            budget(of("motion-follow", "motion-search-10ms"))
        }
        LawKind::Neural => budget(of("track", "park")),
        _ => COUNTED.lines().find_map(|line| {
            let mut fields = line.split(';');
            (fields.next()? == kind.name()).then_some(())?;
            fields.nth(usize::from(parks))?.trim().parse().ok()
        }),
    }
}

fn budget(key: &str) -> Option<u32> {
    let section = BUDGETS.split_once(SECTION)?.1;
    let section = section.split("\n[").next()?;
    section.lines().find_map(|line| {
        let (name, value) = line.split_once('=')?;
        (name.trim() == key).then(|| value.trim().parse().ok())?
    })
}

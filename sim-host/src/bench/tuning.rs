//! Gains of the rivals, searched.

use super::{LawKind, Track};

/// Gains that were found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tuned(Vec<(LawKind, String, Track, Vec<f32>)>);

impl Tuned {
    /// Those of a law, on a base, for a track.
    pub fn of(&self, kind: LawKind, base: &str, track: Track) -> Option<Vec<f32>> {
        let found = self
            .0
            .iter()
            .find(|(of, on, along, _)| *of == kind && on == base && *along == track);
        found.map(|(.., gains)| gains.clone())
    }
}

/// x
pub fn tune() {}

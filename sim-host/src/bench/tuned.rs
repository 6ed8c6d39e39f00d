//! Gains of the rivals, as a search found them.

use super::Track;
use super::law::{Flavour, Law, LawKind};
use std::fmt::Write as _;

/// Gains that were found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tuned(Vec<(LawKind, String, Track, Vec<f32>)>);

/// Law, base, track, gains in the order of the law's list with spaces between them.
const FOUND: &str = include_str!("tuned.csv");

impl Tuned {
    /// What a search found.
    pub(super) const fn of_search(found: Vec<(LawKind, String, Track, Vec<f32>)>) -> Self {
        Self(found)
    }

    /// The gains of a law on a base, for a track.
    pub(super) fn gains(&self, law: &Law, base: &str, track: Track) -> Vec<f32> {
        let found = match law.flavour {
            Flavour::Usual => None,
            Flavour::Tuned => self.of(law.kind, base, track),
        };
        found.unwrap_or_else(|| law.kind.usual())
    }

    /// Those that travel inside the program.
    pub fn built_in() -> Self {
        Self::parse(FOUND)
    }

    fn parse(text: &str) -> Self {
        let line = |line: &str| {
            let mut fields = line.split(';');
            let (law, base, track) = (fields.next()?, fields.next()?, fields.next()?);
            let kind = LawKind::RIVALS
                .into_iter()
                .find(|kind| kind.name() == law)?;
            let track = Track::ALL.into_iter().find(|of| of.name() == track)?;
            let gains = fields.next()?.split_whitespace();
            let gains = gains.map(|gain| gain.parse().ok()).collect::<Option<_>>()?;
            Some((kind, base.to_owned(), track, gains))
        };
        Self(text.lines().filter_map(line).collect())
    }

    /// Those of a law, on a base, for a track; the paper's cases are followed with the gains for files.
    pub fn of(&self, kind: LawKind, base: &str, track: Track) -> Option<Vec<f32>> {
        let track = match track {
            Track::Paper => Track::Files,
            track => track,
        };
        let found = self
            .0
            .iter()
            .find(|(of, on, along, _)| *of == kind && on == base && *along == track);
        found.map(|(.., gains)| gains.clone())
    }

    /// As they stand in a file.
    pub fn csv(&self) -> String {
        let mut text = "law;base;track;gains\n".to_owned();
        for (kind, base, track, gains) in &self.0 {
            let gains: Vec<String> = gains.iter().map(ToString::to_string).collect();
            let _ = writeln!(
                text,
                "{};{base};{};{}",
                kind.name(),
                track.name(),
                gains.join(" ")
            );
        }
        text
    }
}

//! Who drives.

use super::Track;
use crate::run::PaperRival;
use crate::scenario::ControlLaw;
use rivals::{
    Aicardi, Body, Gain, Graceful, Job, LtvUnicycle, Mpc, Now, PurePursuit, Ramsete, Rival, Samson,
    TurnDriveTurn, TwoPids, Wanted,
};

/// Which law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LawKind {
    /// Ours.
    Default,
    /// Turns, drives, turns, with trapezoids.
    TurnDriveTurn,
    /// WPILib's, until 2026.
    Ramsete,
    /// WPILib's.
    Ltv,
    /// Nav2's graceful controller, which turns to the goal's heading at the end.
    Graceful,
    /// The same law with the goal's heading on the way, as published.
    GracefulOnTheWay,
    /// Nav2's regulated pure pursuit.
    PurePursuit,
    /// Aicardi and others' polar law.
    Aicardi,
    /// Samson's chained form.
    Samson,
    /// A PID on the distance and one on the heading.
    TwoPids,
    /// Linear model predictive control.
    Mpc,
    /// The paper's.
    Neural,
    /// The paper's, without neurons.
    Plain,
    /// Ours, with the heading held.
    HeadingHeld,
    /// Orders through the limits on rates, as of Nav2's velocity smoother.
    RateLimits,
}

/// With which gains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Flavour {
    /// As published, or the base file's.
    Usual,
    /// Found by the search, for the base and the track.
    Tuned,
}

impl Flavour {
    /// For people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Usual => "usual",
            Self::Tuned => "tuned",
        }
    }
}

/// A law with its gains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Law {
    /// Which.
    pub kind: LawKind,
    /// With which gains.
    pub flavour: Flavour,
}

impl LawKind {
    /// All of them.
    pub fn all() -> Vec<Self> {
        let ends = [
            Self::Neural,
            Self::Plain,
            Self::HeadingHeld,
            Self::RateLimits,
        ];
        let ours = std::iter::once(Self::Default);
        ours.chain(Self::RIVALS).chain(ends).collect()
    }

    /// Those with gains of their own, in the order of tables.
    pub const RIVALS: [Self; 10] = [
        Self::TurnDriveTurn,
        Self::Ramsete,
        Self::Ltv,
        Self::Mpc,
        Self::Graceful,
        Self::GracefulOnTheWay,
        Self::PurePursuit,
        Self::Aicardi,
        Self::Samson,
        Self::TwoPids,
    ];

    /// For people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Default => "default law",
            Self::TurnDriveTurn => "turn-drive-turn",
            Self::Ramsete => "Ramsete",
            Self::Ltv => "LTV unicycle",
            Self::Graceful => "graceful",
            Self::GracefulOnTheWay => "graceful, heading on the way",
            Self::PurePursuit => "regulated pure pursuit",
            Self::Aicardi => "Aicardi",
            Self::Samson => "Samson",
            Self::TwoPids => "two PIDs",
            Self::Mpc => "linear MPC",
            Self::Neural => "paper, neural",
            Self::Plain => "paper, plain",
            Self::HeadingHeld => "default law, heading held",
            Self::RateLimits => "rate limits alone",
        }
    }

    /// Its gains.
    pub const fn gains(self) -> &'static [Gain] {
        match self {
            Self::TurnDriveTurn => &TurnDriveTurn::GAINS,
            Self::Ramsete => &Ramsete::GAINS,
            Self::Ltv => &LtvUnicycle::GAINS,
            Self::Graceful | Self::GracefulOnTheWay => &Graceful::GAINS,
            Self::PurePursuit => &PurePursuit::GAINS,
            Self::Aicardi => &Aicardi::GAINS,
            Self::Samson => &Samson::GAINS,
            Self::TwoPids => &TwoPids::GAINS,
            Self::Mpc => &Mpc::GAINS,
            Self::Default | Self::Neural | Self::Plain | Self::HeadingHeld | Self::RateLimits => {
                &[]
            }
        }
    }

    /// Its gains as published.
    pub fn usual(self) -> Vec<f32> {
        self.gains().iter().map(|gain| gain.usual).collect()
    }

    /// The rival with these gains; none for our own law.
    pub(super) fn rival(self, gains: &[f32], body: &Body) -> Option<Box<dyn Rival>> {
        Some(match self {
            Self::TurnDriveTurn => Box::new(TurnDriveTurn::new(body, gains)),
            Self::Ramsete => Box::new(Ramsete::new(body, gains)),
            Self::Ltv => Box::new(LtvUnicycle::new(body, gains)),
            Self::Graceful => Box::new(Graceful::new(body, gains, true)),
            Self::GracefulOnTheWay => Box::new(Graceful::new(body, gains, false)),
            Self::PurePursuit => Box::new(PurePursuit::new(body, gains)),
            Self::Aicardi => Box::new(Aicardi::new(body, gains)),
            Self::Samson => Box::new(Samson::new(body, gains)),
            Self::TwoPids => Box::new(TwoPids::new(body, gains)),
            Self::Mpc => Box::new(Mpc::new(body, gains)),
            Self::Neural => Box::new(PaperRival::new(ControlLaw::Neural)?),
            Self::Plain => Box::new(PaperRival::new(ControlLaw::Plain)?),
            Self::RateLimits => Box::new(Orders),
            Self::Default | Self::HeadingHeld => return None,
        })
    }
}

impl Law {
    /// With its usual gains.
    pub const fn usual(kind: LawKind) -> Self {
        Self {
            kind,
            flavour: Flavour::Usual,
        }
    }

    /// All laws that have an answer to a track.
    pub fn of(track: Track) -> Vec<Self> {
        let ours = std::iter::once(Self::usual(LawKind::Default));
        let with_gains = LawKind::RIVALS.into_iter().flat_map(|kind| {
            [Flavour::Usual, Flavour::Tuned].map(|flavour| Self { kind, flavour })
        });
        match track {
            Track::Parking | Track::Files => ours.chain(with_gains).collect(),
            Track::Paper => {
                let paper = [LawKind::Neural, LawKind::Plain].map(Self::usual);
                ours.chain(with_gains).chain(paper).collect()
            }
            Track::Velocity => [LawKind::Default, LawKind::HeadingHeld, LawKind::RateLimits]
                .map(Self::usual)
                .to_vec(),
        }
    }
}

/// Velocity orders do not reach a rival.
struct Orders;

impl Rival for Orders {
    fn advance(&mut self, _: &Now, _: &Job<'_>) -> Option<Wanted> {
        None
    }
}

//! The life of a managed node, by the names and numbers of `lifecycle_msgs`.

use serde::{Deserialize, Serialize};

/// A primary state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Nothing was said to the base.
    Unconfigured,
    /// The base has its parameters and stands, without torque.
    Inactive,
    /// The base is armed and takes orders.
    Active,
    /// The end.
    Finalized,
}

impl Stage {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Unconfigured,
        Self::Inactive,
        Self::Active,
        Self::Finalized,
    ];

    const fn id(self) -> u8 {
        match self {
            Self::Unconfigured => 1,
            Self::Inactive => 2,
            Self::Active => 3,
            Self::Finalized => 4,
        }
    }

    /// Its label.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Unconfigured => "unconfigured",
            Self::Inactive => "inactive",
            Self::Active => "active",
            Self::Finalized => "finalized",
        }
    }

    /// As a message has it.
    pub fn message(self) -> StateMessage {
        StateMessage {
            id: self.id(),
            label: self.label().to_owned(),
        }
    }
}

/// What leads from one to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transition {
    /// Say hello, stop the base, give it its parameters.
    Configure,
    /// Forget that.
    CleanUp,
    /// Arm it.
    Activate,
    /// Stop it.
    Deactivate,
    /// Stop it and end.
    ShutDown,
}

/// Each with where it leads from and to, and its number there.
const TRANSITIONS: [(Transition, Stage, Stage, u8); 7] = [
    (
        Transition::Configure,
        Stage::Unconfigured,
        Stage::Inactive,
        1,
    ),
    (Transition::CleanUp, Stage::Inactive, Stage::Unconfigured, 2),
    (Transition::Activate, Stage::Inactive, Stage::Active, 3),
    (Transition::Deactivate, Stage::Active, Stage::Inactive, 4),
    (
        Transition::ShutDown,
        Stage::Unconfigured,
        Stage::Finalized,
        5,
    ),
    (Transition::ShutDown, Stage::Inactive, Stage::Finalized, 6),
    (Transition::ShutDown, Stage::Active, Stage::Finalized, 7),
];

impl Transition {
    const fn label(self) -> &'static str {
        match self {
            Self::Configure => "configure",
            Self::CleanUp => "cleanup",
            Self::Activate => "activate",
            Self::Deactivate => "deactivate",
            Self::ShutDown => "shutdown",
        }
    }

    /// Where it leads, if it leads from here.
    pub fn from(self, stage: Stage) -> Option<Stage> {
        let found = TRANSITIONS
            .iter()
            .find(|(transition, from, ..)| *transition == self && *from == stage);
        found.map(|(_, _, to, _)| *to)
    }

    /// By number, or by label where the number is 0.
    pub fn of(message: &TransitionMessage) -> Option<Self> {
        let found = TRANSITIONS.iter().find(|(transition, _, _, id)| {
            let named = message.id == 0 && message.label == transition.label();
            *id == message.id || named
        });
        found.map(|(transition, ..)| *transition)
    }

    /// As a message has it, with the stages that it leads from and to.
    pub fn event(self, from: Stage, to: Stage) -> TransitionDescription {
        let id = TRANSITIONS
            .iter()
            .find(|(transition, start, ..)| *transition == self && *start == from)
            .map_or(0, |(.., id)| *id);
        TransitionDescription {
            transition: TransitionMessage {
                id,
                label: self.label().to_owned(),
            },
            start: from.message(),
            goal: to.message(),
        }
    }

    /// Those that lead from a stage; all with none.
    pub fn all(from: Option<Stage>) -> Vec<TransitionDescription> {
        TRANSITIONS
            .iter()
            .filter(|(_, start, ..)| from.is_none_or(|from| from == *start))
            .map(|(transition, start, goal, _)| transition.event(*start, *goal))
            .collect()
    }
}

/// `lifecycle_msgs/State`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StateMessage {
    /// See [`Stage`].
    pub id: u8,
    /// For people.
    pub label: String,
}

/// `lifecycle_msgs/Transition`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TransitionMessage {
    /// See [`Transition`].
    pub id: u8,
    /// For people.
    pub label: String,
}

/// `lifecycle_msgs/TransitionDescription`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TransitionDescription {
    /// Which.
    pub transition: TransitionMessage,
    /// From.
    pub start: StateMessage,
    /// To.
    pub goal: StateMessage,
}

/// `lifecycle_msgs/TransitionEvent`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TransitionEvent {
    /// Nanoseconds.
    pub timestamp: u64,
    /// What happened.
    pub description: TransitionDescription,
}

/// A request without fields, which IDL does not have.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Nothing {
    structure_needs_at_least_one_member: u8,
}

/// A request for a transition.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChangeState {
    /// Which.
    pub transition: TransitionMessage,
}

/// Whether it was done.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Changed {
    /// It was.
    pub success: bool,
}

/// The present state.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CurrentState {
    /// It.
    pub state: StateMessage,
}

/// All states.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct States {
    /// They.
    pub states: Vec<StateMessage>,
}

/// Transitions.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Transitions {
    /// They.
    pub transitions: Vec<TransitionDescription>,
}

/// Answer of `std_srvs/Trigger`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Triggered {
    /// It was done.
    pub success: bool,
    /// Why not.
    pub message: String,
}

macro_rules! messages {
    ($($name:ident),*) => { $(impl ros2_client::Message for $name {})* };
}
messages!(
    Nothing,
    ChangeState,
    Changed,
    CurrentState,
    States,
    Transitions,
    Triggered
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transitions_are_found_by_number_and_by_label() {
        let message = |id, label: &str| TransitionMessage {
            id,
            label: label.to_owned(),
        };
        assert_eq!(Transition::of(&message(3, "")), Some(Transition::Activate));
        assert_eq!(
            Transition::of(&message(0, "cleanup")),
            Some(Transition::CleanUp)
        );
        assert_eq!(Transition::of(&message(7, "")), Some(Transition::ShutDown));
        assert_eq!(Transition::of(&message(9, "")), None);
        assert_eq!(Transition::of(&message(0, "")), None);
    }

    #[test]
    fn nothing_leads_on_from_the_end_or_skips_a_stage() {
        assert!(Transition::all(Some(Stage::Finalized)).is_empty());
        assert_eq!(Transition::Activate.from(Stage::Unconfigured), None);
        assert_eq!(
            Transition::Deactivate.from(Stage::Active),
            Some(Stage::Inactive)
        );
        assert_eq!(Transition::all(None).len(), 7);
    }
}

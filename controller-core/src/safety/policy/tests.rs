//! Every kind with every reaction.

use super::*;

#[test]
fn default_is_valid_and_with_changes_just_one_kind() {
    assert_eq!(
        PolicyParams::DEFAULT.validate(),
        Ok(ValidPolicyParams::default())
    );
    let odd = Response::latched(Reaction::Release);
    for kind in FaultKind::ALL {
        let changed = PolicyParams::DEFAULT.with(kind, odd);
        for other in FaultKind::ALL {
            let expected = if other == kind {
                odd
            } else {
                PolicyParams::DEFAULT.get(other)
            };
            assert_eq!(changed.get(other), expected, "{kind} at {other}");
        }
    }
}

/// Every kind with every reaction: refused for the reason that the fault gives.
#[test]
fn reactions_that_need_what_is_broken_are_refused_by_name() {
    use PolicyProblem as P;
    for kind in FaultKind::ALL {
        for (reaction, blind, refused, driver) in [
            (
                Reaction::Ignore,
                Some(P::MayNotBeIgnored),
                Some(P::MayNotBeIgnored),
                Some(P::NeedsDriver),
            ),
            (
                Reaction::ControlledStop,
                Some(P::NeedsMeasurement),
                Some(P::NeedsController),
                Some(P::NeedsDriver),
            ),
            (Reaction::Brake, None, None, Some(P::NeedsDriver)),
            (Reaction::Release, None, None, None),
        ] {
            let expected = match kind {
                FaultKind::MeasurementStale
                | FaultKind::NotFinite
                | FaultKind::EncoderStuck
                | FaultKind::EncoderReversed => blind,
                FaultKind::StepRefused => refused,
                FaultKind::Driver => driver,
                _ => None,
            };
            let policy = PolicyParams::DEFAULT.with(kind, Response::passing(reaction));
            let error = policy.validate().err();
            assert_eq!(
                error,
                expected.map(|problem| PolicyError { kind, problem }),
                "{kind} {reaction:?}"
            );
        }
    }
}

#[test]
fn what_is_ignored_is_never_latched() {
    let odd = Response::latched(Reaction::Ignore);
    let error = PolicyParams::DEFAULT
        .with(FaultKind::PoseJump, odd)
        .validate();
    let problem = PolicyProblem::IgnoredLatched;
    let kind = FaultKind::PoseJump;
    assert_eq!(error, Err(PolicyError { kind, problem }));
}

//! What goes wrong: what has begun, and what is still there.

use crate::campaign::expected::{GYRO_ALSO, KNOWN, Rule};
use crate::campaign::fault_injection::{FaultInjection, FaultInjectionKind, What};
use crate::campaign::host::Manner;
use crate::campaign::outcome::{Failing, Why};
use crate::campaign::plan::Plan;
use crate::mission::BaseSpec;
use crate::world::{PlantFault, World};

/// The injections of a plan: which of them have begun, and which are still there.
pub(super) struct Timeline<'a> {
    plan: &'a Plan,
    begun: [bool; 2],
    active: [bool; 2],
    /// Everything is mended: nothing is right to be found any more.
    mended: bool,
}

impl<'a> Timeline<'a> {
    pub(super) const fn new(plan: &'a Plan) -> Self {
        Self {
            plan,
            begun: [false; 2],
            active: [false; 2],
            mended: false,
        }
    }

    fn injection(&self, which: usize) -> Option<FaultInjection> {
        match which {
            0 => Some(self.plan.injection),
            _ => self.plan.second.map(|(_, injection)| injection),
        }
    }

    fn those(&self, which: impl Fn(usize) -> bool) -> impl Iterator<Item = FaultInjection> {
        [0, 1]
            .into_iter()
            .filter(move |&number| which(number))
            .filter_map(|number| self.injection(number))
    }

    /// Those that have begun, healed or not.
    pub(super) fn begun(&self) -> impl Iterator<Item = FaultInjection> {
        self.those(|which| self.begun[which])
    }

    /// Those that are there.
    pub(super) fn active(&self) -> impl Iterator<Item = FaultInjection> {
        self.those(|which| self.active[which])
    }

    pub(super) const fn is_active(&self, which: usize) -> bool {
        self.active[which]
    }

    pub(super) const fn has_begun(&self, which: usize) -> bool {
        self.begun[which]
    }

    /// Begins now; the injection, if the plan has it.
    pub(super) fn begin(&mut self, which: usize, world: &mut World) -> Option<FaultInjection> {
        self.begun[which] = true;
        self.active[which] = true;
        let injection = self.injection(which);
        if let Some(injection) = &injection {
            injection.apply(world, true);
        }
        injection
    }

    /// What has to be in place at the beginning of every tick.
    pub(super) fn apply(&self, world: &mut World) {
        for injection in self.active() {
            injection.apply(world, false);
        }
    }

    pub(super) fn heal(&mut self, which: usize, world: &mut World) {
        self.active[which] = false;
        if let Some(injection) = self.injection(which) {
            injection.heal(world);
        }
        // The other may be of the same kind.
        for injection in self.active() {
            injection.apply(world, matches!(injection.what, What::PlantFault(_)));
        }
    }

    /// From here on nothing is right to be found any more.
    pub(super) const fn all_mended(&mut self) {
        self.mended = true;
    }

    /// Whether something that has begun may be found as `why`.
    pub(super) fn allows(&self, why: Why) -> bool {
        !self.mended
            && self.begun().any(|injection| {
                let also = GYRO_ALSO
                    .iter()
                    .any(|(kind, also, _)| *kind == injection.kind && *also == why);
                Rule::of(injection.kind).allows(why) || (self.plan.gyro && also)
            })
    }

    /// Whether a failing is stated for the trouble there is.
    pub(super) fn is_known(&self, failing: Failing) -> bool {
        let injection = self.plan.injection.kind;
        !self.mended
            && KNOWN
                .iter()
                .any(|known| known.injection == injection && known.failing == failing)
    }

    /// What is wrong with host and line now.
    pub(super) fn manner(&self) -> Manner {
        hindered(self.active())
    }

    /// Share of the poses that reach the base, and how much later than they say \[s\].
    pub(super) fn poses(&self) -> (f64, f64) {
        /// A pose's frame with its delimiters.
        const BYTES: i32 = 27;
        let manner = hindered(self.begun());
        // Behind a flood a pose finds the queue full, before it does not: either every other time.
        let share: f64 = if manner.flood > 0 { 0.5 } else { 1.0 };
        let share = share.min((1.0 - manner.line.damaged).powi(BYTES));
        (share, 1.0e-6 * manner.line.delay_us as f64)
    }

    /// What the poses themselves are off by \[m, rad\]: where they are wrong a base cannot know better.
    pub(super) fn pose_offset(&self) -> (f64, f64) {
        let jumps = self.active().filter_map(|injection| match injection.what {
            What::PlantFault(PlantFault::PoseJump { dx, dy, dtheta }) => {
                Some((dx.hypot(dy), dtheta.abs()))
            }
            _ => None,
        });
        // Of two the later one acts.
        jumps.last().unwrap_or_default()
    }

    /// What a base with a gyro may be off by on top \[m, rad\]: where it carries the base without poses, 0.3 % of the way (radii) at 0.8 of its
    /// top speed for half a minute, and 30 mm and 50 mrad of scale and bias; where it is faulty, a part of what it added until then.
    pub(super) fn carried(&self, base: &BaseSpec) -> (f64, f64) {
        use FaultInjectionKind as U;
        if !self.plan.gyro {
            return (0.0, 0.0);
        }
        let lost = |kind| {
            matches!(
                kind,
                U::PoseSilent | U::PoseNan | U::FixAgeNan | U::LineDamaged
            )
        };
        if self.begun().any(|injection| lost(injection.kind)) {
            (0.03 + 0.003 * 0.8 * 30.0 * base.limits.speed, 0.05)
        } else if self
            .begun()
            .any(|injection| U::GYRO.contains(&injection.kind))
        {
            (0.0, 0.01)
        } else {
            (0.0, 0.0)
        }
    }

    /// A driver holds its torque: until its watchdog ends it, it is beyond any command.
    pub(super) fn drive_holds(&self) -> bool {
        self.active()
            .any(|injection| injection.kind == FaultInjectionKind::DriveHolds)
    }
}

fn hindered(injections: impl Iterator<Item = FaultInjection>) -> Manner {
    let mut manner = Manner::default();
    for injection in injections {
        injection.hinder(&mut manner);
    }
    manner
}

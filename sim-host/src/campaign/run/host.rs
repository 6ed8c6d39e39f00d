//! What the host does: commands, orders, goals.

use super::*;

impl Runner<'_> {
    /// Stopped beside the goal.
    pub(super) fn gave_up(&self) -> bool {
        let report = self.rig.base().report();
        report.state == State::Stopped
            && matches!(Why::of(report.cause), Why::Fault(kind) if expected::at_any_goal(kind))
    }

    /// Still trying, close to the goal.
    pub(super) fn beside(&self) -> bool {
        let (Intent::Park(goal), Some(measured)) = (self.intent, self.rig.base().report().measured)
        else {
            return false;
        };
        let (dx, dy) = (
            f64::from(measured.pose.x) - goal.x,
            f64::from(measured.pose.y) - goal.y,
        );
        let gives_up = matches!(
            Why::of(self.rig.base().report().cause),
            Why::Fault(kind) if expected::at_any_goal(kind)
        );
        (self.state() == State::Parking || gives_up) && dx.hypot(dy) < BESIDE_M
    }

    /// A command that has to be taken.
    pub(super) fn command(&mut self, event: Event) -> Checked<()> {
        self.told = true;
        match self.rig.base_mut().on(event) {
            Action::Refuse => Err(format!("{event:?} is refused in {:?}", self.state())),
            _ => Ok(()),
        }
    }

    /// Arms a base that waits, and gives it a goal.
    pub(super) fn wake(&mut self) -> Checked<()> {
        if self.state() == State::Fault {
            if self.rig.base_mut().on(Event::Arm) != Action::Refuse {
                return Err("a latched base was armed".to_owned());
            }
            self.command(Event::Reset)?;
        }
        if matches!(self.state_now(), State::Idle | State::Stopped) {
            self.command(Event::Arm)?;
        }
        self.intent = Intent::Park(self.goal_ahead());
        Ok(())
    }

    pub(super) fn state_now(&self) -> State {
        self.rig.base().supervisor().state()
    }

    pub(super) fn goal_ahead(&self) -> Pose<f64> {
        self.pose_ahead(0.6 * self.limit_speed)
    }

    pub(super) fn pose_ahead(&self, ahead: f64) -> Pose<f64> {
        let at = self
            .rig
            .base()
            .report()
            .measured
            .map_or(Pose::default(), |measured| measured.pose);
        let (x, y, theta) = (f64::from(at.x), f64::from(at.y), f64::from(at.theta));
        Pose::new(x + ahead * theta.cos(), y + ahead * theta.sin(), theta)
    }

    pub(super) fn park_ahead(&mut self) {
        let path = &self.plan.path;
        let way = path.way(self.t - self.follow_from);
        let speed = path.speed;
        let ahead = speed * speed / path.accel + 0.3 * self.limit_speed;
        self.intent = Intent::Park(path.pose(way + ahead));
    }

    pub(super) fn order(&mut self) -> Order<f32> {
        let nan = self.active_upsets().find_map(|upset| match upset.what {
            What::OrderNan { park } => Some(park),
            _ => None,
        });
        if let Some(park) = nan {
            // Once.
            for (active, upset) in [
                (0, Some(self.plan.upset)),
                (1, self.plan.second.map(|(_, upset)| upset)),
            ] {
                if upset.is_some_and(|upset| upset.kind == UpsetKind::OrderNan) {
                    self.active[active] = false;
                }
            }
            let pose = Pose::new(f32::NAN, 0.0, 0.0);
            return if park {
                Order::Park(pose)
            } else {
                match self.plan.path.at(0.0) {
                    Order::Follow(reference) => {
                        Order::Follow(controller_core::reference::Reference::new_with::<
                            controller_core::maths::Single,
                        >(
                            pose, *reference.twist(), *reference.accel()
                        ))
                    }
                    other => other,
                }
            };
        }
        let silent = self
            .active_upsets()
            .any(|upset| upset.what == What::HostSilent);
        if silent {
            return Order::None;
        }
        match self.intent {
            Intent::Quiet => {
                self.rig.base_mut().heard();
                Order::None
            }
            Intent::Follow => self.plan.path.at(self.t - self.follow_from),
            Intent::Park(goal) => Order::Park(narrow(&goal)),
        }
    }
}

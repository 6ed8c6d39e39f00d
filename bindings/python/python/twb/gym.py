"""Environments for Gymnasium: park a base by velocity orders, on the realistic plant.

An action is speed and turn rate as shares of the robot's limits. The base is the firmware's, with localiser, supervisor
and motors, in a world of its own that is drawn anew for every episode; it is seen as it believes itself to be. The goal
is the origin. `twb.gym.register()` makes them known to `gymnasium.make` and `gymnasium.make_vec` as "twb/Park-v0".
"""

from __future__ import annotations

import os
from typing import Any, TypeAlias

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from ._twb import Fleet, Robot
from .errors import InputError

__all__ = ["ParkEnv", "ParkVectorEnv", "register"]

_Floats: TypeAlias = NDArray[np.float32]
_Flags: TypeAlias = NDArray[np.bool_]

#: Parked: within this of the goal [m, rad], slower than that [m/s, rad/s].
PARKED = (0.02, 0.05, 0.02, 0.05)
#: Farther than this from the goal [m] an episode is over.
FAR_M = 10.0
#: Farthest start in x and in y [m]: in the corner of the square it is nearer than `FAR_M`.
START_M = 7.0
#: States of the supervisor in which orders are not obeyed any more.
STOPPED = ("stopping", "braking", "stopped", "fault")


class _Course:
    """What both environments have in common: spaces, starts, what is seen, rewards."""

    def __init__(
        self,
        size: int,
        robot: Robot | str | os.PathLike[str],
        world: str,
        start_m: float,
        act_s: float,
        longest_s: float,
        threads: int | None,
    ) -> None:
        # An action is one call that nothing stops.
        for key, value, least, most in (
            ("start_m", start_m, 0.0, START_M),
            ("act_s", act_s, 1e-4, 10.0),
            ("longest_s", longest_s, 1e-4, 1e6),
        ):
            if not least <= value <= most:
                raise InputError.at(f"{key} must be a number in {least} to {most}", key=key)
        self.robot = robot if isinstance(robot, Robot) else Robot.load(robot)
        self.fleet = Fleet(self.robot, size, world, threads)
        self.size, self.start_m = size, start_m
        self.ticks = max(1, round(act_s / self.robot.period_s))
        # Counted, not timed: ticks come somewhat early and late.
        self.longest = max(1, round(longest_s / (self.ticks * self.robot.period_s)))
        self.acts: NDArray[np.int64] = np.zeros(size, np.int64)
        limits = self.robot.limits
        self.most = np.array([limits["speed"], limits["turn_rate"]])
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        # Where the goal is from the base's own view [m], the heading left to turn as cosine and sine, and the twist as
        # shares of the limits; a base that skids turns faster than its limit.
        high = np.array([2 * FAR_M, 2 * FAR_M, 1, 1, 10, 10], np.float32)
        self.observation_space = spaces.Box(-high, high, dtype=np.float32)
        self.began_s: NDArray[np.float64] = np.full(size, np.nan)
        self.cost: NDArray[np.float64] = np.zeros(size)

    def begin(self, random: np.random.Generator, which: NDArray[np.int64]) -> None:
        """New episodes: at rest, in x and in y within `start_m` of the goal, with any heading, in a new world."""
        count = len(which)
        if count == 0:
            return
        starts = np.column_stack(
            [
                random.uniform(-self.start_m, self.start_m, (count, 2)),
                random.uniform(-np.pi, np.pi, count),
            ]
        )
        seeds = random.integers(0, 2**32, count, dtype=np.uint64)
        self.fleet.reset(which, starts, seeds)
        seen = self.fleet.observe()
        self.began_s[which] = seen["time_s"][which]
        self.acts[which] = 0
        self.cost[which] = self._cost(seen["believed"])[which]

    @staticmethod
    def _cost(believed: NDArray[np.float64]) -> NDArray[np.float64]:
        """What is left to do: the distance [m], and the heading at a quarter of a metre for a radian."""
        x, y, theta = believed[:, 0], believed[:, 1], believed[:, 2]
        return np.hypot(x, y) + 0.25 * np.abs(np.arctan2(np.sin(theta), np.cos(theta)))

    def seen(self, believed: NDArray[np.float64]) -> _Floats:
        """Rows of the observation space."""
        x, y, theta, v, w = believed.T
        cos, sin = np.cos(theta), np.sin(theta)
        rows = [-x * cos - y * sin, x * sin - y * cos, cos, -sin, v / self.most[0], w / self.most[1]]
        space = self.observation_space
        seen: _Floats = np.clip(np.column_stack(rows), space.low, space.high).astype(np.float32)
        return seen

    def act(self, actions: NDArray[Any]) -> dict[str, NDArray[Any]]:
        """One action of each member: what is seen then, rewards, and whose episodes are over."""
        if np.isnan(self.began_s).any():
            raise ResetNeeded("call reset before step: a base has no world yet")
        given = np.asarray(actions, np.float64)
        if given.size != 2 * self.size or np.isnan(given).any():
            raise InputError.at(f"an action is 2 numbers for each of {self.size} bases, not {given}", key="action")
        shares = np.clip(given.reshape(self.size, 2), -1.0, 1.0)
        self.fleet.step(np.ascontiguousarray(shares * self.most), self.ticks)
        seen = self.fleet.observe()
        believed, state = seen["believed"], seen["state"]
        theta = np.arctan2(np.sin(believed[:, 2]), np.cos(believed[:, 2]))
        off = np.column_stack([np.hypot(believed[:, 0], believed[:, 1]), theta, believed[:, 3:5]])
        parked = np.all(np.abs(off) < PARKED, axis=1)
        lost = (off[:, 0] > FAR_M) | np.isin(state, STOPPED)
        cost = self._cost(believed)
        # The way that was made, less a little for time; the shares of both actions do not change what is best.
        rewards = self.cost - cost - 0.01 + 10.0 * parked - 10.0 * (lost & ~parked)
        self.cost = cost
        self.acts += 1
        return {
            "observations": self.seen(believed),
            "rewards": rewards,
            "terminated": parked | lost,
            "truncated": (self.acts >= self.longest) & ~(parked | lost),
            "parked": parked,
            "truth": seen["truth"],
            "state": state,
            "time_s": seen["time_s"] - self.began_s,
        }

    def now(self) -> _Floats:
        """What is seen now."""
        return self.seen(self.fleet.observe()["believed"])


class ParkEnv(gymnasium.Env[_Floats, _Floats]):
    """One base. `info` has its true pose and twist, the supervisor's state and the time."""

    metadata = {"render_modes": []}

    def __init__(
        self,
        robot: Robot | str | os.PathLike[str] = "lab-10kg",
        world: str = "drawn",
        start_m: float = 2.0,
        act_s: float = 0.1,
        longest_s: float = 30.0,
        render_mode: str | None = None,
    ) -> None:
        self._course = _Course(1, robot, world, start_m, act_s, longest_s, 1)
        self.action_space = self._course.action_space
        self.observation_space = self._course.observation_space
        self.render_mode = render_mode

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[_Floats, dict[str, Any]]:
        super().reset(seed=seed)
        self._course.begin(self.np_random, np.zeros(1, np.int64))
        return self._course.now()[0], {}

    def step(self, action: _Floats) -> tuple[_Floats, float, bool, bool, dict[str, Any]]:
        acted = self._course.act(action)
        info = {key: acted[key][0] for key in ("parked", "truth", "state", "time_s")}
        return (
            acted["observations"][0],
            float(acted["rewards"][0]),
            bool(acted["terminated"][0]),
            bool(acted["truncated"][0]),
            info,
        )


class ParkVectorEnv(VectorEnv[_Floats, _Floats, NDArray[Any]]):
    """n bases side by side, on all cores.

    By default an episode that is over begins anew in the next step, which ignores its action: the last observation of
    an episode is returned as any other. With `AutoresetMode.SAME_STEP` it begins anew at once, and the last observation
    and what was said of it are in `infos["final_obs"]` and `infos["final_info"]`. With `DISABLED` the caller resets,
    by `options={"reset_mask": ...}`.
    """

    def __init__(
        self,
        num_envs: int,
        robot: Robot | str | os.PathLike[str] = "lab-10kg",
        world: str = "drawn",
        start_m: float = 2.0,
        act_s: float = 0.1,
        longest_s: float = 30.0,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int | None = None,
    ) -> None:
        self._course = _Course(num_envs, robot, world, start_m, act_s, longest_s, threads)
        self._mode = AutoresetMode(autoreset_mode)
        self.num_envs = num_envs
        self.metadata = {"render_modes": [], "autoreset_mode": self._mode}
        self.single_action_space = self._course.action_space
        self.single_observation_space = self._course.observation_space
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._over: _Flags = np.zeros(num_envs, bool)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[_Floats, dict[str, Any]]:
        if isinstance(seed, list):
            raise TypeError("one seed settles all: worlds and starts are drawn from it in turn")
        super().reset(seed=seed)
        mask = np.asarray((options or {}).get("reset_mask", np.ones(self.num_envs, bool)), bool)
        if mask.shape != (self.num_envs,):
            raise InputError.at(f"reset_mask must have {self.num_envs} flags", key="reset_mask")
        self._course.begin(self.np_random, np.flatnonzero(mask))
        self._over &= ~mask
        return self._course.now(), {}

    def step(
        self, actions: _Floats
    ) -> tuple[_Floats, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        begins = self._over.copy()
        if self._mode is AutoresetMode.DISABLED and begins.any():
            raise RuntimeError("an episode is over: reset it with options={'reset_mask': ...}")
        acted = self._course.act(actions)
        terminated, truncated = acted["terminated"], acted["truncated"]
        rewards = acted["rewards"]
        infos: dict[str, Any] = {key: acted[key] for key in ("parked", "truth", "state", "time_s")}
        infos |= {f"_{key}": np.ones(self.num_envs, bool) for key in tuple(infos)}
        observations = acted["observations"]
        if self._mode is AutoresetMode.NEXT_STEP:
            # The step of a base whose episode was over is the beginning of its next one.
            rewards, terminated, truncated = (
                np.where(begins, 0, value).astype(value.dtype)
                for value in (rewards, terminated, truncated)
            )
            self._course.begin(self.np_random, np.flatnonzero(begins))
            if begins.any():
                observations = np.where(begins[:, None], self._course.now(), observations)
        over = terminated | truncated
        if self._mode is AutoresetMode.SAME_STEP:
            if over.any():
                last = np.full(self.num_envs, None, object)
                for index in np.flatnonzero(over):
                    last[index] = observations[index]
                infos |= {"final_obs": last, "_final_obs": over}
                final = {key: value for key, value in infos.items() if "final" not in key}
                infos |= {"final_info": final, "_final_info": over}
                self._course.begin(self.np_random, np.flatnonzero(over))
                observations = np.where(over[:, None], self._course.now(), observations)
        else:
            self._over = over
        return observations, rewards, terminated, truncated, infos


def register() -> None:
    """Makes "twb/Park-v0" known to `gymnasium.make` and `gymnasium.make_vec(..., vectorization_mode="vector_entry_point")`."""
    gymnasium.register(
        id="twb/Park-v0",
        entry_point="twb.gym:ParkEnv",
        vector_entry_point="twb.gym:ParkVectorEnv",
    )

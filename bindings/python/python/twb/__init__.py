"""Motion control and simulation of two-wheeled robots.

The simulator and the base of the firmware, the same source that runs on the chip: what is computed here is bit for bit
what the command line computes. SI units, radians, right before left; counter-clockwise is positive.

    >>> import twb
    >>> run = twb.simulate(start=(0, 0.5, 0), goal=(2, 1, 0), robot="lab-10kg")
    >>> bool(abs(run["x"][-1] - 2) < 0.005)
    True
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _twb, errors
from ._twb import (
    ROBOTS,
    SCENARIOS,
    Campaign,
    Figure,
    Identification,
    Mission,
    Robot,
    Run,
    Trajectory,
    Tuned,
    Verification,
    __version__,
)
from .errors import Error, InputError, MissingFileError, RunError

__all__ = [
    "ROBOTS",
    "SCENARIOS",
    "Campaign",
    "Error",
    "Figure",
    "Identification",
    "InputError",
    "MissingFileError",
    "Mission",
    "Robot",
    "Run",
    "RunError",
    "Trajectory",
    "Tuned",
    "Verification",
    "__version__",
    "errors",
    "faults",
    "identify",
    "import_trajectory",
    "missions",
    "outcomes",
    "simulate",
    "tune",
    "verify",
]

Path: TypeAlias = "str | os.PathLike[str]"
#: A robot, its file, or the name of a shipped one.
AnyRobot: TypeAlias = "Robot | Path"
#: A mission; a scenario or trajectory file; the name of a shipped scenario; a trajectory.
AnyMission: TypeAlias = "Mission | Trajectory | Path"
#: Called with what is done and what there is to do, some twenty times a second.
Progress: TypeAlias = "Callable[[int, int], object]"


def _robot(robot: AnyRobot) -> Robot:
    if isinstance(robot, Robot):
        return robot
    if isinstance(robot, (str, os.PathLike)):
        return Robot.load(robot)
    raise InputError.at(f"robot must be a Robot, its file or the name of a shipped one, not {robot!r}", key="robot")


def _numbers(key: str, what: str, value: object) -> NDArray[np.float64]:
    try:
        return np.asarray(value, np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError.at(f"{key} must be {what}: {error}", key=key) from error


def _poses(key: str, value: object) -> NDArray[np.float64]:
    what = "a pose (x, y, theta), or rows of them"
    poses = _numbers(key, what, value)
    if poses.ndim not in (1, 2) or poses.shape[-1] != 3:
        raise InputError.at(f"{key} must be {what}", key=key)
    return poses


def _seeds(value: object) -> NDArray[np.uint64]:
    try:
        seeds = np.asarray(value, np.uint64)
        # Conversion alone takes 1.5 for 1 and, of arrays, -1 for the largest.
        if seeds.ndim < 2 and np.all(seeds == np.asarray(value, object)):
            return seeds
    except (TypeError, ValueError, OverflowError):
        pass
    raise InputError.at("seed must be a whole number in 0 to 2**64 - 1, or a row of them", key="seed")


def _words(words: Iterable[str]) -> list[str]:
    return [words] if isinstance(words, str) else list(words)


def import_trajectory(path: Path) -> Trajectory:
    """Reads a trajectory file: WPILib, Choreo, TUM or CSV; its content tells which."""
    return Trajectory.load(path)


def missions(
    *,
    start: ArrayLike,
    goal: ArrayLike,
    robot: AnyRobot | None = None,
    world: str | None = None,
    seed: ArrayLike = 1,
    **options: Any,
) -> list[Mission]:
    """Ways from rest at `start` to `goal`: poses (x, y, theta), or n of them in rows. What is there once is for all.

    `world` is None for the ideal plant, "even" for the robot's own hardware on a perfect floor, and one of the bad
    floors of `verify`: "drawn", "light", "heavy", "wide", "narrow", "low-battery"; `seed` settles what is drawn.
    """
    robot = None if robot is None else _robot(robot)
    starts, goals = np.atleast_2d(_poses("start", start), _poses("goal", goal))
    seeds = np.atleast_1d(_seeds(seed))
    try:
        (count,) = np.broadcast_shapes(starts.shape[:1], goals.shape[:1], seeds.shape)
    except ValueError:
        message = f"{len(starts)} starts, {len(goals)} goals and {seeds.size} seeds do not match"
        raise InputError.at(message, key="start") from None
    starts, goals = (np.broadcast_to(poses, (count, 3)) for poses in (starts, goals))
    rows = zip(starts.tolist(), goals.tolist(), np.broadcast_to(seeds, (count,)).tolist())
    return [
        Mission.park(start, goal, robot=robot, world=world, seed=seed, **options)
        for start, goal, seed in rows
    ]


def _mission(what: AnyMission, robot: Robot | None, options: Mapping[str, Any]) -> Mission:
    if isinstance(what, Mission):
        if robot is not None or options:
            raise InputError.at("a Mission has its robot and options already", key="robot")
        return what
    if isinstance(what, Trajectory):
        return Mission.follow(what, robot=robot, **options)
    if isinstance(what, (str, os.PathLike)):
        return Mission.load(what, robot=robot, **options)
    raise _unknown(what)


def _unknown(what: object) -> InputError:
    message = f"what must be missions, trajectories, files or names of scenarios, not {what!r}"
    return InputError.at(message, key="what")


def _planned(
    what: AnyMission | Sequence[AnyMission] | None, robot: AnyRobot | None, options: dict[str, Any]
) -> tuple[list[Mission], bool]:
    """The missions, and whether it is a single one."""
    robot = None if robot is None else _robot(robot)
    if what is None:
        if "start" not in options or "goal" not in options:
            raise InputError.at("what is to be run, or start and goal?", key="what")
        several = any(_poses(key, options[key]).ndim > 1 for key in ("start", "goal"))
        several = several or _seeds(options.get("seed", 1)).ndim > 0
        return missions(robot=robot, **options), not several
    if isinstance(what, (Mission, Trajectory, str, os.PathLike)):
        return [_mission(what, robot, options)], True
    if not isinstance(what, Iterable):
        raise _unknown(what)
    return [_mission(one, robot, options) for one in what], False


@overload
def simulate(
    what: AnyMission,
    *,
    robot: AnyRobot | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> Run: ...
@overload
def simulate(
    what: Sequence[AnyMission],
    *,
    robot: AnyRobot | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> list[Run]: ...
@overload
def simulate(
    *,
    start: tuple[float, float, float],
    goal: tuple[float, float, float],
    robot: AnyRobot | None = None,
    seed: int = 1,
    threads: int | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> Run: ...
@overload
def simulate(
    *,
    start: ArrayLike,
    goal: ArrayLike,
    robot: AnyRobot | None = None,
    seed: ArrayLike = 1,
    threads: int | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> Run | list[Run]: ...
def simulate(
    what: AnyMission | Sequence[AnyMission] | None = None,
    *,
    robot: AnyRobot | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> Run | list[Run]:
    """Runs a mission, or many side by side on all cores.

    `what` is a shipped scenario, a scenario or trajectory file, a trajectory, a mission, or a sequence of these. Without
    it the robot goes from `start` to `goal`: see `missions`, which has the other options, and `Mission.load` for those
    of files. One mission gives a `Run`, several a list in their order.
    """
    planned, single = _planned(what, robot, options)
    runs = _twb.run_all(planned, threads, progress)
    return runs[0] if single else runs


def outcomes(
    what: AnyMission | Sequence[AnyMission] | None = None,
    *,
    robot: AnyRobot | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> dict[str, NDArray[Any]]:
    """As `simulate`, for runs by the thousand: the last row of each trace, an array for each column.

    Beside the columns, `ticks` has the length of each run and `parked_s` the time from which on it was parked, not a
    number if it was not at the end.
    """
    planned, _ = _planned(what, robot, options)
    return _twb.finish_all(planned, threads, progress)


def tune(
    robot: AnyRobot,
    *,
    trajectory: Trajectory | Path | None = None,
    evaluations: int = 240,
    seed: int = 1,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Tuned:
    """Searches gains in worlds drawn around the robot, and compares them in worlds that the search did not see."""
    if trajectory is not None and not isinstance(trajectory, Trajectory):
        trajectory = Trajectory.load(trajectory)
    return _twb.tune(_robot(robot), trajectory, evaluations, seed, threads, progress)


def verify(
    robot: AnyRobot,
    *,
    seeds: int = 10,
    seed: int = 1,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Verification:
    """Whether a robot does its courses on bad floors: line, curve and park in six kinds of worlds, `seeds` of each."""
    return _twb.verify(_robot(robot), seeds, seed, threads, progress)


def identify(
    log: Path | Mapping[str, ArrayLike],
    *,
    counts_per_turn: float | None = None,
    known: Mapping[str, float | str] | Iterable[str] = (),
    latency_s: float = 0.0,
    slow_rad_s: float | None = None,
) -> Identification:
    """Lengths, masses, friction and motor constants from the log of a drive: a CSV file, or its columns as arrays.

    Where an array is not a number, nothing was measured. `known` has what is stated, such as {"mass": 9.8} or
    {"efficiency": "0.8+-0.05"}.
    """
    if isinstance(log, Mapping):
        # Floats are written so that they read back as the same ones.
        what = "columns of numbers by their names, one axis each"
        columns = [_numbers("log", what, column).tolist() for column in log.values()]
        if any(not isinstance(name, str) for name in log) or any(np.ndim(column) != 1 for column in columns):
            raise InputError.at(f"log must be {what}", key="log")
        if len({len(column) for column in columns}) > 1:
            raise InputError.at("the columns of the log have different lengths", key="log")
        rows = (",".join("" if cell != cell else repr(cell) for cell in row) for row in zip(*columns))
        text, file = "\n".join([",".join(log), *rows]).encode(), "log"
    else:
        file = os.fspath(log)
        try:
            with open(file, "rb") as opened:
                text = opened.read()
        except OSError as error:
            kind = MissingFileError if isinstance(error, FileNotFoundError) else InputError
            raise kind.at(f"{file}: cannot be read: {error}", file=file) from error
    if isinstance(known, Mapping):
        known = [f"{name}={value}" for name, value in known.items()]
    return _twb.identify(text, file, _words(known), counts_per_turn, latency_s, slow_rad_s)


def faults(
    runs: int = 1000,
    *,
    robot: AnyRobot | None = None,
    seed: int = 1,
    only: Iterable[str] = (),
    gyro: bool = False,
    first: int = 0,
    shard: tuple[int, int] | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Campaign:
    """The fault campaign: random trouble in every state, on the realistic plant.

    On `robot`; without one on the three built-in bases in turn, with gyros if `gyro`.

    With `shard` = (index, count) only that part of it, counted from 0; `Campaign.merge` puts the parts together. The
    bytes of the whole do not depend on how many there were.
    """
    robot = None if robot is None else _robot(robot)
    return _twb.faults(robot, runs, seed, _words(only), gyro, first, shard, threads, progress)

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Campaign",
    "Figure",
    "Fleet",
    "Identification",
    "Mission",
    "ROBOTS",
    "Robot",
    "Run",
    "SCENARIOS",
    "Trajectory",
    "Tuned",
    "Verification",
    "__version__",
    "faults",
    "finish_all",
    "identify",
    "run_all",
    "tune",
    "verify",
]

__version__: Final[str]
ROBOTS: Final[tuple[str, ...]]
SCENARIOS: Final[tuple[str, ...]]

_Path: TypeAlias = str | os.PathLike[str]
_Progress: TypeAlias = Callable[[int, int], object]
_Array: TypeAlias = NDArray[Any]
_Floats: TypeAlias = NDArray[np.float64]
_Numbers: TypeAlias = Sequence[float] | NDArray[np.floating[Any] | np.integer[Any]]

@final
class Robot:
    @staticmethod
    def load(path: _Path) -> Robot: ...
    @staticmethod
    def parse(text: str, file: str = "robot.toml") -> Robot: ...
    @property
    def name(self) -> str: ...
    @property
    def description(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def period_s(self) -> float: ...
    @property
    def limits(self) -> dict[str, float]: ...
    @property
    def gains(self) -> dict[str, float]: ...
    def with_gains(self, gains: Mapping[str, float]) -> Robot: ...
    def constants(self, language: str = "rust") -> str: ...

@final
class Trajectory:
    @staticmethod
    def load(path: _Path, *, tolerance_m: float | None = None) -> Trajectory: ...
    @staticmethod
    def parse(content: bytes, file: str = "trajectory", *, tolerance_m: float | None = None) -> Trajectory: ...
    @property
    def name(self) -> str: ...
    @property
    def format(self) -> str: ...
    @property
    def duration_s(self) -> float: ...
    @property
    def figures(self) -> dict[str, float]: ...
    @property
    def repairs(self) -> list[str]: ...
    @property
    def closeness(self) -> tuple[float, float]: ...
    @property
    def report(self) -> str: ...
    @property
    def samples(self) -> dict[str, _Floats]: ...
    def at(self, times: _Numbers) -> dict[str, _Floats]: ...
    def scaled(
        self, robot: Robot | None = None, *, fastest: bool = False, tolerance_m: float | None = None
    ) -> tuple[Trajectory, str]: ...

@final
class Mission:
    @staticmethod
    def load(
        path: _Path,
        *,
        robot: Robot | None = None,
        law: str | None = None,
        world: str | None = None,
        seed: int = 1,
        offset_m: float | None = None,
        fastest: bool = False,
        tolerance_m: float | None = None,
        precision: str = "f32",
        period_s: float | None = None,
    ) -> Mission: ...
    @staticmethod
    def parse(
        text: str,
        file: str = "scenario.toml",
        *,
        robot: Robot | None = None,
        law: str | None = None,
        world: str | None = None,
        seed: int = 1,
    ) -> Mission: ...
    @staticmethod
    def follow(
        trajectory: Trajectory,
        *,
        robot: Robot | None = None,
        world: str | None = None,
        seed: int = 1,
        offset_m: float | None = None,
        fastest: bool = False,
        tolerance_m: float | None = None,
        precision: str = "f32",
        period_s: float | None = None,
    ) -> Mission: ...
    @staticmethod
    def park(
        start: Sequence[float],
        goal: Sequence[float],
        *,
        robot: Robot | None = None,
        world: str | None = None,
        seed: int = 1,
        precision: str = "f32",
        period_s: float | None = None,
        longest_s: float = 60.0,
    ) -> Mission: ...
    @property
    def name(self) -> str: ...
    @property
    def description(self) -> str: ...
    @property
    def law(self) -> str: ...
    @property
    def warnings(self) -> list[str]: ...

@final
class Run:
    @property
    def name(self) -> str: ...
    @property
    def mission(self) -> Mission: ...
    @property
    def columns(self) -> list[str]: ...
    @property
    def units(self) -> dict[str, str]: ...
    @property
    def trace(self) -> dict[str, _Array]: ...
    def __getitem__(self, key: str, /) -> _Array: ...
    def __len__(self) -> int: ...
    def csv(self, every: int = 1) -> bytes: ...
    def json(self) -> str: ...
    @property
    def metrics(self) -> dict[str, Any]: ...
    @property
    def summary(self) -> str: ...
    def figure(self, other: Run | None = None) -> Figure: ...
    def _repr_svg_(self) -> str: ...

@final
class Figure:
    @property
    def svg(self) -> str: ...
    @property
    def png(self) -> bytes: ...
    def _repr_svg_(self) -> str: ...
    def _repr_png_(self) -> bytes: ...

@final
class Tuned:
    @property
    def robot(self) -> Robot: ...
    @property
    def gains(self) -> tuple[dict[str, float], dict[str, float]]: ...
    @property
    def training(self) -> tuple[dict[str, float], dict[str, float]]: ...
    @property
    def unseen(self) -> tuple[dict[str, float], dict[str, float]]: ...
    @property
    def scores(self) -> tuple[float, float]: ...
    @property
    def report(self) -> str: ...

@final
class Verification:
    @property
    def passed(self) -> bool: ...
    @property
    def rows(self) -> dict[str, _Array]: ...
    @property
    def cases(self) -> list[dict[str, Any]]: ...
    def csv(self) -> bytes: ...
    @property
    def report(self) -> str: ...
    def worst(self) -> Run: ...

@final
class Identification:
    @property
    def quantities(self) -> list[dict[str, Any]]: ...
    @property
    def combinations(self) -> list[dict[str, Any]]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def report(self) -> str: ...
    def json(self) -> str: ...
    def update(self, text: str = "") -> tuple[str, list[str]]: ...

@final
class Campaign:
    @property
    def seed(self) -> int: ...
    def __len__(self) -> int: ...
    @property
    def rows(self) -> dict[str, _Array]: ...
    @property
    def violations(self) -> list[str]: ...
    @property
    def cells(self) -> list[dict[str, Any]]: ...
    @property
    def report(self) -> str: ...
    def csv(self) -> bytes: ...
    def json(self) -> str: ...
    @staticmethod
    def merge(parts: Sequence[Campaign]) -> Campaign: ...
    def to_bytes(self) -> bytes: ...
    @staticmethod
    def from_bytes(bytes: bytes) -> Campaign: ...

@final
class Fleet:
    def __new__(
        cls, robot: Robot, size: int, world: str = "drawn", threads: int | None = None
    ) -> Fleet: ...
    def __len__(self) -> int: ...
    def reset(
        self, which: NDArray[np.int64], starts: _Floats, seeds: NDArray[np.uint64]
    ) -> None: ...
    def step(self, twists: _Floats, ticks: int) -> None: ...
    def observe(self) -> dict[str, _Array]: ...

def run_all(
    missions: Sequence[Mission], threads: int | None = None, progress: _Progress | None = None
) -> list[Run]: ...
def finish_all(
    missions: Sequence[Mission], threads: int | None = None, progress: _Progress | None = None
) -> dict[str, _Array]: ...
def tune(
    robot: Robot,
    trajectory: Trajectory | None = None,
    evaluations: int = 240,
    seed: int = 1,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> Tuned: ...
def verify(
    robot: Robot,
    seeds: int,
    seed: int = 1,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> Verification: ...
def identify(
    text: bytes,
    file: _Path,
    statements: Sequence[str],
    counts_per_turn: float | None = None,
    latency_s: float = 0.0,
    slow_rad_s: float | None = None,
) -> Identification: ...
def faults(
    robot: Robot | None = None,
    runs: int = 1000,
    seed: int = 1,
    only: Sequence[str] = ...,
    gyro: bool = False,
    first: int = 0,
    shard: tuple[int, int] | None = None,
    threads: int | None = None,
    progress: _Progress | None = None,
) -> Campaign: ...

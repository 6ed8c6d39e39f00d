"""Studies: faults in shards, verify, tune, identify; the wheel itself; docs and examples."""

from __future__ import annotations

import importlib.util
import json
import os
import pathlib
import pickle
import re
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from conftest import ROOT, WHEELS, command_line

import twb

RUNS = 60


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> tuple[bytes, str]:
    """The command line's campaign."""
    out = tmp_path_factory.mktemp("faults")
    command_line("faults", "--runs", str(RUNS), "--seed", "7", out=out)
    return (out / "faults.csv").read_bytes(), (out / "faults.json").read_text()


@pytest.mark.parametrize("count", [1, 2, 7, 64])
def test_any_number_of_shards_gives_the_same_bytes(count: int, campaign: tuple[bytes, str]) -> None:
    parts = [twb.faults(RUNS, seed=7, shard=(i, count)) for i in range(count)]
    # From other processes, and in any order.
    parts = [pickle.loads(pickle.dumps(part)) for part in reversed(parts)]
    merged = twb.Campaign.merge(parts)
    assert (merged.csv(), merged.json()) == campaign
    assert sum(len(part) for part in parts) == len(merged) == RUNS
    assert merged.rows["run"].tolist() == list(range(RUNS))
    assert len(merged.cells) > 5 and merged.seed == 7
    assert merged.rows["at_s"].dtype.kind == "f" and merged.rows["trouble"].dtype.kind == "U"
    if count > 1:
        with pytest.raises(twb.InputError, match="missing or there twice"):
            twb.Campaign.merge([parts[0], *parts[2:]])
        with pytest.raises(twb.InputError, match="missing or there twice"):
            twb.Campaign.merge([*parts, max(parts, key=len)])
        with pytest.raises(twb.InputError, match="several campaigns"):
            twb.Campaign.merge([*parts, twb.faults(RUNS, seed=8, shard=(0, count))])


def test_a_campaign_on_one_robot_is_the_command_lines(tmp_path: pathlib.Path) -> None:
    command_line("faults", "hobby-1kg", "--runs", "20", "--seed", "7", out=tmp_path)
    parts = [twb.faults(20, robot="hobby-1kg", seed=7, shard=(i, 2)) for i in range(2)]
    merged = twb.Campaign.merge([pickle.loads(pickle.dumps(part)) for part in parts])
    assert merged.csv() == (tmp_path / "hobby-1kg-faults.csv").read_bytes()
    assert merged.json() == (tmp_path / "hobby-1kg-faults.json").read_text()
    assert set(merged.rows["base"]) == {"hobby-1kg"}


def test_verification_is_the_command_lines(tmp_path: pathlib.Path) -> None:
    printed = command_line("verify", "hobby-1kg", "--seeds", "1", "--seed", "5", out=tmp_path)
    found = twb.verify("hobby-1kg", seeds=1, seed=5)
    assert found.csv() == (tmp_path / "hobby-1kg-verify.csv").read_bytes()
    assert found.worst().csv() == (tmp_path / "hobby-1kg-verify-worst.csv").read_bytes()
    record = json.loads((tmp_path / "hobby-1kg-verify.json").read_text())[0]
    assert found.cases == record["cases"] and found.passed == record["passed"]
    assert len(found.rows["seed"]) == 18 and set(found.rows["seed"]) == {5}
    assert found.report in printed and "least damping" in found.report
    assert ("PASS" in found.report) == found.passed


def test_tuning_is_the_command_lines(tmp_path: pathlib.Path) -> None:
    printed = command_line("tune", "hobby-1kg", "--evaluations", "4", "--seed", "3", out=tmp_path)
    calls: list[tuple[int, int]] = []
    found = twb.tune(
        "hobby-1kg", evaluations=4, seed=3, progress=lambda *done: calls.append(done)
    )
    record = json.loads((tmp_path / "hobby-1kg-tune.json").read_text())[0]
    assert found.gains == (record["gains_before"], record["gains_after"])
    assert list(found.training) == record["training"] and list(found.unseen) == record["unseen"]
    assert found.scores == tuple(sum(score.values()) for score in record["unseen"])
    assert found.robot.gains == record["gains_after"]
    assert found.report in printed and "least damping of following" in found.report
    assert calls and all(total == 4 for _, total in calls)


WEAVING = """
[run]
duration = 20.0
period = 0.01
[controller]
kind = "motion"
[reference]
v = { v0 = 0.8, v1 = 0.4, Ov = 1.3 }
w = { w0 = 0.2, w1 = 0.8, Ow = 0.9 }
"""


@pytest.fixture(scope="module")
def log() -> dict[str, np.ndarray]:
    """A drive of the ideal plant: what acts on the wheels, how far they turned, where the robot was.

    Torques are held from row to row, so that the mean of two speeds is the speed between them. Wheels and body are
    those of the paper's robot.
    """
    run = twb.simulate(twb.Mission.parse(WEAVING, "weaving.toml"))
    radius, track = 0.1, 0.5
    t, v, w = run["t"], run["v"], run["w"]
    log = {"t": t, "torque_right": run["tau_right"], "torque_left": run["tau_left"]}
    for side, sign in (("right", 1), ("left", -1)):
        speed = (v + sign * 0.5 * track * w) / radius
        turned = 0.5 * np.diff(t) * (speed[1:] + speed[:-1])
        log[f"angle_{side}"] = np.concatenate([[0], np.cumsum(turned)])
    fixes = np.arange(len(t)) % 20 != 0
    for name in ("x", "y", "theta"):
        log[name] = np.where(fixes, np.nan, run[name])
    return log


def test_a_log_gives_back_the_robot(log: dict[str, np.ndarray], tmp_path: pathlib.Path) -> None:
    found = twb.identify(log)
    values = {entry["name"]: entry for entry in found.quantities}
    truth = {"mass": 30.0, "inertia": 15.0, "radius_right": 0.1, "radius_left": 0.1, "track": 0.5}
    for name, true in truth.items():
        entry = values[name]
        assert entry["verdict"] == "identified", found.report
        assert abs(entry["value"] - true) < 0.01 * true, entry
    # The same from a file, in Python and on the command line.
    path = tmp_path / "drive.csv"
    rows = zip(*(column.tolist() for column in log.values()))
    lines = [",".join("" if x != x else repr(x) for x in row) for row in rows]
    path.write_text("\n".join([",".join(log), *lines, ""]))
    assert twb.identify(path).json() == found.json()
    command_line("identify", str(path), out=tmp_path)
    assert (tmp_path / "drive-identify.json").read_text() == found.json()
    text, _ = found.update()
    assert "[robot]" in text
    stated = twb.identify(log, known={"mass": 30.0})
    assert {e["name"]: e for e in stated.quantities}["mass"]["verdict"] == "stated"
    with pytest.raises(twb.InputError) as caught:
        twb.identify(log | {"angle_left": np.where(log["t"] > 1, np.nan, log["angle_left"])})
    assert caught.value.key == "angle_left" and caught.value.line is not None


def test_the_wheel_is_small_and_for_every_python() -> None:
    (wheel,) = WHEELS.glob("*.whl")
    assert "-cp310-abi3-" in wheel.name
    size = wheel.stat().st_size
    print(f"{size / 1e6:.2f} MB")
    # 3 MB were asked for. It may not grow (2.12 MB, with the reports and warnings of the command line): docs/python.md says what it is made of.
    assert size <= 2_140_000
    # Such as a bill of materials that names folders of the machine that built it.
    assert not [name for name in zipfile.ZipFile(wheel).namelist() if "sboms" in name]


def blocks() -> list[str]:
    text = (ROOT / "docs" / "python.md").read_text()
    return re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def test_the_examples_of_the_docs_run(tmp_path: pathlib.Path) -> None:
    """One after the other, in one program, as a reader would."""
    program = "\n".join(blocks())
    assert len(blocks()) >= 8
    for name in ("wpilib_gaps.json",):
        (tmp_path / name).write_bytes((ROOT / "sim-host/tests/fixtures" / name).read_bytes())
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", program],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr


def test_the_docstrings_examples_hold() -> None:
    import doctest

    results = doctest.testmod(twb)
    assert results.attempted >= 3 and results.failed == 0


@pytest.mark.skipif(importlib.util.find_spec("ray") is None, reason="no ray for this machine")
def test_the_campaign_on_ray_gives_the_same_bytes(
    tmp_path: pathlib.Path, campaign: tuple[bytes, str]
) -> None:
    example = ROOT / "bindings" / "python" / "examples" / "faults_on_ray.py"
    arguments = ["--runs", str(RUNS), "--seed", "7", "--shards", "5", "--cpus", "2"]
    done = subprocess.run(
        [sys.executable, str(example), *arguments, "--out", str(tmp_path)],
        env=os.environ | {"RAY_USAGE_STATS_ENABLED": "0"},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    written = (tmp_path / "faults.csv").read_bytes(), (tmp_path / "faults.json").read_text()
    assert written == campaign

"""Runs: the command line's bytes, one or many, and what is refused."""

from __future__ import annotations

import csv
import io
import math
import os
import pathlib
import re
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from conftest import ROOT, command_line

import twb

FIXTURES = ROOT / "sim-host" / "tests" / "fixtures"
GAPS = FIXTURES / "wpilib_gaps.json"


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """What the command line writes of some runs."""
    out = tmp_path_factory.mktemp("cli")
    command_line("run", "paper-line", "park-beside", "drive-and-park", "--csv", out=out)
    command_line("run", "bad-floor-line", "--csv", "--every", "7", out=out)
    command_line("run", str(GAPS), "--csv", "--base", "lab-10kg", "--fastest", out=out)
    return out


def run_of(name: str) -> twb.Run:
    if name == "wpilib_gaps":
        return twb.simulate(GAPS, robot="lab-10kg", fastest=True)
    return twb.simulate(name)


@pytest.mark.parametrize(
    "name", ["paper-line", "park-beside", "drive-and-park", "bad-floor-line", "wpilib_gaps"]
)
def test_a_run_is_the_command_lines_byte_for_byte(name: str, files: pathlib.Path) -> None:
    run = run_of(name)
    every = 7 if name == "bad-floor-line" else 1
    assert run.csv(every) == (files / f"{name}.csv").read_bytes()
    assert run.json() == (files / f"{name}.json").read_text()
    figure = run.figure()
    assert figure.svg == (files / f"{name}.svg").read_text()
    assert figure.png == (files / f"{name}.png").read_bytes()
    assert figure._repr_svg_() == figure.svg and figure._repr_png_() == figure.png


@pytest.mark.parametrize("name", ["paper-line", "bad-floor-line"])
def test_arrays_have_the_bits_of_the_csv_file(name: str) -> None:
    run = twb.simulate(name)
    rows = list(csv.DictReader(io.StringIO(run.csv().decode())))
    trace = run.trace
    assert list(trace) == run.columns == list(rows[0]) == list(run.units)
    kinds = set()
    for column, array in trace.items():
        assert array.shape == (len(run),)
        kinds.add(array.dtype.kind)
        texts = [row[column] for row in rows]
        if array.dtype.kind == "U":
            assert array.tolist() == texts, column
        else:
            # Bits, and not only values: of -0.0 as well.
            assert array.astype(float).tobytes() == np.array(texts, float).tobytes(), column
        np.testing.assert_array_equal(run[column], array)
    assert kinds == {"f", "U", "b", "u"}
    assert run.units["tau_right"] == "N m" and run.units["e_theta"] == "rad"
    named = {column for column, unit in run.units.items() if unit == ""}
    # What has no unit is a word, a flag or a number of something.
    assert all(trace[column].dtype.kind in "Ubu" for column in named), named
    assert all(trace[column].dtype.kind == "f" for column in set(trace) - named)
    with pytest.raises(KeyError):
        run["nothing"]


def test_a_run_is_a_table_of_its_columns() -> None:
    run = twb.simulate("paper-line")
    assert list(run) == run.columns and set(run) == set(run.trace)
    assert all(column in run for column in run)
    assert "nothing" not in run and 0 not in run and None not in run
    # As of a data frame, what it holds is columns and how long it is are rows.
    assert len(run) == len(run["t"]) > len(run.columns)


def test_many_are_one_at_a_time_bit_for_bit() -> None:
    starts = np.array([[0.1 * k, 0.5 - 0.1 * k, 0.3 * k] for k in range(8)])
    planned = twb.missions(
        start=starts, goal=(2, 1, 0.5), robot="hobby-1kg", world="drawn", seed=range(8)
    )
    together = twb.simulate(planned, threads=2)
    ends = twb.outcomes(planned, threads=2)
    assert len({run.csv() for run in together}) == 8
    for k, run in enumerate(together):
        alone = twb.simulate(
            start=starts[k], goal=(2, 1, 0.5), robot="hobby-1kg", world="drawn", seed=k, threads=1
        )
        assert isinstance(alone, twb.Run)
        assert run.csv() == alone.csv()
        assert ends["ticks"][k] == len(run)
        for column, last in alone.trace.items():
            if column != "tick":
                assert ends[column][k] == last[-1], column
        assert ends["parked_s"][k] == run.metrics["parked_s"]
    ideal = twb.outcomes(start=starts, goal=(2, 1, 0.5), robot="hobby-1kg")
    off = np.hypot(ideal["x"] - 2, ideal["y"] - 1)
    assert (off < 1e-3).all() and not np.isnan(ideal["parked_s"]).any()


def test_laws_and_worlds_can_be_chosen() -> None:
    assert twb.simulate("paper-curve").mission.law == "neural"
    plain = twb.simulate("paper-curve", law="plain")
    motion = twb.simulate("paper-curve", law="motion")
    assert (plain.mission.law, motion.mission.law) == ("plain", "motion")
    assert motion.metrics["run"]["final_error"]["position_m"] < 1e-3
    assert plain.metrics["final_error"]["position_m"] > 1e-3
    figure = motion.figure(plain)
    assert "robot" in figure.svg and "plain" in figure.svg
    other = twb.simulate("paper-curve", law="motion", robot="hobby-1kg")
    assert np.abs(other["tau_right"]).max() < 0.1 * np.abs(motion["tau_right"]).max()
    in_world = twb.simulate("park-beside", robot=None, world="even", seed=3)
    assert set(in_world["state"]) >= {"parking", "parked"}
    assert twb.Mission.load("weaving").warnings
    for period_s, warned in ((0.01, False), (0.5, True)):
        warnings = twb.Mission.park((0, 0, 0), (1, 0, 0), period_s=period_s).warnings
        assert any("a period of 0.5 s" in warning for warning in warnings) == warned, warnings
    lab = twb.Robot.load("lab-10kg")
    assert not lab.warnings
    stuck = lab.text.replace("static_nm = 0.35", "static_nm = 9.0").replace("\nlateral = ", "\nacross = ")
    told = twb.Robot.parse(stuck).warnings
    assert len(told) == 2 and "`gains.lateral`" in told[0] and "does not move" in told[1], told
    assert twb.Mission.park((0, 0, 7), (1, 0, 0), robot=twb.Robot.parse(stuck)).warnings[:2] == told
    turned = twb.Mission.park((0, 0, 7), (1, 0, 0), robot=lab).warnings
    assert len(turned) == 1 and "start.theta = 7 is more than a turn" in turned[0], turned


BAD_GAIN = twb.Robot.load("lab-10kg").text.replace("\nheading = ", "\nheading = -")
BARE = twb.Robot.load("lab-10kg").text.split("[motor]")[0]
BLIND = re.sub(r"\[pose_source\][^[]*", "", twb.Robot.load("lab-10kg").text)


def bad_robot() -> object:
    return twb.Robot.parse(BAD_GAIN, "mine.toml")


def bad_table() -> object:
    return twb.Trajectory.parse(b"t,x,y,theta\n0,0,0,0\n1,a,0,0\n", "table.csv")


def bad_scenario() -> object:
    text = '[run]\nduration = 5.0\nperiod = 0.01\n[controller]\nkind = "motion"\n[goal]\nz = 1.0\n'
    return twb.Mission.parse(text, "mine.toml")


@pytest.mark.parametrize(
    ("wrong", "file", "line", "key"),
    [
        (bad_robot, "mine.toml", 1 + BAD_GAIN[: BAD_GAIN.index("heading = -")].count("\n"), "gains.heading"),
        (bad_table, "table.csv", 3, "x"),
        (bad_scenario, "mine.toml", 7, "goal.z"),
        (lambda: twb.Robot.load("nowhere.toml"), "nowhere.toml", None, None),
        (lambda: twb.simulate("nowhere"), "nowhere", None, None),
        (lambda: twb.simulate(start=(0, 0, 0), goal=(math.nan, 0, 0)), None, None, "goal"),
        (lambda: twb.simulate(start=(0, 0), goal=(1, 0, 0)), None, None, "start"),
        (lambda: twb.missions(start=np.zeros((2, 3)), goal=np.zeros((3, 3))), None, None, "start"),
        (lambda: twb.simulate("park-beside", law="neural"), None, None, "law"),
        (lambda: twb.simulate("paper-line", world="even"), None, None, "world"),
        (lambda: twb.simulate("park-beside", world="moon"), None, None, "world"),
        (lambda: twb.simulate(start=(0, 0, 0), goal=(1, 0, 0), world="even", precision="f64"), None, None, "precision"),
        (lambda: twb.simulate(GAPS, world="drawn", precision="f64"), None, None, "precision"),
        (lambda: twb.simulate("park-beside", robot="lab-10kg"), None, None, "robot"),
        (lambda: twb.simulate("park-beside", fastest=True), None, None, "fastest"),
        (lambda: twb.simulate(GAPS, period_s=3.0), None, None, "period_s"),
        (lambda: twb.simulate("park-beside", threads=0), None, None, "threads"),
        (lambda: twb.Robot.load("lab-10kg").with_gains({"nose": 1.0}), None, None, "nose"),
        (lambda: twb.Robot.load("lab-10kg").with_gains({"heading": -1.0}), None, None, "heading"),
        (lambda: twb.import_trajectory(GAPS).at(1.0), None, None, "times"),  # type: ignore[arg-type]
        (lambda: twb.import_trajectory(GAPS).at(["soon"]), None, None, "times"),  # type: ignore[list-item]
        (lambda: twb.import_trajectory(GAPS).at([0.5, math.nan]), None, None, "times"),
        (lambda: twb.tune(twb.Robot.parse(BLIND, "blind.toml")), "blind.toml", 1, "pose_source"),
        (lambda: twb.faults(0), None, None, "runs"),
        (lambda: twb.faults(10, only=["no such"]), None, None, "only"),
        (lambda: twb.faults(10, shard=(3, 3)), None, None, "shard"),
        (lambda: twb.faults(10, robot="hobby-1kg", gyro=True), None, None, "gyro"),
        (lambda: twb.faults(10, robot=twb.Robot.parse(BARE, "bare.toml")), "bare.toml", 1, "motor"),
        (lambda: twb.identify({"t": [1.0, 2.0], "x": [1.0]}), None, None, "log"),
        (lambda: twb.identify({"t": [1.0]}, known={"nose": 1}), None, None, "known"),
    ],
)
def test_an_error_says_where(wrong, file, line, key) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(twb.InputError) as caught:
        wrong()
    error = caught.value
    assert (error.file, error.line, error.key) == (file, line, key), str(error)
    assert isinstance(error, ValueError) and str(error)
    # Nobody who looks for a missing file has to know this package.
    assert isinstance(error, FileNotFoundError) == ("nowhere" in str(file))


LINE = b"t,x,y,theta\n0,0,0,0\n1,0.1,0,0\n2,0.3,0,0\n"
#: A log that says nothing, of arguments that are looked at before it.
LOG = {"t": [1.0], "angle_right": [0.0], "angle_left": [0.0]}


@pytest.mark.parametrize(
    ("wrong", "key", "limit"),
    [
        (lambda: twb.simulate("paper-line", threads=-1), "threads", "1 to 1024"),
        (lambda: twb.simulate("paper-line", threads=10**6), "threads", "1 to 1024"),
        (lambda: twb.simulate("paper-line", progress=3), "progress", "function"),  # type: ignore[call-overload]
        (lambda: twb.simulate("paper-line").csv(0), "every", "1 to"),
        (lambda: twb.simulate(5), "what", "not 5"),  # type: ignore[call-overload]
        (lambda: twb.simulate(["paper-line", None]), "what", "not None"),  # type: ignore[list-item]
        (lambda: twb.simulate(start="there", goal=(0, 0, 0)), "start", "there"),
        (lambda: twb.simulate(start=(0, 0, 0), goal=[[1, 0, 0], [1, 0]]), "goal", "pose"),
        (lambda: twb.simulate(start=(0, 0, 0), goal=(1, 0, 0), seed=-1), "seed", "0 to 2**64 - 1"),
        (lambda: twb.simulate(start=(0, 0, 0), goal=(1, 0, 0), seed=1.5), "seed", "0 to 2**64 - 1"),
        (lambda: twb.missions(start=(0, 0, 0), goal=(1, 0, 0), seed=np.array([-1])), "seed", "0 to"),
        (lambda: twb.missions(start=(0, 0, 0), goal=(1, 0, 0), seed=[[1]]), "seed", "a row"),
        (lambda: twb.Mission.park((0, 0, 0), (1, 0, 0), seed=-1), "seed", "18446744073709551615"),
        (lambda: twb.Mission.park((0, 0, 0), (1, 0, 0), longest_s=0), "longest_s", "at least one control period"),
        (lambda: twb.Mission.park((0, 0, 0), (1, 0, 0), longest_s=math.nan), "longest_s", "a finite number"),
        # Traces that no machine has the memory for.
        (
            lambda: twb.simulate(start=(0, 0, 0), goal=(1, 0, 0), longest_s=1e4, period_s=1e-4),
            "longest_s",
            "2000000",
        ),
        (lambda: twb.simulate(GAPS, offset_m=math.nan), "offset_m", "-10 to 10"),
        (lambda: twb.Trajectory.parse(LINE, tolerance_m=math.nan), "tolerance_m", "0 to 1"),
        (lambda: twb.Trajectory.parse(LINE, tolerance_m=-1), "tolerance_m", "0 to 1"),
        (lambda: twb.Robot.load("lab-10kg").with_gains({"heading": 1e308}), "heading", "1e308 is out"),
        (lambda: twb.verify(None), "robot", "not None"),  # type: ignore[arg-type]
        (lambda: twb.verify("lab-10kg", seeds=0), "seeds", "1 to 100000"),
        (lambda: twb.verify("lab-10kg", seeds=2**32), "seeds", "1 to 100000"),
        (lambda: twb.tune("lab-10kg", evaluations=2**64 - 1), "evaluations", "1 to 1000000"),
        (lambda: twb.faults(10**18), "runs", "1 to 100000000"),
        (lambda: twb.faults(1, first=2**64 - 1), "first", "0 to 4503599627370496"),
        (lambda: twb.faults(3, shard=(-1, 2)), "shard", "index from 0"),
        (lambda: twb.faults(3, shard=(0, 0)), "shard", "below the count"),
        (lambda: twb.identify({"t": 3.0}), "log", "one axis"),
        (lambda: twb.identify({"t": [[1.0, 2.0]]}), "log", "one axis"),
        (lambda: twb.identify({3: [1.0]}), "log", "by their names"),  # type: ignore[dict-item]
        (lambda: twb.identify({"t": ["soon"]}), "log", "soon"),
        (lambda: twb.identify(LOG, counts_per_turn=0), "counts_per_turn", "above 0"),
        (lambda: twb.identify(LOG, counts_per_turn=math.inf), "counts_per_turn", "finite"),
        (lambda: twb.identify(LOG, latency_s=-1), "latency_s", "not negative"),
        (lambda: twb.identify(LOG, slow_rad_s=math.nan), "slow_rad_s", "above 0"),
        (lambda: twb.identify(LOG, known="mass"), "known", "`mass` is not"),
    ],
)
def test_an_error_names_the_argument_and_its_limit(wrong, key, limit) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(twb.InputError) as caught:
        wrong()
    said = str(caught.value)
    assert caught.value.key == key and (key in said or key == "known") and limit in said, said


def test_a_word_is_one_word() -> None:
    assert twb.faults(4, only="gyro", gyro=True).csv() == twb.faults(4, only=["gyro"], gyro=True).csv()
    with pytest.raises(twb.InputError, match="Is a directory|denied") as caught:
        twb.identify(ROOT)
    assert caught.value.file == str(ROOT)


def test_robots_are_their_text() -> None:
    import pickle

    robot = twb.Robot.load("lab-10kg")
    assert twb.ROBOTS == ("paper-30kg", "lab-10kg", "hobby-1kg")
    other = robot.with_gains({"heading": 4.5})
    assert other.gains == robot.gains | {"heading": 4.5}
    assert twb.Robot.parse(other.text).gains == other.gains
    assert "# " in other.text and "heading = 4.5" in other.text
    again = pickle.loads(pickle.dumps(other))
    assert (again.text, again.name, again.gains) == (other.text, other.name, other.gains)
    assert robot.limits["speed"] == 1.2 and robot.period_s == 0.01
    assert "pub const" in robot.constants() and "lab_10kg" in robot.constants("c")


def test_trajectories_are_read_and_sampled() -> None:
    trajectory = twb.import_trajectory(GAPS)
    samples = trajectory.samples
    assert trajectory.format.lower().startswith("wpilib")
    assert samples["t"][0] == 0 and abs(samples["t"][-1] - trajectory.duration_s) < 1e-9
    middle = trajectory.at(samples["t"][3:5])
    for name, column in samples.items():
        np.testing.assert_array_equal(middle[name], column[3:5])
    for times in ([0, 1, 2.5], (0, 1, 2.5), np.array([0.0, 1.0, 2.5], dtype=np.float32)):
        np.testing.assert_array_equal(trajectory.at(times)["t"], [0.0, 1.0, 2.5])
    np.testing.assert_array_equal(trajectory.at(range(3))["x"], trajectory.at(np.arange(3.0))["x"])
    # The base follows: position is the integral of speed along the heading.
    t = np.linspace(0, trajectory.duration_s, 20_001)
    fine = trajectory.at(t)
    way = np.concatenate([[0], np.cumsum(np.diff(t) * fine["v"][:-1] * np.cos(fine["theta"][:-1]))])
    assert np.abs(fine["x"][0] + way - fine["x"]).max() < 1e-3
    scaled, how = trajectory.scaled(twb.Robot.load("hobby-1kg"), fastest=True)
    assert scaled.duration_s != trajectory.duration_s and how
    assert scaled.samples["v"].max() <= twb.Robot.load("hobby-1kg").limits["speed"]


def test_progress_is_told_and_an_error_in_it_stops() -> None:
    calls: list[tuple[int, int]] = []
    twb.faults(40, progress=lambda done, total: calls.append((done, total)))
    assert calls[-1] == (40, 40) and calls == sorted(calls) and len(calls) == len(set(calls))

    def enough(done: int, total: int) -> None:
        raise StopAsyncIteration(f"{done} of {total}")

    began = time.monotonic()
    # Without a stop for each run that is left.
    with pytest.raises(StopAsyncIteration):
        twb.faults(10_000_000, progress=enough)
    assert time.monotonic() - began < 20


def interrupted(call: str) -> None:
    """That Ctrl-C ends a program, which says when it is at work."""
    # Tests that are started in the background have the signal ignored, and so would their children.
    heeds = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    child = subprocess.Popen(
        [sys.executable, "-c", f"{heeds}; import twb; {call}"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert child.stdout is not None
    # It is at work.
    assert int(child.stdout.readline()) > 0
    child.send_signal(signal.SIGINT)
    began = time.monotonic()
    _, errors = child.communicate(timeout=60)
    assert "KeyboardInterrupt" in errors
    assert "panicked" not in errors
    # On two cores that nothing else uses 0.1 s.
    assert child.returncode != 0 and time.monotonic() - began < 5


@pytest.mark.parametrize("study", ["faults(1_000_000, ", "verify('hobby-1kg', seeds=100_000, "])
def test_ctrl_c_stops_a_long_study(study: str) -> None:
    interrupted(f"twb.{study}progress=lambda done, total: print(done, flush=True))")


@pytest.mark.parametrize("runs", ["outcomes", "simulate"])
def test_ctrl_c_stops_a_long_run(runs: str) -> None:
    # A run alone makes no progress before its end, after 2 million ticks.
    way = "start=(0, 0, 0), goal=(9e5, 0, 0), robot='lab-10kg', world='drawn', period_s=0.005, longest_s=1e4"
    interrupted(f"mission = twb.missions({way})[0]; print(1, flush=True); twb.{runs}([mission])")


def test_other_threads_run_meanwhile() -> None:
    counted, over = 0, threading.Event()

    def count() -> None:
        nonlocal counted
        while not over.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    planned = twb.missions(start=np.tile([0, 0.5, 0], (30, 1)), goal=(1, 0, 0), world="drawn")
    thread.start()
    before, began = counted, time.monotonic()
    twb.outcomes(planned, threads=1)
    passed, during = time.monotonic() - began, counted - before
    over.set()
    thread.join()
    # A thousand a second if nothing else ran; with the GIL held there would be none.
    assert during > 20 * passed, f"{during} in {passed:.2f} s"


def test_a_forked_process_can_run() -> None:
    """Threads of before the fork are not there after it."""
    twb.outcomes("park-beside", threads=2)
    child = os.fork()
    if child == 0:
        status = 1
        try:
            status = 0 if len(twb.simulate("park-beside", threads=2)) > 100 else 1
        finally:
            os._exit(status)
    for _ in range(600):
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            break
        time.sleep(0.1)
    else:
        os.kill(child, signal.SIGKILL)
        pytest.fail("it hangs")
    assert os.waitstatus_to_exitcode(status) == 0

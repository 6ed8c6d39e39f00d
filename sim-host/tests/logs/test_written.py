"""What `--log` writes: every tick of the CSV of the same run, bit for bit, by every reader."""

import math
import os
import signal
import struct
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from mcap.exceptions import McapError
from mcap.records import Message
from mcap.stream_reader import StreamReader
from readers import Messages, Table, by_mcap, by_rosbags, by_wpilib, same
from wpimath.geometry import Pose2d, Rotation2d, Translation2d
from wpiutil import wpistruct

SIM_HOST = os.environ["TWB_SIM_HOST"]
BOARD = Path(os.environ["TWB_BOARD_LOGS"])
READERS = [by_mcap, by_rosbags]

# Whole bases in single precision, and the paper's law in double.
RUNS = ["bad-floor-line", "bad-floor-curve", "wrong-robot"]
# The same, and the paper's law at 1 kHz.
SMALL = ["bad-floor-line", "bad-floor-curve", "paper-line"]


def sim_host(folder: Path, *arguments: str) -> str:
    done = subprocess.run([SIM_HOST, *arguments], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs")
    for name in RUNS:
        sim_host(folder, "run", name, "--csv", "--log", f"{name}.mcap")
        sim_host(folder, "run", name, "--log", f"{name}.wpilog")
    sim_host(folder, "run", "paper-line", "--csv", "--log", "paper-line.mcap")
    return folder


def times(table: Table, per_second: float) -> list[int]:
    """Of the ticks. The first tick of an uneven clock may lie before 0, where neither format has times."""
    return [max(0, round(per_second * float(t))) for t in table.column("t")]


def assert_same(table: Table, messages: Messages, float_format: str = "<d") -> None:
    reports = messages["/report"]
    assert len(reports) == len(table.rows)
    for index, (row, (_, report)) in enumerate(zip(table.rows, reports)):
        for name, text in zip(table.names, row):
            value = getattr(report, name)
            # The only column that the CSV has rounded.
            agrees = f"{value:.6f}" == text if name == "time_s" else same(text, value, float_format)
            assert agrees, (index, name, text, value)


def assert_same_wpilog(table: Table, path: Path, float_format: str = "<d") -> None:
    kinds, values = by_wpilib(path)
    for name in table.names:
        if name == "time_s":
            continue
        expected = [text for text in table.column(name) if text or kinds[f"/report/{name}"] == "string"]
        recorded = values[f"/report/{name}"]
        assert len(recorded) == len(expected), name
        for text, (_, value) in zip(expected, recorded):
            assert same(text, value, float_format), (name, text, value)


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize("name", RUNS)
def test_bag_has_every_tick_exactly(runs: Path, name: str, read: Callable[[Path], Messages]) -> None:
    table, messages = Table(runs / f"out/{name}.csv"), read(runs / f"{name}.mcap")
    assert_same(table, messages)
    assert [at for at, _ in messages["/report"]] == times(table, 1e9)


@pytest.mark.parametrize("read", READERS)
def test_standard_messages_say_what_the_report_says(runs: Path, read: Callable[[Path], Messages]) -> None:
    table, messages = Table(runs / "out/bad-floor-line.csv"), read(runs / "bad-floor-line.mcap")
    row_of = {at: index for index, at in enumerate(times(table, 1e9))}
    column = {name: table.column(name) for name in table.names}
    # Ten a second: uneven ticks make no pause as long as two.
    pauses = [b - a for (a, _), (b, _) in zip(messages["/odom"], messages["/odom"][1:])]
    assert 95e6 < sum(pauses) / len(pauses) < 105e6 and max(pauses) < 200e6
    for at, odometry in messages["/odom"]:
        row = row_of[at]
        pose, yaw = odometry.pose.pose, 0.5 * float(column["theta_m"][row])
        assert odometry.header.frame_id == "odom" and odometry.child_frame_id == "base_link"
        assert odometry.header.stamp.sec * 10**9 + odometry.header.stamp.nanosec == at
        assert same(column["x_m"][row], pose.position.x) and same(column["y_m"][row], pose.position.y)
        # The last bits are those of two libraries' sines.
        assert math.isclose(pose.orientation.z, math.sin(yaw), abs_tol=1e-15)
        assert math.isclose(pose.orientation.w, math.cos(yaw), abs_tol=1e-15)
        # Commanded, and measured minus commanded, each in single precision.
        speed = float(column["v_c"][row]) + float(column["d_v"][row])
        if column["state"][row] == "tracking":
            assert math.isclose(odometry.twist.twist.linear.x, speed, abs_tol=1e-6)
    for at, tf in messages["/tf"]:
        row = row_of[at]
        by_frame = {transform.child_frame_id: transform.transform for transform in tf.transforms}
        assert set(by_frame) == {"base_link", "base_link_true", "reference"}
        for frame, x in [("base_link", "x_m"), ("base_link_true", "x"), ("reference", "x_r")]:
            assert same(column[x][row], by_frame[frame].translation.x)
    for at, joints in messages["/joint_states"]:
        row = row_of[at]
        assert list(joints.name) == ["right_wheel_joint", "left_wheel_joint"]
        assert len(joints.position) == len(joints.velocity) == 2
        if column["state"][row] == "tracking":
            assert same(column["tau_right"][row], float(joints.effort[0]))
            assert same(column["tau_left"][row], float(joints.effort[1]))
    # Each change of state is reported in the tick in which it happens.
    statuses = {at: diagnostics.status[0] for at, diagnostics in messages["/diagnostics"]}
    for at, row in row_of.items():
        state = column["state"][row]
        if row == 0 or column["state"][row - 1] != state:
            assert statuses[at].message == f"{state} ({column['cause'][row]})"
            assert statuses[at].hardware_id


@pytest.mark.parametrize("name", SMALL)
def test_bag_is_small(runs: Path, name: str) -> None:
    ticks = len(Table(runs / f"out/{name}.csv").rows)
    size = (runs / f"{name}.mcap").stat().st_size / ticks
    print(f"{name}: {size:.0f} bytes a tick")
    assert size <= 200


@pytest.mark.parametrize("name", RUNS)
def test_wpilog_has_every_tick_exactly(runs: Path, name: str) -> None:
    assert_same_wpilog(Table(runs / f"out/{name}.csv"), runs / f"{name}.wpilog")


def test_wpilog_has_structs_as_wpilib_has_them(runs: Path) -> None:
    table = Table(runs / "out/bad-floor-line.csv")
    kinds, values = by_wpilib(runs / "bad-floor-line.wpilog")
    for kind in (Pose2d, Translation2d, Rotation2d):
        name = f"/.schema/struct:{wpistruct.getTypeName(kind)}"
        assert kinds[name] == "structschema"
        assert values[name][0][1] == wpistruct.getSchema(kind)
    for entry, suffix in [("measured", "_m"), ("true", ""), ("reference", "_r")]:
        assert kinds[f"/pose/{entry}"] == "struct:Pose2d"
        poses = values[f"/pose/{entry}"]
        assert len(poses) == len(table.rows)
        columns = zip(*(table.column(name + suffix) for name in ("x", "y", "theta")))
        for texts, (_, [pose]) in zip(columns, poses):
            assert all(same(text, value) for text, value in zip(texts, pose))
    assert kinds["/pose/all"] == "struct:Pose2d[]"
    assert all(len(poses) == 3 for _, poses in values["/pose/all"])
    assert [at for at, _ in values["/pose/true"]] == times(table, 1e6)


def test_faults_logs_the_run_that_is_named(tmp_path: Path) -> None:
    one = ["faults", "--runs", "1", "--seed", "1", "--run", "7"]
    sim_host(tmp_path, *one, "--log", "one.mcap")
    sim_host(tmp_path, *one, "--log", "one.wpilog")
    table = Table(tmp_path / "out/faults-7.csv")
    for read in READERS:
        assert_same(table, read(tmp_path / "one.mcap"))
    assert_same_wpilog(table, tmp_path / "one.wpilog")


def test_verify_logs_the_worst_run(tmp_path: Path) -> None:
    sim_host(tmp_path, "verify", "hobby-1kg", "--seeds", "1", "--log", "worst.mcap")
    table = Table(tmp_path / "out/hobby-1kg-verify-worst.csv")
    for read in READERS:
        assert_same(table, read(tmp_path / "worst.mcap"))


@pytest.mark.skipif("TWB_PIL" not in os.environ, reason="builds a firmware for the emulator, unless it is built")
def test_pil_logs_what_the_chip_computed(tmp_path: Path) -> None:
    sim_host(tmp_path, "pil", "bad-floor-line", "--log", "chip.mcap")
    table = Table(tmp_path / "out/bad-floor-line-pil.csv")
    for read in READERS:
        assert_same(table, read(tmp_path / "chip.mcap"))


def test_monitor_logs_every_report_of_a_board() -> None:
    table = Table(BOARD / "mcap.csv")
    assert len(table.rows) == 3
    for read in READERS:
        messages = read(BOARD / "board.mcap")
        # A board has singles, and their shortest text is that of singles.
        assert_same(table, messages, "<f")
        # Times of the day.
        assert messages["/report"][0][0] > 1.7e18
    assert_same_wpilog(Table(BOARD / "wpilog.csv"), BOARD / "board.wpilog", "<f")


def whole_chunks(path: Path) -> list[int]:
    """Times of the reports up to the end of a file that has none."""
    found: list[int] = []
    topics: dict[int, str] = {}
    with path.open("rb") as file:
        try:
            for record in StreamReader(file).records:
                if hasattr(record, "topic"):
                    topics[record.id] = record.topic
                if isinstance(record, Message) and topics[record.channel_id] == "/report":
                    found.append(record.log_time)
        # What it raises where a record is cut off depends on the record.
        except (McapError, EOFError, struct.error):
            pass
    return found


def test_bag_that_is_cut_anywhere_is_whole_up_to_its_last_chunk(runs: Path, tmp_path: Path) -> None:
    whole = (runs / "paper-line.mcap").read_bytes()
    all_times = whole_chunks(runs / "paper-line.mcap")
    assert all_times == times(Table(runs / "out/paper-line.csv"), 1e9)
    lengths = set()
    for cut in (0.31, 0.5, 0.77, 0.999):
        path = tmp_path / "cut.mcap"
        path.write_bytes(whole[: int(cut * len(whole))])
        found = whole_chunks(path)
        # A chunk is a thirteenth of this bag.
        assert len(found) > (cut - 0.08) * len(all_times) and found == all_times[: len(found)]
        lengths.add(len(found))
        # And the command line takes what is there: here torques and no wheel angles, which is what it says.
        said = subprocess.run([SIM_HOST, "identify", str(path)], capture_output=True, text=True, cwd=tmp_path)
        assert "ends early" in said.stdout and "no position" in said.stderr
    assert len(lengths) > 2


def test_killed_run_leaves_what_it_had_written(tmp_path: Path) -> None:
    text = sim_host(tmp_path, "show", "paper-line")
    text = text.replace("duration = 20.0", "duration = 1000.0")
    assert "duration = 1000.0" in text
    (tmp_path / "long.toml").write_text(text)
    for log in ("long.mcap", "long.wpilog"):
        path = tmp_path / log
        child = subprocess.Popen([SIM_HOST, "run", "long.toml", "--log", log], cwd=tmp_path)
        until = time.monotonic() + 30
        while not path.exists() or path.stat().st_size < 2**20:
            assert time.monotonic() < until and child.poll() is None
            time.sleep(0.001)
        child.send_signal(signal.SIGKILL)
        assert child.wait() == -signal.SIGKILL
        if log.endswith("mcap"):
            found = [1e-9 * at for at in whole_chunks(path)]
        else:
            found = [1e-6 * at for at, _ in by_wpilib(path)[1]["/report/t"]]
        assert 1000 < len(found) < 1_000_000
        assert all(math.isclose(at, 1e-3 * tick, abs_tol=1e-9) for tick, at in enumerate(found))


def test_refuses_another_ending(tmp_path: Path) -> None:
    done = subprocess.run([SIM_HOST, "run", "paper-line", "--log", "x.bag"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1 and "ends in .mcap or .wpilog" in done.stderr


def test_several_runs_have_a_log_each(tmp_path: Path) -> None:
    sim_host(tmp_path, "run", "park-beside", "reverse", "--log", "two.mcap")
    for name in ("park-beside", "reverse"):
        assert by_mcap(tmp_path / f"two-{name}.mcap")["/report"]

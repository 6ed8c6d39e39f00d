"""What is read: bags that an independent library wrote, as ROS 2 writes them."""

import json
import math
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

SIM_HOST = os.environ["TWB_SIM_HOST"]
STORE = get_typestore(Stores.ROS2_HUMBLE)
TYPE = STORE.types
EPOCH_NS = 1_790_000_000_000_000_000

# A robot: radii right and left, track, mass with what turns, inertia, friction of the wheels.
RADIUS = (0.0801, 0.0795)
TRACK, MASS, INERTIA = 0.40, 10.0, 0.35
COULOMB, VISCOUS = 0.15, 0.02
PERIOD_NS, FINE = 10_000_000, 50


def stamp(ns: int) -> object:
    return TYPE["builtin_interfaces/msg/Time"](sec=ns // 10**9, nanosec=ns % 10**9)


def header(ns: int, frame: str = "map") -> object:
    return TYPE["std_msgs/msg/Header"](stamp=stamp(ns), frame_id=frame)


def pose(x: float, y: float, theta: float) -> object:
    return TYPE["geometry_msgs/msg/Pose"](
        position=TYPE["geometry_msgs/msg/Point"](x=x, y=y, z=0.0),
        orientation=TYPE["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=math.sin(theta / 2), w=math.cos(theta / 2)),
    )


def pose_stamped(ns: int, x: float, y: float, theta: float) -> object:
    return TYPE["geometry_msgs/msg/PoseStamped"](header=header(ns), pose=pose(x, y, theta))


def odometry(ns: int, x: float, y: float, theta: float) -> object:
    zero = TYPE["geometry_msgs/msg/Vector3"](x=0.0, y=0.0, z=0.0)
    twist = TYPE["geometry_msgs/msg/Twist"](linear=zero, angular=zero)
    return TYPE["nav_msgs/msg/Odometry"](
        header=header(ns, "odom"),
        child_frame_id="base_link",
        pose=TYPE["geometry_msgs/msg/PoseWithCovariance"](pose=pose(x, y, theta), covariance=np.zeros(36)),
        twist=TYPE["geometry_msgs/msg/TwistWithCovariance"](twist=twist, covariance=np.zeros(36)),
    )


def joints(ns: int, names: list[str], position: np.ndarray, effort: np.ndarray) -> object:
    return TYPE["sensor_msgs/msg/JointState"](
        header=header(ns, ""), name=names, position=position, velocity=np.array([]), effort=effort
    )


def battery(ns: int, volts: float) -> object:
    kind = TYPE["sensor_msgs/msg/BatteryState"]
    names = [field for field in kind.__dataclass_fields__ if field != "__msgtype__"]
    values = {name: 0 for name in names} | {"header": header(ns), "voltage": volts, "present": True}
    values |= {"cell_voltage": np.array([], np.float32), "cell_temperature": np.array([], np.float32), "location": "", "serial_number": ""}
    return kind(**{name: values[name] for name in names})


def array(data: np.ndarray) -> object:
    layout = TYPE["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
    return TYPE["std_msgs/msg/Float64MultiArray"](layout=layout, data=data)


class Bag:
    """A bag that is written."""

    def __init__(self, path: Path) -> None:
        self.writer = Writer(path, version=9, storage_plugin=StoragePlugin.MCAP)
        self.connections: dict[str, object] = {}
        self.path = path

    def __enter__(self) -> "Bag":
        self.writer.open()
        return self

    def __exit__(self, *_: object) -> None:
        self.writer.close()

    def add(self, topic: str, kind: str, ns: int, message: object) -> None:
        if topic not in self.connections:
            self.connections[topic] = self.writer.add_connection(topic, kind, typestore=STORE)
        self.writer.write(self.connections[topic], ns, STORE.serialize_cdr(message, kind))

    @property
    def file(self) -> str:
        [file] = self.path.glob("*.mcap")
        return str(file)


def drive() -> list[dict[str, float]]:
    """Rows of a drive of this robot, by small steps of its equations of motion; poses each fifth row."""
    random = np.random.default_rng(11)
    r, w = np.array(RADIUS), np.array([0.0, 0.0])
    angle, x, y, theta = np.array([0.0, 0.0]), 0.0, 0.0, 0.3
    # Body from wheels: v, omega; and the wheels' inertia by power.
    body = np.array([[r[0] / 2, r[1] / 2], [r[0] / TRACK, -r[1] / TRACK]])
    inertia = np.linalg.inv(body.T @ np.diag([MASS, INERTIA]) @ body)
    torque, level, until = np.zeros(2), np.zeros(2), np.zeros(2)
    rows = []
    for row in range(2500):
        # To the last bit as from nanoseconds: the fit's windows begin with the rows that reach them.
        t = 1e-9 * (PERIOD_NS * row)
        part = int(t // 6.25)
        direction = [(1, 1), (1, -1), (-1, -1), (1, 1)][part]
        for i in range(2):
            if t >= until[i]:
                level[i] = direction[i] * random.uniform(0.2, 0.8)
                until[i] = t + random.uniform(0.3, 1.0)
                if part < 2:
                    level, until = np.array(direction) * abs(level[i]), np.full(2, until[i])
        torque = torque + np.clip(level - torque, -0.05, 0.05)
        data = dict(t=t, torque_right=torque[0], torque_left=torque[1], angle_right=angle[0], angle_left=angle[1])
        # A column that no log has.
        data |= {"speed_right": w[0], "speed_left": w[1]}
        if row % 5 == 0:
            noise = random.normal(0, [1e-3, 1e-3, 2e-3])
            data |= dict(x=x + noise[0], y=y + noise[1], theta=theta + noise[2])
        rows.append(data)
        h = 1e-9 * PERIOD_NS / FINE
        for _ in range(FINE):
            friction = COULOMB * np.tanh(w / 0.02) + VISCOUS * w
            # Midpoint: errors far below the noise.
            middle = w + 0.5 * h * (inertia @ (torque - friction))
            friction = COULOMB * np.tanh(middle / 0.02) + VISCOUS * middle
            w = w + h * (inertia @ (torque - friction))
            angle = angle + h * middle
            v, omega = body @ middle
            heading = theta + 0.5 * h * omega
            x, y, theta = x + h * v * math.cos(heading), y + h * v * math.sin(heading), theta + h * omega
    return rows


def identified(folder: Path, *arguments: str) -> dict[str, tuple[float, float]]:
    """Values and half widths."""
    done = subprocess.run([SIM_HOST, "identify", *arguments], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    stem = Path(arguments[0]).stem
    record = json.loads((folder / f"out/{stem}-identify.json").read_text())[0]
    return {
        quantity["name"]: (quantity["value"], quantity["half_width"])
        for quantity in record["quantities"]
        if quantity["verdict"] == "identified"
    }


def test_bag_of_a_drive_identifies_the_robot(tmp_path: Path) -> None:
    rows = drive()
    names = ["left", "right"]
    with Bag(tmp_path / "drive") as bag:
        for row in rows:
            ns = EPOCH_NS + round(1e9 * row["t"])
            angles = np.array([row["angle_left"], row["angle_right"]])
            torques = np.array([row["torque_left"], row["torque_right"]])
            state = joints(ns, names, angles, np.array([]))
            bag.add("/joint_states", "sensor_msgs/msg/JointState", ns, state)
            # The command of a tick comes a little after its measurement.
            command = joints(ns + 900_000, names, np.array([]), torques)
            bag.add("/commands", "sensor_msgs/msg/JointState", ns + 950_000, command)
            if "x" in row:
                message = pose_stamped(ns, row["x"], row["y"], row["theta"])
                # It arrives late; its stamp tells when it was.
                bag.add("/mocap", "geometry_msgs/msg/PoseStamped", ns + 30_000_000, message)
    columns = list(rows[0])
    (tmp_path / "drive.csv").write_text(
        ",".join(columns) + "\n" + "".join(",".join(str(row.get(c, "")) for c in columns) + "\n" for row in rows)
    )
    by_csv = identified(tmp_path, "drive.csv")
    topics = ["--topic", "torque=/commands", "--topic", "pose=/mocap", "--joints", "right,left"]
    by_bag = identified(tmp_path, bag.file, *topics)
    assert set(by_csv) == set(by_bag) and {"radius_right", "track", "mass", "inertia"} <= set(by_bag)
    for name, (value, half) in by_csv.items():
        # Quaternions round the last bits of a heading, by which alone half widths of the same CSV move: that of a radius by 0.3 %,
        # those of friction and lags, which a drive without noise leaves to rounding, by some percent.
        assert by_bag[name][0] == pytest.approx(value, rel=1e-6, abs=0.01 * half), name
        assert by_bag[name][1] == pytest.approx(half, rel=0.1), name
    true = {"radius_right": RADIUS[0], "radius_left": RADIUS[1], "track": TRACK, "mass": MASS, "inertia": INERTIA}
    for name, value in true.items():
        found, half = by_bag[name]
        # Three half widths are six standard deviations: a wrong column is off by more.
        assert abs(found - value) < 3 * half and half < 0.1 * value, (name, found, half)


def test_duties_supply_currents_and_counts_are_read(tmp_path: Path) -> None:
    """The same numbers in CSV and in messages give the same result; what they say of a robot is for the test above."""
    turn, constant, resistance = 4096, 0.8, 0.5
    rows = []
    for row in drive()[:1500]:
        # What a drive of such motors shows, as far as speed and torque are even within a row.
        volts = [
            resistance / constant * row[f"torque_{side}"] + constant * row[f"speed_{side}"] for side in ("right", "left")
        ]
        supply = float(np.float32(24.0 + 0.5 * math.sin(row["t"])))
        data = {"t": row["t"], "supply": supply, "x": "", "y": "", "theta": ""}
        data |= {name: row[name] for name in ("x", "y", "theta") if name in row}
        for side, volt in zip(("right", "left"), volts):
            data[f"duty_{side}"] = volt / supply
            data[f"current_{side}"] = row[f"torque_{side}"] / constant
            data[f"counts_{side}"] = math.floor(turn * row[f"angle_{side}"] / math.tau)
        rows.append(data)
    with Bag(tmp_path / "duties") as bag:
        for row in rows:
            ns = EPOCH_NS + round(1e9 * row["t"])
            pair = {
                name: np.array([row[f"{name}_right"], row[f"{name}_left"]], float)
                for name in ("duty", "current", "counts")
            }
            bag.add("/encoders", "sensor_msgs/msg/JointState", ns, joints(ns, ["r", "l"], pair["counts"], np.array([])))
            bag.add("/battery", "sensor_msgs/msg/BatteryState", ns, battery(ns, row["supply"]))
            if row["x"] != "":
                way = odometry(ns, row["x"], row["y"], row["theta"])
                bag.add("/odom", "nav_msgs/msg/Odometry", ns, way)
            for name in ("duty", "current"):
                bag.add(f"/{name}", "std_msgs/msg/Float64MultiArray", ns, array(pair[name]))
    columns = list(rows[0])
    (tmp_path / "duties.csv").write_text("\n".join([",".join(columns)] + [",".join(str(row[c]) for c in columns) for row in rows]))
    counts = ["--counts-per-turn", str(turn)]
    by_csv = identified(tmp_path, "duties.csv", *counts)
    topics = ["counts=/encoders", "duty=/duty", "current=/current", "supply=/battery", "pose=/odom"]
    named = [word for topic in topics for word in ("--topic", topic)]
    by_bag = identified(tmp_path, bag.file, *counts, *named, "--joints", "r,l")
    # Of these the lengths are sure, and what the log warns of tells that all else was there.
    assert set(by_csv) == set(by_bag) and "radius_right" in by_bag
    for name, (value, half) in by_csv.items():
        assert by_bag[name][0] == pytest.approx(value, rel=1e-6, abs=0.01 * half), name
    warned = [
        json.loads((tmp_path / f"out/{name}-identify.json").read_text())[0]["warnings"]
        for name in ("duties", Path(bag.file).stem)
    ]
    assert warned[0] and warned[0] == warned[1]


def test_damaged_bags_are_told_or_read_never_a_crash(tmp_path: Path) -> None:
    with Bag(tmp_path / "way") as bag:
        for t, x, y, theta in route():
            ns = EPOCH_NS + round(1e9 * t)
            bag.add("/odom", "nav_msgs/msg/Odometry", ns, odometry(ns, x, y, theta))
    whole = Path(bag.file).read_bytes()
    random = np.random.default_rng(5)
    codes = set()
    for _ in range(100):
        damaged = bytearray(whole)
        for place in random.integers(8, len(whole), 3):
            damaged[place] = random.integers(256)
        (tmp_path / "damaged.mcap").write_bytes(damaged)
        done = subprocess.run([SIM_HOST, "check", "damaged.mcap"], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode in (0, 1), done.stderr
        codes.add(done.returncode)
    assert codes == {0, 1}


def test_identify_names_what_a_bag_lacks(tmp_path: Path) -> None:
    with Bag(tmp_path / "poses") as bag:
        for k in range(40):
            bag.add("/mocap", "geometry_msgs/msg/PoseStamped", EPOCH_NS + k * 10**7, pose_stamped(k, 0.0, 0.0, 0.0))
    done = subprocess.run([SIM_HOST, "identify", bag.file], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1
    assert "no topic /joint_states" in done.stderr and "/mocap (geometry_msgs/msg/PoseStamped)" in done.stderr


def route() -> list[tuple[float, float, float, float]]:
    """Straight on and round a curve, at 0.4 m/s, ten times a second."""
    rows, x, y, theta = [], 1.0, 2.0, 0.5
    for k in range(100):
        rows.append((0.1 * k, x, y, theta))
        for _ in range(10):
            speed = 0.4 * min(1.0, 0.1 * k, 0.1 * (99 - k))
            turn = 0.5 * speed if k > 40 else 0.0
            theta += 0.01 * turn
            x, y = x + 0.01 * speed * math.cos(theta), y + 0.01 * speed * math.sin(theta)
    return rows


def test_poses_of_a_bag_are_a_trajectory(tmp_path: Path) -> None:
    rows = route()
    with Bag(tmp_path / "route") as bag:
        for t, x, y, theta in rows:
            ns = EPOCH_NS + round(1e9 * t)
            bag.add("/odom", "nav_msgs/msg/Odometry", ns, odometry(ns, x, y, theta))
            bag.add("/mocap", "geometry_msgs/msg/PoseStamped", ns, pose_stamped(ns, x, y + 1, theta))
    (tmp_path / "route.tum").write_text(
        "".join(f"{t} {x} {y} 0 0 0 {math.sin(theta / 2)} {math.cos(theta / 2)}\n" for t, x, y, theta in rows)
    )

    def check(file: str) -> list[str]:
        done = subprocess.run([SIM_HOST, "check", file], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout.splitlines()[1:]

    assert check(f"{bag.file}:/odom") == check("route.tum")
    done = subprocess.run([SIM_HOST, "run", f"{bag.file}:/mocap", "--csv"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    stem = Path(bag.file).stem
    last = (tmp_path / f"out/{stem}.csv").read_text().splitlines()[-1].split(",")
    # Parked at the last pose of that topic; the importer passes recorded ends within 0.1 mm.
    assert math.hypot(float(last[1]) - rows[-1][1], float(last[2]) - rows[-1][2] - 1) < 3e-3
    # Two topics with poses: which one has to be said.
    done = subprocess.run([SIM_HOST, "run", bag.file], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1 and "several topics with poses" in done.stderr and "/mocap" in done.stderr


def test_own_log_is_a_bag_like_any(tmp_path: Path) -> None:
    """The way of a run, driven again after its log; and the robot identified from it."""
    base = ["run", "bad-floor-line", "--log", "first.mcap", "--log-rate", "1000"]
    done = subprocess.run([SIM_HOST, *base], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    done = subprocess.run([SIM_HOST, "check", "first.mcap"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0 and "drivable" in done.stdout, done.stdout
    topics = ["first.mcap", "--topic", "pose=/tf:base_link_true"]
    found = identified(tmp_path, *topics)
    # The base of that scenario, whose wheels the world has 1 % apart at most.
    assert 0.9 < found["radius_right"][0] / found["radius_left"][0] < 1.1

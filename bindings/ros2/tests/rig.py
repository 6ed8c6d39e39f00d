"""The emulated chip, the bridge at the other end of a pseudo-terminal, and a peer of another DDS."""

import math
import os
import re
import signal
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path as File
from typing import Any

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

import messages as ros

ROOT = File(__file__).resolve().parents[3]
#: The base that the image is compiled with stands in this file too.
BASE = ROOT / "bases" / "paper-30kg.toml"
#: A domain of our own, and only this machine: nobody else is on it, nobody else is reached.
DOMAIN = 73
CYCLONE = """<CycloneDDS><Domain Id="any">
<General><Interfaces><NetworkInterface name="lo"/></Interfaces><AllowMulticast>false</AllowMulticast></General>
<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""
ENVIRONMENT = {
    "CYCLONEDDS_URI": CYCLONE,
    "RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp",
    "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    "ROS_DOMAIN_ID": str(DOMAIN),
}
os.environ |= ENVIRONMENT
try:
    # Real time where it is allowed, as ros2_control's controller manager asks for itself; chip and bridge inherit it. Niceness
    # would not do: Linux weighs sessions before it weighs programs.
    os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(10))
except PermissionError:
    pass


def keep_last(depth: int, *more: Any) -> Qos:
    """As ROS has it by default."""
    reliable = Policy.Reliability.Reliable(duration(milliseconds=100))
    return Qos(reliable, Policy.Durability.Volatile, Policy.History.KeepLast(depth), *more)


class Chip:
    """The firmware `robot` on an emulated Cortex-M4F, its serial port a pseudo-terminal.

    An instruction takes 16 ns of the chip's time, which never runs ahead of this machine's clock: what the chip calls a
    second is a second here unless this machine is too slow, which `odom` would show.
    """

    def __init__(self, image: str) -> None:
        semihosting = "enable=on,target=native,arg=firmware,arg=uart"
        self.process = subprocess.Popen(
            ["qemu-system-arm", "-M", "mps2-an386", "-display", "none", "-monitor", "none", "-serial", "pty"]
            + ["-icount", "shift=4,align=on", "-semihosting-config", semihosting, "-kernel", image],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        assert self.process.stdout is not None
        found = None
        while found is None:
            line = self.process.stdout.readline()
            assert line, "the emulator has ended"
            found = re.search(r"/dev/pts/\d+", line)
        self.port = found.group()

    def end(self) -> None:
        self.process.kill()
        self.process.wait()


class Bridge:
    def __init__(self, program: str, port: str, log: File, *arguments: str, base: File = BASE) -> None:
        self.log = log
        with log.open("w") as out:
            self.process = subprocess.Popen([program, port, "--base", str(base), *arguments], stderr=out)

    def end(self) -> int:
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(20)


@dataclass
class Heard:
    """Messages with the times at which they came."""

    reader: DataReader
    all: list[tuple[float, Any]] = field(default_factory=list)

    def take(self) -> None:
        now = time.monotonic()
        self.all += [(now, message) for message in self.reader.take(N=100)]

    @property
    def last(self) -> Any:
        return self.all[-1][1]


class Peer:
    """A host of ROS 2 in the robot's domain."""

    def __init__(self, stamped: bool = False) -> None:
        self.participant = DomainParticipant(DOMAIN)
        self.stamped = stamped
        self.heard: dict[str, Heard] = {}
        self.writers: dict[str, DataWriter] = {}
        for name, kind in (
            ("odom", ros.Odometry),
            ("tf", ros.TFMessage),
            ("joint_states", ros.JointState),
            ("diagnostics", ros.DiagnosticArray),
        ):
            self.hear(name, f"rt/{name}", kind)
        twist = ros.TwistStamped if stamped else ros.Twist
        for name, kind in (("cmd_vel", twist), ("goal_pose", ros.PoseStamped), ("trajectory", ros.Path)):
            self.writers[name] = DataWriter(self.participant, Topic(self.participant, f"rt/{name}", kind), keep_last(1))
        self.number = 0

    def end(self) -> None:
        """Leaves the domain, where the next test begins with nobody: what a failed one keeps alive is no peer any more."""
        self.writers.clear()
        self.heard.clear()
        del self.participant

    def hear(self, name: str, topic: str, kind: Any) -> Heard:
        reader = DataReader(self.participant, Topic(self.participant, topic, kind), keep_last(100))
        return self.heard.setdefault(name, Heard(reader))

    def listen(self, seconds: float, until: Callable[[], bool] = lambda: False) -> bool:
        """Whether it came to that; takes what comes as it comes."""
        end = time.monotonic() + seconds
        while True:
            for heard in self.heard.values():
                heard.take()
            if until():
                return True
            if time.monotonic() >= end:
                return False
            time.sleep(0.002)

    def drive(self, v: float, w: float = 0.0) -> None:
        twist = ros.Twist(ros.Vector3(v), ros.Vector3(z=w))
        self.writers["cmd_vel"].write(ros.TwistStamped(ros.Header(), twist) if self.stamped else twist)

    def drive_for(self, seconds: float, v: float, w: float = 0.0) -> None:
        """At the 20 Hz of Nav2's controllers."""
        for _ in range(round(20 * seconds)):
            self.drive(v, w)
            self.listen(0.05)

    def call(self, service: str, request: Any, response: Any, *arguments: Any, node: str = "base") -> Any:
        writer, heard = self.client(service, request, response, node)
        self.number += 1
        writer.write(request(1, self.number, *arguments))
        # A transition may wait for a base that comes to rest.
        assert self.listen(10, lambda: any(m.number == self.number for _, m in heard.all)), f"no answer of {service}"
        return next(message for _, message in heard.all if message.number == self.number)

    def client(self, service: str, request: Any, response: Any, node: str) -> tuple[DataWriter, Heard]:
        if service not in self.writers:
            name = f"{node}/{service}"
            heard = self.hear(service, f"rr/{name}Reply", response)
            writer = DataWriter(self.participant, Topic(self.participant, f"rq/{name}Request", request), keep_last(10))
            self.writers[service] = writer
            matched = lambda: bool(writer.get_matched_subscriptions() and heard.reader.get_matched_publications())
            assert self.listen(10, matched), f"no service {service}"
        return self.writers[service], self.heard[service]

    def odom(self) -> ros.Odometry:
        return self.heard["odom"].last

    def speed(self) -> float:
        return self.odom().twist.twist.linear.x

    def status(self) -> ros.DiagnosticStatus:
        return self.heard["diagnostics"].last.status[0]


def heading(q: ros.Quaternion) -> float:
    return 2 * math.atan2(q.z, q.w)


def of_heading(theta: float) -> ros.Quaternion:
    return ros.Quaternion(z=math.sin(theta / 2), w=math.cos(theta / 2))


def pose_stamped(x: float, y: float, theta: float, frame: str = "odom", t: float = 0.0) -> ros.PoseStamped:
    stamp = ros.Time(int(t), round(1e9 * (t % 1)) % 1_000_000_000)
    return ros.PoseStamped(ros.Header(stamp, frame), ros.Pose(ros.Point(x, y), of_heading(theta)))

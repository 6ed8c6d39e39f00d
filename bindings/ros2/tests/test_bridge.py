"""The bridge between the emulated firmware and CycloneDDS, which shares no code with it."""

import gc
import math
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import messages as ros
from rig import BASE, Bridge, Chip, Peer, heading, pose_stamped

FILE = tomllib.loads(BASE.read_text())
#: For how long the firmware and its bases wait for an order [s]: `DetectorParams::command`.
STALE = 0.1
#: A report is due every 20 ms, and this machine has other things to do.
LATE = 0.06


def away(message: ros.Odometry, x: float, y: float) -> float:
    position = message.pose.pose.position
    return math.hypot(position.x - x, position.y - y)


def stops_in(v: float) -> float:
    """Time of a controlled stop [s]: braking, and jerk until it brakes and until it stands; 0.2 s to see that it stands."""
    limits = FILE["limits"]
    return v / limits["brake"] + 2 * limits["brake"] / limits["jerk"] + 0.2


def test_cmd_vel_moves_the_base(active: Bridge, peer: Peer) -> None:
    peer.drive_for(2.5, 0.4)
    speed, x = peer.speed(), peer.odom().pose.pose.position.x
    # The share that a servo settles to within two seconds.
    assert speed == pytest.approx(0.4, rel=0.01)
    assert 0.7 < x < 1.0
    peer.drive_for(2.0, 0.0, 0.5)
    odom = peer.odom()
    assert odom.twist.twist.angular.z == pytest.approx(0.5, rel=0.02)
    assert 0.5 < heading(odom.pose.pose.orientation) < 1.1
    peer.drive_for(2.0, -0.2)
    assert peer.speed() == pytest.approx(-0.2, rel=0.02)


def test_what_is_published_fits_together(active: Bridge, peer: Peer) -> None:
    peer.drive_for(1.5, 0.3, 0.4)
    peer.listen(2)
    stamps: dict[tuple[int, int], dict[str, Any]] = {}
    for name in ("odom", "tf", "joint_states"):
        for _, message in peer.heard[name].all:
            header = message.transforms[0].header if name == "tf" else message.header
            stamps.setdefault((header.stamp.sec, header.stamp.nanosec), {})[name] = message
    whole = [together for together in stamps.values() if len(together) == 3]
    assert len(whole) > 60
    radius, track = FILE["robot"]["r"], FILE["robot"]["l"]
    for together in whole:
        odom, joints = together["odom"], together["joint_states"]
        transform = together["tf"].transforms[0]
        assert (odom.header.frame_id, odom.child_frame_id) == ("odom", "base_link")
        assert (transform.header.frame_id, transform.child_frame_id) == ("odom", "base_link")
        assert transform.transform.translation.x == odom.pose.pose.position.x
        assert transform.transform.rotation == odom.pose.pose.orientation
        assert joints.name == ["right_wheel_joint", "left_wheel_joint"]
        v, w = odom.twist.twist.linear.x, odom.twist.twist.angular.z
        # `l` of a base's file is the whole track.
        expected = [(v + w * track / 2) / radius, (v - w * track / 2) / radius]
        assert joints.velocity == pytest.approx(expected, abs=1e-6)
        assert len(joints.effort) == 2
    # What the wheels have turned is what the base has driven, when it stands again: 2 % for the speed's filter.
    last = whole[-1]
    assert abs(last["odom"].twist.twist.linear.x) < 0.005
    right, left = last["joint_states"].position
    turned = heading(last["odom"].pose.pose.orientation)
    assert turned > 0.5
    assert (right - left) * radius / track == pytest.approx(turned, rel=0.02)
    driven = sum(away(b["odom"], position.x, position.y) for position, b in zip(
        (together["odom"].pose.pose.position for together in whole), whole[1:]))
    assert (right + left) / 2 * radius == pytest.approx(driven, rel=0.02)


def even_minute(peer: Peer) -> bool:
    """Drives for a minute; whether all was as it should be."""
    # Gaps of the bridge, not of Python: a collection among a minute's messages takes longer than two of them are apart.
    for heard in peer.heard.values():
        heard.all.clear()
    gc.collect()
    gc.disable()
    peer.drive_for(60, 0.2, 0.3)
    gc.enable()
    odom = peer.heard["odom"].all
    came = [at for at, _ in odom]
    gaps = [b - a for a, b in zip(came, came[1:])]
    stamps = [message.header.stamp.seconds() for _, message in odom]
    apart = [b - a for a, b in zip(stamps, stamps[1:])]
    rate = len(gaps) / (came[-1] - came[0])
    print(f"{len(odom)} odometries, {rate:.3f} Hz, longest gap {1e3 * max(gaps):.1f} ms")
    print(f"stamps {1e3 * min(apart):.2f} to {1e3 * max(apart):.2f} ms apart")
    # None was lost: stamps are as far apart as reports.
    none_lost = max(apart) < 0.03 and peer.status().of("reports_dropped") == "0"
    return none_lost and abs(rate - 50) < 0.25 and max(gaps) <= 0.04


def test_odometry_comes_at_50_hz_for_a_minute(active: Bridge, peer: Peer) -> None:
    peer.drive_for(1, 0.2, 0.3)
    # Chip, bridge and peer share two cores with whatever else runs here, which may stop the emulator for longer than that. So a
    # minute of three has to be even, all of it: the bridge would spoil every one.
    assert any(even_minute(peer) for _ in range(3))


@pytest.mark.parametrize("goal", [(1.0, 0.3, 0.8), (-0.5, -0.4, 2.5)])
def test_a_goal_parks_the_base_within_5_mm(active: Bridge, peer: Peer, goal: tuple[float, float, float]) -> None:
    x, y, theta = goal
    peer.writers["goal_pose"].write(pose_stamped(x, y, theta))
    assert peer.listen(30, lambda: peer.status().of("state") == "parked"), peer.status()
    # It stays.
    peer.listen(1)
    off = away(peer.odom(), x, y)
    turned = math.remainder(heading(peer.odom().pose.pose.orientation) - theta, math.tau)
    print(f"{1e3 * off:.2f} mm, {1e3 * turned:.2f} mrad")
    assert off < 0.005
    assert abs(turned) < 0.01


def test_a_path_is_followed_in_its_time_and_parked_at(active: Bridge, peer: Peer) -> None:
    # A quarter of a circle of 1 m from rest to rest in 8 s, by a law without jumps of acceleration.
    def angle(t: float) -> float:
        s = min(max(t / 8, 0), 1)
        return math.pi / 2 * s**3 * (10 - 15 * s + 6 * s**2)

    poses = []
    for n in range(81):
        t = 0.1 * n
        a = angle(t)
        poses.append(pose_stamped(math.sin(a), 1 - math.cos(a), a, t=1000 + t))
    peer.writers["trajectory"].write(ros.Path(ros.Header(ros.Time(1000), "odom"), poses))
    assert peer.listen(2, lambda: peer.speed() > 0.005)
    began = len(peer.heard["odom"].all)
    assert peer.listen(20, lambda: peer.status().of("state") == "parked"), peer.status()
    driven = peer.heard["odom"].all[began:]
    off = max(abs(away(odom, 0, 1) - 1) for _, odom in driven)
    print(f"at most {1e3 * off:.1f} mm beside the path, parked {1e3 * away(peer.odom(), 1, 1):.2f} mm beside its end")
    assert off < 0.01
    assert away(peer.odom(), 1, 1) < 0.005
    moving = [at for at, odom in driven if odom.twist.twist.linear.x > 0.02]
    # The ends of the law are slower than that.
    assert 6.0 < moving[-1] - moving[0] < 8.2


def test_a_path_is_taken_up_by_a_base_that_drives(active: Bridge, peer: Peer) -> None:
    peer.drive_for(1.5, 0.3)
    # From somewhere near, where it will stand by then, 0.6 m on in 4 s.
    def share(t: float) -> float:
        s = min(t / 4, 1)
        return s**3 * (10 - 15 * s + 6 * s**2)

    poses = [pose_stamped(0.5 + 0.6 * share(0.1 * n), 0.02, 0, t=0.1 * n) for n in range(41)]
    peer.writers["trajectory"].write(ros.Path(ros.Header(ros.Time(), "odom"), poses))
    assert peer.listen(20, lambda: peer.status().of("state") == "parked"), peer.status()
    assert away(peer.odom(), 1.1, 0.02) < 0.005
    # And on to a goal, whose way a velocity ends.
    peer.writers["goal_pose"].write(pose_stamped(2.0, 0, 0))
    assert peer.listen(5, lambda: peer.speed() > 0.3)
    peer.drive_for(1.5, 0.0)
    assert abs(peer.speed()) < 0.005
    assert away(peer.odom(), 2.0, 0) > 0.3


@pytest.mark.parametrize("kept", [False, True])
def test_the_base_gets_the_parameters_of_its_file(
    start: Callable[..., Bridge], peer: Peer, tmp_path: Path, kept: bool
) -> None:
    speed = FILE["limits"]["speed"]
    slow = tmp_path / "slow.toml"
    text = BASE.read_text()
    assert text.count(f"\nspeed = {speed}") == 1
    slow.write_text(text.replace(f"\nspeed = {speed}", "\nspeed = 0.25"))
    start(*["--keep-parameters"][: int(kept)], base=slow)
    assert peer.listen(20, lambda: bool(peer.heard["odom"].all))
    peer.drive_for(2.5, 0.4)
    assert peer.speed() == pytest.approx(0.4 if kept else 0.25, rel=0.02)


def test_a_killed_peer_leaves_a_base_that_stops_in_time(active: Bridge, peer: Peer) -> None:
    script = Path(__file__).parent / "killed_peer.py"
    child = subprocess.Popen([sys.executable, script], stdout=subprocess.PIPE, text=True)
    assert child.stdout is not None
    assert peer.listen(20, lambda: bool(peer.heard["odom"].all) and peer.speed() > 0.39)
    # Until the speed has settled.
    peer.listen(1.5)
    child.kill()
    # What it printed last may be cut off.
    last = float(child.stdout.read().split("\n")[-2])
    peer.listen(3)
    odom = [(at, message.twist.twist.linear.x) for at, message in peer.heard["odom"].all if at > last]
    begins = next(at for at, v in odom if v < 0.39) - last
    stands = next(at for at, v in odom if v < 0.005) - last
    print(f"stop begins {1e3 * begins:.0f} ms after the last order, the base stands after {1e3 * stands:.0f} ms")
    # An order is good for its time. The first 2.5 % of the speed take jerk a while.
    assert STALE - 0.05 < begins < STALE + 0.05 + LATE
    assert stands < STALE + stops_in(0.4) + LATE
    said = [status.status[0].message for _, status in peer.heard["diagnostics"].all]
    assert any("stale" in message for message in said), said
    # Others are served meanwhile and afterwards.
    gaps = [b - a for (a, _), (b, _) in zip(odom, odom[1:])]
    assert max(gaps) < 0.1
    peer.drive_for(1.5, 0.2)
    assert peer.speed() == pytest.approx(0.2, rel=0.03)


def test_a_killed_bridge_leaves_a_base_that_stops_in_time(
    active: Bridge, peer: Peer, start: Callable[..., Bridge]
) -> None:
    peer.drive_for(2.0, 0.4)
    active.process.kill()
    active.process.wait()
    peer.listen(0.1)
    before = peer.odom().pose.pose.position.x
    peer.listen(3)
    peer.heard["odom"].all.clear()
    start()
    assert peer.listen(20, lambda: bool(peer.heard["odom"].all))
    on = peer.odom().pose.pose.position.x - before
    braking = 0.4**2 / (2 * FILE["limits"]["brake"]) + 0.4 * FILE["limits"]["brake"] / FILE["limits"]["jerk"]
    print(f"{1e3 * on:.0f} mm on")
    assert peer.speed() < 0.005
    assert 0 < on < 0.4 * (STALE + LATE) + braking


def change(peer: Peer, number: int) -> bool:
    service = ("change_state", ros.ChangeStateRequest, ros.ChangeStateResponse)
    return peer.call(*service, ros.Transition(number, "")).success


def stage(peer: Peer) -> str:
    return peer.call("get_state", ros.GetStateRequest, ros.GetStateResponse, 0).current_state.label


def test_a_managed_node_does_what_its_manager_says(start: Callable[..., Bridge], peer: Peer) -> None:
    configure, cleanup, activate, deactivate, shutdown = 1, 2, 3, 4, 7
    bridge = start("--managed")
    events = peer.hear("events", "rt/base/transition_event", ros.TransitionEvent)
    assert stage(peer) == "unconfigured"
    assert not change(peer, activate)
    assert change(peer, configure)
    assert stage(peer) == "inactive"
    service = ("get_available_transitions", ros.GetAvailableTransitionsRequest, ros.GetAvailableTransitionsResponse)
    labels = [t.transition.label for t in peer.call(*service, 0).available_transitions]
    assert labels == ["cleanup", "activate", "shutdown"]
    # An inactive node neither drives nor publishes odometry.
    peer.drive_for(0.5, 0.3)
    assert not peer.heard["odom"].all
    assert change(peer, activate)
    peer.drive_for(1.5, 0.3)
    assert peer.speed() > 0.28
    began = time.monotonic()
    assert change(peer, deactivate)
    # It answers when the base stands.
    assert time.monotonic() - began < stops_in(0.3) + 0.2
    count = len(peer.heard["odom"].all)
    peer.drive_for(0.5, 0.3)
    assert len(peer.heard["odom"].all) <= count + 1
    assert change(peer, activate)
    assert peer.listen(2, lambda: len(peer.heard["odom"].all) > count + 10)
    assert abs(peer.speed()) < 0.005
    assert change(peer, deactivate) and change(peer, cleanup) and change(peer, configure)
    assert change(peer, 6)
    assert bridge.process.wait(10) == 0
    goals = [event.goal_state.label for _, event in events.all]
    known = ["inactive", "active", "inactive", "active", "inactive", "unconfigured", "inactive", "finalized"]
    assert goals == known


def test_velocities_may_have_stamps_and_be_held(start: Callable[..., Bridge], stamped_peer: Peer) -> None:
    peer = stamped_peer
    start("--stamped", "--hold", "0.4", "--namespace", "/")
    assert peer.listen(20, lambda: bool(peer.writers["cmd_vel"].get_matched_subscriptions()))
    assert peer.listen(20, lambda: bool(peer.heard["odom"].all))
    # Four a second: without being held each would be stale before the next.
    for _ in range(10):
        peer.drive(0.3)
        peer.listen(0.25)
    assert peer.speed() == pytest.approx(0.3, rel=0.02)
    at = time.monotonic()
    peer.listen(2)
    stopping = next(t for t, odom in peer.heard["odom"].all if t > at and odom.twist.twist.linear.x < 0.28)
    # Held until 0.4 s after it came, which was 0.25 s ago, and stale 0.1 s later.
    assert 0.1 < stopping - at < 0.4 - 0.25 + STALE + 0.05 + LATE


def test_a_base_without_a_fault_has_nothing_to_reset(active: Bridge, peer: Peer) -> None:
    answer = peer.call("reset_fault", ros.TriggerRequest, ros.TriggerResponse, 0)
    assert not answer.success
    assert "state" in answer.message


def test_what_cannot_be_driven_is_refused_and_said(active: Bridge, peer: Peer) -> None:
    refused = lambda words: peer.listen(3, lambda: words in peer.status().of("problem"))
    peer.writers["goal_pose"].write(pose_stamped(1, 0, 0, frame="map"))
    assert refused("in the frame `map`, not in `odom`"), peer.status()
    untimed = [pose_stamped(0.1 * n, 0, 0) for n in range(10)]
    peer.writers["trajectory"].write(ros.Path(ros.Header(ros.Time(), "odom"), untimed))
    assert refused("a path has the time of each pose"), peer.status()
    peer.drive(math.nan)
    assert refused("not a number"), peer.status()
    peer.listen(0.3)
    assert away(peer.odom(), 0, 0) < 1e-3
    assert peer.status().of("state") == "armed"


def test_a_refused_goal_leaves_a_path_that_is_being_fitted(active: Bridge, peer: Peer) -> None:
    # So many poses that fitting takes longer than the messages that follow.
    def share(t: float) -> float:
        s = min(t / 4, 1)
        return s**3 * (10 - 15 * s + 6 * s**2)

    poses = [pose_stamped(0.6 * share(0.002 * n), 0, 0, t=0.002 * n) for n in range(2001)]
    peer.writers["trajectory"].write(ros.Path(ros.Header(ros.Time(), "odom"), poses))
    peer.listen(0.02)
    peer.writers["goal_pose"].write(pose_stamped(1, 0, 0, frame="map"))
    peer.drive(math.nan)
    assert peer.listen(20, lambda: peer.status().of("state") == "parked"), peer.status()
    assert away(peer.odom(), 0.6, 0) < 0.005


def test_a_signal_stops_the_base_and_ends_the_bridge(active: Bridge, peer: Peer) -> None:
    peer.drive_for(1.5, 0.4)
    began = time.monotonic()
    assert active.end() == 0
    # Orders are over: it came to rest first.
    assert 0.1 < time.monotonic() - began < stops_in(0.4) + 1.0


def test_a_chip_that_is_gone_ends_the_bridge(active: Bridge, peer: Peer, chip: Chip) -> None:
    chip.end()
    assert active.process.wait(5) == 1
    assert "the base is gone" in active.log.read_text()

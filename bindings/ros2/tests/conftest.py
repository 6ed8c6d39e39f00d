"""A chip, a bridge and a peer for each test."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from rig import BASE, Bridge, Chip, Peer


@pytest.fixture
def chip() -> Iterator[Chip]:
    chip = Chip(os.environ["ROBOT_IMAGE"])
    yield chip
    chip.end()


@pytest.fixture
def start(chip: Chip, tmp_path: Path) -> Iterator[Callable[..., Bridge]]:
    """Starts a bridge with these arguments."""
    bridges: list[Bridge] = []

    def start(*arguments: str, base: Path = BASE) -> Bridge:
        log = tmp_path / f"bridge-{len(bridges)}.log"
        bridges.append(Bridge(os.environ["ROS2_BRIDGE"], chip.port, log, *arguments, base=base))
        return bridges[-1]

    yield start
    for bridge in bridges:
        bridge.process.kill()
        bridge.process.wait()
        print(bridge.log.read_text())


@pytest.fixture
def peer() -> Iterator[Peer]:
    peer = Peer()
    yield peer
    peer.end()


@pytest.fixture
def stamped_peer() -> Iterator[Peer]:
    """One whose velocities have stamps."""
    peer = Peer(stamped=True)
    yield peer
    peer.end()


@pytest.fixture
def active(start: Callable[..., Bridge], peer: Peer) -> Bridge:
    """A bridge that is active, and whose topics the peer has found."""
    bridge = start()
    found = lambda: bool(peer.heard["odom"].all and peer.heard["diagnostics"].all)
    matched = lambda: all(writer.get_matched_subscriptions() for writer in peer.writers.values())
    assert peer.listen(20, lambda: found() and matched()), bridge.log.read_text()
    return bridge

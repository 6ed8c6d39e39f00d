"""Where the project and its command line are. Both are named by tests/run."""

from __future__ import annotations

import os
import pathlib
import subprocess

import pytest

import twb

ROOT = pathlib.Path(os.environ["TWB_ROOT"])
WHEELS = pathlib.Path(os.environ["TWB_WHEELS"])


def command_line(*arguments: str, out: pathlib.Path) -> str:
    """Runs the simulator's command line; what it prints."""
    program = os.environ["TWB_SIM_HOST"]
    command = [program, *arguments, "--out", str(out)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    # 1: a run did not park, or is against the rules; the files are written all the same.
    assert done.returncode in (0, 1) and "error: " not in done.stdout, done.stderr
    return done.stdout


@pytest.fixture(autouse=True, scope="session")
def _is_the_wheel() -> None:
    """What is tested is what was installed, not the sources beside the tests."""
    assert not pathlib.Path(twb.__file__).is_relative_to(ROOT / "bindings")

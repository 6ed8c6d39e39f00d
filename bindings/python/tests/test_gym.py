"""Environments: Gymnasium's own checker, ends of episodes, bits that do not depend on threads."""

from __future__ import annotations

import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

from twb import InputError
from twb.gym import ParkEnv, ParkVectorEnv, register


def drive(observations: np.ndarray) -> np.ndarray:
    """To the goal: turn towards it, then forward; at it, turn on the spot."""
    x, y, cos, sin = observations[:, :4].T
    far = np.hypot(x, y) > 0.02
    back = x < 0
    towards = np.arctan2(np.where(back, -y, y), np.abs(x))
    speed = np.where(far, np.clip(x, -0.5, 0.5) * np.cos(towards), 0)
    turn = np.where(far, 1.0 * towards, 0.7 * np.arctan2(sin, cos))
    return np.column_stack([speed, np.clip(turn, -1, 1)]).astype(np.float32)


def test_the_checker_passes() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Bounds of observations and of rewards, seeds, types, and what a reset gives back.
        check_env(ParkEnv(), skip_render_check=True)


def test_registered_names_make_both() -> None:
    register()
    one = gymnasium.make("twb/Park-v0", robot="hobby-1kg")
    first, _ = one.reset(seed=4)
    again, _ = one.reset(seed=4)
    other, _ = one.reset(seed=5)
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()
    many = gymnasium.make_vec(
        "twb/Park-v0", num_envs=3, vectorization_mode="vector_entry_point", robot="hobby-1kg"
    )
    seen, _ = many.reset(seed=4)
    assert seen in many.observation_space and seen.shape == (3, 6)
    one.close()
    many.close()


def episode(env: ParkVectorEnv, steps: int) -> list[tuple[Any, ...]]:
    seen, _ = env.reset(seed=2)
    taken = []
    for _ in range(steps):
        step = env.step(drive(seen))
        taken.append(step)
        seen = step[0]
    return taken


@pytest.fixture(scope="module")
def same_step() -> list[tuple[Any, ...]]:
    env = ParkVectorEnv(
        6, "hobby-1kg", start_m=0.6, longest_s=6.0, autoreset_mode=AutoresetMode.SAME_STEP
    )
    return episode(env, 130)


def test_threads_do_not_change_a_bit(same_step: list[tuple[Any, ...]]) -> None:
    env = ParkVectorEnv(
        6, "hobby-1kg", start_m=0.6, longest_s=6.0, autoreset_mode="SameStep", threads=1
    )
    for (a, ra, *_), (b, rb, *_) in zip(same_step, episode(env, 130), strict=True):
        assert a.tobytes() == b.tobytes() and ra.tobytes() == rb.tobytes()


def test_observations_of_ends_are_kept(same_step: list[tuple[Any, ...]]) -> None:
    """The same first episodes in both modes: what one has as the last observation the other keeps in its infos."""
    env = ParkVectorEnv(6, "hobby-1kg", start_m=0.6, longest_s=6.0)
    assert env.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    following = episode(env, 130)
    ended, parked = 0, 0
    for member in range(6):
        first = next(k for k, step in enumerate(same_step) if (step[2] | step[3])[member])
        observation, reward, terminated, truncated, infos = same_step[first]
        last = infos["final_obs"][member]
        assert infos["_final_obs"][member]
        plain = following[first]
        np.testing.assert_array_equal(last, plain[0][member])
        assert (plain[2][member], plain[3][member]) == (terminated[member], truncated[member])
        assert plain[1][member] == reward[member]
        # At once anew in one mode, in the next step in the other, whose reward is none.
        assert (observation[member] != last).any()
        begun = following[first + 1]
        assert begun[1][member] == 0 and not begun[2][member] and not begun[3][member]
        assert np.hypot(*begun[0][member][:2]) > 0 and (begun[0][member][4:] == 0).all()
        ended += 1
        if infos["final_info"]["parked"][member]:
            assert np.hypot(*last[:2]) < 0.02 and terminated[member] and reward[member] > 5
            parked += 1
    assert ended == 6 and parked >= 3, f"{parked} parked"


def test_without_autoreset_the_caller_resets() -> None:
    env = ParkVectorEnv(2, "hobby-1kg", longest_s=0.5, autoreset_mode="Disabled")
    env.reset(seed=1)
    still = np.zeros((2, 2), np.float32)
    for _ in range(5):
        _, _, terminated, truncated, _ = env.step(still)
    assert truncated.all() and not terminated.any()
    with pytest.raises(RuntimeError, match="reset_mask"):
        env.step(still)
    before = env._course.now()
    after, _ = env.reset(options={"reset_mask": np.array([True, False])})
    assert (after[0] != before[0]).any() and (after[1] == before[1]).all()


def test_the_base_is_the_real_one() -> None:
    """It drives as it is ordered, within its limits, as encoders and late poses have it: near the truth, not at it."""
    env = ParkVectorEnv(4, "lab-10kg", longest_s=60.0)
    env.reset(seed=9)
    forward = np.tile(np.array([0.25, 0.0], np.float32), (4, 1))
    for _ in range(20):
        seen, _, _, _, infos = env.step(forward)
    truth = infos["truth"]
    speed = 0.25 * env._course.most[0]
    assert np.abs(truth[:, 3] - speed).max() < 0.1 * speed
    assert set(infos["state"]) == {"tracking"}
    believed = np.hypot(seen[:, 0], seen[:, 1])
    off = np.abs(believed - np.hypot(truth[:, 0], truth[:, 1]))
    assert (off > 0).all() and (off < 0.03).all()


@pytest.mark.parametrize(
    ("wrong", "key"),
    [
        (lambda: ParkVectorEnv(-1), "size"),
        (lambda: ParkVectorEnv(10**12), "size"),
        (lambda: ParkVectorEnv(3, threads=0), "threads"),
        (lambda: ParkEnv(start_m=np.nan), "start_m"),
        (lambda: ParkEnv(start_m=10.0), "start_m"),
        (lambda: ParkEnv(act_s=1e12), "act_s"),
        (lambda: ParkEnv(longest_s=np.inf), "longest_s"),
        (lambda: ParkVectorEnv(2).reset(options={"reset_mask": [True]}), "reset_mask"),
    ],
)
def test_what_is_refused_is_named(wrong, key) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as caught:
        wrong()
    assert caught.value.key == key and key in str(caught.value)


def test_actions_are_numbers_of_an_episode() -> None:
    env = ParkVectorEnv(2)
    with pytest.raises(ResetNeeded, match="reset before step"):
        env.step(np.zeros((2, 2), np.float32))
    env.reset(seed=1)
    for actions in (np.full((2, 2), np.nan, np.float32), np.zeros((1, 2), np.float32)):
        with pytest.raises(InputError) as caught:
            env.step(actions)
        assert caught.value.key == "action"
    env.step(np.zeros((2, 2), np.float32))

"""Learning environments: what Gymnasium asks of them, the same by the same seed, and rules worth beating."""

import time
import warnings

import anergy
import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

import anergy.gym  # noqa: E402
from gymnasium.utils.env_checker import check_env  # noqa: E402

NAMES = ["Pumps", "District", "House"]


@pytest.fixture(scope="module", params=NAMES)
def env(request):
    return getattr(anergy.gym, request.param)()


def test_gymnasium_accepts_it(env):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env, skip_render_check=True)


def episode(env, seed):
    observations = [env.reset(seed=seed)[0]]
    env.action_space.seed(seed)
    rewards = []
    over = False
    while not over:
        observation, reward, terminated, truncated, _ = env.step(env.action_space.sample())
        observations.append(observation)
        rewards.append(reward)
        over = terminated or truncated
    assert truncated and not terminated
    return np.array(observations), np.array(rewards)


def test_episodes_are_told_by_their_seeds(env):
    first = episode(env, 3)
    other = episode(env, 4)
    again = episode(env, 3)
    fresh = episode(type(env)(), 3)
    for one, two in ((first, again), (first, fresh)):
        np.testing.assert_array_equal(one[0], two[0])
        np.testing.assert_array_equal(one[1], two[1])
    assert not np.array_equal(first[1], other[1])
    assert len(first[1]) == round(env.length_s / env.interval_s)
    assert np.isfinite(first[0]).all() and np.isfinite(first[1]).all()


def test_the_rule_is_better_than_chance(env):
    rule, chance = anergy.gym.score(env, env.baseline(), 4), anergy.gym.score(env, None, 4)
    assert rule.mean() > chance.mean() + 1.0
    assert (rule < 0).all()
    np.testing.assert_array_equal(rule, anergy.gym.score(env, env.baseline(), 4))


@pytest.mark.parametrize("name", NAMES)
def test_many_at_once_are_the_same_as_one(name):
    one = gymnasium.make(f"anergy/{name}-v0")
    many = gymnasium.make_vec(f"anergy/{name}-v0", num_envs=3, vectorization_mode="sync")
    observations, _ = many.reset(seed=[5, 6, 7])
    actions = np.random.default_rng(0).uniform(-1, 1, (4, *many.action_space.shape)).astype(np.float32)
    expected = [one.reset(seed=6)[0]]
    for action in actions:
        expected.append(one.step(action[1])[0])
    np.testing.assert_array_equal(observations[1], expected[0])
    for action, wanted in zip(actions, expected[1:]):
        observations, *_ = many.step(action)
        np.testing.assert_array_equal(observations[1], wanted)
    many.close()


def test_many_in_processes():
    many = gymnasium.make_vec("anergy/Pumps-v0", num_envs=2, vectorization_mode="async")
    observations, _ = many.reset(seed=[5, 6])
    single, _ = anergy.gym.Pumps().reset(seed=6)
    np.testing.assert_array_equal(observations[1], single)
    many.step(np.zeros((2, 2), dtype=np.float32))
    many.close()


def test_pumps_block_each_other():
    env = anergy.gym.Pumps()
    env.reset(seed=1)
    for _ in range(6):
        _, reward, *_ = env.step(env.action([0.95, 1.0]))
    # The near pump delivers far too much, the far one less than half: it is blocked.
    assert env.seen[0] < 0.5 * env.wanted_kg_s[0] and env.seen[1] > 1.5 * env.wanted_kg_s[1]
    assert reward < -0.5
    np.testing.assert_allclose(env.command, [0.95, 1.0])


def test_water_comes_late_to_the_last_house():
    env = anergy.gym.District()
    env.reset(seed=1)
    for _ in range(8):
        env.step(env.action([273.15 + 60]))
    before = env.seen[:3].copy()
    for _ in range(2):
        env.step(env.action([273.15 + 85]))
    assert env.seen[0] > before[0] + 5 and abs(env.seen[2] - before[2]) < 1


def test_a_house_of_the_model_file():
    from pathlib import Path

    model = anergy.Model.from_file(Path(__file__).parents[3] / "examples/laboratory-house/model.toml")
    env = anergy.gym.House(model, site="sf1", days=3)
    assert anergy.gym.score(env, env.baseline(), 1)[0] < 0
    colder = anergy.gym.score(env, lambda _: env.action([273.15 + 17, 273.15 + 60]), 1, 2)[0]
    assert colder < anergy.gym.score(env, lambda _: env.action([273.15 + 21, 273.15 + 60]), 1, 2)[0]


def test_steps_that_fail_end_the_episode(monkeypatch):
    env = anergy.gym.Pumps()
    env.reset(seed=1)

    class Broken:
        time_s = 0.0

        def set(self, *_):
            raise anergy.RunError("no water")

    env.simulation = Broken()
    _, reward, terminated, _, info = env.step(np.zeros(2, dtype=np.float32))
    assert terminated and reward == anergy.gym.FAILED and info["error"] == "no water"


class Own(anergy.gym.Environment):
    """The least that an environment says."""

    def reward(self, before):
        return 0.0

    def baseline(self):
        return lambda observation: observation


def test_intervals_are_whole_steps():
    with pytest.raises(ValueError, match="no multiple of the step"):
        Own(anergy.examples.load("three-houses"), {}, {}, 0, 1.5, 10.0, 1.0)


class Watched:
    """A simulation that says how long it has calculated."""

    def __init__(self, simulation):
        self.simulation, self.spent_s = simulation, 0.0

    def step(self, n):
        started = time.process_time()
        self.simulation.step(n)
        self.spent_s += time.process_time() - started

    def __getattr__(self, name):
        return getattr(self.simulation, name)


def overhead_us(env, count):
    """What a step takes beside the physics, in microseconds of the processor."""
    env.reset(seed=1)
    action = np.zeros(env.action_space.shape, dtype=np.float32)
    env.simulation = watched = Watched(env.simulation)
    started = time.process_time()
    for _ in range(count):
        env.step(action)
    whole_s = time.process_time() - started
    env.simulation = watched.simulation
    return 1e6 * (whole_s - watched.spent_s) / count


LIMITS_US = {"Pumps": 50, "House": 50, "District": 100}
"""A step of the district calculates so long that its Python starts from cold caches."""


def test_overhead_of_a_step_is_small(env):
    # Of several attempts the best: other work on the machine only adds.
    best_us = min(overhead_us(env, 60) for _ in range(20))
    assert best_us < LIMITS_US[type(env).__name__]


def test_an_environment_without_reward_is_refused_where_it_is_made():
    class Rewardless(anergy.gym.Environment):
        def baseline(self):
            return lambda observation: observation

    with pytest.raises(TypeError, match="abstract method '?reward'?"):
        Rewardless(anergy.examples.load("three-houses"), {}, {}, 0, 10.0, 60.0)

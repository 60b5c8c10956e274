"""Learning environments of Gymnasium: pumps, a district, a house.

Each has observations and actions between -1 and 1, is reproducible by its seed, and comes with a rule to beat.
`gymnasium.make_vec` makes many of them at once. Needs `pip install anergy[rl]`.

>>> import anergy.gym
>>> env = anergy.gym.Pumps()
>>> observation, info = env.reset(seed=1)
>>> observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
>>> float(anergy.gym.score(env, env.baseline(), episodes=1, seed=1)[0].round(1))
-7.8
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from importlib import resources
from typing import Any, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from anergy import examples
from anergy._core import Model, Snapshot
from anergy._export import _optional
from anergy.errors import RunError

_optional("gymnasium", "rl")

import gymnasium  # noqa: E402

__all__ = ["District", "Environment", "House", "Policy", "Pumps", "score"]

Array: TypeAlias = npt.NDArray[np.float32]
Range: TypeAlias = tuple[float, float]

ZERO_CELSIUS_K = 273.15
FAILED = -100.0
"""Reward of a step that cannot be simulated; it ends the episode."""


class Policy(Protocol):
    """Whatever gives an action for an observation."""

    def __call__(self, observation: Array) -> Array:
        """The action."""


class Environment(gymnasium.Env[Array, Array], ABC):
    """A model whose signals are driven at an interval: the base of the environments here, and of your own.

    An environment of your own says how an episode begins (`begin`), what disturbs it (`disturb`), and what a step is
    worth (`reward`); `told` adds to the observation what is no channel.

    Parameters
    ----------
    model : Model
        What is simulated.
    actions : mapping of str to (float, float)
        Signals, and the values that -1 and 1 stand for.
    observations : mapping of str to (float, float)
        Channels, and the values that -1 and 1 stand for; twice that range is shown.
    told : int
        How many numbers `told` gives.
    interval_s, length_s : float
        Time between two actions, and of an episode, s.
    step_s : float, optional
        Time step of the simulation, s; absent: the model's.
    """

    metadata = {"render_modes": []}

    def __init__(
        self,
        model: Model,
        actions: Mapping[str, Range],
        observations: Mapping[str, Range],
        told: int,
        interval_s: float,
        length_s: float,
        step_s: float | None = None,
    ) -> None:
        self.simulation = model.simulation(step_s=step_s)
        step = self.simulation.step_s
        if step is None or abs(interval_s / step - round(interval_s / step)) > 1e-9:
            raise ValueError(f"interval_s = {interval_s} is no multiple of the step of the simulation, {step} s")
        self.interval_s, self.length_s = interval_s, length_s
        self._steps = round(interval_s / step)
        self._acts = self.simulation.handles(list(actions))
        self._sees = self.simulation.handles(list(observations))
        self._action = _scale(actions)
        self._observation = _scale(observations)
        self.seen = np.zeros(len(observations))
        self.command = np.zeros(len(actions))
        low, half = self._observation
        self._gain, self._shift = 1.0 / half, -low / half - 1.0
        self._shown = np.zeros(len(observations) + told)
        self._channels, self._told = self._shown[: len(observations)], self._shown[len(observations) :]
        self._start = self.simulation.snapshot()
        self._end_s = 0.0
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (len(actions),), np.float32)
        self.observation_space = gymnasium.spaces.Box(-2.0, 2.0, self._shown.shape, np.float32)

    def begin(self) -> Snapshot:
        """Draws what an episode is like, and gives the state that it begins in."""
        return self._start

    def disturb(self, time_s: float) -> None:
        """Drives what the agent does not, for the interval that begins."""

    def told(self, time_s: float) -> list[float]:
        """What is observed beside the channels, about between -1 and 1."""
        return []

    @abstractmethod
    def reward(self, before: npt.NDArray[np.float64]) -> float:
        """What the interval is worth that has passed; `seen` and `command` are known, and the command before."""

    @abstractmethod
    def baseline(self) -> Policy:
        """A rule for the same task, to be beaten; new for each episode."""

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """Begins an episode."""
        super().reset(seed=seed)
        self.simulation.restore(self.begin())
        self._end_s = self.simulation.time_s + self.length_s
        self.simulation.get(self._sees, out=self.seen)
        self.command[:] = [self.simulation.get(name) for name in self._acts.names]
        self.disturb(self.simulation.time_s)
        return self._observe(), {}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Drives the signals for an interval."""
        low, half = self._action
        before = self.command.copy()
        self.command[:] = low + half * (np.minimum(np.maximum(action, -1.0), 1.0) + 1.0)
        try:
            self.simulation.set(self._acts, self.command)
            self.simulation.step(self._steps)
        except RunError as error:
            return self._observe(), FAILED, True, False, {"error": str(error)}
        self.simulation.get(self._sees, out=self.seen)
        reward = self.reward(before)
        time_s = self.simulation.time_s
        self.disturb(time_s)
        return self._observe(), reward, False, time_s >= self._end_s - 1e-6, {}

    def _observe(self) -> Array:
        np.multiply(self.seen, self._gain, out=self._channels)
        np.add(self._channels, self._shift, out=self._channels)
        self._told[:] = self.told(self.simulation.time_s)
        # Not np.clip, which takes longer than everything else here.
        observation: Array = np.minimum(np.maximum(self._shown, -2.0), 2.0).astype(np.float32)
        return observation

    def action(self, command: npt.ArrayLike) -> Array:
        """The action that gives a command, in the units of the signals."""
        low, half = self._action
        return np.clip((np.asarray(command) - low) / half - 1.0, -1.0, 1.0).astype(np.float32)


def _scale(ranges: Mapping[str, Range]) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    low = np.array([low for low, _ in ranges.values()], dtype=float)
    high = np.array([high for _, high in ranges.values()], dtype=float)
    return low, (high - low) / 2.0


def score(
    env: gymnasium.Env[Array, Array],
    policy: Policy | None,
    episodes: int = 20,
    seed: int = 0,
) -> npt.NDArray[np.float64]:
    """Sums of rewards of whole episodes with the seeds `seed`, `seed + 1`, ...

    Parameters
    ----------
    env : gymnasium.Env
        The environment.
    policy : Policy or None
        What gives the action for an observation; None: random actions.
    episodes, seed : int
        How many, and the seed of the first one.

    Returns
    -------
    numpy.ndarray
        Shape `(episodes,)`.
    """
    scores = np.zeros(episodes)
    for k in range(episodes):
        observation, _ = env.reset(seed=seed + k)
        env.action_space.seed(seed + k)
        if isinstance(policy, _Rule):
            policy.start()
        over = False
        while not over:
            action = env.action_space.sample() if policy is None else policy(observation)
            observation, reward, terminated, truncated, _ = env.step(action)
            scores[k] += float(reward)
            over = terminated or truncated
    return scores


class _Rule(ABC):
    """A policy that remembers something within an episode."""

    def start(self) -> None:
        """An episode begins."""

    @abstractmethod
    def __call__(self, observation: Array) -> Array:
        """The action."""


def _text(name: str) -> Model:
    return Model.from_toml((resources.files("anergy") / "_models" / name).read_text(encoding="utf-8"))


class Pumps(Environment):
    """Two pumps feed into one street and must not block each other nor hunt: the three houses.

    Each feeder has a flow to deliver, 2 to 3.5 l/min, new at random moments, while the consumer opens and closes. Actions are
    the speeds of the two pumps, every 10 s for half an hour. Observed: flows, speeds, what is wanted.

    A step is worth minus the mean of what is missing or too much, relative to what is wanted (at most 1 each), minus the mean
    change of the speeds: hunting costs.

    The rule is a PI controller for each pump, as `[[controller]]` of the kind `pi` does it.
    """

    def __init__(self, model: Model | None = None) -> None:
        speeds = {f"sf{i}.feed_in_pump.speed": (0.4, 1.0) for i in (1, 2)}
        flows = {f"sf{i}.station.m_flow_kg_s": (0.0, 0.12) for i in (1, 2)}
        super().__init__(model or examples.load("three-houses"), speeds, flows | speeds, 2, 10.0, 1800.0, 1.0)
        self.wanted_kg_s = np.full(2, 0.05)
        self._valve = self.simulation.handle("sf4.extraction_valve.kappa")

    def begin(self) -> Snapshot:
        """Draws the first speeds and wishes."""
        self._draw()
        self.simulation.restore(self._start)
        self.simulation.set(self._valve, self.np_random.uniform(0.4, 0.6))
        self.simulation.set(self._acts, self.np_random.uniform(0.8, 1.0, 2))
        self.simulation.step(60)
        return self.simulation.snapshot()

    def _draw(self) -> None:
        self.wanted_kg_s = self.np_random.uniform(2.0, 3.5, 2) / 60.0

    def disturb(self, time_s: float) -> None:
        """About every 5 min another wish, or another opening of the consumer."""
        chance = self.np_random.random()
        if chance < 1 / 60:
            self._draw()
        elif chance < 2 / 60:
            self.simulation.set(self._valve, self.np_random.uniform(0.4, 0.6))

    def told(self, time_s: float) -> list[float]:
        """What is wanted."""
        return [wanted / 0.06 - 1.0 for wanted in self.wanted_kg_s.tolist()]

    def reward(self, before: npt.NDArray[np.float64]) -> float:
        """Minus what is missing and what the pumps moved."""
        # Numbers of Python: arrays of two take longer.
        pairs = zip(self.seen.tolist(), self.wanted_kg_s.tolist())
        missed = sum(min(abs(flow / wanted - 1.0), 1.0) for flow, wanted in pairs)
        moved = sum(abs(now - then) for now, then in zip(self.command.tolist(), before.tolist()))
        return -0.5 * float(missed + moved)

    def baseline(self) -> Policy:
        """A PI controller for each pump."""
        return _PumpPi(self)


class _PumpPi(_Rule):
    GAIN = 1.0
    """Of the speed, per kg/s: with twice as much the two pumps hunt against each other."""
    INTEGRAL_TIME_S = 10.0

    def __init__(self, env: Pumps) -> None:
        self.env = env
        self.start()

    def start(self) -> None:
        self.integral = np.zeros(2)
        self.fresh = True

    def __call__(self, observation: Array) -> Array:
        env = self.env
        if self.fresh:
            self.integral, self.fresh = env.command.copy(), False
        error = env.wanted_kg_s - env.seen[:2]
        change = self.GAIN * error * env.interval_s / self.INTEGRAL_TIME_S
        self.integral = np.clip(self.integral + change, 0.4, 1.0)
        return env.action(np.clip(self.integral + self.GAIN * error, 0.4, 1.0))


class District(Environment):
    """The supply temperature of a plant that three houses of a winter day live on.

    The action is the supply temperature, 55 to 85 degC, every 15 min for two days. Hotter water loses more heat, colder water
    needs more pumping; each house needs a temperature that follows the weather, and hot water comes late to the last one.
    Observed: temperatures at the houses, the plant, the weather now and in three and six hours.

    A step is worth minus the cost of losses and pumping (electricity 2.5 times heat), by the kWh of a step at 10 kW, and minus
    0.2 for each kelvin that a house is short of, at most 2.

    The rule is the usual one: a curve over the outdoor temperature, with a reserve for the last house.
    """

    NEEDED_DEGC = 58.0
    """What a house needs when it is not cold."""
    PER_K = 0.6
    """What it needs more for each K below 5 degC outdoors."""

    def __init__(self, model: Model | None = None) -> None:
        degc = ZERO_CELSIUS_K
        houses = [f"h{i}.unit.t_in_k" for i in (1, 2, 3)]
        seen = {name: (degc + 45, degc + 85) for name in houses}
        seen |= {"plant.unit.supply_k_command": (degc + 55, degc + 85), "plant.circulation_pump.power_w": (0.0, 600.0)}
        action = {"plant.unit.supply_k": (degc + 55, degc + 85)}
        super().__init__(model or _text("district.toml"), action, seen, 5, 900.0, 172_800.0, 300.0)
        lost = [name for name in self.simulation.channels if name.endswith(".q_loss_w")]
        self._lost = self.simulation.handles(lost)
        self._loads = self.simulation.handles([f"h{i}.unit.load_w" for i in (1, 2, 3)])
        self._weather: tuple[float, float, float] = (0.0, 0.0, 0.0)
        self._size = [1.0, 1.0, 1.0]

    def begin(self) -> Snapshot:
        """Draws the weather: mean, daily swing, a cold or warm spell; and the houses."""
        random = self.np_random
        self._weather = (random.uniform(-8, 8), random.uniform(1, 5), random.uniform(-8, 8))
        self._size = random.uniform(0.7, 1.2, 3).tolist()
        return self._start

    def outdoor_degc(self, time_s: float) -> float:
        """Outdoor temperature, degC."""
        mean, swing, spell = self._weather
        day = time_s / 86_400.0
        return mean + swing * math.sin(2 * math.pi * (day - 0.375)) + spell * math.tanh(4 * (day - 1.0)) / 2

    def needed_degc(self, time_s: float) -> float:
        """What the houses need, degC."""
        return self.NEEDED_DEGC + self.PER_K * max(5.0 - self.outdoor_degc(time_s), 0.0)

    def disturb(self, time_s: float) -> None:
        """Loads follow the weather and the hour."""
        hour = time_s / 3600.0 % 24.0
        morning = 1.0 + 0.4 * math.exp(-((hour - 7.0) ** 2) / 2.0)
        heat_w = 1e3 * max(18.0 - self.outdoor_degc(time_s), 1.0)
        self.simulation.set(self._loads, [heat_w * morning * size for size in self._size])

    def told(self, time_s: float) -> list[float]:
        """Weather now and later, the hour."""
        weather = [self.outdoor_degc(time_s + ahead_s) / 15.0 for ahead_s in (0.0, 10_800.0, 21_600.0)]
        angle = 2 * math.pi * time_s / 86_400.0
        return [*weather, math.sin(angle), math.cos(angle)]

    def reward(self, before: npt.NDArray[np.float64]) -> float:
        """Minus cost and shortage."""
        *houses_k, _, pump_w = self.seen.tolist()
        cost_w = sum(self.simulation.get(self._lost).tolist()) + 2.5 * pump_w
        needed_k = self.needed_degc(self.simulation.time_s) + ZERO_CELSIUS_K
        short_k = sum(max(needed_k - house_k, 0.0) for house_k in houses_k)
        return float(-cost_w / 1e4 - min(0.2 * short_k, 2.0))

    def baseline(self) -> Policy:
        """A curve over the outdoor temperature."""
        return _Curve(self)


class _Curve(_Rule):
    RESERVE_K = 5.0
    """For what is lost on the way, and for water that left the plant while it was warmer."""

    def __init__(self, env: District) -> None:
        self.env = env

    def __call__(self, observation: Array) -> Array:
        env = self.env
        degc = env.needed_degc(env.simulation.time_s) + self.RESERVE_K
        return env.action([degc + ZERO_CELSIUS_K])


class House(Environment):
    """A house in winter: when to warm the rooms, and how hot to keep the storage.

    Actions are the set temperature of the rooms, 17 to 23 degC, and the temperature below which the generator charges the
    storage, 35 to 70 degC, every 15 min for two days. Observed: room, storage, weather, the hour and the price of heat, which is
    1.5 times as high from 16 to 21 h.

    A step is worth minus the fuel in kWh times the price, divided by the kWh of a step at 10 kW, and minus 0.5 for each kelvin
    that the rooms are colder than 20.5 degC from 6 to 22 h or warmer than 23 degC, at most 2.

    Any model with a building, a storage and a generator behind a `two_sensors` controller will do: name them. An episode begins on
    one of the first `days` days.

    The rule is that of the model: rooms at 21 degC by day and 18 degC by night, storage at 60 degC.

    Parameters
    ----------
    model : Model, optional
        Absent: a house with a gas boiler of 20 kW.
    site : str
        Where it stands.
    generator, controller : str
        Names of its unit and of what switches it.
    top, bottom : str
        Channels of the storage.
    days : int
        Days of the model to begin on; the episodes must fit into its weather.
    """

    def __init__(
        self,
        model: Model | None = None,
        site: str = "home",
        generator: str = "boiler",
        controller: str = "boiler_control",
        top: str = "storage.t_8_k",
        bottom: str = "storage.t_1_k",
        days: int = 30,
    ) -> None:
        degc = ZERO_CELSIUS_K
        actions = {
            f"{site}.building.room_set_k": (degc + 17, degc + 23),
            f"{site}.{controller}.on_below_k": (degc + 35, degc + 70),
        }
        seen = {
            f"{site}.building.t_room_k": (degc + 17, degc + 23),
            f"{site}.{top}": (degc + 20, degc + 80),
            f"{site}.{bottom}": (degc + 20, degc + 80),
            "weather.t_outdoor_k": (degc - 15, degc + 15),
            "weather.global_horizontal_w_m2": (0.0, 600.0),
        }
        super().__init__(model or _text("house.toml"), actions, seen, 3, 900.0, 172_800.0, 60.0)
        self._fuel = self.simulation.handle(f"{site}.{generator}.fuel_j")
        self._off = self.simulation.handle(f"{site}.{controller}.off_above_k")
        self._days = days
        self._mornings = [self._start]
        self._used_j = 0.0
        self._mean_room_k = 0.0

    def begin(self) -> Snapshot:
        """Draws the day, which the house has reached under the rules of its model."""
        day = int(self.np_random.integers(self._days))
        if day >= len(self._mornings):
            self.simulation.restore(self._mornings[-1])
            while day >= len(self._mornings):
                self.simulation.advance(86_400.0 * len(self._mornings))
                self._mornings.append(self.simulation.snapshot())
        self.simulation.restore(self._mornings[day])
        self._used_j = self.simulation.get(self._fuel)
        return self._mornings[day]

    @staticmethod
    def price(time_s: float) -> float:
        """Price of fuel, relative."""
        return 1.5 if 16.0 <= time_s / 3600.0 % 24.0 < 21.0 else 1.0

    def told(self, time_s: float) -> list[float]:
        """The hour, and the price."""
        angle = 2 * math.pi * time_s / 86_400.0
        return [math.sin(angle), math.cos(angle), 4.0 * self.price(time_s) - 5.0]

    def disturb(self, time_s: float) -> None:
        """The storage is full a little above where charging begins."""
        if time_s > 0.0:
            self.simulation.set(self._off, min(float(self.command[1]), ZERO_CELSIUS_K + 65.0))

    def reward(self, before: npt.NDArray[np.float64]) -> float:
        """Minus fuel and discomfort."""
        used_j = self.simulation.get(self._fuel)
        fuel = (used_j - self._used_j) / (1e4 * self.interval_s)
        self._used_j = used_j
        began_s = self.simulation.time_s - self.interval_s
        room_degc = float(self.seen[0]) - ZERO_CELSIUS_K
        cold_k = max(20.5 - room_degc, 0.0) if 6.0 <= began_s / 3600.0 % 24.0 < 22.0 else 0.0
        discomfort_k = cold_k + max(room_degc - 23.0, 0.0)
        return -fuel * self.price(began_s) - min(0.5 * discomfort_k, 2.0)

    def baseline(self) -> Policy:
        """Day and night."""
        return _DayAndNight(self)


class _DayAndNight(_Rule):
    def __init__(self, env: House) -> None:
        self.env = env

    def __call__(self, observation: Array) -> Array:
        hour = self.env.simulation.time_s / 3600.0 % 24.0
        room_degc = 21.0 if 5.0 <= hour < 22.0 else 18.0
        return self.env.action([room_degc + ZERO_CELSIUS_K, 60.0 + ZERO_CELSIUS_K])


gymnasium.register("anergy/Pumps-v0", entry_point="anergy.gym:Pumps")
gymnasium.register("anergy/District-v0", entry_point="anergy.gym:District")
gymnasium.register("anergy/House-v0", entry_point="anergy.gym:House")

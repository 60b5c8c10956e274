"""From what is true to what is logged: lag, clock, jitter, noise, offset, gain, resolution, gaps."""

from dataclasses import dataclass, field

import numpy as np
from numba import njit

ROOT3 = 3**0.5
# A value in SI as a reading.
UNITS = {"degC": (1.0, -273.15), "K": (1.0, 0.0), "kg_h": (3600.0, 0.0), "l_h": (3.6e6, 0.0), "hPa": (0.01, 0.0),
         "kW": (1e-3, 0.0), "W": (1.0, 0.0), "1": (1.0, 0.0), "percent": (100.0, 0.0)}
# Share of a run after which a sensor jumps.
JUMPS_AT = 0.42
# No data sheet says how slow a sensor is in its pocket: up to so much more than what is known, s.
UNKNOWN_LAG_S = 3.0
# Seconds that truths go on after the last reading.
SPARE_S = 120
# Resolution, lag.
TEMPERATURE = dict(unit="degC", quantisation=0.1)
FLOW = dict(unit="kg_h", quantisation=1.0)


@dataclass
class Sensor:
    column: str
    signal: str
    role: str
    klass: str | None
    unit: str
    truth: str  # channel of the truth, SI
    quantisation: float = 0.0
    lag_s: float = 0.0
    clock: str = "logger"
    signed: bool = False  # reads backward flow as such
    blank: str = ""  # channel of the flow without which it reads nothing, as heat meters do
    draws: dict = field(default_factory=dict)

    @property
    def kind(self):
        return {"degC": "k", "K": "k", "kg_h": "kg_s", "l_h": "m3_s", "hPa": "pa", "kW": "w", "W": "w"}.get(self.unit, "1")

    def limits(self, y):
        """Largest permissible offset and gain error and the noise, SI, for true values `y`."""
        mean, top = np.mean(y), np.max(np.abs(y))
        degc = abs(mean - 273.15)
        return {
            "pt100_a": (0.15 + 0.002 * degc, 0.0, 0.02),
            "pt100_b": (0.30 + 0.005 * degc, 0.0, 0.02),
            "heat_meter_pair": (0.1, 0.0, 0.02),
            "surface": (1.0, 0.0, 0.1),
            "mid": (0.002 * top, 0.005, 0.002 * abs(mean)),
            "flow_class_2": (0.0, 0.02, 0.005 * abs(mean)),
            "electric_0_2": (0.0, 0.002, 0.001 * abs(mean)),
            "dp_0_25": (0.0025 * top, 0.0, 0.0005 * top),
            None: (0.0, 0.0, 0.0),
        }[self.klass]

    def resolution_si(self):
        return self.quantisation / UNITS[self.unit][0]

    def perfect(self, y, at_s, effect=None):
        """What it would read without errors of its own but with this effect."""
        effect = effect or {}
        x = np.interp(at_s + effect.get("clock_s", 0.0), np.arange(y.size), lagged(y, self.lag_s + effect.get("lag_s", 0.0)))
        factor, offset = UNITS[self.unit]
        return (effect.get("gain", 1.0) * x + own_offset(effect, at_s, y.size)) * factor + offset

    def toml(self):
        lines = [f'column = "{self.column}"', f'signal = "{self.signal}"', f'unit = "{self.unit}"', f'role = "{self.role}"']
        if self.klass:
            lines.append(f'class = "{self.klass}"')
        if self.quantisation:
            lines.append(f"quantisation = {self.quantisation}")
        if self.lag_s:
            lines.append(f"lag_s = {self.lag_s}")
        lines.append(f'clock = "{self.clock}"')
        return "[[sensor]]\n" + "\n".join(lines) + "\n"


def own_offset(effect, at_s, duration_s):
    """What a sensor adds, SI: constant, or a drift or a jump in the course of a run of so many seconds."""
    share = at_s / (duration_s - SPARE_S)
    jump = effect.get("step_k", 0.0) * (share > JUMPS_AT)
    constant = effect.get("bias_k", 0.0) + effect.get("offset_kg_s", 0.0) + effect.get("offset_m3_s", 0.0)
    return constant + effect.get("drift_k", 0.0) * share + jump


def as_read(rig, y):
    """What is known of an input of every second from its readings: a straight line between two of them, the first at `rig["as_read_s"]`."""
    if "as_read_s" not in rig:
        return y
    t = np.arange(y.size)
    at_s = np.arange(rig["as_read_s"] - rig["every_s"], y.size + rig["every_s"], rig["every_s"])
    return np.interp(t, at_s, np.interp(at_s, t, y))


def commanded(key):
    """The plant as a command is read: the gain of its reading on its own factor."""
    return lambda p, bias, gain, as_is=False: p | {key: p[key] * gain}


def held(rig, y):
    """The same of a command, which is one or the other: that of the nearest reading."""
    if "as_read_s" not in rig:
        return y
    t = np.arange(y.size)
    at_s = rig["as_read_s"] + rig["every_s"] * np.round((t - rig["as_read_s"]) / rig["every_s"])
    return y[np.clip(at_s, 0, y.size - 1).astype(int)]


# What a further run does otherwise: half of the flow, so many K more or less, so many seconds without flow, from its middle on.
HALF_FLOW, WARMER_K, HOTTEST_DEGC, HOLD_S = 0.5, 15.0, 80.0, 1200


def otherwise(rig, y, quantity):
    """What drives the plant in a further run, `rig["otherwise"]`: y every second, a flow, a temperature in degC or anything else."""
    how, middle = rig.get("otherwise"), (y.size - SPARE_S) // 2
    if how == "half" and quantity == "flow":
        return np.concatenate([y[:middle], HALF_FLOW * y[middle:]])
    if how == "warmer" and quantity == "degc":
        step_k = WARMER_K if y.max() + WARMER_K < HOTTEST_DEGC else -WARMER_K
        return y + step_k * np.clip((np.arange(y.size) - middle) / 60.0, 0, 1)
    if how == "hold":
        return np.concatenate([y[:middle], np.full(HOLD_S, 0.0 if quantity == "flow" else y[middle - 1]), y[middle:]])
    return y


def longer_s(rig):
    """Seconds by which a further run is longer."""
    return HOLD_S if rig.get("otherwise") == "hold" else 0


def lagged(y, tau):
    """First order, samples of 1 s."""
    if tau <= 0:
        return y
    return _lagged(np.ascontiguousarray(y, dtype=float), float(tau))


@njit(cache=True)
def _lagged(y, tau):
    out, keep = np.empty_like(y), np.exp(-1.0 / tau)
    state = y[0]
    # y is straight between its samples.
    for i, x in enumerate(y):
        state = x if i == 0 else x - (x - y[i - 1]) * tau * (1 - keep) + (state - y[i - 1]) * keep
        out[i] = state
    return out


def pink(n, rng):
    """1/f noise of standard deviation 1."""
    f = np.fft.rfftfreq(n)
    f[0] = 1.0
    spectrum = (rng.normal(size=f.size) + 1j * rng.normal(size=f.size)) / np.sqrt(f)
    spectrum[0] = 0
    x = np.fft.irfft(spectrum, n)
    return x / max(x.std(), 1e-12)


def draw(sensor, y, rng, edge):
    """Offset and gain error within the class: anywhere, or at its edge."""
    bias, gain, _ = sensor.limits(y)
    within = (lambda: rng.choice([-1, 1]) * rng.uniform(0.9, 1.0)) if edge else (lambda: rng.uniform(-0.6, 0.6))
    sensor.draws = {"bias": bias * within(), "gain": 1 + gain * within(), "lag_s": 0.2 * sensor.lag_s * rng.uniform(-1, 1) + rng.uniform(0, UNKNOWN_LAG_S)}


def measure(sensor, y, at_s, rng, clock_s=0.0, effect=None):
    """Readings in the unit of the sensor at nominal times `at_s` of true values `y` of every second from 0 on."""
    effect = effect or {}
    tau = sensor.lag_s + sensor.draws["lag_s"] + effect.get("lag_s", 0.0)
    behind = lagged(y, tau)
    times = at_s + rng.uniform(-1, 1, at_s.size) + clock_s + effect.get("clock_s", 0.0)
    x = np.interp(times, np.arange(y.size), behind)
    _, _, noise = sensor.limits(y)
    x = sensor.draws["gain"] * effect.get("gain", 1.0) * x + sensor.draws["bias"]
    x = x + noise * rng.normal(size=x.size) + 0.5 * noise * pink(x.size, rng)
    if sensor.kind in ("kg_s", "m3_s"):
        x = np.where(np.abs(np.interp(times, np.arange(y.size), y)) < 1e-6, 0.0, x)  # low-flow cut-off
        x = x + own_offset(effect, at_s, y.size)
        x = x if sensor.signed else np.maximum(x, 0.0)
    elif sensor.kind == "k":
        x = x + own_offset(effect, at_s, y.size)
    if sensor.kind == "1":
        x = np.maximum(x, 0.0)  # commands
    factor, offset = UNITS[sensor.unit]
    x = x * factor + offset
    if sensor.quantisation:
        x = np.round(x / sensor.quantisation) * sensor.quantisation
    return x


def spoil(table, inputs, at_s, rng, plain=False):
    """2 % of all readings missing, one gap of all columns, now and then a column that holds its value for a while."""
    n = at_s.size
    for name, x in table.items():
        first = x[0]
        x[rng.random(n) < 0.02] = np.nan
        if name in inputs:
            x[0] = first
    if plain:
        return
    start = int(rng.uniform(0.2, 0.8) * n)
    gap = slice(start, start + max(int(rng.uniform(60, 180) / (at_s[1] - at_s[0])), 1))
    for x in table.values():
        x[gap] = np.nan
    if rng.random() < 0.3:
        x = table[rng.choice(list(table))]
        start = int(rng.uniform(0.1, 0.9) * n)
        x[start : start + max(int(60 / (at_s[1] - at_s[0])), 2)] = x[start]

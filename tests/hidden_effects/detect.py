"""What can be seen of an effect beside noise and everything that is uncertain anyway, and what cannot be told apart from it.

Residuals r of an effect, over the noise of the samples; G: what tolerances (offsets and gains of sensors, lengths, losses, ...)
can make of the same readings, times their standard deviations. The expected gain in log-likelihood is
`<r, r>/2` with `<a, b> = a.b - a.G (1 + G'G)^-1 G'.b`.
"""

import tomllib

import numpy as np

from sensors import ROOT3, lagged

# Noise of a sample that says nothing, in any unit.
NOTHING = 1e12


class Look:
    """Readings of all compared sensors of a rig as one vector, over the noise.

    Noise: of the sensor, its resolution, and the moment of a reading, which is only known to lie within its interval. Samples that
    are not given to be fitted (`fitted`: which are) say nothing: what is kept to be shown, and what is left out after a change.
    """

    def __init__(self, sensors, base, at_s, fitted):
        self.sensors = [s for s in sensors if s.role == "compare"]
        self.at_s, self.channels = at_s, base
        self.base = self.readings(base)
        sigma = []
        for sensor in self.sensors:
            y = base[sensor.truth][0]
            rate = np.gradient(self.sampled(lagged(y, sensor.lag_s)), at_s)
            _, _, noise = sensor.limits(y)
            moment = rate * (at_s[1] - at_s[0]) / 12**0.5
            blank = still(base[sensor.blank][0], at_s) if sensor.blank else False
            sigma.append(np.where(blank | ~fitted, NOTHING, np.sqrt(1.25 * noise**2 + sensor.resolution_si() ** 2 / 12 + moment**2)))
        self.sigma = np.concatenate(sigma)
        self.g = np.zeros((self.sigma.size, 0))

    def sampled(self, y):
        return np.interp(self.at_s, np.arange(y.size), y)

    def readings(self, channels, k=0):
        return np.concatenate([self.sampled(lagged(channels[s.truth][k], s.lag_s)) for s in self.sensors])

    def noisier(self, signature, noise):
        """Noise of a measured input, by what one unit of it changes: independent from sample to sample."""
        before = self.sigma.copy()
        self.sigma = np.hypot(before, signature * before * noise)
        self.g *= (before / self.sigma)[:, None]

    def unread(self, others):
        """Noise of what inputs do between two readings: what the plant does where it is driven by what is read of them, at several moments."""
        self.between = self.off(others, 0, self.channels, 0)
        self.noisier(self.around(self.between) / self.sigma, 1.0)

    def off(self, others, j, channels, k):
        """How far readings of variant j of each of others are from those of variant k of channels."""
        return np.array([self.readings(other, j) - self.readings(channels, k) for other in others])

    def around(self, off):
        """Root mean square of such differences over neighbouring samples too."""
        squares = np.mean(off**2, axis=0).reshape(len(self.sensors), -1)
        beside = np.pad(squares, ((0, 0), (1, 1)), mode="edge")
        return np.sqrt((beside[:, :-2] + beside[:, 1:-1] + beside[:, 2:]) / 3).ravel()

    def of(self, channels, k):
        """Signature of variant k."""
        return (self.readings(channels, k) - self.base) / self.sigma

    def of_sensor(self, sensor, make):
        """Signature of what one compared sensor does: `make` turns what it reads every second into something else."""
        out = []
        for s in self.sensors:
            y = lagged(self.channels[s.truth][0], s.lag_s)
            out.append(self.sampled(make(y)) - self.sampled(y) if s is sensor else np.zeros(self.at_s.size))
        return np.concatenate(out) / self.sigma

    def shaped(self, sensor, shape):
        """Signature of what a sensor adds in the course of time."""
        return np.concatenate([shape if s is sensor else np.zeros(self.at_s.size) for s in self.sensors]) / self.sigma

    def tolerate(self, signature, sd=1.0):
        self.g = np.column_stack([self.g, sd * signature])

    def ready(self):
        self.inverse = np.linalg.inv(np.eye(self.g.shape[1]) + self.g.T @ self.g)

    def inner(self, a, b):
        return a @ b - (a @ self.g) @ self.inverse @ (self.g.T @ b)

    def gain(self, r, further=0.0):
        """Expected gain; `further` is how much further readings are off with the effect than without it (`off`)."""
        more = self.around(self.between + further) ** 2 - self.around(self.between) ** 2
        w = 1.0 / np.sqrt(1.0 + np.maximum(more, 0.0) / self.sigma**2)
        r, g = r * w, self.g * w[:, None]
        across = g.T @ r
        return 0.5 * (r @ r - across @ np.linalg.solve(np.eye(g.shape[1]) + g.T @ g, across))

    def untouched(self, r):
        """Sensors that hardly see it: below a twentieth of their noise on average."""
        each = r.reshape(len(self.sensors), -1)
        return [s.column for s, x in zip(self.sensors, each) if np.sqrt(np.mean(x**2)) < 0.05]

    def cosine(self, a, b):
        return abs(self.inner(a, b)) / max(np.sqrt(self.inner(a, a) * self.inner(b, b)), 1e-12)


def still(m_flow, at_s):
    """Samples around which nothing flows."""
    least = np.minimum.reduce([np.interp(at_s + dt, np.arange(m_flow.size), m_flow) for dt in (-3, 0, 3)])
    return least < 1e-6


def slow(tau):
    return lambda y: lagged(y, tau)


def shifted(delta):
    return lambda y: np.interp(np.arange(y.size) + delta, np.arange(y.size), y)


def fitted(split, at_s):
    """Which samples a split (the text of the file) gives to be fitted: those that identify, and those that validate."""
    blocks = [b for b in tomllib.loads(split)["block"] if b["role"] != "show"]
    return np.any([(at_s >= b["from_s"]) & (at_s <= b["until_s"]) for b in blocks], axis=0)


def stratum(gain):
    return "none" if gain < 5 else "hard" if gain < 15 else "medium" if gain < 60 else "easy"

"""What can be seen of an effect beside noise and everything that is uncertain anyway, and what cannot be told apart from it.

Residuals r of an effect, over the noise of the samples; G: what tolerances (offsets and gains of sensors, lengths, losses, ...)
can make of the same readings, times their standard deviations. The expected gain in log-likelihood is
`<r, r>/2` with `<a, b> = a.b - a.G (1 + G'G)^-1 G'.b`.
"""

import numpy as np

from sensors import ROOT3, lagged


class Look:
    """Readings of all compared sensors of a rig as one vector, over the noise."""

    def __init__(self, rig, sensors, base, at_s):
        self.sensors = [s for s in sensors if s.role == "compare"]
        self.at_s, self.every = at_s, at_s[1] - at_s[0]
        self.base = self.readings(base)
        sigma = []
        for sensor in self.sensors:
            y = base[sensor.truth][0]
            rate = np.gradient(self.one(sensor, base, 0), at_s)
            _, _, noise = sensor.limits(y)
            blank = 1e6 if sensor.blank else 0.0
            still = base[sensor.blank][0][np.minimum(at_s.astype(int), y.size - 1)] < 1e-6 if sensor.blank else False
            sigma.append(np.where(still, blank, 0.0) + np.sqrt(1.25 * noise**2 + sensor.resolution_si() ** 2 / 12 + (rate / ROOT3) ** 2))
        self.sigma = np.concatenate(sigma)
        self.g = np.zeros((self.sigma.size, 0))

    def one(self, sensor, channels, k):
        return np.interp(self.at_s, np.arange(channels[sensor.truth].shape[1]), lagged(channels[sensor.truth][k], sensor.lag_s))

    def readings(self, channels, k=0):
        return np.concatenate([self.one(sensor, channels, k) for sensor in self.sensors])

    def of(self, channels, k):
        """Signature of variant k."""
        return (self.readings(channels, k) - self.base) / self.sigma

    def of_sensor(self, sensor, make):
        """Signature of what one compared sensor does: `make` turns its readings (times, values) into others."""
        out, start = np.zeros(self.sigma.size), 0
        for s in self.sensors:
            n = self.at_s.size
            if s is sensor:
                y = self.base[start : start + n]
                out[start : start + n] = make(self.at_s, y) - y
            start += n
        return out / self.sigma

    def tolerate(self, signature, sd=1.0):
        self.g = np.column_stack([self.g, sd * signature])

    def ready(self):
        self.inverse = np.linalg.inv(np.eye(self.g.shape[1]) + self.g.T @ self.g)

    def inner(self, a, b):
        return a @ b - (a @ self.g) @ self.inverse @ (self.g.T @ b)

    def gain(self, r):
        return 0.5 * self.inner(r, r)

    def cosine(self, a, b):
        return abs(self.inner(a, b)) / max(np.sqrt(self.inner(a, a) * self.inner(b, b)), 1e-12)


def slow(tau):
    def make(at_s, y):
        fine = np.arange(at_s[0], at_s[-1] + 1.0)
        return np.interp(at_s, fine, lagged(np.interp(fine, at_s, y), tau))

    return make


def shifted(delta):
    return lambda at_s, y: np.interp(at_s + delta, at_s, y)


def stratum(gain):
    return "none" if gain < 5 else "hard" if gain < 15 else "medium" if gain < 60 else "easy"

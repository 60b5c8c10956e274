"""Water in a pipe with its wall: finite volumes, many variants of one pipe side by side.

Second-order upwind with a limiter (monotonised central differences) in steps of at most 0.8 cells. Then, once a second:
dispersion, and the wall, a node per cell behind the film of the water that loses the heat to what is around, through a node of soil where there is one. Heat capacity
is that of the temperature of each cell; density, viscosity and film are those of the mean temperature, once per second.
"""

import numpy as np
from numba import njit

import water

CELLS = 200
_H = water._ENTHALPY.copy()
_C = water._VOLUMETRIC.copy()


@njit(cache=True, fastmath=True)
def _value(p, t):
    y = p[0]
    for a in p[1:]:
        y = y * t + a
    return y


@njit(cache=True, fastmath=True)
def _second(t, wall, ground, t_from, t_to, m, around, dt, steps, dx, area, wall_j, film, loss, spread, ground_j, ground_k_m_w, h, c):
    """One variant for a second, `steps` times `dt`; the temperature at the outlet at its end. Water enters at index 0."""
    n = t.size
    face = np.empty(n + 1)
    work = np.empty(n)
    for step in range(steps):
        inlet = t_from + (t_to - t_from) * (step + 0.5) / steps
        kg = m * dt / dx
        face[0] = inlet
        for i in range(n):
            up = t[i] - (t[i - 1] if i > 0 else inlet)
            down = t[i + 1] - t[i] if i < n - 1 else 0.0
            slope = 0.0
            if up * down > 0.0:
                slope = min(2 * abs(up), 2 * abs(down), 0.5 * abs(up + down)) * np.sign(up)
            capacity = _value(c, t[i]) * area
            work[i] = capacity
            face[i + 1] = t[i] + 0.5 * (1 - kg * 4180.0 / capacity) * slope
        h_in = _value(h, face[0])
        for i in range(n):
            h_out = _value(h, face[i + 1])
            t[i] += kg * (h_in - h_out) / work[i]
            h_in = h_out
    if spread > 0.0 and m > 1e-7:
        # Implicit, by elimination; nothing leaves through the ends.
        x = spread / dx**2
        upper = face
        upper[0] = x / (1 + x)
        t[0] = t[0] / (1 + x)
        for i in range(1, n):
            diagonal = 1 + (2 * x if i < n - 1 else x)
            rest = diagonal - x * upper[i - 1]
            upper[i] = x / rest
            t[i] = (t[i] + x * t[i - 1]) / rest
        for i in range(n - 2, -1, -1):
            t[i] += upper[i] * t[i + 1]
    for i in range(n):
        capacity = work[i]
        # Water and wall: exact for two bodies.
        mean = (t[i] * capacity + wall[i] * wall_j) / (capacity + wall_j)
        decay = np.exp(-film * (1 / capacity + 1 / wall_j))
        t[i] = mean + (t[i] - mean) * decay
        wall[i] = mean + (wall[i] - mean) * decay
        outside = ground[i] if ground_j > 0 else around
        thin = wall_j < 0.2 * capacity  # then water and wall cool together
        change = loss * (outside - wall[i]) / (wall_j + (capacity if thin else 0.0))
        wall[i] += change
        if thin:
            t[i] += change
        if ground_j > 0:
            gain = -change * (wall_j + (capacity if thin else 0.0))
            ground[i] += (gain - (ground[i] - around) / ground_k_m_w * 1.0) / ground_j
    return 1.5 * t[n - 1] - 0.5 * t[n - 2]


@njit(cache=True, fastmath=True)
def _all(t, wall, ground, t_from, t_to, m, around, steps, dx, area, wall_j, film, loss, spread, ground_j, ground_r, h, c):
    out = np.empty(t.shape[0])
    for k in range(t.shape[0]):
        if m[k] < 0:
            a, b, g = t[k, ::-1].copy(), wall[k, ::-1].copy(), ground[k, ::-1].copy()
        else:
            a, b, g = t[k], wall[k], ground[k]
        out[k] = _second(a, b, g, t_from[k], t_to[k], abs(m[k]), around[k], 1.0 / steps, steps, dx[k], area[k], wall_j[k],
                         film[k], loss[k], spread[k], ground_j[k], ground_r[k], h, c)
        if m[k] < 0:
            t[k], wall[k], ground[k] = a[::-1], b[::-1], g[::-1]
    return out


class Pipe:
    """Every argument is a number or an array of one number per variant."""

    def __init__(self, variants, length_m, inner_m, wall_j_m_k, resistance_k_m_w, t_degc, roughness_m=1e-5, zeta=0.0,
                 film=1.0, dispersion_m2_s=0.004, standstill=1.0, friction=1.0,
                 ground_j_m_k=0.0, ground_k_m_w=1.0, around_degc=None, cells=CELLS):
        def row(x):
            return np.broadcast_to(np.asarray(x, float), (variants,)).copy()

        self.length, self.inner, self.wall_j = row(length_m), row(inner_m), np.maximum(row(wall_j_m_k), 1.0)
        self.resistance, self.roughness, self.zeta = row(resistance_k_m_w), row(roughness_m), row(zeta)
        self.film, self.spread = row(film), row(dispersion_m2_s)
        self.standstill, self.friction = row(standstill), row(friction)
        self.ground_j, self.ground_r = row(ground_j_m_k), row(ground_k_m_w)
        self.area = np.pi * self.inner**2 / 4
        self.dx = self.length / cells
        self.t = np.repeat(row(t_degc)[:, None], cells, axis=1)
        self.wall = self.t.copy()
        # Ground that no pipe has warmed before.
        self.ground = self.t.copy() if around_degc is None else np.repeat(row(around_degc)[:, None], cells, axis=1)
        self.before = None
        self.dp = np.zeros(variants)

    def second(self, m_flow_kg_s, t_in, around_degc):
        """One second of flow with water that enters at the upstream end; the temperature of the outlet at its end."""
        count = len(self.t)
        m = np.broadcast_to(np.asarray(m_flow_kg_s, float), (count,))
        t_in = np.broadcast_to(np.asarray(t_in, float), (count,))
        around = np.broadcast_to(np.asarray(around_degc, float), (count,))
        mean = self.t.mean(axis=1)
        mu, rho, lam = water.viscosity(mean), water.density(mean), water.conductivity(mean)
        reynolds = 4 * np.abs(m) / (np.pi * self.inner * mu)
        nu = water.nusselt(reynolds, mu * water.heat_capacity(mean) / lam)
        # Standing water: free convection is as good as Nu = 5.
        film = self.film * np.pi * lam * np.maximum(nu, 5.0)
        velocity = np.abs(m) / (rho * self.area)
        factor = self.friction * water.friction_factor(reynolds, self.roughness / self.inner)
        self.dp = np.sign(m) * (factor * self.length / self.inner + self.zeta) * rho * velocity**2 / 2
        loss = np.where(np.abs(m) < 1e-6, self.standstill, 1.0) / self.resistance
        steps = max(int(np.ceil(np.max(velocity / self.dx) * 1.03 / 0.8)), 1)
        before = t_in if self.before is None else self.before
        out = _all(self.t, self.wall, self.ground, before, t_in, m, around, steps, self.dx, self.area, self.wall_j, film, loss,
                   self.spread, self.ground_j, self.ground_r, _H, _C)
        self.before = t_in
        return out


class Plug:
    """A piece behind a pipe: what enters leaves after its content has passed, as it was (volumes in kg)."""

    def __init__(self, content_kg, t_degc, seconds):
        count = len(content_kg)
        self.content, self.start = np.asarray(content_kg, float), t_degc
        self.passed, self.entered, self.n = np.zeros((count, seconds + 1)), np.zeros((count, seconds)), 0

    def second(self, m_flow_kg_s, t_in):
        """One second; the temperature at its outlet, in the middle of it."""
        i = self.n
        self.n += 1
        self.entered[:, i] = t_in
        self.passed[:, i + 1] = self.passed[:, i] + m_flow_kg_s
        out = np.array(t_in, float)
        for k in np.flatnonzero(self.content > 0):
            leaves = 0.5 * (self.passed[k, i] + self.passed[k, i + 1]) - self.content[k]
            if leaves <= 0:
                out[k] = self.start
            else:
                j = np.searchsorted(self.passed[k, : i + 2], leaves, side="left") - 1
                out[k] = self.entered[k, max(j, 0)]
        return out

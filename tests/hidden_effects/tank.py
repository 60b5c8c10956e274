"""Water in an upright storage: 120 layers, many flows in and out.

Second-order upwind with a limiter, so that hardly anything is mixed by the numbers; what real storages mix is a law of its own: an eddy
conductivity `rho cp v l` of the flow through a layer with a mixing length `l`, beside conduction. Water that lies the wrong way round is mixed at once.
A jet mixes the surroundings of its inlet; what leaves is drawn from around its port. Once a second, explicit.
"""

import numpy as np
from numba import njit

LAYERS = 120
DENSITY, HEAT_CAPACITY = 987.0, 4180.5  # of 53 degC
GRAVITY_EXPANSION = 9.81 * 4.7e-4
DIFFUSER_M = 1.75 / 60  # height over which a port (of 25 mm) lets water in and out
REACH_M = DIFFUSER_M  # of a jet to either side


@njit(cache=True)
def layer_of(height_m, total_m):
    return min(int(height_m / total_m * LAYERS), LAYERS - 1)


@njit(cache=True)
def draw_from(weights, height_m, total_m, depth_m):
    """Layers of a port: those of its diffuser, or all within a depth, the nearer the more."""
    weights[:] = 0.0
    dz = total_m / LAYERS
    total = 0.0
    for l in range(LAYERS):
        away = abs((l + 0.5) * dz - height_m)
        near = 1.0 - away / depth_m if depth_m > DIFFUSER_M / 2 else (1.0 if away < DIFFUSER_M / 2 else 0.0)
        if near > 0:
            weights[l] = near
            total += near
    weights /= total


@njit(cache=True)
def leaving(t, weights):
    out = 0.0
    for l in range(LAYERS):
        out += weights[l] * t[l]
    return out


@njit(cache=True)
def jet(conductance, height_m, total_m, m, t_in, t, share, diameter_m):
    """Exchange that water which enters brings about, W/K between neighbours: always within its diffuser, with a jet as far as it reaches."""
    if m <= 1e-6:
        return
    dz = total_m / LAYERS
    for l in range(LAYERS - 1):
        if abs((l + 1) * dz - height_m) < 0.5 * (DIFFUSER_M - dz):
            conductance[l] += HEAT_CAPACITY * m * 8.0
    if share <= 0.0:
        return
    at = layer_of(height_m, total_m)
    v = m / (DENSITY * np.pi * diameter_m**2 / 4)
    richardson = GRAVITY_EXPANSION * abs(t_in - t[at]) * diameter_m / v**2
    exchanged = share * m / (1.0 + richardson)
    reach = int(round(REACH_M / dz))
    for l in range(max(at - reach, 0), min(at + reach, LAYERS - 1)):
        conductance[l] += HEAT_CAPACITY * exchanged * REACH_M / dz


@njit(cache=True)
def second(t, inflow, inheat, outflow, jets, total_m, area, ua_side, ua_end, around, conductivity, mixing_m, heater_w, heater_at):
    """A second of the storage. `inflow`, `outflow` kg/s and `inheat` kg K/s of each layer, `jets` W/K between a layer and the next."""
    n = LAYERS
    dz = total_m / n
    mass = DENSITY * area * dz
    up = np.empty(n)
    face = np.empty(n)
    through = 0.0
    for l in range(n):
        through += inflow[l] - outflow[l]
        up[l] = through
    up[n - 1] = 0.0
    for l in range(n - 1):
        if up[l] >= 0:
            back = t[l] - t[l - 1] if l > 0 else 0.0
            ahead, sign, own = t[l + 1] - t[l], 1.0, t[l]
        else:
            back = t[l + 2] - t[l + 1] if l < n - 2 else 0.0
            ahead, sign, own = t[l + 1] - t[l], -1.0, t[l + 1]
        slope = 0.0
        if back * ahead > 0:
            slope = min(2 * abs(back), 2 * abs(ahead), 0.5 * abs(back + ahead)) * np.sign(ahead)
        courant = abs(up[l]) / mass
        face[l] = own + sign * 0.5 * (1 - courant) * slope
    new = np.empty(n)
    for l in range(n):
        gain = inheat[l] - inflow[l] * t[l]
        if l > 0:
            gain += up[l - 1] * (face[l - 1] - t[l])
        if l < n - 1:
            gain -= up[l] * (face[l] - t[l])
        watts = 0.0
        for k in (l - 1, l):
            if k < 0 or k > n - 2:
                continue
            # Water that has just entered through a port is not yet uneasy.
            fresh = inflow[k] > 0 or inflow[k + 1] > 0
            eddy = 0.0 if fresh else HEAT_CAPACITY * abs(up[k]) * mixing_m / dz
            g = conductivity * area / dz + eddy + jets[k]
            g = min(g, 0.4 * mass * HEAT_CAPACITY)
            watts += g * (t[l + 1] - t[l] if k == l else t[l - 1] - t[l])
        ua = ua_side / n + (ua_end if l == 0 or l == n - 1 else 0.0)
        watts -= ua * (t[l] - around)
        if l == heater_at:
            watts += heater_w
        new[l] = t[l] + gain / mass + watts / (mass * HEAT_CAPACITY)
    t[:] = new
    overturn(t)


@njit(cache=True)
def overturn(t):
    n = LAYERS
    steady = True
    for l in range(1, n):
        if t[l] < t[l - 1]:
            steady = False
            break
    if steady:
        return
    value, weight, count = np.empty(n), np.empty(n, np.int64), 0
    for l in range(n):
        value[count], weight[count] = t[l], 1
        count += 1
        while count > 1 and value[count - 2] > value[count - 1]:
            whole = weight[count - 2] + weight[count - 1]
            value[count - 2] = (value[count - 2] * weight[count - 2] + value[count - 1] * weight[count - 1]) / whole
            weight[count - 2] = whole
            count -= 1
    at = 0
    for k in range(count):
        for _ in range(weight[k]):
            t[at] = value[k]
            at += 1

"""Two houses around the storage, second by second: two gas boilers in a two-pipe connection, or an air-source heat pump.

Numba keeps what it compiled until this file changes: touch it where `tank.py` changes."""

import numpy as np
from numba import njit

import tank
from tank import DENSITY, HEAT_CAPACITY, LAYERS


BRANCH = 25.0  # pressure loss of a generator's branch over that of the storage, at the same flow
METAL_W_K, START_S, OVERRUN_S = 100.0, 50.0, 240.0


@njit(cache=True)
def efficiency(t_return):
    """Of a condensing boiler, lower heating value: condensation fades out around 50 degC."""
    return 1.01 - 0.05 * np.tanh((t_return - 45.0) / 14.0)


@njit(cache=True)
def boiler_heat(full_w, load, t_return):
    return full_w * (0.24 + 0.76 * (load - 0.2) / 0.8) * (1.0 - 0.0016 * (t_return - 30.0))


@njit(cache=True)
def from_metal_w_k(m):
    """Heat into the water per kelvin between metal and entering water: not more than the water can take up."""
    c = m * HEAT_CAPACITY
    return c * (1.0 - np.exp(-METAL_W_K / c))


@njit(cache=True)
def part_load(load, at_40):
    """Factor on the efficiency: 1 at full load, straight between its points."""
    d = at_40 - 1.0
    x = np.array([0.2, 0.4, 0.6, 1.0])
    y = np.array([1.0 + 1.4 * d, 1.0 + d, 1.0 + 0.6 * d, 1.0])
    return np.interp(load, x, y)


@njit(cache=True)
def two_boilers(p, flow, t_ret, load_a, load_b, shape, out):
    """`p`: volume, height, ua, around, conductivity, mixing, depth, jet, start temperature, heat a, heat b, flow a, flow b (kg/s), efficiency a, b,
    part load a, b, start a, b, idle opening a, suction a, hidden heater W, hidden draw kg/s, short way share, air in a."""
    volume, total, ua, around, conductivity, mixing, depth, share = p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]
    area = volume / total
    side, end = shape[0] * total, shape[1]
    whole = side + 2 * end
    t = np.full(LAYERS, p[8])
    metal = np.array([p[8], p[8]])
    run, off = np.zeros(2), np.full(2, 1e6)
    inflow, inheat, outflow = np.empty(LAYERS), np.empty(LAYERS), np.empty(LAYERS)
    jets, low, high, top = np.empty(LAYERS), np.empty(LAYERS), np.empty(LAYERS), np.empty(LAYERS)
    low_in, high_in, middle_in = np.empty(LAYERS), np.empty(LAYERS), np.empty(LAYERS)
    low_m, high_m = shape[2], shape[3]
    tank.draw_from(low, low_m, total, depth)
    tank.draw_from(high, high_m, total, depth)
    tank.draw_from(low_in, low_m, total, 0.0)
    tank.draw_from(high_in, high_m, total, 0.0)
    tank.draw_from(middle_in, total / 2, total, 0.0)
    tank.draw_from(top, total - 0.01, total, 0.0)
    t_back = p[8]
    for i in range(flow.size):
        loads = (load_a[i], load_b[i])
        wanted, burn, fuel = np.zeros(2), np.zeros(2), np.zeros(2)
        m_draw = flow[i] * DENSITY
        for k in range(2):
            if loads[k] > 0:
                run[k] += 1.0
                off[k] = 0.0
                burn[k] = boiler_heat(p[9 + k], loads[k], t_back)
                fuel[k] = burn[k] / efficiency(t_back) / (p[13 + k] * part_load(loads[k], p[15 + k]))
                wanted[k] = p[11 + k]
            else:
                run[k] = 0.0
                off[k] += 1.0
                if off[k] <= OVERRUN_S:
                    wanted[k] = p[11 + k]
        m_a, m_b = wanted[0], wanted[1]
        if p[24] > 0 and m_a > 0 and i % 700 < 200:
            m_a *= 1.0 - p[24]
        if m_a > 0 and m_b > m_a:
            m_a += p[20] * (m_b - m_a)
        m_storage = m_a + m_b - m_draw  # into its top
        if wanted[0] <= 0 and p[19] > 0:
            other = m_b - m_draw
            m_storage = other / (1.0 + p[19] / np.sqrt(BRANCH))
            m_a = m_storage - other  # through the idle one, from the return to the supply
        t_high, t_low = tank.leaving(t, high), tank.leaving(t, low)
        # The return first: what comes back, the bottom of the storage, and what passes the idle boiler the wrong way round.
        into = m_draw + max(m_storage, 0.0) + max(-m_a, 0.0)
        sum_back = m_draw * t_ret[i] + max(m_storage, 0.0) * t_low
        t_supply_guess = t_high if m_storage < 0 else t_back
        if m_a < 0:
            # Only what the other boiler sends.
            t_supply_guess = t_back + (from_metal_w_k(m_b) * (metal[1] - t_back) / (m_b * HEAT_CAPACITY) if m_b > 0 else 0.0)
        # Its metal takes part, whichever way the water goes.
        q_back = from_metal_w_k(-m_a) * (metal[0] - t_supply_guess) if m_a < -1e-9 else 0.0
        sum_back += max(-m_a, 0.0) * t_supply_guess + q_back / HEAT_CAPACITY
        if into > 1e-9:
            t_back = sum_back / into
        t_out = np.empty(2)
        for k in range(2):
            m = (m_a, m_b)[k]
            if m > 1e-9:
                q = from_metal_w_k(m) * (metal[k] - t_back)
                t_out[k] = t_back + q / (m * HEAT_CAPACITY)
                slower = p[17 + k] if loads[k] > 0 and run[k] < 6 * START_S * p[17 + k] else 1.0
                metal[k] += (burn[k] - q) / (from_metal_w_k(p[11 + k]) * START_S * slower)
            elif m < -1e-9:
                t_out[k] = t_back
                metal[k] -= q_back / (from_metal_w_k(p[11 + k]) * START_S)
            else:
                t_out[k] = t_back
                metal[k] += (t_back - metal[k]) / 3600.0
        into = max(m_a, 0.0) + m_b + max(-m_storage, 0.0)
        t_supply = t_high
        if into > 1e-9:
            t_supply = (max(m_a, 0.0) * t_out[0] + m_b * t_out[1] + max(-m_storage, 0.0) * t_high) / into
        inflow[:] = 0.0
        inheat[:] = 0.0
        jets[:] = 0.0
        m = abs(m_storage)
        if m_storage >= 0:
            inflow += m * high_in
            inheat += m * t_supply * high_in
            outflow[:] = m * low
            tank.jet(jets, high_m, total, m, t_supply, t, share, 0.025)
        else:
            short = m * p[23]
            entering = (m - short) * low_in + short * middle_in
            inflow += entering
            inheat += entering * t_back
            outflow[:] = m * high
            tank.jet(jets, low_m, total, m, t_back, t, share, 0.025)
        if i % 900 < 75 and p[22] > 0:
            inflow[0] += p[22]
            inheat[0] += p[22] * 12.0
            outflow += p[22] * top
        heater = p[21] if i % 1100 < 420 else 0.0
        tank.second(t, inflow, inheat, outflow, jets, total, area, ua * side / whole, ua * end / whole, around, conductivity, mixing, heater, LAYERS // 2)
        for k in range(10):
            z = (2 * k + 0.5) * total / 20
            out[k, i] = t_at(t, z, total)
        out[10, i], out[11, i], out[12, i] = t_out[0], t_out[1], t_supply
        out[13, i], out[14, i], out[15, i], out[16, i] = m_a, m_b, fuel[0], fuel[1]
        out[17, i], out[18, i] = m_storage, t_back


@njit(cache=True)
def t_at(t, z, total):
    x = z / total * LAYERS - 0.5
    l = min(max(int(x), 0), LAYERS - 2)
    return t[l] + (x - l) * (t[l + 1] - t[l])


@njit(cache=True)
def heat_pump_map(full_w, load, t_air, t_return, flow_kg_s):
    """Heat and electricity: a share of Carnot between the refrigerant's temperatures."""
    heat = full_w * (0.08 + 1.02 * load - 0.10 * load**2) * (1 + 0.024 * t_air) * (1 - 0.004 * (t_return - 35.0))
    t_hot = t_return + heat / (flow_kg_s * HEAT_CAPACITY) + 2.0 + 3.0 * load + 273.15
    t_cold = t_air - 4.0 - 5.0 * load + 273.15
    share = 0.46 * (1 + 0.14 * (1 - load) - 0.10 * (1 - load) ** 2)
    return heat, heat / (share * t_hot / (t_hot - t_cold))


@njit(cache=True)
def heat_pump_house(p, flow, t_ret, load, aux, shape, out):
    """`p` as far as `start temperature`, then: heat, flow (kg/s), efficiency, part load, start, de-icing W, heater (factor), air degC,
    hidden heater W, hidden draw kg/s, short way share, air in the circuit."""
    volume, total, ua, around, conductivity, mixing, depth, share = p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]
    area = volume / total
    side, end = shape[0] * total, shape[1]
    whole = side + 2 * end
    t = np.full(LAYERS, p[8])
    inflow, inheat, outflow = np.empty(LAYERS), np.empty(LAYERS), np.empty(LAYERS)
    jets, low, high, top = np.empty(LAYERS), np.empty(LAYERS), np.empty(LAYERS), np.empty(LAYERS)
    low_in, high_in, middle_in = np.empty(LAYERS), np.empty(LAYERS), np.empty(LAYERS)
    low_m, high_m = shape[2], shape[3]
    tank.draw_from(low, low_m, total, depth)
    tank.draw_from(high, high_m, total, depth)
    tank.draw_from(low_in, low_m, total, 0.0)
    tank.draw_from(high_in, high_m, total, 0.0)
    tank.draw_from(middle_in, total / 2, total, 0.0)
    tank.draw_from(top, total - 0.01, total, 0.0)
    content, warm, speed = p[8], 0.0, 0.0
    run, off, frost, ice = 0.0, 1e6, 0.0, -1.0
    for i in range(flow.size):
        wanted = 1.0 if aux[i] > 0 and load[i] > 0 else load[i]
        m = 0.0
        heat, power, heater = 0.0, 0.0, 0.0
        t_back = tank.leaving(t, low)
        if wanted > 0:
            if run == 0.0:
                speed = 0.2
            run += 1.0
            off = 0.0
            speed = min(wanted, speed + 1.0 / 40.0) if wanted > speed else wanted
            m = p[10] * min(run / 10.0, 1.0)
            q, e = heat_pump_map(p[9], speed, p[16], t_back, p[10])
            s = p[13]
            rising = max(run - 0.5 - 20.0 * s, 0.0)
            warm = 1.0 - np.exp(-rising / (70.0 * s))
            heat, power = q * warm, e / (p[11] * part_load(speed, p[12])) * (1.0 - 0.4 * np.exp(-(run - 0.5) / (60.0 * s)))
            frost += 1.0
            if p[14] > 0 and frost >= 2700.0 and ice < 0:
                ice = 0.0
            if ice >= 0:
                ice += 1.0
                if ice <= 300.0:
                    heat, power = -p[14] * max(speed, 0.6), 1200.0
                else:
                    back = min((ice - 300.0) / 120.0, 1.0)
                    heat, power = heat * back, power * back
                    if ice == 301.0:
                        frost = 1.0
                    if ice >= 420.0:
                        ice = -1.0
            heater = p[15] * np.ceil(3 * aux[i] - 1e-6) / 3.0 * min(run / 10.0, 1.0)
        elif 0.0 <= ice < 300.0:
            # Ice that melts is melted to the end.
            ice += 1.0
            m, heat, power = p[10], -p[14] * max(speed, 0.6), 1200.0
            off = 0.0
        else:
            if ice >= 0:
                ice, frost = -1.0, 0.0
            run = 0.0
            off += 1.0
            if off <= 60.0:
                m = p[10]
            if off <= 10.0:
                q, e = heat_pump_map(p[9], max(speed, 0.2), p[16], t_back, p[10])
                heat, power = q * warm * (1 - (off - 0.5) / 10.0), e / (p[11] * part_load(speed, p[12])) * (1 - (off - 0.5) / 10.0)
        if p[20] > 0 and m > 0 and i % 700 < 200:
            m *= 1.0 - p[20]
        if m > 1e-9:
            into = t_back + (heat + heater) / (m * HEAT_CAPACITY)
            content = into + (content - into) * np.exp(-m / (0.004 * DENSITY))
        m_draw = flow[i] * DENSITY
        t_high = tank.leaving(t, high)
        inflow[:] = 0.0
        inheat[:] = 0.0
        jets[:] = 0.0
        short = m_draw * p[19]
        entering = (m_draw - short) * low_in + short * middle_in
        inflow += m * high_in + entering
        inheat += m * content * high_in + entering * t_ret[i]
        outflow[:] = m * low + m_draw * high
        tank.jet(jets, high_m, total, m, content, t, share, 0.025)
        tank.jet(jets, low_m, total, m_draw, t_ret[i], t, share, 0.025)
        if i % 900 < 75 and p[18] > 0:
            inflow[0] += p[18]
            inheat[0] += p[18] * 12.0
            outflow += p[18] * top
        hidden = p[17] if i % 1100 < 420 else 0.0
        tank.second(t, inflow, inheat, outflow, jets, total, area, ua * side / whole, ua * end / whole, around, conductivity, mixing, hidden, LAYERS // 2)
        for k in range(10):
            z = (2 * k + 0.5) * total / 20
            out[k, i] = t_at(t, z, total)
        out[10, i], out[11, i], out[12, i] = content, t_high, power + heater + (15.0 if wanted <= 0 else 0.0)
        out[13, i] = m

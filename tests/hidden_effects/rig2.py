"""R2: a house. A storage with ten sensors, heat drawn from it, and two gas boilers in a two-pipe connection or an air-source heat pump
(`house.py`). Rich: ten sensors on the wall of the storage, flows, temperatures, fuel or electricity. Poor: heat meters, and two sensors of the storage.
"""

import numpy as np

import house
from sensors import SPARE_S, Sensor, as_read, commanded, held, otherwise

NAME = "R2"
BLOCK_S, BLOCKS = 900.0, 12
FIRST_S = 240
AGREES_K = 0.22  # with anergy, median, where nothing is hidden
FLOWS_THROUGH = False  # without storages
AS_BUILT = set()
ONE_SIDED = {"T3", "T4", "G4", "H1", "H2", "S4"}
# So much an effect is at least: less is the tolerance of another unit of the same kind.
SMALLEST = {"T1": 0.3, "T2": 0.7, "T3": 0.06, "T4": 0.1, "G1": 0.03, "G2": 0.05, "G3": 0.2, "G6": 0.03}
LAYERS = 60  # of the model
OUTLET_LAG_S = {True: 5, False: 20}  # of the water and metal of a heat pump, of a boiler: what the model declares
DENSITY = house.DENSITY
LITRE_MIN = 1 / 60000.0


def layer(twentieths):
    """Of the model, at this height; from 1."""
    return int(twentieths * LAYERS / 20) + 1


def _warmer(p, bias, gain, as_is=False):
    return p | {"return_k": p["return_k"] + bias + (0.0 if as_is else (gain - 1) * 35.0)}


def _flow(p, bias, gain, as_is=False):
    return p | {"flow": p["flow"] * gain, "flow_zero": p["flow_zero"] + bias}


INPUTS = {"t_ret": _warmer, "flow": _flow} | {command: commanded(command) for command in ("load_a", "load_b")}


def duration_s(rig):
    return BLOCK_S * BLOCKS


def draw(rng, rich):
    pump = bool(rng.random() < 0.5)
    n = int(BLOCK_S * BLOCKS) + SPARE_S
    loads = {"a": np.zeros(n), "b": np.zeros(n)}
    if pump:
        # Long runs, now and then a pause; the heater in some of them.
        t = float(rng.uniform(100, 250))
        while t < n:
            length = rng.uniform(1300, 3400)
            begin, end = int(t), int(min(t + length, n))
            loads["a"][begin:end] = np.round(rng.choice([0.3, 0.45, 0.6, 0.8, 1.0]), 2)
            if rng.random() < 0.6 and end - begin > 900:
                at = int(begin + rng.uniform(400, 700))
                loads["b"][at : min(at + int(rng.uniform(350, 700)), end)] = rng.choice([0.33, 0.66, 1.0])
            t = end + rng.uniform(330, 700)
    else:
        # The big one in every second block, the small one in most.
        for k in range(BLOCKS):
            if rng.random() < 0.8:
                begin = int(k * BLOCK_S + rng.uniform(20, 260))
                loads["a"][begin : begin + int(rng.uniform(300, 520))] = np.round(rng.uniform(0.2, 1.0), 2)
            if k % 2 == (k // 4) % 2:
                begin = int(k * BLOCK_S + rng.uniform(20, 300))
                loads["b"][begin : begin + int(rng.uniform(250, 450))] = np.round(rng.uniform(0.2, 1.0), 2)
    flow = np.zeros(n)
    t, ramp = 40.0, 20
    while t < n:
        length = rng.uniform(250, 700)
        if rng.random() < 0.75:
            flow[int(t) : int(t + length)] = rng.uniform(3.5, 9.5)
        t += length
    wobble = np.zeros(n)
    for i in range(1, n):
        wobble[i] = 0.98 * wobble[i - 1] + 0.2 * rng.normal()
    flow = np.convolve(np.pad(flow, ramp // 2, mode="edge"), np.full(ramp + 1, 1 / (ramp + 1)), "valid") * (1 + 0.005 * np.clip(wobble, -3, 3))
    knots = np.arange(0, n + 600, 600)
    t_ret = np.interp(np.arange(n), knots, rng.uniform(26, 38, knots.size) if not pump else rng.uniform(24, 32, knots.size))
    return dict(pump=pump, rich=rich, loads=loads, flow=np.where(flow < 0.3, 0.0, flow) * LITRE_MIN, t_ret=t_ret,
                volume=float(np.round(rng.uniform(0.5, 0.8), 3)), height=1.75, ua=float(np.round(rng.uniform(6, 16), 1)), around=18.0,
                start=float(np.round(rng.uniform(48, 55) if not pump else rng.uniform(38, 44), 1)), small_w=float(np.round(rng.uniform(6e3, 9e3), -2)),
                large_w=float(np.round(rng.uniform(13e3, 17e3), -2)), small_l_min=6.0, large_l_min=14.0, heat_w=float(np.round(rng.uniform(8e3, 11e3), -2)),
                pump_l_min=float(np.round(rng.uniform(16, 22), 1)), air=float(np.round(rng.uniform(-6, 3), 1)), every_s=float(rng.choice([10, 15, 20])))


TANK = ["volume", "height", "ua", "around_k", "conductivity", "mixing", "depth", "jet", "start"]
GAS = TANK + ["heat_a", "heat_b", "flow_a", "flow_b", "good_a", "good_b", "part_a", "part_b", "slow_a", "slow_b", "opening", "suction", "heater_w", "tap", "short", "air_in"]
PUMP = TANK + ["heat", "flow_hp", "good", "part", "slow", "ice_w", "aux", "air", "heater_w", "tap", "short", "air_in"]


def neutral(rig):
    p = {"volume": 1.0, "ua": 1.0, "around_k": 0.0, "conductivity": 1.0, "mixing": 1.0, "depth": 0.0, "jet": 0.0, "return_k": 0.0, "flow": 1.0, "flow_zero": 0.0,
         "heater_w": 0.0, "tap": 0.0, "short": 0.0, "air_in": 0.0, "load_a": 1.0, "load_b": 1.0}
    if rig["pump"]:
        return p | {"heat": 1.0, "good": 1.0, "part": 1.0, "slow": 1.0, "ice_w": 0.0, "aux": 1.0}
    return p | {"heat_a": 1.0, "heat_b": 1.0, "good_a": 1.0, "good_b": 1.0, "part_a": 1.0, "part_b": 1.0, "slow_a": 1.0, "slow_b": 1.0, "opening": 0.0, "suction": 0.0}


def program(rig):
    return {"load_a": held(rig, rig["loads"]["a"]), "load_b": held(rig, rig["loads"]["b"]), "flow": as_read(rig, otherwise(rig, rig["flow"], "flow")),
            "t_ret": as_read(rig, otherwise(rig, rig["t_ret"], "degc")) + 273.15}


def simulate(rig, variants):
    n, count = rig["flow"].size, len(variants)
    area = rig["volume"] / rig["height"]
    diameter = (4 * area / np.pi) ** 0.5
    dz = rig["height"] / LAYERS
    shape = np.array([np.pi * diameter, area, 1.5 / 20 * rig["height"], 18.5 / 20 * rig["height"]])
    rated = {"volume": rig["volume"], "height": rig["height"], "ua": rig["ua"], "conductivity": rig.get("conductivity", 0.644), "mixing": 0.5 * dz * 0.95, "start": rig["start"],
             "heat_a": rig["small_w"], "heat_b": rig["large_w"], "flow_a": rig["small_l_min"] * LITRE_MIN * DENSITY, "flow_b": rig["large_l_min"] * LITRE_MIN * DENSITY,
             "heat": rig["heat_w"], "flow_hp": rig["pump_l_min"] * LITRE_MIN * DENSITY, "aux": 6000.0, "air": rig["air"]}
    names = ([f"ts{k + 1}" for k in range(10)] + (["t_hp", "t_high", "power", "m_hp"] if rig["pump"] else
             ["t_small", "t_large", "t_supply", "m_small", "m_large", "fuel_small", "fuel_large", "m_storage", "t_back"]))
    all_ = np.empty((count, len(names), n))
    inputs = program(rig)
    for row, v in enumerate(variants):
        p = np.array([rated.get(k, 1.0) * v.get(k, 1.0) if k not in ("around_k", "start", "air") else rig["around"] + v["around_k"] if k == "around_k" else rated[k]
                      for k in (PUMP if rig["pump"] else GAS)])
        flow = np.where(inputs["flow"] > 0, inputs["flow"] * v["flow"] + v["flow_zero"], 0.0)
        t_ret = inputs["t_ret"] - 273.15 + v["return_k"]
        run = house.heat_pump_house if rig["pump"] else house.two_boilers
        run(p, flow, t_ret, inputs["load_a"] * v["load_a"], inputs["load_b"] * v["load_b"], shape, all_[row])
    out = {name: all_[:, k] + (273.15 if name.startswith("t") else 0.0) for k, name in enumerate(names)}
    return out | {name: np.tile(x, (count, 1)) for name, x in inputs.items()}


def sensors(rig):
    rich = rig["rich"]
    warm = dict(klass="pt100_a" if rich else "heat_meter_pair", unit="degC", quantisation=0.1)
    command = dict(role="input", klass="electric_0_2", unit="1", quantisation=0.01)
    every = [Sensor("T_return", "draw.supply_k", "input", truth="t_ret", **warm),
             Sensor("V_draw", "draw.v_flow_m3_s", "input", "mid" if rich else "flow_class_2", "l_h", "flow", quantisation=1.0),
             Sensor("T_draw", "draw.t_in_k", "compare", truth="t_high" if rig["pump"] else "t_supply", blank="flow", **warm)]
    if rig["pump"]:
        every += [Sensor("u_hp", "heat_pump.modulation", truth="load_a", **command), Sensor("u_aux", "heat_pump.aux_modulation", truth="load_b", **command),
                  Sensor("T_hp", "heat_pump.water.t_out_k", "compare", truth="t_hp", blank="m_hp", **warm),
                  Sensor("P_hp", "heat_pump.electric_w", "compare", "electric_0_2", "W", "power", quantisation=10.0)]
    else:
        every += [Sensor("u_small", "small.modulation", truth="load_a", **command), Sensor("u_large", "large.modulation", truth="load_b", **command)]
        for name in ("small", "large"):
            every += [Sensor(f"T_{name}", f"{name}.t_supply_k", "compare", truth=f"t_{name}", blank=f"m_{name}", **warm),
                      Sensor(f"gas_{name}", f"{name}.fuel_w", "compare", "flow_class_2", "W", f"fuel_{name}", quantisation=10.0)]
        if rich:
            every += [Sensor(f"F_{name}", f"{name}.water.m_flow_kg_s", "compare", "mid", "kg_h", f"m_{name}", quantisation=1.0, signed=True) for name in ("small", "large")]
    for k in range(10):
        if rich or k in (1, 8):
            every.append(Sensor(f"TS{k + 1}", f"storage.t_{layer(2 * k + 0.5)}_k", "compare", "surface", "degC", f"ts{k + 1}", quantisation=0.1, lag_s=60.0))
    return every


def tolerances(rig):
    p = {"around_k": 0.5, "ua": 0.05, "volume": 0.005, "mixing": 0.03}
    return p | ({"heat": 0.003, "good": 0.01} if rig["pump"] else {"heat_a": 0.003, "heat_b": 0.003, "good_a": 0.01, "good_b": 0.01})


def declared(rig):
    """What the model declares beside what is drawn: what its storage conducts, and how a generator goes at part load and starts."""
    ends = [""] if rig["pump"] else ["_a", "_b"]
    return {"conductivity": 0.5} | {f"part{x}": 0.01 for x in ends} | {f"slow{x}": 0.08 for x in ends}


def effects(rig):
    def one(id_, component, parameter, key, first, range_, zero):
        return id_, component, parameter, (lambda x: {key: x}), first, range_, zero

    yield one("T1", "storage", "factor", "ua", 1.8, (0.5, 4.0), 1.0)
    yield one("T2", "storage", "factor", "conductivity", 5.0, (0.05, 20.0), 1.0)
    yield one("T3", "storage", "depth_m", "depth", 0.2, (0.05, 0.35), 0.0)
    yield one("T4", "storage", "share", "jet", 0.4, (0.05, 1.0), 0.0)
    if rig["pump"]:
        yield one("G1", "heat_pump", "factor", "good", 1.08, (0.8, 1.2), 1.0)
        yield one("G2", "heat_pump", "factor_40", "part", 1.1, (0.75, 1.25), 1.0)
        yield one("G3", "heat_pump", "time_factor", "slow", 1.6, (0.4, 3.0), 1.0)
        yield one("G4", "heat_pump", "heat_w", "ice_w", 3000.0, (1000.0, 8000.0), 0.0)
        if rig["loads"]["b"].any():
            yield one("G6", "heat_pump", "factor", "aux", 0.9, (0.75, 1.25), 1.0)
        return
    for x, name in (("a", "small"), ("b", "large")):
        yield one("G1", name, "factor", f"good_{x}", 1.08, (0.8, 1.2), 1.0)
        yield one("G2", name, "factor_40", f"part_{x}", 1.1, (0.75, 1.25), 1.0)
        yield one("G3", name, "time_factor", f"slow_{x}", 1.6, (0.4, 3.0), 1.0)
    yield one("H1", "small_branch", "opening", "opening", 0.2, (0.03, 1.0), 0.0)
    yield one("H2", "small_branch", "share", "suction", 0.1, (0.03, 0.5), 0.0)


def unknown(rig, rng):
    return [("hidden periodic heater in the storage", {"heater_w": rng.uniform(1200, 4000)}),
            ("water drawn for another use now and then", {"tap": rng.uniform(0.05, 0.15)}),
            ("part of the return enters at half height", {"short": rng.uniform(0.25, 0.6)}),
            ("air in the circuit of the generator", {"air_in": rng.uniform(0.2, 0.5)})][rng.integers(4)]


def model(rig):
    start = rig["start"]
    lines = ["format = 1", "[model]", 'name = "house"', "[run]", f'until = "{BLOCK_S * BLOCKS:.0f}s"', 'step = "10s"', 'record = "10s"', f"initial_degc = {start}",
             "[fluid]", 'kind = "constant_water"', f"density_kg_m3 = {DENSITY}", f"heat_capacity_j_kg_k = {house.HEAT_CAPACITY}",
             # What `tolerances` draws (the loss with half a kelvin of 27; 3 % of the mixing by the flow are half of what water conducts), and the metal of a boiler to twice: 4.5 kJ/K over 0.4 kW/K of its flow are 11 s.
             "[tolerance]", "storage_loss = 0.07", "storage_mixing = 0.5", "efficiency = 0.013", "part_load = 0.01", "start = 0.08", f"outlet_lag_s = {OUTLET_LAG_S[rig['pump']]}",
             "[[unit]]", 'id = "storage"', 'kind = "storage"', f"volume_m3 = {rig['volume']}", f"height_m = {rig['height']}", f"layers = {LAYERS}", f"ua_w_k = {rig['ua']}",
             f"ambient_degc = {rig['around']}", f"conductivity_w_m_k = {rig.get('conductivity', 0.644)}", 'buoyancy = "at_once"']
    high, low = layer(18.5), layer(1.5)
    if rig["pump"]:
        lines.append(f"ports = {{ charge = {{ inlet_layer = {high}, outlet_layer = {low} }}, draw = {{ inlet_layer = {low}, outlet_layer = {high} }} }}")
    else:
        lines.append(f"ports = {{ point = {{ inlet_layer = {high}, outlet_layer = {low} }} }}")
    lines += ["[[unit]]", 'id = "draw"', 'kind = "prescribed_source"', "supply_degc = 30", "v_flow_l_min = 5"]
    if rig["pump"]:
        loads, airs, returns = [0.2, 0.4, 0.6, 0.8, 1.0], [-7, -3, 1, 5], [20, 30, 40, 50, 60]
        flow = rig["pump_l_min"] * LITRE_MIN * DENSITY
        at = [[[house.heat_pump_map(rig["heat_w"], u, a, r, flow) for r in returns] for a in airs] for u in loads]
        rows = [row for of_load in at for row in of_load]
        start_s = [0, 20, 40, 70, 100, 140, 190, 250, 320, 400]
        lines += ["[heat_pump_map.ours]", f"modulation = {loads}", f"source_degc = {airs}", f"return_degc = {returns}",
                  f"heat_kw = {[[round(q / 1e3, 4) for q, _ in row] for row in rows]}", f"electric_kw = {[[round(e / 1e3, 5) for _, e in row] for row in rows]}",
                  "[[unit]]", 'id = "heat_pump"', 'kind = "air_source_heat_pump"', 'map = "ours"', f"t_outdoor_degc = {rig['air']}", 'flow_control = "constant_flow"',
                  f"v_flow_l_min = {rig['pump_l_min']}", "defrost = false", "aux_rated_kw = 6", "warm_within_s = 0", f"start_times_s = {start_s}",
                  f"start_heat = {[round(1 - float(np.exp(-max(s - 20, 0) / 70)), 4) for s in start_s[:-1]] + [1.0]}",
                  f"start_power = {[round(1 - 0.4 * float(np.exp(-s / 60)), 4) for s in start_s[:-1]] + [1.0]}",
                  "[[circuit]]", 'id = "charging"', 'through = ["heat_pump.water", "storage.charge"]',
                  "[[circuit]]", 'id = "heating"', 'through = ["draw", "storage.draw"]']
        return "\n".join(lines) + "\n"
    returns = list(range(20, 76, 5))
    start_s, stop_s = [0, 8, 16, 28, 45, 70, 105, 150, 210, 300], [0, 8, 16, 28, 45, 70, 105, 150, 200, 240]
    for name, full in (("small", rig["small_w"]), ("large", rig["large_w"])):
        of = lambda load: [round(house.boiler_heat(full, load, r) / 1e3, 4) for r in returns]  # noqa: E731
        lines += ["[[unit]]", f'id = "{name}"', 'kind = "condensing_boiler"', 'flow_control = "constant_flow"', f"v_flow_l_min = {rig[name + '_l_min']}",
                  f"table_return_degc = {returns}", f"table_efficiency = {[round(float(house.efficiency(r)), 4) for r in returns]}",
                  f"table_heat_min_kw = {of(0.2)}", f"table_heat_max_kw = {of(1.0)}", f"start_times_s = {start_s}", f"start_flow = {[1.0] * len(start_s)}",
                  f"start_heat = {[round(1 - float(np.exp(-s / house.START_S)), 4) for s in start_s[:-1]] + [1.0]}", f"stop_times_s = {stop_s}",
                  f"stop_heat = {[round(float(np.exp(-s / house.START_S)), 4) for s in stop_s[:-1]] + [0.0]}",
                  "[[circuit]]", f'id = "{name}_branch"', f'through = ["{name}.water"]', 'from = "return"', 'to = "supply"']
    lines += ["[[circuit]]", 'id = "storage_pipes"', 'through = ["storage.point"]', 'from = "supply"', 'to = "return"',
              "[[circuit]]", 'id = "heating"', 'through = ["draw"]', 'from = "supply"', 'to = "return"']
    return "\n".join(lines) + "\n"


def outlet_lag_s(rig, column):
    """Lag of the generator that stands before a sensor, as the model declares it."""
    return OUTLET_LAG_S[rig["pump"]] if column in ("T_hp", "T_small", "T_large") else 0.0


def split(rig):
    """Blocks of 15 min in turns, of the first one four minutes left out."""
    turns = ["identify", "validate", "identify", "show"]
    return "".join(f'[[block]]\nrole = "{turns[i % 4]}"\nfrom_s = {i * BLOCK_S + (30 if i else FIRST_S)}\nuntil_s = {(i + 1) * BLOCK_S - 1}\n' for i in range(BLOCKS))


def is_show(rig, at_s):
    block = (at_s // BLOCK_S).astype(int)
    return (block % 4 == 3) & (at_s >= block * BLOCK_S + 30) & (at_s <= (block + 1) * BLOCK_S - 1)


def beside(rig):
    """Pairs of components and sensors with nothing between them."""
    of_storage = [f"TS{k}" for k in range(1, 11)] + ["T_draw", "V_draw", "T_return"]
    if rig["pump"]:
        return [("storage", x) for x in of_storage + ["heat_pump"]] + [("heat_pump", x) for x in ("T_hp", "P_hp", "u_hp", "u_aux")]
    pairs = [("storage", x) for x in of_storage + ["small", "large", "small_branch"]] + [("small", "small_branch")]
    return pairs + [(a, f"{x}_{b}") for a, b in (("small", "small"), ("small_branch", "small"), ("large", "large")) for x in ("T", "gas", "F", "u")]

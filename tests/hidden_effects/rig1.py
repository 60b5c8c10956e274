"""R1: a bench of one or two pipes in series with a flow meter, as the pipe of Liege.

Rich: temperatures between and behind the pipes, pressure losses of both. Poor: one pipe between two sensors of temperature.
"""

import numpy as np

from pipe import Pipe, Plug
from sensors import FLOW, SPARE_S, TEMPERATURE, Sensor, as_read, longer_s, otherwise

NAME = "R1"
BLOCK_S, BLOCKS = 300.0, 12
FIRST_S = 200  # until the water that was there at the start has left
AGREES_K = 0.05  # with anergy, median, where nothing is hidden
STEEL = 7850.0 * 470.0
FLOWS_THROUGH = True  # without storages
AS_BUILT = {"P1"}  # as strong as the pipe is thick
ONE_SIDED = {"P4", "P5", "P6", "P7", "P8", "S4"}


def _inlet(p, bias, gain, as_is=False):
    return p | {"inlet_k": p["inlet_k"] + bias + (0.0 if as_is else (gain - 1) * 50.0)}


def _flow(p, bias, gain, as_is=False):
    return p | {"flow": p["flow"] * gain, "flow_zero": p["flow_zero"] + bias}


# Truth channels of measured inputs, and the variant in which the plant gets what such a sensor would read.
INPUTS = {"inlet.t": _inlet, "flow": _flow}


def block_s(rig):
    """Length of a block; with the ground in mind hours."""
    return 2400.0 if rig.get("long") else BLOCK_S


def duration_s(rig):
    return block_s(rig) * BLOCKS + longer_s(rig)


def draw(rng, rich):
    """The bench and what is done with it."""
    inner = rng.choice([0.016, 0.0217, 0.0272, 0.0359, 0.0431])
    wall = bool(rng.random() < 0.5)
    pipes = []
    for name in ["near", "far"] if rich else ["street"]:
        thick = rng.uniform(0.0012, 0.003)
        pipes.append(dict(name=name, length=float(np.round(rng.uniform(12, 24) if rich else rng.uniform(20, 42), 1)),
                          inner=float(inner), outer=float(np.round(inner + 2 * thick, 4)),
                          resistance=float(np.round(rng.uniform(2.5, 7), 2)), roughness=1e-5, wall=wall))
    velocities = rng.permuted([rng.uniform(0.28, 0.36), rng.uniform(0.42, 0.55), rng.uniform(0.65, 0.85)])
    area = np.pi * inner**2 / 4
    levels, flows = [], []
    level = rng.uniform(40, 60)
    for i in range(BLOCKS):
        new = rng.uniform(32, 75)
        while abs(new - level) < 12:
            new = rng.uniform(32, 75)
        levels.append(level := new)
        flows.append(988 * area * velocities[(i + i // 4) % 3] * rng.uniform(0.95, 1.05))
    pauses = [0, 5, 7, 10] if rng.random() < 0.6 else []  # identify, validate, show, identify
    return dict(pipes=pipes, levels=levels, flows=flows, pauses=pauses, rich=rich, start=float(rng.uniform(40, 60)),
                ramps=rng.uniform(30, 80, BLOCKS), delays=rng.uniform(10, 60, BLOCKS), pause_s=rng.uniform(90, 150, BLOCKS),
                around=float(np.round(rng.uniform(8, 20), 1)), period=rng.uniform(120, 300), every_s=float(rng.choice([10, 10, 20, 30])),
                seed=int(rng.integers(1 << 30)))


def program(rig):
    """Inlet temperature and flow of every second."""
    block, slow = block_s(rig), 0.35 if rig.get("long") else 1.0
    n = int(block * BLOCKS) + SPARE_S
    t = np.arange(n, dtype=float)
    points_t, points = [0.0], [rig["start"]]
    flow = np.empty(n)
    for i, level in enumerate(rig["levels"]):
        begin = i * block + rig["delays"][i]
        points_t += [begin, begin + rig["ramps"][i]]
        points += [points[-1], level]
        flow[int(i * block) :] = slow * rig["flows"][i]
    rng = np.random.default_rng(rig["seed"])
    wobble = np.zeros(n)
    for i in range(1, n):  # the demand is never quiet
        wobble[i] = 0.98 * wobble[i - 1] + 0.2 * rng.normal()
    flow *= 1 + 0.005 * np.clip(wobble, -3, 3)
    for i in rig["pauses"]:
        begin = int((i + 1) * block - rig["pause_s"][i] - 20)
        flow[begin : begin + int(rig["pause_s"][i])] = 0.0
    flow = np.where(flow == 0, 0, np.convolve(np.pad(flow, 10, mode="edge"), np.full(21, 1 / 21), "valid"))  # pumps ramp
    inlet = np.interp(t, points_t, points) + 0.3 * np.sin(2 * np.pi * t / rig["period"])
    return as_read(rig, otherwise(rig, inlet, "degc")), as_read(rig, otherwise(rig, flow, "flow"))


def neutral(rig):
    """The parameters of the truth as the model has them; variants are made by changing some."""
    p = {"around_k": 0.0, "flow": 1.0, "flow_zero": 0.0, "inlet_k": 0.0, "drift_k": 0.3}
    for pipe in rig["pipes"]:
        n = pipe["name"]
        geometry = STEEL * np.pi / 4 * (pipe["outer"] ** 2 - pipe["inner"] ** 2)
        p |= {f"{n}.length": 1.0, f"{n}.loss": 1.0, f"{n}.around_k": 0.0, f"{n}.film": 1.0, f"{n}.dispersion": 0.004,
              f"{n}.standstill": 1.0, f"{n}.friction": 1.0, f"{n}.wall": geometry if pipe["wall"] else 0.0,
              f"{n}.piece": 0.0, f"{n}.ground": 0.0, f"{n}.parallel": 0.0, f"{n}.window": 0.0, f"{n}.heater_w": 0.0}
    return p


def simulate(rig, variants):
    """Channels in SI at every second, one row per variant."""
    inlet, flow = program(rig)
    n, count = inlet.size, len(variants)

    def of(key):
        return np.array([v[key] for v in variants])

    pipes = []
    plugs = {}
    for pipe in rig["pipes"]:
        k = pipe["name"]
        # Half of the resistance lies beyond the ground that is warmed.
        ground, resistance = of(f"{k}.ground"), pipe["resistance"] / of(f"{k}.loss")
        beyond = np.where(ground > 0, 0.5, 0.0) * resistance
        if of(f"{k}.piece").any():
            plugs[k] = Plug(of(f"{k}.piece") * 988.0, rig["start"], n + 300)
        pipes.append(Pipe(count, pipe["length"] * of(f"{k}.length"), pipe["inner"], of(f"{k}.wall"), resistance - beyond, rig["start"],
                          pipe["roughness"], film=of(f"{k}.film"), dispersion_m2_s=of(f"{k}.dispersion"), standstill=of(f"{k}.standstill"),
                          friction=of(f"{k}.friction"), ground_j_m_k=ground, ground_k_m_w=np.maximum(beyond, 1e-3), around_degc=rig["around"]))
    short = {spec["name"]: Pipe(count, 0.25 * spec["length"], spec["inner"], 0.0, spec["resistance"], rig["start"])
             for spec in rig["pipes"] if of(f"{spec['name']}.parallel").any()}
    out = {f"{p['name']}.t": np.empty((count, n)) for p in rig["pipes"]} | {f"{p['name']}.dp": np.empty((count, n)) for p in rig["pipes"]}
    scale, zero, inlet_k, around_k, drift_k = (of(k) for k in ("flow", "flow_zero", "inlet_k", "around_k", "drift_k"))
    rows = [(pipe, spec["name"], of(f"{spec['name']}.around_k"), of(f"{spec['name']}.parallel"), of(f"{spec['name']}.window"),
             of(f"{spec['name']}.heater_w")) for pipe, spec in zip(pipes, rig["pipes"])]
    for second in range(-300, n):  # five minutes before the first reading
        i = max(second, 0)
        m = flow[i] * scale + (zero if flow[i] > 0 else 0.0)
        around = rig["around"] + around_k + drift_k * np.sin(2 * np.pi * i / 4000)
        t = inlet[i] + inlet_k
        for pipe, name, own_k, parallel, window, heater_w in rows:
            t_in = t
            if name in short:
                share = parallel * np.where(window > 0, 1000 < second < 2600, 1.0)
                t = pipe.second(m * (1 - share), t_in, around + own_k)
                t = (1 - share) * t + share * short[name].second(m * share, t_in, around)
            else:
                t = pipe.second(m, t_in, around + own_k)
            if name in plugs:
                t = plugs[name].second(m, t)
            if second % 600 < 260 and flow[i] > 0:
                t = t + heater_w / m / 4180.0
            out[f"{name}.t"][:, i] = t + 273.15
            out[f"{name}.dp"][:, i] = pipe.dp
    out["inlet.t"] = np.tile(inlet + 273.15, (count, 1))
    out["flow"] = np.tile(flow, (count, 1))
    return out


def sensors(rig):
    names = [p["name"] for p in rig["pipes"]]
    nodes = dict(zip(names, ["middle", "house"] if len(names) == 2 else ["house"]))
    all_ = [Sensor("T_in", "plant.temperature_k", "input", "pt100_a", truth="inlet.t", **TEMPERATURE),
            Sensor("flow", "plant.m_flow_kg_s", "input", "mid", truth="flow", **FLOW)]
    for name in names:
        all_.append(Sensor(f"T_{nodes[name]}", f"{nodes[name]}.t_k", "compare", "pt100_a", truth=f"{name}.t", blank="flow", **TEMPERATURE))
    if rig["rich"] or rig.get("dp"):
        for name in names:
            all_.append(Sensor(f"dp_{name}", f"{name}.dp_pa", "compare", "dp_0_25", truth=f"{name}.dp", unit="hPa", quantisation=0.1))
    return all_


def further(rig, signal):
    """A sensor that could be added; none where the truth has no such channel."""
    of, quantity = signal.split(".")
    if quantity == "dp_pa":
        return Sensor("new", signal, "compare", "dp_0_25", truth=f"{of}.dp", unit="hPa", quantisation=0.1)
    return None


def tolerances(rig):
    """What always differs a little: parameter, half width of its range."""
    p = {"around_k": 0.5, "drift_k": 0.3}
    for pipe in rig["pipes"]:
        n = pipe["name"]
        p |= {f"{n}.length": 0.005, f"{n}.loss": 0.05, f"{n}.film": 0.1, f"{n}.friction": 0.01}
        p[f"{n}.wall"] = 0.02 * neutral(rig)[f"{n}.wall"]
    return p


def declared(rig):
    """What is uncertain beside what is drawn: the model's formula of friction is right to 1 to 2 %, a heat loss at rest to 12 %."""
    of = {"friction": 0.01} | ({"standstill": 0.12} if rig["pauses"] else {})
    return {f"{pipe['name']}.{key}": half for pipe in rig["pipes"] for key, half in of.items()}


def effects(rig):
    """Of the plant: (id, component, parameter of the model, variant at a value, value for the first look, range)."""
    for pipe in rig["pipes"]:
        n = pipe["name"]
        geometry = STEEL * np.pi / 4 * (pipe["outer"] ** 2 - pipe["inner"] ** 2)
        if not pipe["wall"]:
            yield "P1", n, "wall_capacity_j_m_k", (lambda x, n=n: {f"{n}.wall": x}), geometry, (0.8 * geometry, 1.2 * geometry), 0.0
        yield "P2", n, "factor", (lambda x, n=n: {f"{n}.loss": x}), 1.5, (0.3, 6.0), 1.0
        yield "P3", n, "difference_k", (lambda x, n=n: {f"{n}.around_k": x}), 5.0, (-10.0, 10.0), 0.0
        if rig["pauses"]:
            content = np.pi / 4 * pipe["inner"] ** 2 * pipe["length"]
            yield "P6", n, "volume_m3", (lambda x, n=n: {f"{n}.piece": x}), 0.1 * content, (0.02 * content, 0.5 * content), 0.0
            yield "P5", n, "factor", (lambda x, n=n: {f"{n}.standstill": x}), 2.5, (0.2, 5.0), 1.0
        yield "P7", n, "dispersion_m2_s", (lambda x, n=n: {f"{n}.dispersion": max(x, 0.004)}), 0.1, (0.01, 1.0), 0.0
        yield "P10", n, "factor", (lambda x, n=n: {f"{n}.length": x}), 1.02, (0.7, 1.3), 1.0
        if rig.get("long"):
            yield "P4", n, "capacity_j_m_k", (lambda x, n=n: {f"{n}.ground": x}), 1e5, (2e4, 5e5), 0.0
        if rig["rich"] or rig.get("dp"):
            yield "P8", n, "factor", (lambda x, n=n: {f"{n}.friction": x}), 1.3, (0.5, 5.0), 1.0


def model(rig):
    lines = ["format = 1", "[model]", 'name = "bench"', "[run]", f'until = "{duration_s(rig):.0f}s"', f'step = "{20 if rig.get("long") else 5}s"',
             'record = "10s"', f"initial_degc = {rig['start']:.1f}", "[fluid]", 'kind = "water"', "follow_temperature = true",
             "[ground]", f"temperature_degc = {rig['around']}",
             "[tolerance]", "length = 0.005", "loss = 0.05", "friction = 0.014", "surroundings_difference_k = 0.5",
             "[[node]]", 'id = "plant"', 'kind = "source"',
             f"m_flow_kg_h = {rig['flows'][0] * 3600:.0f}", f"temperature_degc = {rig['start']:.1f}"]
    nodes = ["plant", "middle", "house"] if rig["rich"] else ["plant", "house"]
    if rig["rich"]:
        lines += ["[[node]]", 'id = "middle"', 'kind = "junction"']
    lines += ["[[node]]", 'id = "house"', 'kind = "pressure_boundary"', "pressure_bar = 2", f"temperature_degc = {rig['start']:.1f}"]
    for pipe, a, b in zip(rig["pipes"], nodes, nodes[1:]):
        lines += ["[[edge]]", f'id = "{pipe["name"]}"', 'kind = "pipe"', f'from = "{a}"', f'to = "{b}"',
                  f"length_m = {pipe['length']}", f"inner_diameter_mm = {pipe['inner'] * 1e3:.1f}",
                  f"outer_diameter_mm = {pipe['outer'] * 1e3:.1f}", f"roughness_mm = {pipe['roughness'] * 1e3}",
                  f"insulation_resistance_k_m_w = {pipe['resistance']}"]
        if pipe["wall"]:
            lines += ['wall = "film"']
    return "\n".join(lines) + "\n"


def split(rig):
    """Blocks of 5 min in turns, the first 40 s of each left out, of the whole 200 s."""
    turns = ["identify", "validate", "identify", "show"]
    return "".join(f'[[block]]\nrole = "{turns[i % 4]}"\nfrom_s = {i * block_s(rig) + (40 if i else 900 if rig.get("long") else FIRST_S)}\nuntil_s = {(i + 1) * block_s(rig) - 1}\n'
                   for i in range(BLOCKS))


def is_show(rig, at_s):
    block = (at_s // block_s(rig)).astype(int)
    return (block % 4 == 3) & (at_s >= block * block_s(rig) + 40) & (at_s <= (block + 1) * block_s(rig) - 1)


def unknown(rig, rng):
    """What no effect of the catalogue describes."""
    n = rig["pipes"][rng.integers(len(rig["pipes"]))]["name"]
    return [
        ("two parallel paths", {f"{n}.parallel": rng.uniform(0.25, 0.45)}),
        ("hidden periodic heater", {f"{n}.heater_w": rng.uniform(600, 2500)}),
        ("a hand valve opens a short path for a while", {f"{n}.parallel": rng.uniform(0.3, 0.5), f"{n}.window": 1.0}),
        ("cold water drawn in at the joint now and then", {f"{n}.heater_w": -rng.uniform(600, 2500)}),
    ][rng.integers(4)]


def beside(rig):
    """Pairs of components and sensors with nothing between them."""
    names = [p["name"] for p in rig["pipes"]]
    pairs = [("T_in", names[0]), ("T_house", names[-1])] + [("flow", n) for n in names] + [(f"dp_{n}", n) for n in names]
    return pairs + ([("near", "far"), ("near", "T_middle"), ("far", "T_middle")] if len(names) == 2 else [])

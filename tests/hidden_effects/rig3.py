"""R3: two houses feed in with pumps, the third takes heat: the hot line of the laboratory's three-house case.

The cold line is wide (one pressure, as boundaries); what feeds in has the temperature that is measured. Pumps after
`H = H0 n^2 - k m^2`, check valves, friction after Colebrook and White with the viscosity of each pipe's water. Rich: both flows, temperatures
at the joint of the first house and at the third, pressure losses of both lines. Poor: heat meters.
"""

import numpy as np
from numba import njit

from pipe import Pipe
from sensors import SPARE_S, TEMPERATURE, Sensor, as_read, commanded, longer_s, otherwise

NAME = "R3"
BLOCK_S, BLOCKS = 300.0, 12
FIRST_S = 280  # until the water that was there at the start has left
AGREES_K = 0.05  # with anergy, median, where nothing is hidden
STEEL = 7850.0 * 470.0
FLOWS_THROUGH = True  # without storages
AS_BUILT = {"P1"}
ONE_SIDED = {"H4", "P5", "P7", "P8", "P11", "S4"}
PIPES = [("stub1", "b1", "j1"), ("line12", "j1", "j2"), ("stub2", "b2", "j2"), ("line23", "j2", "j3")]
# So much an effect is at least: less is the tolerance of another pump or valve of the same kind.
SMALLEST = {"H3": 0.06, "H4": 0.01, "P11": 0.004}
KVS_CHECK = 6.0


def _warmer(key):
    def change(p, bias, gain, as_is=False):
        return p | {key: p[key] + bias + (0.0 if as_is else (gain - 1) * 50.0)}

    return change


COMMANDS = ("n1", "n2", "kappa")
INPUTS = {"t1": _warmer("t1_k"), "t2": _warmer("t2_k")} | {command: commanded(command) for command in COMMANDS}


def duration_s(rig):
    return BLOCK_S * BLOCKS + longer_s(rig)


def draw(rng, rich):
    inner = rng.choice([0.0217, 0.0272])
    wall = bool(rng.random() < 0.3)
    lengths = {"stub1": rng.uniform(4, 9), "line12": rng.uniform(35, 60), "stub2": rng.uniform(4, 9), "line23": rng.uniform(15, 30)}
    pipes = [dict(name=n, length=float(np.round(lengths[n], 1)), inner=float(inner), outer=float(np.round(inner + 2 * rng.uniform(0.0012, 0.003), 4)),
                  resistance=float(np.round(rng.uniform(2.5, 6), 2)), roughness=1e-5, wall=wall and n.startswith("line")) for n, _, _ in PIPES]
    speeds = {1: rng.uniform(0.85, 0.97, BLOCKS), 2: rng.uniform(0.8, 0.92, BLOCKS)}
    off = {1: [1, 6, 11] if rng.random() < 0.6 else [], 2: [3, 5, 8]}  # validate, identify, show; and others
    return dict(pipes=pipes, rich=rich, speeds=speeds, off=off, kappa=rng.uniform(0.4, 0.9, BLOCKS), head=float(np.round(rng.uniform(350, 500))),
                free=float(np.round(rng.uniform(45, 60))), kvs=float(np.round(rng.uniform(2.5, 4.0), 2)), around=float(np.round(rng.uniform(8, 16), 1)),
                t1=rng.uniform(52, 78, BLOCKS), t2=rng.uniform(52, 78, BLOCKS), start=float(rng.uniform(50, 60)), shift=rng.uniform(10, 70, (2, BLOCKS)),
                every_s=float(rng.choice([10, 10, 20])), pauses=True)


def program(rig):
    n = int(BLOCK_S * BLOCKS) + SPARE_S
    t = np.arange(n, dtype=float)

    def steps(values, ramp, shift):
        points_t, points, last = [0.0], [values[0]], values[0]
        for i, v in enumerate(values):
            points_t += [i * BLOCK_S + shift[i] + 1, i * BLOCK_S + shift[i] + ramp]
            points += [last, v]
            last = v
        return np.interp(t, points_t, points)

    out = {"kappa": steps(rig["kappa"], 30, rig["shift"][0])}
    for k in (1, 2):
        out[f"t{k}"] = steps(rig[f"t{k}"], 50, rig["shift"][k - 1]) + 0.3 * np.sin(2 * np.pi * t / (170 + 40 * k))
        speed = steps(rig["speeds"][k], 20, rig["shift"][1] + 20)
        for i in rig["off"][k]:
            begin = int(i * BLOCK_S + 120)
            speed[begin : begin + 110] = 0.0
            speed[begin - 10 : begin] *= np.linspace(1, 0.1, 10)
            speed[begin + 110 : begin + 120] *= np.linspace(0.1, 1, 10)
        out[f"n{k}"] = speed
    return {name: as_read(rig, otherwise(rig, x, "degc" if name[0] == "t" else "command")) for name, x in out.items()}


def neutral(rig):
    p = {"around_k": 0.0, "drift_k": 0.3, "t1_k": 0.0, "t2_k": 0.0, "head1": 1.0, "head2": 1.0, "kv": 1.0, "extra1": 0.0, "open1": 0.0, "open2": 0.0, "leak": 0.0}
    p |= {command: 1.0 for command in COMMANDS}
    for pipe in rig["pipes"]:
        n = pipe["name"]
        geometry = STEEL * np.pi / 4 * (pipe["outer"] ** 2 - pipe["inner"] ** 2)
        p |= {f"{n}.length": 1.0, f"{n}.loss": 1.0, f"{n}.around_k": 0.0, f"{n}.film": 1.0, f"{n}.dispersion": 0.003, f"{n}.standstill": 1.0,
              f"{n}.friction": 1.0, f"{n}.wall": geometry if pipe["wall"] else 0.0, f"{n}.heater_w": 0.0}
    return p


@njit(cache=True)
def branch(pressure, own, check, open_):
    """Flow of a branch that this pressure drives: back only what the closed check valve lets through."""
    return np.sqrt(pressure / (own + check)) if pressure >= 0 else -np.sqrt(-pressure / (own + check / open_**2))


@njit(cache=True)
def flows_of(head1, head2, own1, own2, common, check, open1, open2, leak, outlet):
    """Flows of both branches and to the third house, with a hole at the joint: by halving."""
    m1, m2, m3 = np.zeros(head1.size), np.zeros(head1.size), np.zeros(head1.size)
    for k in range(head1.size):
        low, high = 0.0, np.sqrt(max(head1[k], head2[k]) / common[k])
        for _ in range(40):
            m = 0.5 * (low + high)
            drop = common[k] * m * m
            m1[k], m2[k] = branch(head1[k] - drop, own1[k], check, open1[k]), branch(head2[k] - drop, own2[k], check, open2[k])
            lost = leak[k] * np.sqrt((outlet + drop) / 1e5)
            if m1[k] + m2[k] > m + lost:
                low = m
            else:
                high = m
        m1[k], m2[k] = m1[k] if abs(m1[k]) > 1e-4 else 0.0, m2[k] if abs(m2[k]) > 1e-4 else 0.0
        m3[k] = max(m1[k] + m2[k] - lost, 0.0)
    return m1, m2, m3


def simulate(rig, variants):
    inputs, count = program(rig), len(variants)
    n = inputs["kappa"].size

    def of(key):
        return np.array([v[key] for v in variants])

    pipes = {}
    for pipe in rig["pipes"]:
        k = pipe["name"]
        pipes[k] = Pipe(count, pipe["length"] * of(f"{k}.length"), pipe["inner"], of(f"{k}.wall"), pipe["resistance"] / of(f"{k}.loss"), rig["start"],
                        pipe["roughness"], film=of(f"{k}.film"), dispersion_m2_s=of(f"{k}.dispersion"), standstill=of(f"{k}.standstill"),
                        friction=of(f"{k}.friction"), cells=60 if k.startswith("stub") else 200)
    own_k = {k: of(f"{k}.around_k") for k in pipes}
    heater = {k: of(f"{k}.heater_w") for k in pipes}
    t_k, head, kv, extra = {i: of(f"t{i}_k") for i in (1, 2)}, {i: of(f"head{i}") * rig["head"] * 100 for i in (1, 2)}, of("kv"), of("extra1")
    around_k, drift_k = of("around_k"), of("drift_k")
    gain = {command: of(command) for command in COMMANDS}
    rho = 985.0
    out = {c: np.empty((count, n)) for c in ("m1", "m2", "m3", "j1.t", "j2.t", "j3.t", "stub1.dp", "line12.dp", "stub2.dp", "line23.dp")}
    per_kg = {k: np.full(count, 1e4) for k in pipes}  # Pa/(kg/s)^2
    check = 1e5 * (3600 / (rho * KVS_CHECK)) ** 2 * rho / 1000
    # A weaker pump has less head at every flow.
    pump = {k: head[k] / (rig["free"] / 60000 * rho) ** 2 for k in (1, 2)}
    t1 = t2 = tj1 = tj2 = np.full(count, rig["start"])
    outlet, open_, leak = 1.5e5, {k: 1e-5 + of(f"open{k}") for k in (1, 2)}, of("leak")
    for second in range(-300, n):
        i = max(second, 0)
        valve = 1e5 * (3600 / (rho * rig["kvs"] * kv * gain["kappa"] * inputs["kappa"][i])) ** 2 * rho / 1000
        common = per_kg["line23"] + valve
        own = {1: pump[1] + per_kg["stub1"] + per_kg["line12"] + extra * (second > 1500), 2: pump[2] + per_kg["stub2"]}
        heads = {k: head[k] * (gain[f"n{k}"] * inputs[f"n{k}"][i]) ** 2 for k in (1, 2)}
        m1, m2, total = flows_of(heads[1], heads[2], own[1], own[2], common, check, open_[1], open_[2], leak, outlet)
        flows = {"stub1": m1, "line12": m1, "stub2": m2, "line23": total}
        around = rig["around"] + around_k + drift_k * np.sin(2 * np.pi * i / 4000)
        heat = {k: np.where(flows[k] > 1e-3, heater[k] * (second % 600 < 260) / np.maximum(flows[k], 0.02) / 4180.0, 0.0) for k in pipes}
        # What flows back comes from the joint behind.
        t1 = pipes["stub1"].second(m1, np.where(m1 < 0, tj1, inputs["t1"][i] + t_k[1]), around + own_k["stub1"]) + heat["stub1"]
        t12 = pipes["line12"].second(m1, np.where(m1 < 0, tj2, np.where(m1 > 0, t1, tj1)), around + own_k["line12"]) + heat["line12"]
        tj1 = np.where(m1 > 0, t1, np.where(m1 < 0, t12, tj1))
        t2 = pipes["stub2"].second(m2, np.where(m2 < 0, tj2, inputs["t2"][i] + t_k[2]), around + own_k["stub2"]) + heat["stub2"]
        to_joint = np.maximum(m1, 0) + np.maximum(m2, 0)
        mixed = (np.maximum(m1, 0) * t12 + np.maximum(m2, 0) * t2) / np.maximum(to_joint, 1e-9)
        tj2 = np.where(to_joint > 0, mixed, tj2)
        tj3 = pipes["line23"].second(total, tj2, around + own_k["line23"]) + heat["line23"]
        for k, p in pipes.items():
            per_kg[k] = np.where(np.abs(flows[k]) > 1e-3, np.abs(p.dp) / np.maximum(np.abs(flows[k]), 1e-3) ** 2, per_kg[k])
        for c, x in (("m1", m1), ("m2", m2), ("m3", total), ("j1.t", tj1 + 273.15), ("j2.t", tj2 + 273.15), ("j3.t", tj3 + 273.15)):
            out[c][:, i] = x
        for name, pipe in pipes.items():
            out[f"{name}.dp"][:, i] = pipe.dp
    for c in ("t1", "t2"):
        out[c] = np.tile(inputs[c] + 273.15, (count, 1))
    for c in ("n1", "n2", "kappa"):
        out[c] = np.tile(inputs[c], (count, 1))
    return out


def sensors(rig):
    flow = dict(unit="kg_h", quantisation=1.0, klass="mid" if rig["rich"] else "flow_class_2", signed=rig["rich"])
    command = dict(role="input", klass="electric_0_2", unit="1", quantisation=0.001)
    every = [Sensor("T_1", "s1.temperature_k", "input", "pt100_a", truth="t1", **TEMPERATURE),
             Sensor("T_2", "s2.temperature_k", "input", "pt100_a", truth="t2", **TEMPERATURE),
             Sensor("n_1", "pump1.speed", truth="n1", **command), Sensor("n_2", "pump2.speed", truth="n2", **command),
             Sensor("kappa", "valve3.kappa", truth="kappa", **command),
             Sensor("flow_1", "pump1.m_flow_kg_s", "compare", truth="m1", **flow),
             Sensor("flow_2", "pump2.m_flow_kg_s", "compare", truth="m2", **flow),
             Sensor("T_3", "j3.t_k", "compare", "pt100_a", truth="j3.t", **TEMPERATURE)]
    if rig["rich"]:
        every += [Sensor("flow_3", "valve3.m_flow_kg_s", "compare", truth="m3", **flow),
                  Sensor("T_j1", "j1.t_k", "compare", "pt100_a", truth="j1.t", blank="m1", **TEMPERATURE),
                  Sensor("dp_12", "line12.dp_pa", "compare", "dp_0_25", truth="line12.dp", unit="hPa", quantisation=0.1),
                  Sensor("dp_23", "line23.dp_pa", "compare", "dp_0_25", truth="line23.dp", unit="hPa", quantisation=0.1)]
    return every


def further(rig, signal):
    """A sensor that could be added; none where the truth has no such channel."""
    of, quantity = signal.split(".")
    flows = {"stub1": "m1", "line12": "m1", "stub2": "m2", "line23": "m3"}
    if quantity == "dp_pa" and of in flows:
        return Sensor("new", signal, "compare", "dp_0_25", truth=f"{of}.dp", unit="hPa", quantisation=0.1)
    if quantity == "m_flow_kg_s" and of in flows:
        return Sensor("new", signal, "compare", "mid", "kg_h", flows[of], quantisation=1.0, signed=True)
    water = {"b1": ("t1", "m1"), "b2": ("t2", "m2"), "j1": ("j1.t", "m1"), "j2": ("j2.t", "m3")}
    if quantity == "t_k" and of in water:
        return Sensor("new", signal, "compare", "pt100_a", truth=water[of][0], blank=water[of][1], **TEMPERATURE)
    return None


def tolerances(rig):
    p = {"around_k": 0.5, "drift_k": 0.3, "head1": 0.002, "head2": 0.002, "kv": 0.003}
    for pipe in rig["pipes"]:
        n = pipe["name"]
        p |= {f"{n}.length": 0.005, f"{n}.loss": 0.05, f"{n}.film": 0.1, f"{n}.friction": 0.01, f"{n}.wall": 0.02 * neutral(rig)[f"{n}.wall"]}
    return p


def declared(rig):
    """What is uncertain beside what is drawn: the model's formula of friction is right to 1 to 2 %, a heat loss at rest to 12 %, heads to 0.5 %."""
    p = {f"{pipe['name']}.{key}": half for pipe in rig["pipes"] for key, half in (("friction", 0.01), ("standstill", 0.12))}
    # With the 0.2 % that are drawn 0.5 %: (0.5^2 - 0.2^2)^0.5.
    return p | {"head1": 0.0046, "head2": 0.0046}


def effects(rig):
    for pipe in rig["pipes"]:
        n = pipe["name"]
        geometry = STEEL * np.pi / 4 * (pipe["outer"] ** 2 - pipe["inner"] ** 2)
        if n.startswith("line"):
            if not pipe["wall"]:
                yield "P1", n, "wall_capacity_j_m_k", (lambda x, n=n: {f"{n}.wall": x}), geometry, (0.8 * geometry, 1.2 * geometry), 0.0
            yield "P7", n, "dispersion_m2_s", (lambda x, n=n: {f"{n}.dispersion": max(x, 0.003)}), 0.1, (0.01, 1.0), 0.0
        yield "P2", n, "factor", (lambda x, n=n: {f"{n}.loss": x}), 1.5, (0.3, 6.0), 1.0
        yield "P3", n, "difference_k", (lambda x, n=n: {f"{n}.around_k": x}), 5.0, (-10.0, 10.0), 0.0
        yield "P5", n, "factor", (lambda x, n=n: {f"{n}.standstill": x}), 2.5, (0.2, 5.0), 1.0
        yield "P10", n, "factor", (lambda x, n=n: {f"{n}.length": x}), 1.02, (0.7, 1.3), 1.0
        yield "P8", n, "factor", (lambda x, n=n: {f"{n}.friction": x}), 1.3, (0.5, 5.0), 1.0
    for k in (1, 2):
        yield "H3", f"pump{k}", "factor", (lambda x, k=k: {f"head{k}": x}), 0.95, (0.7, 1.3), 1.0
    if rig["rich"]:
        # Meters on both sides, and those that read backwards.
        for k in (1, 2) if rig["off"][1] else (2,):
            yield "H4", f"check{k}", "share", (lambda x, k=k: {f"open{k}": x}), 0.02, (0.004, 0.1), 0.0
        yield "P11", "j2", "m_flow_kg_s", (lambda x: {"leak": x}), 0.005, (0.001, 0.03), 0.0


def unknown(rig, rng):
    n = ["line12", "line23"][rng.integers(2)]
    return [("hidden periodic heater", {f"{n}.heater_w": rng.uniform(800, 2500)}),
            ("a strainer blocks after 25 min", {"extra1": rng.uniform(0.5, 3) * 1e5}),
            ("cold water drawn in at the joint now and then", {f"{n}.heater_w": -rng.uniform(800, 2500)})][rng.integers(3)]


def model(rig):
    lines = ["format = 1", "[model]", 'name = "three houses"', "[run]", f'until = "{BLOCK_S * BLOCKS:.0f}s"', 'step = "5s"', 'record = "10s"',
             f"initial_degc = {rig['start']:.1f}", "[fluid]", 'kind = "water"', "follow_temperature = true", "[ground]", f"temperature_degc = {rig['around']}",
             "[tolerance]", "length = 0.005", "loss = 0.05", "friction = 0.014", "surroundings_difference_k = 0.5", "pump_head = 0.005"]
    for node in ("s1", "s2", "out"):
        lines += ["[[node]]", f'id = "{node}"', 'kind = "pressure_boundary"', "pressure_bar = 1.5", f"temperature_degc = {rig['start']:.1f}"]
    for node in ("a1", "b1", "a2", "b2", "j1", "j2", "j3"):
        lines += ["[[node]]", f'id = "{node}"', 'kind = "junction"']
    for k in (1, 2):
        lines += ["[[edge]]", f'id = "pump{k}"', 'kind = "pump"', f'from = "s{k}"', f'to = "a{k}"', f"head_max_hpa = {rig['head']}",
                  f"free_flow_l_min = {rig['free']}", "rise_time_s = 0",
                  "[[edge]]", f'id = "check{k}"', 'kind = "check_valve"', f'from = "a{k}"', f'to = "b{k}"', f"kvs_m3_h = {KVS_CHECK}", "leakage = 1e-5"]
    for pipe, (name, a, b) in zip(rig["pipes"], PIPES):
        lines += ["[[edge]]", f'id = "{name}"', 'kind = "pipe"', f'from = "{a}"', f'to = "{b}"', f"length_m = {pipe['length']}",
                  f"inner_diameter_mm = {pipe['inner'] * 1e3:.1f}", f"outer_diameter_mm = {pipe['outer'] * 1e3:.1f}",
                  f"roughness_mm = {pipe['roughness'] * 1e3}", f"insulation_resistance_k_m_w = {pipe['resistance']}"]
        if pipe["wall"]:
            lines += ['wall = "film"']
    lines += ["[[edge]]", 'id = "valve3"', 'kind = "valve"', 'from = "j3"', 'to = "out"', f"kvs_m3_h = {rig['kvs']}", 'command = "kappa"',
              f"kappa = {rig['kappa'][0]:.3f}", "stroke_time_s = 0"]
    return "\n".join(lines) + "\n"


def split(rig):
    """Blocks of 5 min in turns, the first 40 s of each left out, of the run 280 s."""
    turns = ["identify", "validate", "identify", "show"]
    return "".join(f'[[block]]\nrole = "{turns[i % 4]}"\nfrom_s = {i * BLOCK_S + (40 if i else FIRST_S)}\nuntil_s = {(i + 1) * BLOCK_S - 1}\n'
                   for i in range(BLOCKS))


def is_show(rig, at_s):
    block = (at_s // BLOCK_S).astype(int)
    return (block % 4 == 3) & (at_s >= block * BLOCK_S + 40) & (at_s <= (block + 1) * BLOCK_S - 1)


def beside(rig):
    """Pairs of components and sensors with nothing between them."""
    meets = {"j1": ["stub1", "line12", "T_j1"], "j2": ["line12", "stub2", "line23"], "j3": ["line23", "T_3", "m_3", "kappa_3"], "b1": ["stub1", "T_1", "m_1", "n_1", "pump1"],
             "b2": ["stub2", "T_2", "m_2", "n_2", "pump2"]}
    return [(a, b) for group in meets.values() for a in group for b in group if a < b] + [("dp_12", "line12"), ("dp_23", "line23")]

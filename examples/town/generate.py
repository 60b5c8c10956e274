"""Makes nodes.csv and pipes.csv: 500 houses along the streets of a town, one plant, a few loops.

The same seed gives the same files: `python generate.py` changes nothing. Pipes are sized for a pressure
gradient, valves for the design flow of their house at the pressure difference it has in the design.
"""

import csv
import math
import random
from pathlib import Path

SEED = 7
HOUSES = 500
COLUMNS, ROWS = 11, 9  # crossings
BLOCK_M = (85.0, 70.0)  # between crossings, east and north
LOOPS = 9  # streets that close a loop

SUPPLY_RETURN_K = 30.0
CP_J_KG_K = 4180.0
GRADIENT_PA_M = 100.0  # largest of the design, at simultaneous full load of all houses
FRICTION = 0.024
WORST_PA = 50_000.0  # held at the worst house
RESERVE = 1.1  # flow of the open valves over the design flow
EXCHANGER_PA = 15_000.0
LMTD_K = 8.0  # mean difference over a house's heat exchanger

# Steel pipes, inner diameter in mm: the types of model.toml.
PIPES = {
    "dn20": 21.6, "dn25": 28.5, "dn32": 37.2, "dn40": 43.1, "dn50": 54.5, "dn65": 70.3,
    "dn80": 82.5, "dn100": 107.1, "dn125": 132.5, "dn150": 160.3, "dn200": 210.1, "dn250": 263.0,
}

NODE_COLUMNS = [
    "id", "x_m", "y_m", "elevation_m", "station", "unit.load_kw", "stub.pipe", "stub.length_m",
    "heat_exchanger.m_flow_nominal_kg_s", "heat_exchanger.ua_w_k", "extraction_valve.kvs_m3_h",
]


def gradient_pa_m(m_flow_kg_s, diameter_mm):
    d = diameter_mm / 1000.0
    velocity = m_flow_kg_s / 1000.0 / (math.pi / 4.0 * d * d)
    return FRICTION / d * 500.0 * velocity * velocity


def pipe_for(m_flow_kg_s):
    fits = [name for name, d in PIPES.items() if gradient_pa_m(m_flow_kg_s, d) <= GRADIENT_PA_M]
    return fits[0] if fits else "dn250"


def streets(rng, place):
    """The streets with pipes: a tree that grows from the plant's crossing, and a few more for loops."""
    crossings = list(place)
    neighbours = {
        (x, y): [c for c in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)) if c in place]
        for x, y in crossings
    }
    start = (0, ROWS // 2)
    way = {start: 0.0}
    tree, rest = [], []
    candidates = [(start, n) for n in neighbours[start]]
    weight = {}
    while candidates:
        def cost(street):
            if street not in weight:
                weight[street] = rng.uniform(0.0, 150.0)
            return way[street[0]] + weight[street]

        street = min(candidates, key=cost)
        candidates.remove(street)
        a, b = street
        if b in way:
            if (b, a) not in tree and (b, a) not in rest:
                rest.append((a, b))
            continue
        way[b] = way[a] + math.dist(place[a], place[b])
        tree.append((a, b))
        candidates += [(b, n) for n in neighbours[b] if n not in way]
    return start, tree, rng.sample(rest, LOOPS)


def main():
    rng = random.Random(SEED)
    place = {
        (x, y): (
            round(x * BLOCK_M[0] + rng.uniform(-12, 12)),
            round(y * BLOCK_M[1] + rng.uniform(-10, 10)),
        )
        for x in range(COLUMNS)
        for y in range(ROWS)
    }
    start, tree, loops = streets(rng, place)

    plant = (-90, place[start][1] + 15)
    nodes = {"plant": {"x_m": plant[0], "y_m": plant[1], "station": "plant"}}
    name = lambda c: f"x{c[0]}_{c[1]}"
    for crossing, (x, y) in place.items():
        nodes[name(crossing)] = {"x_m": x, "y_m": y}
    trenches = [("plant", name(start))]
    parent = {name(start): "plant"}
    closing = []  # streets that close a loop, as their trenches from one crossing to the other

    # Houses stand along the streets, one after the other; the trench passes them all.
    share = HOUSES / len(tree + loops)
    house = 0
    for i, (a, b) in enumerate(tree + loops):
        count = round((i + 1) * share) - round(i * share)
        leaf = (a, b) in tree and all(s[0] != b for s in tree) and all(b not in s for s in loops)
        (xa, ya), (xb, yb) = place[a], place[b]
        last = name(a)
        first = len(trenches)
        for k in range(count):
            house += 1
            at = (k + 0.6) / count
            load_kw = rng.choice([6, 7, 8, 9, 10, 11, 12, 14])
            if rng.random() < 0.08:
                load_kw = rng.choice([35, 50, 70, 95])  # a block of flats
            here = f"h{house}"
            nodes[here] = {
                "x_m": round(xa + at * (xb - xa)),
                "y_m": round(ya + at * (yb - ya)),
                "station": "house",
                "load_kw": load_kw,
                "stub_m": rng.randint(6, 18),
            }
            trenches.append((last, here))
            parent.setdefault(here, last)
            last = here
        if leaf:
            del nodes[name(b)]  # nobody stands at the end of the street
        else:
            trenches.append((last, name(b)))
            if (a, b) in loops:
                closing.append(trenches[first:])
            else:
                parent[name(b)] = last

    for node in nodes.values():
        x, y = node["x_m"], node["y_m"]
        hill_m = 4.0 * math.sin(x / 260.0) * math.cos(y / 190.0)
        node["elevation_m"] = round(420.0 + 0.012 * x + hill_m, 1)
        node["m_flow_kg_s"] = node.get("load_kw", 0.0) * 1000.0 / (CP_J_KG_K * SUPPLY_RETURN_K)

    position = {n: (node["x_m"], node["y_m"]) for n, node in nodes.items()}
    length = {(a, b): max(3.0, round(math.dist(position[a], position[b]), 1)) for a, b in trenches}
    # The design counts with the tree alone: flows from the ends, then losses from the plant.
    order, depth = list(parent), {"plant": 0}

    def depth_of(n):
        if n not in depth:
            depth[n] = depth_of(parent[n]) + 1
        return depth[n]

    order.sort(key=depth_of)
    total = {n: node["m_flow_kg_s"] for n, node in nodes.items()}
    for n in reversed(order):
        total[parent[n]] += total[n]
    loss_pa = {"plant": 0.0}
    size = {}
    for n in order:
        trench = (parent[n], n)
        size[trench] = pipe_for(total[n])
        gradient = gradient_pa_m(total[n], PIPES[size[trench]])
        loss_pa[n] = loss_pa[parent[n]] + gradient * length[trench]
    for street in closing:
        # One pipe from end to end, so that water can come from both.
        for trench in street:
            size[trench] = size[street[0]]
    farthest_pa = max(loss_pa[n] for n, node in nodes.items() if "load_kw" in node)

    folder = Path(__file__).parent
    with open(folder / "nodes.csv", "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(NODE_COLUMNS)
        for n, node in nodes.items():
            row = [n, node["x_m"], node["y_m"], node["elevation_m"], node.get("station", "")]
            if "load_kw" in node:
                flow = node["m_flow_kg_s"]
                stub = pipe_for(flow)
                stub_pa = 2.0 * gradient_pa_m(flow, PIPES[stub]) * node["stub_m"]
                valve_pa = WORST_PA + 2.0 * (farthest_pa - loss_pa[n]) - EXCHANGER_PA - stub_pa
                kvs = RESERVE * 3.6 * flow / math.sqrt(valve_pa / 1e5)
                row += [
                    node["load_kw"], stub, node["stub_m"], f"{flow:.4f}",
                    round(node["load_kw"] * 1000.0 / LMTD_K), f"{kvs:.3f}",
                ]
            else:
                row += [""] * 6
            table.writerow(row)
    with open(folder / "pipes.csv", "w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["from", "to", "length_m", "pipe"])
        for trench in trenches:
            table.writerow([*trench, length[trench], size[trench]])


if __name__ == "__main__":
    main()

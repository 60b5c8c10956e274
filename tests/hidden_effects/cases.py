"""Cases with a hidden effect, with none, with one outside of the catalogue, with two, and with broken data.

    python cases.py OUT --rig R1 --seed 1 --draws 4      # folders OUT/R1-1-..., answers in OUT/answers.json

A draw is one bench and one experiment; from it come several cases, each with its own tolerances, sensors and noise. Seeds below
1 000 000 are for development, those from there on for scores that are reported.
"""

import argparse
import copy
import dataclasses
import importlib
import json
import re
from pathlib import Path

import numpy as np

import broken
from detect import Look, fitted, shifted, slow, still, stratum
from sensors import JUMPS_AT, ROOT3, UNKNOWN_LAG_S, draw, longer_s, measure, spoil

RIGS = {"R1": "rig1", "R2": "rig2", "R3": "rig3"}
# Range of the expected gain in log-likelihood that is aimed at.
STRATA = {"hard": (6, 14), "medium": (17, 55), "easy": (80, 4000)}
# So much an effect of a sensor is at least, K, and a zero offset over the largest that is looked for: less is within what a class of sensors means.
SMALLEST, SMALLEST_ZERO = {"S3": 0.6}, 0.3
# A drift or a jump is at least so many times the largest permissible error: within its class a sensor may drift.
BEYOND_CLASS = 1.25
# Share of a reading that is small but visible.
SLIGHT = 0.005
# Nats within which two effects are not told apart, and cosine of their signatures.
TOGETHER, PARALLEL = 3.0, 0.99


class Draw:
    """A rig with its experiment: what each effect would show, from the truth with and without it."""

    def __init__(self, module, seed, rich, **kind):
        self.module, self.seed = module, seed
        self.rng = np.random.default_rng(seed)
        self.rig = module.draw(self.rng, rich) | kind
        self.sensors = module.sensors(self.rig)
        self.at_s = np.arange(0, module.duration_s(self.rig), self.rig["every_s"])
        self.neutral = module.neutral(self.rig)
        self.plant = list(module.effects(self.rig))
        # What is drawn, and what the model declares beside it.
        tolerances = list(module.tolerances(self.rig).items()) + list(module.declared(self.rig).items())
        plain = module.simulate(self.rig, [self.neutral])
        # What never does anything is as it is read.
        inputs = [s for s in self.sensors if s.role == "input" and s.truth in module.INPUTS and plain[s.truth].any()]
        # An offset and a gain of each input that are small but visible.
        offset = {s.truth: 0.5 if s.kind == "k" else SLIGHT * np.mean(plain[s.truth]) for s in inputs}
        variants = [{}] + [{k: self.neutral[k] + half} for k, half in tolerances]
        variants += [module.INPUTS[s.truth](self.neutral, *error) for s in inputs for error in ((offset[s.truth], 1.0), (0.0, 1 + SLIGHT))]
        variants += [variant(look) for _, _, _, variant, look, _, _ in self.plant]
        channels = module.simulate(self.rig, [self.neutral | v for v in variants])
        look = self.look = Look(self.sensors, channels, self.at_s, fitted(module.split(self.rig), self.at_s))
        # Readings may lie anywhere on their inputs.
        moments = [share * self.rig["every_s"] for share in (0, 1 / 3, 2 / 3)]
        plants = [self.neutral] + [self.neutral | variant(first) for _, _, _, variant, first, _, _ in self.plant]
        unread = [module.simulate(self.rig | {"as_read_s": at_s}, plants) for at_s in moments]
        look.unread(unread)
        for j, s in enumerate(inputs):
            _, _, noise = s.limits(channels[s.truth][0])
            first = 1 + len(tolerances) + 2 * j
            if s.kind == "k":
                look.noisier(look.of(channels, first) / offset[s.truth], np.hypot(noise, s.resolution_si() / 12**0.5))
            else:
                on = channels[s.truth][0]
                mean = np.mean(on[on != 0.0])
                look.noisier(look.of(channels, first + 1) / SLIGHT, np.hypot(noise, s.resolution_si() / 12**0.5) / mean)
        k = 1
        for _ in tolerances:
            look.tolerate(look.of(channels, k), 1 / ROOT3)
            k += 1
        self.effects = []  # id, component, parameter, neutral, first look, range, variant or None, signature
        for s in inputs:
            bias, gain, _ = s.limits(channels[s.truth][0])
            by_bias, by_gain = -look.of(channels, k) / offset[s.truth], -look.of(channels, k + 1) / SLIGHT
            k += 2
            look.tolerate(by_bias, bias / ROOT3)
            look.tolerate(by_gain, gain / ROOT3)
            if s.kind == "k":
                self.effects.append(("S1", s.column, "bias_k", 0.0, 1.0, (-5, 5), None, by_bias))
                if module.FLOWS_THROUGH:  # what enters leaves within minutes: a slow change shows as an offset of that moment does
                    for parameter, shape in self.shapes():
                        self.effects.append(("S3", s.column, parameter, 0.0, 1.0, (-5, 5), None, by_bias * np.tile(shape, len(look.sensors))))
            elif s.kind != "1":
                self.effects.append(("S2", s.column, "gain", 1.0, 1.05, (0.8, 1.2), None, 0.05 * by_gain))
                self.effects.append(self.zero_of(s, channels, by_bias))
        for s in look.sensors:
            bias, gain, _ = s.limits(channels[s.truth][0])
            one = look.of_sensor(s, lambda y: y + 1.0)
            same = look.of_sensor(s, lambda y: 1.05 * y)
            look.tolerate(one, bias / ROOT3)
            look.tolerate(same, gain / ROOT3 / 0.05)
            look.tolerate(look.of_sensor(s, shifted(self.rig["every_s"] / ROOT3)))
            look.tolerate(look.of_sensor(s, slow(self.lag_s(s))), 1 / ROOT3)
            if s.kind == "k":
                self.effects.append(("S1", s.column, "bias_k", 0.0, 1.0, (-5, 5), None, one))
                for parameter, shape in self.shapes():
                    self.effects.append(("S3", s.column, parameter, 0.0, 1.0, (-5, 5), None, look.shaped(s, shape)))
            else:
                self.effects.append(("S2", s.column, "gain", 1.0, 1.05, (0.8, 1.2), None, same))
                if s.kind in ("kg_s", "m3_s"):
                    self.effects.append(self.zero_of(s, channels, one))
            self.effects.append(("S4", s.column, "lag_s", 0.0, 30.0, (2, 180), None, look.of_sensor(s, slow(30.0))))
            self.effects.append(("S7", s.column, "clock_s", 0.0, 30.0, (-60, 60), None, look.of_sensor(s, shifted(30.0))))
        # How much further readings are off with each effect of the plant than without, as nobody knows what inputs do between two of theirs.
        self.unread_with = {}
        for id_, component, parameter, variant, first, range_, zero in self.plant:
            self.effects.append((id_, component, parameter, zero, first, range_, variant, look.of(channels, k)))
            self.unread_with[id_, component] = look.off(unread, len(self.unread_with) + 1, channels, k) - look.between
            k += 1
        # Meters that read no flow as none whatever their offset takes away.
        self.unsigned = {s.column for s in look.sensors if s.kind in ("kg_s", "m3_s") and not s.signed}
        look.ready()

    def shapes(self):
        """What a sensor adds in the course of a run: a drift, a jump."""
        share = self.at_s / self.module.duration_s(self.rig)
        return ("drift_k", share), ("step_k", 1.0 * (share > JUMPS_AT))

    def zero_of(self, sensor, channels, signature):
        """A flow meter that reads too much by a constant; `signature` is that of one unit."""
        top = 0.03 * np.max(np.abs(channels[sensor.truth][0]))
        return "S8", sensor.column, f"offset_{sensor.kind}", 0.0, top, (-top, top), None, top * signature

    def near(self, component):
        """What has nothing between it and this component."""
        pairs = self.module.beside(self.rig)
        return sorted({component} | {b for a, b in pairs if a == component} | {a for a, b in pairs if b == component})

    def of_strength(self, effect, wanted, rng):
        """Value of an effect so that it gains about `wanted`."""
        id_, _, _, zero, first, (lo, hi), _, signature = effect
        if id_ in self.module.AS_BUILT:
            return rng.uniform(lo, hi)
        if id_ in ("S4", "S7"):  # not in proportion: look for it
            low, high = (2.0, hi)
            for _ in range(12):
                middle = np.sqrt(low * high)
                low, high = (middle, high) if self.gain(effect, middle) < wanted else (low, middle)
            return float(low * (rng.choice([-1, 1]) if id_ == "S7" else 1))
        share = np.sqrt(wanted / max(self.look.gain(signature), 1e-9))
        sign = rng.choice([-1, 1]) if lo < zero < hi and id_ not in self.module.ONE_SIDED else 1
        smallest = SMALLEST_ZERO * hi if id_ == "S8" else (SMALLEST | getattr(self.module, "SMALLEST", {})).get(id_, 0.0)
        if id_ == "S3":
            sensor = next(s for s in self.sensors if s.column == effect[1])
            smallest = max(smallest, BEYOND_CLASS * sensor.limits(self.look.channels[sensor.truth][0])[0])
        size = max(share * abs(first - zero), smallest * rng.uniform(1, 1.5))
        return float(np.clip(zero + sign * np.sign(first - zero) * size, lo, hi))

    def lag_s(self, sensor):
        """Lag that nobody has written down: of the sensor, and of what stands before it."""
        before_s = getattr(self.module, "outlet_lag_s", lambda *_: 0.0)(self.rig, sensor.column)
        return float(np.hypot(np.hypot(0.2 * sensor.lag_s, UNKNOWN_LAG_S), before_s))

    def gain(self, effect, value):
        gain = self.look.gain(self.seen(effect, value), (value - effect[3]) / (effect[4] - effect[3]) * self.unread_with.get(effect[:2], 0.0))
        # A clock is always off by up to an interval, a lag by what nobody knows of it, and fronts are no straight lines.
        if effect[0] not in ("S4", "S7"):
            return gain
        usual_s = self.rig["every_s"] if effect[0] == "S7" else self.lag_s(self.sensor(effect[1]))
        return min(gain, 0.5 * (value * ROOT3 / usual_s) ** 2)

    def sensor(self, column):
        return next(s for s in self.look.sensors if s.column == column)

    def seen(self, effect, value):
        """What it shows at this value."""
        if effect[0] == "S8" and effect[1] in self.unsigned:
            return self.look.of_sensor(self.sensor(effect[1]), lambda y: np.maximum(np.maximum(y, 0) + value, 0) - np.maximum(y, 0) + y)
        if effect[0] in ("S4", "S7"):
            sensor = self.sensor(effect[1])
            return self.look.of_sensor(sensor, slow(value) if effect[0] == "S4" else shifted(value))
        return effect[-1] * (value - effect[3]) / (effect[4] - effect[3])

    def together(self, effect, signature, parallel=PARALLEL):
        """The effects that these data do not tell from this one."""
        gain = self.look.gain(signature)
        same = [effect[:2]]
        for other in self.effects:
            c = self.look.cosine(signature, other[-1])
            # The other one, as strong as it has to be, must be possible.
            need = (other[4] - other[3]) * self.look.inner(signature, other[-1]) / max(self.look.inner(other[-1], other[-1]), 1e-12)
            possible = other[5][0] <= other[3] + need <= other[5][1]
            if other[:2] != effect[:2] and possible and (gain * (1 - c * c) < TOGETHER or c > parallel):
                same.append(other[:2])
        return [list(x) for x in same]


def whole(effect, value, truth, sensors, clocks):
    """What a fit of the parameter can find: the effect with the tolerance of its own quantity on top, as the plant or the sensor has it."""
    _, component, parameter, zero, first, _, variant, _ = effect
    if variant is not None:
        key, x = next(iter(variant(value).items()))
        slope = (variant(first)[key] - variant(zero)[key]) / (first - zero)
        return value + (truth[key] - x) / slope if slope else value
    sensor = next(s for s in sensors if s.column == component)
    own = sensor.draws
    beside = {"bias_k": own["bias"], "offset_kg_s": own["bias"], "offset_m3_s": own["bias"], "gain": value * (own["gain"] - 1),
              "lag_s": own["lag_s"], "clock_s": clocks[sensor.clock] - clocks["logger"]}
    return value + beside.get(parameter, 0.0)


def read(sensors, channels, at_s, rng, clocks, by_sensor, plain=False):
    """What is logged of a run."""
    table = {}
    for s in sensors:
        table[s.column] = measure(s, channels[s.truth][0], at_s, rng, clocks[s.clock], by_sensor.get(s.column))
        if s.blank:
            table[s.column][still(channels[s.blank][0], at_s)] = np.nan
    spoil(table, {s.column for s in sensors if s.role == "input"}, at_s, rng, plain=plain)
    return table


def later(split, from_s, by_s):
    """A split (the text of the file) of which all from a moment on is later."""
    moved = lambda m: f"{m[1]} = {float(m[2]) + (by_s if float(m[2]) >= from_s else 0):.0f}"
    return re.sub(r"(from_s|until_s) = ([0-9.]+)", moved, split)


def make(d, folder, rng, effects=(), edge=False, unknown=None, spoiler=None, addition=None):
    """Writes a case with these effects [(entry of d.effects, value)]; what the scorer has to know.

    `addition` is measured beside: a further `sensor`, or a run of another `rig` after it, in which another sensor may read instead of the `exchanged` one.
    """
    module, rig = d.module, d.rig
    addition = addition or {}
    sensors = copy.deepcopy(d.sensors) + ([addition["sensor"]] if "sensor" in addition else [])
    within = (lambda: rng.choice([-1, 1]) * rng.uniform(0.9, 1.0)) if edge else (lambda: rng.uniform(-0.6, 0.6))
    truth = dict(d.neutral)
    for key, half in module.tolerances(rig).items():
        truth[key] += half * within()
    as_known = dict(d.neutral)
    by_sensor = {}
    for (id_, component, parameter, zero, _, _, variant, _), value in effects:
        if variant is None:
            by_sensor.setdefault(component, {})[parameter] = value
            continue
        for key, x in variant(value).items():
            # The tolerance stays on top of the effect.
            relative = d.neutral[key] != 0 and truth[key] != 0
            truth[key] = x * truth[key] / d.neutral[key] if relative else x + truth[key] - d.neutral[key]
            as_known[key] = x
    if unknown is not None:
        truth |= unknown
    for s in sensors:
        draw(s, d.look.channels[s.truth][0], rng, edge)
        if s.role == "input" and s.truth in module.INPUTS:  # the model sees the inputs as they are measured
            as_known = module.INPUTS[s.truth](as_known, s.draws["bias"], s.draws["gain"], as_is=True)
    both = module.simulate(rig, [truth, d.neutral | as_known])
    channels, oracle = ({name: y[k : k + 1] for name, y in both.items()} for k in (0, 1))
    clocks = {"logger": rng.uniform(-1, 1), "own": rig["every_s"] * (within() if edge else 0.5 * within())}
    odd = rng.choice([s.column for s in sensors if s.role == "compare"])
    for s in sensors:
        s.clock = "own" if s.column == odd else "logger"
    runs = [(d.at_s, read(sensors, channels, d.at_s, rng, clocks, by_sensor, plain=spoiler is not None))]
    note = spoiler(runs[0][1], sensors, d.at_s, rng) if spoiler else None
    splits = [module.split(rig)]
    if "rig" in addition:
        at_s = np.arange(0, module.duration_s(addition["rig"]), rig["every_s"])
        then = list(sensors)
        if addition.get("exchanged"):
            k = next(k for k, s in enumerate(sensors) if s.column == addition["exchanged"])
            then[k] = dataclasses.replace(sensors[k], column="new")
            draw(then[k], d.look.channels[then[k].truth][0], rng, edge)
            sensors.append(then[k])
        runs.append((at_s, read(then, module.simulate(addition["rig"], [truth]), at_s, rng, clocks, by_sensor)))
        splits.append(later(splits[0], module.duration_s(rig) / 2, longer_s(addition["rig"])))
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "model.toml").write_text(module.model(rig))
    (folder / "sensors.toml").write_text("\n".join(s.toml() for s in sensors))
    named = splits if len(splits) == 1 else [text.replace("[[block]]", f'[[block]]\nrun = "{k + 1}"') for k, text in enumerate(splits)]
    (folder / "split.toml").write_text("".join(named))
    columns = list(dict.fromkeys(column for _, table in runs for column in table))
    with (folder / "data.csv").open("w") as file:
        print("time_s", *(["run"] if len(runs) > 1 else []), *columns, sep=",", file=file)
        for number, (at_s, table) in enumerate(runs, 1):
            for k, t in enumerate(at_s):
                cells = (table[c][k] if c in table else np.nan for c in columns)
                print(f"{t:.0f}", *([number] if len(runs) > 1 else []), *("" if np.isnan(x) else f"{x:.6g}" for x in cells), sep=",", file=file)
    table = runs[0][1]
    floor = {}
    for s in sensors:
        if s.role == "compare" and spoiler is None and s.column in table:
            x = s.perfect(oracle[s.truth][0], d.at_s, by_sensor.get(s.column))
            show = module.is_show(rig, d.at_s) & np.isfinite(table[s.column])
            floor[s.column] = float(np.sqrt(np.mean((x[show] - table[s.column][show]) ** 2)))
    return {"note": note, "oracle": floor, "whole": [float(whole(e, x, truth, sensors, clocks)) for e, x in effects]}


def case_set(d, out, counts, tag):
    """Writes the cases of one draw; their answers."""
    rng, answers = d.rng, {}
    head = {"rig": d.module.NAME, "rich": d.rig["rich"], "seed": d.seed}
    number = iter(range(1000))

    def add(kind, **what):
        name = f"{tag}-{next(number):02d}"
        answer = make(d, out / name, np.random.default_rng([d.seed, len(answers)]), **what)
        answers[name] = head | {"kind": kind, "edge": what.get("edge", False), "effects": [], "class": []} | answer
        return answers[name]

    def effect(stratum_, other_than=()):
        """A random effect of about this visibility."""
        ids = sorted({e[0] for e in d.effects})
        for _ in range(200):
            id_ = rng.choice(ids)
            chosen = rng.choice([k for k, e in enumerate(d.effects) if e[0] == id_])
            e = d.effects[chosen]
            value = d.of_strength(e, np.exp(rng.uniform(*np.log(STRATA[stratum_]))), rng)
            signature = d.seen(e, value)
            if e[:2] in other_than:
                continue
            if stratum(d.gain(e, value)) == stratum_:
                return e, value, signature
        return None

    for k in range(counts["null"]):
        add("null", edge=bool(k % 2))
    for stratum_, n in counts["single"].items():
        for _ in range(n):
            if (found := effect(stratum_)) is None:
                continue
            e, value, signature = found
            a = add("single", effects=[(e, value)])
            a |= {"effects": [{"id": e[0], "component": e[1], "parameter": e[2], "value": value}], "stratum": stratum_,
                  "gain": d.gain(e, value), "class": d.together(e, signature), "strict": d.together(e, signature, parallel=1.0),
                  "near": d.near(e[1]), "untouched": d.look.untouched(signature)}
    for _ in range(counts["pair"]):
        first, second = effect("easy"), None
        if first:
            second = effect("easy", other_than=[first[0][:2]])
        if not second:
            continue
        a = add("pair", effects=[first[:2], second[:2]])
        a["effects"] = [{"id": e[0], "component": e[1], "parameter": e[2], "value": v} for e, v, _ in (first, second)]
        a["class"] = d.together(first[0], first[2]) + d.together(second[0], second[2])
        a["classes"] = [d.together(first[0], first[2]), d.together(second[0], second[2])]
    for _ in range(counts["unknown"]):
        what, change = d.module.unknown(d.rig, rng)
        add("unknown", unknown=change)["note"] = what
    for _ in range(counts["data"]):
        add("data", spoiler=broken.any_of(rng))
    return answers


COUNTS = {"null": 4, "single": {"hard": 1, "medium": 2, "easy": 3}, "pair": 1, "unknown": 1, "data": 1}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out", type=Path)
    parser.add_argument("--rig", choices=RIGS, default="R1")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--draws", type=int, default=2)
    parser.add_argument("--nulls", type=int, default=COUNTS["null"])
    parser.add_argument("--only-nulls", action="store_true")
    parser.add_argument("--counts", type=json.loads, default={}, help='other numbers of cases of a draw, as {"pair": 0, "single": {"easy": 2}}')
    parser.add_argument("--effect", nargs=3, metavar=("ID", "COMPONENT", "GAIN"), help="a single case with this effect, so that it gains about so many nats; =VALUE: as strong as that")
    parser.add_argument("--kind", type=json.loads, default={}, help="what the rig is beside what is drawn, as JSON")
    parser.add_argument("--sensors", choices=["both", "rich", "poor"], default="both", help="both: in turns")
    wanted = parser.parse_args()
    counts = dict(COUNTS, null=wanted.nulls) | wanted.counts
    if wanted.only_nulls:
        counts = {"null": wanted.nulls, "single": {}, "pair": 0, "unknown": 0, "data": 0}
    module = importlib.import_module(RIGS[wanted.rig])
    file = wanted.out / "answers.json"
    if wanted.effect:
        d = Draw(module, wanted.seed, wanted.sensors == "rich", **wanted.kind)
        effect = next(e for e in d.effects if e[:2] == tuple(wanted.effect[:2]))
        rng = np.random.default_rng([wanted.seed, 7])
        strength = wanted.effect[2]
        value = float(strength[1:]) if strength.startswith("=") else d.of_strength(effect, float(strength), rng)
        make(d, wanted.out / f"{wanted.rig}-{wanted.seed}-{effect[0]}", rng, effects=[(effect, value)])
        print(effect[:3], f"{value:.4g}, {d.gain(effect, value):.0f} nats, class {d.together(effect, d.seen(effect, value))}")
        return
    for k in range(wanted.draws):
        tag = f"{wanted.rig}-{wanted.seed + k}"
        answers = json.loads(file.read_text()) if file.exists() else {}
        if any(name.startswith(f"{tag}-") for name in answers):
            continue
        d = Draw(module, wanted.seed + k, rich=wanted.sensors == "rich" or (wanted.sensors == "both" and k % 2 == 0))
        new = case_set(d, wanted.out, counts, tag)
        answers = json.loads(file.read_text()) if file.exists() else {}
        file.write_text(json.dumps(answers | new, indent=1))
        print(tag, len(new), "cases", flush=True)


if __name__ == "__main__":
    main()

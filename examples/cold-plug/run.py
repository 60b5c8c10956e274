"""The cold plug and its remedy: what arrives at SF4 with a cold pipe, with a flushed one, and with losses."""

from pathlib import Path

import anergy

here = Path(__file__).parent
text = (here / "model.toml").read_text()
flushed = text.replace("initial_degc = 15", "initial_degc = 60")
variants = {
    "cold pipe": text,
    "flushed": flushed.replace('"swinging_degc"', '"smooth_degc"'),
    "flushed, SF1 hot at once": flushed.replace('"swinging_degc"', '"hot_degc"'),
    "cooled by standstill": (here / "real.toml").read_text(),
}
for name, variant in variants.items():
    result = anergy.Model.from_toml(variant, here).simulate()
    t_degc = result["sf4.hot.t_k"] - 273.15
    step_s = result.time_s[1] - result.time_s[0]
    print(f"{name}: at least {t_degc.min():.1f} degC, {(t_degc < 50).sum() * step_s:.0f} s below 50 degC")

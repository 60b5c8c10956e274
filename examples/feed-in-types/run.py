"""Three ways to feed in, with and without pressure in the supply: pump heads, hydraulic power, return temperature."""

from pathlib import Path

import anergy

FOLDER = Path(__file__).parent
TEXT = (FOLDER / "model.toml").read_text()
DENSITY_KG_M3 = 988

print("plant            producer          flow l/min  head hPa  power W  back degC  consumer hPa")
for plant, consumer in [
    ("pressurised", "extraction_by_valve"),
    ("non_pressurised", "extraction_by_pump"),
]:
    for producer in ["return_to_supply", "return_to_return", "supply_to_supply"]:
        text = TEXT.replace('type = "pressurised" #', f'type = "{plant}" #')
        text = text.replace('type = "return_to_supply" #', f'type = "{producer}" #')
        text = text.replace('type = "extraction_by_valve" #', f'type = "{consumer}" #')
        steady = anergy.Model.from_toml(text, FOLDER).solve()
        pump = steady["far.feed_in_pump"]
        flow_m3_s, head_pa = pump["m_flow_kg_s"] / DENSITY_KG_M3, -pump["dp_pa"]
        back_degc = steady["plant.cold"]["t_k"] - 273.15
        consumer_pa = 0.0
        if consumer == "extraction_by_pump":
            consumer_pa = -steady["consumer.extraction_pump"]["dp_pa"]
        print(
            f"{plant:16} {producer:16} {60_000 * flow_m3_s:11.2f} {head_pa / 100:9.1f}"
            f" {flow_m3_s * head_pa:8.2f} {back_degc:10.1f} {consumer_pa / 100:13.1f}"
        )

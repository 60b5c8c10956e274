"""One street as a grid of four generations: heat given by the plant and lost on the way."""

import pathlib

import anergy

FOLDER = pathlib.Path(__file__).parent

print("grid    plant kW  lost kW  lost %  back degC")
for name in ["3gdh", "4gdh", "ultdh", "5gdhc"]:
    model = anergy.Model.from_file(FOLDER / f"{name}.toml")
    result = model.simulate(until_s=86_400, step_s=60, record_s=900)
    cold = "plant.cold.t_k"
    plant_kw = result["plant.station.q_flow_w"][-1] / 1000
    lost_kw = result["network.loss_w"][-1] / 1000
    print(
        f"{name:6} {plant_kw:9.2f} {lost_kw:8.3f} {100 * lost_kw / plant_kw:7.2f}"
        f" {result[cold][-1] - 273.15:10.2f}"
    )

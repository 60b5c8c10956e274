"""Positions of the sun and irradiance on tilted planes, as pvlib computes them: the numbers beside this file.

    pip install pvlib==0.16.1 && python reference.py

Positions: `pvlib.solarposition.spa_python`, the Solar Position Algorithm of NREL (Reda and Andreas 2004, error
0.0003 deg), geometric: without refraction.
Tilted planes: `pvlib.irradiance.isotropic` and `perez` ("allsitescomposite1990"); Erbs: `pvlib.irradiance.erbs`.
"""

import numpy as np
import pandas as pd
import pvlib

PLACES = [
    ("Tromso", 69.65, 18.96), ("Edinburgh", 55.95, -3.19), ("Munich", 48.14, 11.58), ("Golden", 39.74, -105.18),
    ("Singapore", 1.35, 103.82), ("Equator", 0.0, 0.0), ("Cape Town", -33.92, 18.42), ("Ushuaia", -54.80, -68.30),
]
DAYS = ["2020-02-29", "2021-01-05", "2021-03-20", "2021-05-01", "2021-06-21", "2021-08-15", "2021-09-22",
        "2021-11-03", "2021-12-21", "2026-04-10", "2035-10-01"]


def positions():
    rows = []
    for place, latitude, longitude in PLACES:
        for day in DAYS:
            # Through the day, and at solar noon.
            times = pd.date_range(day, periods=8, freq="3h", tz="UTC")
            transit = pvlib.solarposition.sun_rise_set_transit_spa(times[:1], latitude, longitude)["transit"].iloc[0]
            times = times.append(pd.DatetimeIndex([transit.round("1s")]))
            sun = pvlib.solarposition.spa_python(times, latitude, longitude, delta_t=None)
            for i, (time, row) in enumerate(sun.iterrows()):
                rows.append((place, latitude, longitude, int(time.timestamp()), "noon" if i == 8 else "",
                             round(row["elevation"], 5), round(row["azimuth"], 5)))
    columns = ["place", "latitude_deg", "longitude_deg", "unix_s", "noon", "elevation_deg", "azimuth_from_north_deg"]
    pd.DataFrame(rows, columns=columns).to_csv("positions.csv", index=False)


def planes():
    rows = []
    extra = 1361.0
    for zenith in (5.0, 40.0, 65.0, 80.0, 86.0):
        for sun_azimuth in (180.0, 110.0, 260.0):
            for beam, diffuse in ((850.0, 90.0), (500.0, 200.0), (60.0, 150.0), (0.0, 80.0), (0.0, 0.0)):
                glob = diffuse + beam * np.cos(np.radians(zenith))
                for tilt, azimuth in ((0.0, 180.0), (35.0, 180.0), (60.0, 240.0), (90.0, 90.0), (90.0, 0.0)):
                    airmass = pvlib.atmosphere.get_relative_airmass(zenith, "kastenyoung1989")
                    incidence = np.cos(np.radians(pvlib.irradiance.aoi(tilt, azimuth, zenith, sun_azimuth)))
                    perez = pvlib.irradiance.perez(tilt, azimuth, diffuse, beam, extra, zenith, sun_azimuth, airmass,
                                                   model="allsitescomposite1990")
                    rows.append((zenith, sun_azimuth, beam, diffuse, round(glob, 9), tilt, azimuth, round(incidence, 9),
                                 round(float(pvlib.irradiance.isotropic(tilt, diffuse)), 6), round(float(np.nan_to_num(perez)), 6),
                                 round(float(pvlib.irradiance.get_ground_diffuse(tilt, glob, 0.2)), 6)))
    columns = ["zenith_deg", "sun_azimuth_from_north_deg", "beam_normal_w_m2", "diffuse_horizontal_w_m2",
               "global_horizontal_w_m2", "tilt_deg", "azimuth_from_north_deg", "incidence_cosine", "isotropic_w_m2",
               "perez_w_m2", "ground_w_m2"]
    pd.DataFrame(rows, columns=columns).to_csv("planes.csv", index=False)


def erbs():
    rows = []
    for kt in (0.05, 0.2, 0.219, 0.3, 0.5, 0.7, 0.8, 0.81, 0.95):
        zenith, day = 45.0, 100
        extra = pvlib.irradiance.get_extra_radiation(day, method="spencer")
        glob = kt * extra * np.cos(np.radians(zenith))
        split = pvlib.irradiance.erbs(glob, zenith, day)
        rows.append((kt, round(float(split["dhi"] / glob), 6)))
    pd.DataFrame(rows, columns=["clearness", "diffuse_share"]).to_csv("erbs.csv", index=False)


positions()
planes()
erbs()

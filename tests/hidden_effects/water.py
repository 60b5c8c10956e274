"""Water at 0 to 100 degC, after Popiel and Wojtkowiak (1998), and the friction of pipes after Colebrook and White.

Not the formulas of anergy (Kell, IAPWS), so that a mistake in one of them would show.
"""

import numpy as np


def density(t):
    return 999.79684 + 0.068317355 * t - 0.010740248 * t**2 + 0.00082140905 * t**2.5 - 2.3030988e-5 * t**3


def heat_capacity(t):
    return 1e3 * (4.2174356 - 0.0056181625 * t + 0.0012992528 * t**1.5 - 0.00011535353 * t**2 + 4.14964e-6 * t**2.5)


def viscosity(t):
    return 1 / (557.82468 + 19.408782 * t + 0.1360459 * t**2 - 3.1160832e-4 * t**3)


def conductivity(t):
    return 0.5650285 + 0.0026363895 * t - 0.00012516934 * t**1.5 - 1.5154918e-6 * t**2 - 0.0009412945 * t**0.5


_T = np.linspace(1, 99, 99)
# Powers of t are slow; within 0.01 % of the above.
_VOLUMETRIC = np.polyfit(_T, density(_T) * heat_capacity(_T), 4)
_ENTHALPY = np.polyint(np.polyfit(_T, heat_capacity(_T), 4))


def volumetric_heat_capacity(t):
    """J/(m3 K)."""
    return np.polyval(_VOLUMETRIC, t)


def enthalpy(t):
    """J/kg above 0 degC."""
    return np.polyval(_ENTHALPY, t)


def friction_factor(reynolds, relative_roughness):
    """Darcy; laminar to 2300, Colebrook and White from 3500 on, a smooth step between."""
    laminar = 64 / np.maximum(reynolds, 1.0)
    turbulent_reynolds = np.maximum(reynolds, 2300.0)
    root = np.full(np.broadcast(reynolds, relative_roughness).shape, 0.15)
    for _ in range(8):
        root = 1 / (-2 * np.log10(relative_roughness / 3.71 + 2.51 / (turbulent_reynolds * root)))
    x = np.clip((reynolds - 2300) / 1200, 0, 1)
    share = x * x * (3 - 2 * x)
    return (1 - share) * laminar + share * root**2


def nusselt(reynolds, prandtl):
    """Laminar 3.66; Dittus and Boelter from 3500 on, a smooth step between."""
    x = np.clip((reynolds - 2300) / 1200, 0, 1)
    share = x * x * (3 - 2 * x)
    return (1 - share) * 3.66 + share * 0.023 * np.maximum(reynolds, 2300.0) ** 0.8 * prandtl**0.4

//! Units other than SI, converted here and nowhere else.
//!
//! Inside the program a name ends in its SI unit (`_pa`, `_kg_s`, `_k`, ...). Files and terminals may
//! use the units of the trade (`_bar`, `_l_min`, `_degc`, ...): the same name with another suffix.

use crate::medium::ZERO_CELSIUS_K;

/// A unit of files and displays and how it becomes SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Suffix in names, for example `l_min`.
    pub suffix: &'static str,
    /// SI suffix it becomes, for example `m3_s`.
    pub si: &'static str,
    /// SI value = (value + offset) * factor / divisor.
    factor: f64,
    divisor: f64,
    offset: f64,
}

const fn unit(suffix: &'static str, si: &'static str, factor: f64, divisor: f64) -> Unit {
    Unit { suffix, si, factor, divisor, offset: 0.0 }
}

/// All units a file may use besides SI.
pub const UNITS: &[Unit] = &[
    unit("mm", "m", 1.0, 1000.0),
    unit("cm", "m", 1.0, 100.0),
    unit("km", "m", 1000.0, 1.0),
    unit("cm2", "m2", 1.0, 10_000.0),
    unit("l", "m3", 1.0, 1000.0),
    unit("l_s", "m3_s", 1.0, 1000.0),
    unit("l_min", "m3_s", 1.0, 60_000.0),
    unit("l_h", "m3_s", 1.0, 3_600_000.0),
    unit("m3_h", "m3_s", 1.0, 3600.0),
    unit("kg_min", "kg_s", 1.0, 60.0),
    unit("kg_h", "kg_s", 1.0, 3600.0),
    unit("hpa", "pa", 100.0, 1.0),
    unit("mbar", "pa", 100.0, 1.0),
    unit("kpa", "pa", 1000.0, 1.0),
    unit("bar", "pa", 100_000.0, 1.0),
    unit("mpa", "pa", 1_000_000.0, 1.0),
    unit("kw", "w", 1000.0, 1.0),
    unit("mw", "w", 1_000_000.0, 1.0),
    unit("kwh", "j", 3_600_000.0, 1.0),
    unit("mwh", "j", 3_600_000_000.0, 1.0),
    unit("eur_kwh", "eur_j", 1.0, 3_600_000.0),
    unit("ct_kwh", "eur_j", 1.0, 360_000_000.0),
    unit("eur_mwh", "eur_j", 1.0, 3_600_000_000.0),
    unit("kj_kg_k", "j_kg_k", 1000.0, 1.0),
    unit("kw_k", "w_k", 1000.0, 1.0),
    unit("kj_k", "j_k", 1000.0, 1.0),
    unit("min", "s", 60.0, 1.0),
    unit("h", "s", 3600.0, 1.0),
    unit("d", "s", 86_400.0, 1.0),
    unit("1_h", "1_s", 1.0, 3600.0),
    unit("deg", "rad", std::f64::consts::PI, 180.0),
    unit("percent", "", 1.0, 100.0),
    Unit { suffix: "degc", si: "k", factor: 1.0, divisor: 1.0, offset: ZERO_CELSIUS_K },
];

/// SI suffixes that occur in names, longest first where one ends in another.
pub const SI_SUFFIXES: &[&str] = &[
    "w_m_k", "k_m_w", "j_kg_k", "j_m_k", "j_k", "kg_m3", "m2_k_w", "w_m2_k", "m3_s", "m2_s", "m_s",
    "kg_s", "pa_s", "eur_j", "1_s", "w_k", "w_m2", "rad", "m2", "m3", "kg", "pa", "j", "w", "s",
    "m", "k",
];

impl Unit {
    /// The unit with a suffix.
    pub fn find(suffix: &str) -> Option<Self> {
        UNITS.iter().copied().find(|unit| unit.suffix == suffix)
    }

    /// A value in this unit, in SI.
    #[inline]
    pub fn to_si(&self, value: f64) -> f64 {
        (value + self.offset) * self.factor / self.divisor
    }

    /// A value in SI, in this unit.
    #[inline]
    pub fn of_si(&self, value: f64) -> f64 {
        value * self.divisor / self.factor - self.offset
    }
}

/// A share of the nominal mass flow, whose name in the field (`deltaM`) ends as if it were in metres.
const SHARE_OF_FLOW: &str = "delta_m";

/// The unit part of a name: `("length", "mm")` of `length_mm`; `None` without a known suffix.
pub fn split_suffix(name: &str) -> Option<(&str, &str)> {
    if name == SHARE_OF_FLOW {
        return None;
    }
    let known = |suffix: &str| {
        SI_SUFFIXES.contains(&suffix) || UNITS.iter().any(|unit| unit.suffix == suffix)
    };
    // The longest known suffix wins: `_l_min` before `_min`.
    name.match_indices('_')
        .map(|(at, _)| (&name[..at], &name[at + 1..]))
        .find(|(stem, suffix)| !stem.is_empty() && known(suffix))
}

/// Whether the kelvin of a quantity are those of a difference, which must not be read as degC.
pub fn is_difference(stem: &str) -> bool {
    ["difference", "amplitude", "hysteresis"].iter().any(|end| stem.ends_with(end))
}

/// Units a value of SI suffix `si` can also be written in. A temperature difference has none.
pub fn alternatives(name: &str) -> impl Iterator<Item = (String, Unit)> + '_ {
    let split = split_suffix(name).filter(|(stem, _)| !is_difference(stem));
    UNITS.iter().filter_map(move |unit| {
        let (stem, si) = split?;
        (unit.si == si).then(|| (format!("{stem}_{}", unit.suffix), *unit))
    })
}

/// Mass flow in l/min at a density, for display.
#[inline]
pub fn l_min(m_flow_kg_s: f64, density_kg_m3: f64) -> f64 {
    m_flow_kg_s / density_kg_m3 * 60_000.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversions_are_exact_where_decimal_numbers_are() {
        let si = |suffix: &str, value: f64| Unit::find(suffix).unwrap().to_si(value);
        assert_eq!(si("mm", 22.0), 0.022);
        assert_eq!(si("l_min", 3.5), 3.5 / 60_000.0);
        assert_eq!(si("bar", 1.5), 150_000.0);
        assert_eq!(si("degc", 65.0), 338.15);
        assert_eq!(si("percent", 85.0), 0.85);
        for unit in UNITS {
            assert!((unit.of_si(unit.to_si(12.5)) - 12.5).abs() < 1e-12, "{}", unit.suffix);
        }
    }

    #[test]
    fn suffixes() {
        assert_eq!(split_suffix("v_flow_l_min"), Some(("v_flow", "l_min")));
        assert_eq!(split_suffix("roughness_mm"), Some(("roughness", "mm")));
        assert_eq!(
            split_suffix("insulation_resistance_k_m_w"),
            Some(("insulation_resistance", "k_m_w"))
        );
        assert_eq!(split_suffix("opening"), None);
        assert!(alternatives("supply_k").any(|(name, _)| name == "supply_degc"));
        assert_eq!(alternatives("temperature_difference_k").count(), 0);
        assert_eq!(alternatives("amplitude_k").count(), 0);
        assert_eq!(alternatives("delta_m").count(), 0);
        assert_eq!(
            split_suffix("surface_resistance_m2_k_w"),
            Some(("surface_resistance", "m2_k_w"))
        );
    }
}

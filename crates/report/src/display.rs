//! How quantities look in the report: units of the trade, numbers and times as text.

use anergy_core::clock::Time;
use anergy_core::medium::Medium;
use anergy_core::units::{self, Unit};
use serde::Serialize;

/// A display unit: shown = SI * `factor` + `offset`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Display {
    /// Text behind numbers.
    pub unit: &'static str,
    /// Slope of the conversion.
    pub factor: f64,
    /// Shift of the conversion, in the shown unit.
    pub offset: f64,
}

impl Display {
    fn of(suffix: &str, unit: &'static str) -> Self {
        let convert = |si: f64| Unit::find(suffix).map_or(si, |unit| unit.of_si(si));
        let offset = convert(0.0);
        Self { unit, factor: if offset == 0.0 { convert(1.0) } else { 1.0 }, offset }
    }

    /// Mass flow as volume flow at a density, l/min.
    pub fn flow(density_kg_m3: f64) -> Self {
        Self { unit: "l/min", factor: units::l_min(1.0, density_kg_m3), offset: 0.0 }
    }

    /// Pressure, bar.
    pub fn pressure() -> Self {
        Self::of("bar", "bar")
    }

    /// Temperature, degC.
    pub fn temperature() -> Self {
        Self::of("degc", "°C")
    }

    /// Heat flow, kW.
    pub fn heat() -> Self {
        Self::of("kw", "kW")
    }

    /// Velocity, m/s.
    pub fn velocity() -> Self {
        Self { unit: "m/s", factor: 1.0, offset: 0.0 }
    }

    /// Speeds and openings, 1.
    pub fn ratio() -> Self {
        Self { unit: "–", factor: 1.0, offset: 0.0 }
    }
}

/// Density that turns mass into volume flow: the setting `density_kg_m3`, else that of the default medium.
pub fn density_kg_m3(settings: &[(String, String)]) -> f64 {
    settings
        .iter()
        .find(|(name, _)| name == "density_kg_m3")
        .and_then(|(_, value)| value.trim().parse::<f64>().ok())
        .filter(|density| density.is_finite() && *density > 0.0)
        .unwrap_or(Medium::default().density_kg_m3)
}

/// Four significant digits, a power of ten only where it is shorter; a dash for what is no number.
pub fn number(value: f64) -> String {
    let magnitude = value.abs();
    if !value.is_finite() {
        "–".to_owned()
    } else if magnitude == 0.0 {
        "0".to_owned()
    } else if !(1e-3..1e6).contains(&magnitude) {
        let text = format!("{value:.2e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{} × 10{}", minus(mantissa), superscript(exponent))
    } else if value.fract() == 0.0 {
        minus(&format!("{value}"))
    } else {
        let decimals = (3 - magnitude.log10().floor() as i32).clamp(0, 6) as usize;
        let text = format!("{value:.decimals$}");
        minus(if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text })
    }
}

/// A JSON value as text: numbers in short form, everything else as it is.
pub fn json_value(value: Option<&serde_json::Value>) -> String {
    match value {
        None | Some(serde_json::Value::Null) => "–".to_owned(),
        Some(serde_json::Value::String(text)) => text.clone(),
        Some(other) => other.as_f64().map_or_else(|| other.to_string(), number),
    }
}

/// A duration or point in time: `37 min 25 s`.
pub fn time(time: Time) -> String {
    let text = time.to_string();
    let parts = text.split(' ').map(|part| {
        let digits = part.trim_end_matches(char::is_alphabetic);
        match &part[digits.len()..] {
            "m" => format!("{digits} min"),
            unit => format!("{digits} {unit}").trim_end().to_owned(),
        }
    });
    parts.collect::<Vec<_>>().join(" ")
}

/// The same from seconds.
pub fn seconds(value: f64) -> String {
    Time::from_s(value).map_or_else(|| "–".to_owned(), time)
}

/// Calendar time, UTC, of ns since 1970: `2026-01-31 07:15:00 UTC`.
pub fn calendar(unix_ns: i64) -> String {
    let total_s = unix_ns.div_euclid(anergy_core::clock::NS_PER_S);
    let (days, s) = (total_s.div_euclid(86_400), total_s.rem_euclid(86_400));
    // Days since 1970 to a date of the Gregorian calendar, in eras of 400 years starting on 1 March.
    let shifted = days + 719_468;
    let (era, day_of_era) = (shifted.div_euclid(146_097), shifted.rem_euclid(146_097));
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = era * 400 + year_of_era + i64::from(month <= 2);
    let (hour, minute, second) = (s / 3600, s / 60 % 60, s % 60);
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC")
}

fn minus(text: &str) -> String {
    text.replace('-', "−")
}

fn superscript(exponent: &str) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let glyph = |c: char| c.to_digit(10).map_or('⁻', |digit| digits[digit as usize]);
    exponent.chars().map(glyph).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers() {
        let cases = [
            (0.0, "0"),
            (7.914_23, "7.914"),
            (0.031_200_4, "0.0312"),
            (9.999_99, "10"),
            (12.0, "12"),
            (-0.123_46, "−0.1235"),
            (12_345.6, "12346"),
            (3.14e-12, "3.14 × 10⁻¹²"),
            (f64::NAN, "–"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn times() {
        assert_eq!(seconds(2245.0), "37 min 25 s");
        assert_eq!(seconds(90_000.5), "1 d 1 h 0.5 s");
        assert_eq!(seconds(f64::NAN), "–");
        assert_eq!(calendar(951_782_400_000_000_000), "2000-02-29 00:00:00 UTC");
        assert_eq!(calendar(-1), "1969-12-31 23:59:59 UTC");
    }

    #[test]
    fn units() {
        let shown = |display: Display, si: f64| si * display.factor + display.offset;
        assert!((shown(Display::temperature(), 338.15) - 65.0).abs() < 1e-9);
        assert!((shown(Display::pressure(), 2.5e5) - 2.5).abs() < 1e-12);
        assert!((shown(Display::flow(1000.0), 1.0) - 60.0).abs() < 1e-12);
        let settings = vec![("density_kg_m3".to_owned(), "500".to_owned())];
        assert_eq!(density_kg_m3(&settings), 500.0);
        assert_eq!(density_kg_m3(&[]), 1000.0);
    }
}

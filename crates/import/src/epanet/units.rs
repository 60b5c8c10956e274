//! Options and times of an EPANET file, and its units in SI.
//!
//! The factors are exact. EPANET's own are rounded: 28.317 L in a cubic foot (5e-6 off), 1.9837 cfs of
//! an acre foot a day (1e-4 off), 0.4333 psi per foot of water (5e-5 off).

use super::inp::{Row, Section, begins};
use crate::model_text::ModelText;
use crate::{ImportError, NoteKind};
use std::f64::consts::PI;

/// Length of a foot, m.
pub(super) const FT: f64 = 0.3048;
/// EPANET's gravity, 32.2 ft/s2.
pub(super) const GRAVITY_M_S2: f64 = 32.2 * FT;
/// Gravity in the power laws of a pipe.
pub(super) const POWER_LAW_GRAVITY_M_S2: f64 = 9.81;
/// EPANET's kinematic viscosity, 1.1e-5 ft2/s.
const VISCOSITY_M2_S: f64 = 1.1e-5 * FT * FT;
/// A cubic foot, m3.
const FT3: f64 = FT * FT * FT;
const US_GALLON_M3: f64 = 3.785_411_784e-3;
const UK_GALLON_M3: f64 = 4.546_09e-3;
const ACRE_FOOT_M3: f64 = 43_560.0 * FT3;
const DAY_S: f64 = 86_400.0;
/// psi per foot of water in EPANET.
const PSI_PER_FT: f64 = 0.4333;
const KPA_PER_PSI: f64 = 6.895;
/// Loss of a fitting in EPANET in ft over `K q^2/d^4` in ft and s.
const EPANET_FITTING: f64 = 0.02517;
/// kW and hp in EPANET.
const KW_PER_HP: f64 = 0.7457;

/// Names of the flow units, their size in m3/s, whether they bring SI lengths.
const FLOW_UNITS: &[(&str, f64, bool)] = &[
    ("CFS", FT3, false),
    ("GPM", US_GALLON_M3 / 60.0, false),
    ("MGD", 1e6 * US_GALLON_M3 / DAY_S, false),
    ("IMGD", 1e6 * UK_GALLON_M3 / DAY_S, false),
    ("AFD", ACRE_FOOT_M3 / DAY_S, false),
    ("LPS", 1e-3, true),
    ("LPM", 1e-3 / 60.0, true),
    ("MLD", 1e3 / DAY_S, true),
    ("CMH", 1.0 / 3600.0, true),
    ("CMD", 1.0 / DAY_S, true),
    ("CMS", 1.0, true),
];

/// Settings of the solution, of water quality and of the map.
const WITHOUT_MEANING: &[&str] = &[
    "QUAL",
    "TRIAL",
    "ACCU",
    "TOLER",
    "DIFF",
    "CHECKFREQ",
    "MAXCHECK",
    "DAMPLIMIT",
    "UNBAL",
    "MAP",
    "HEADERROR",
    "FLOWCHANGE",
    "SEGM",
    "VERIFY",
    "HYDR",
    "STATUS",
];

/// Head loss formula.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum HeadLoss {
    HazenWilliams,
    DarcyWeisbach,
    ChezyManning,
}

/// What holds for the whole file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Options {
    pub flow_m3_s: f64,
    pub si: bool,
    pub head_loss: HeadLoss,
    /// As written; see [`Options::viscosity_m2_s`].
    viscosity: f64,
    pub specific_gravity: f64,
    pub demand_multiplier: f64,
    pub default_pattern: String,
    pub emitter_exponent: f64,
    pressure_kpa: bool,
    pub duration_s: f64,
    pub hydraulic_step_s: f64,
    pub pattern_step_s: f64,
    pub pattern_start_s: f64,
    pub report_step_s: f64,
    pub start_clock_s: f64,
}

impl Options {
    pub fn read(rows: &[Row<'_>], text: &mut ModelText, errors: &mut Vec<ImportError>) -> Self {
        let mut options = Self {
            flow_m3_s: US_GALLON_M3 / 60.0,
            si: false,
            head_loss: HeadLoss::HazenWilliams,
            viscosity: 1.0,
            specific_gravity: 1.0,
            demand_multiplier: 1.0,
            default_pattern: "1".into(),
            emitter_exponent: 0.5,
            pressure_kpa: false,
            duration_s: 0.0,
            hydraulic_step_s: 3600.0,
            pattern_step_s: 3600.0,
            pattern_start_s: 0.0,
            report_step_s: 3600.0,
            start_clock_s: 0.0,
        };
        let mut settings = Vec::new();
        for row in rows {
            let result = match row.section {
                Section::Options => options.option(row, text, &mut settings),
                Section::Times => options.time(row, text),
                // Demands can be multiplied in their section, too.
                Section::Demands if begins(row.words[0], "MULTIPLY") => row
                    .positive(1, "demand multiplier")
                    .map(|value| options.demand_multiplier = value),
                _ => Ok(()),
            };
            errors.extend(result.err());
        }
        if !settings.is_empty() {
            let list = settings.join(", ");
            text.note(NoteKind::NotTranslated, None, format!("[OPTIONS] of EPANET's own: {list}"));
        }
        options
    }

    fn option(
        &mut self,
        row: &Row<'_>,
        text: &mut ModelText,
        settings: &mut Vec<String>,
    ) -> Result<(), ImportError> {
        let key = row.words[0];
        let last = row.words.len() - 1;
        if begins(key, "UNIT") {
            self.units(row, last)?;
        } else if begins(key, "HEADL") {
            let word = row.word(1, "head loss formula")?;
            let known = [
                ("H-W", HeadLoss::HazenWilliams),
                ("D-W", HeadLoss::DarcyWeisbach),
                ("C-M", HeadLoss::ChezyManning),
            ];
            let found = known.iter().find(|(name, _)| begins(word, name));
            let Some((_, law)) = found else {
                return Err(row.error(format!("unknown head loss formula \"{word}\"")));
            };
            self.head_loss = *law;
        } else if begins(key, "VISC") {
            self.viscosity = row.positive(last, "viscosity")?;
        } else if begins(key, "SPEC") {
            self.specific_gravity = row.positive(last, "specific gravity")?;
        } else if begins(key, "PATT") {
            self.default_pattern = row.words.get(1).copied().unwrap_or_default().into();
        } else if begins(key, "PRES") {
            let word = row.word(1, "unit of pressure")?;
            // EPANET takes psi with US units and m with SI units whatever is written, but kPa.
            self.pressure_kpa = begins(word, "KPA");
        } else if begins(key, "DEMA") && begins(row.words.get(1).unwrap_or(&""), "MULT") {
            self.demand_multiplier = row.positive(last, "demand multiplier")?;
        } else if begins(key, "DEMA") {
            if !begins(row.words[last], "DDA") {
                let what = "demands that depend on the pressure: they are taken as given";
                text.note(NoteKind::Problem, row.line, format!("{}: {what}", row.text));
            }
        } else if begins(key, "EMIT") && begins(row.words.get(1).unwrap_or(&""), "BACK") {
            if begins(row.words[last], "NO") {
                let what = "water can flow back through emitters";
                text.note(NoteKind::NotTranslated, row.line, format!("{}: {what}", row.text));
            }
        } else if begins(key, "EMIT") {
            // The manual has 0.5 as a flow over a pressure.
            self.emitter_exponent = row.positive(last, "emitter exponent")?;
        } else if begins(key, "MINI") || begins(key, "REQU") {
            let what = "belongs to demands that depend on the pressure";
            text.note(NoteKind::NotTranslated, row.line, format!("{}: {what}", row.text));
        } else if WITHOUT_MEANING.iter().any(|known| begins(key, known)) {
            settings.push(row.words.join(" "));
        } else {
            text.note(NoteKind::NotTranslated, row.line, format!("option {}", row.text));
        }
        Ok(())
    }

    fn units(&mut self, row: &Row<'_>, last: usize) -> Result<(), ImportError> {
        let word = row.words[last];
        let known = FLOW_UNITS.iter().find(|(name, ..)| word.eq_ignore_ascii_case(name));
        match known {
            Some((_, flow_m3_s, si)) => (self.flow_m3_s, self.si) = (*flow_m3_s, *si),
            // The older word for litres per second.
            None if word.eq_ignore_ascii_case("SI") => (self.flow_m3_s, self.si) = (1e-3, true),
            None => return Err(row.error(format!("unknown flow unit \"{word}\""))),
        }
        Ok(())
    }

    fn time(&mut self, row: &Row<'_>, text: &mut ModelText) -> Result<(), ImportError> {
        let (first, second) = (row.words[0], row.words.get(1).copied().unwrap_or_default());
        if begins(first, "STAT") {
            text.note(NoteKind::NotTranslated, row.line, format!("{}: what is reported", row.text));
            return Ok(());
        }
        let at = row.words.iter().position(|word| word.starts_with(|c: char| c.is_ascii_digit()));
        let Some(at) = at else {
            return Err(row.error(format!("\"{}\" has no time", row.text)));
        };
        let value = time_s(&row.words[at..])
            .ok_or_else(|| row.error(format!("\"{}\" is not a time", row.words[at..].join(" "))))?;
        let positive = |value: f64| if value > 0.0 { value } else { 3600.0 };
        match () {
            () if begins(first, "DURA") => self.duration_s = value,
            () if begins(first, "HYDR") => self.hydraulic_step_s = positive(value),
            () if begins(first, "PATT") && begins(second, "STAR") => self.pattern_start_s = value,
            () if begins(first, "PATT") => self.pattern_step_s = positive(value),
            () if begins(first, "REPO") && begins(second, "STAR") => {}
            () if begins(first, "REPO") => self.report_step_s = positive(value),
            () if begins(first, "STAR") => self.start_clock_s = value % DAY_S,
            () if begins(first, "QUAL") || begins(first, "RULE") => {}
            () => return Err(row.error(format!("unknown time \"{}\"", row.text))),
        }
        Ok(())
    }

    pub fn length_m(&self) -> f64 {
        if self.si { 1.0 } else { FT }
    }

    pub fn diameter_m(&self) -> f64 {
        if self.si { 1e-3 } else { FT / 12.0 }
    }

    /// Unit of roughness for Darcy-Weisbach.
    pub fn roughness_m(&self) -> f64 {
        if self.si { 1e-3 } else { 1e-3 * FT }
    }

    /// A pressure as metres of this water.
    pub fn pressure_m(&self) -> f64 {
        let psi = FT / (PSI_PER_FT * self.specific_gravity);
        match (self.si, self.pressure_kpa) {
            (_, true) => psi / KPA_PER_PSI,
            (true, false) => 1.0 / self.specific_gravity,
            (false, false) => psi,
        }
    }

    /// Head times flow of a pump with this power, m4/s: `8.814 ft4/s` for a horsepower.
    pub fn head_times_flow_m4_s(&self, power: f64) -> f64 {
        let hp = if self.si { power / KW_PER_HP } else { power };
        8.814 * hp * FT * FT3
    }

    pub fn density_kg_m3(&self) -> f64 {
        1000.0 * self.specific_gravity
    }

    pub fn gravity_m_s2(&self) -> f64 {
        match self.head_loss {
            HeadLoss::DarcyWeisbach => GRAVITY_M_S2,
            _ => POWER_LAW_GRAVITY_M_S2,
        }
    }

    /// Pressure of a metre of this water.
    pub fn pa_m(&self) -> f64 {
        self.density_kg_m3() * self.gravity_m_s2()
    }

    /// The coefficient with which `K v^2/(2 g)` is EPANET's loss of a fitting.
    pub fn loss_coefficient(&self, k: f64) -> f64 {
        k * EPANET_FITTING * PI * PI * self.gravity_m_s2() / (8.0 * FT)
    }

    /// A number above 1e-3 is a multiple of EPANET's viscosity, below it is the viscosity.
    pub fn viscosity_m2_s(&self) -> f64 {
        match (self.viscosity > 1e-3, self.si) {
            (true, _) => self.viscosity * VISCOSITY_M2_S,
            (false, true) => self.viscosity,
            (false, false) => self.viscosity * FT * FT,
        }
    }
}

/// A time as EPANET reads it: hours as a number, `h:mm` or `h:mm:ss`, then a unit, AM or PM.
pub(super) fn time_s(words: &[&str]) -> Option<f64> {
    let first = *words.first()?;
    let unit = words.get(1).copied().unwrap_or_default();
    let hours = match first.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => {
            let factor = match () {
                () if begins(unit, "SEC") => 1.0 / 3600.0,
                () if begins(unit, "MIN") => 1.0 / 60.0,
                () if begins(unit, "DAY") => 24.0,
                () => 1.0,
            };
            value * factor
        }
        Ok(_) => return None,
        Err(_) => {
            let mut hours = 0.0;
            for (part, size) in first.split(':').zip([1.0, 60.0, 3600.0]) {
                let value = part.parse::<f64>().ok().filter(|v| v.is_finite() && *v >= 0.0)?;
                hours += value / size;
            }
            (first.split(':').count() <= 3).then_some(hours)?
        }
    };
    let hours = match () {
        () if begins(unit, "AM") && hours >= 12.0 => hours - 12.0,
        () if begins(unit, "PM") && hours < 12.0 => hours + 12.0,
        () => hours,
    };
    Some((hours * 3600.0).round()).filter(|seconds| seconds.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times() {
        assert_eq!(time_s(&["24:00"]), Some(86_400.0));
        assert_eq!(time_s(&["1:30:30"]), Some(5430.0));
        assert_eq!(time_s(&["1.5"]), Some(5400.0));
        assert_eq!(time_s(&["90", "MIN"]), Some(5400.0));
        assert_eq!(time_s(&["12", "AM"]), Some(0.0));
        assert_eq!(time_s(&["6:30", "PM"]), Some(66_600.0));
        assert_eq!(time_s(&["x"]), None);
        assert_eq!(time_s(&["1:x"]), None);
        assert_eq!(time_s(&[]), None);
    }

    fn options(text: &str) -> Options {
        let (rows, _) = super::super::inp::rows(text);
        let mut errors = Vec::new();
        let options = Options::read(&rows, &mut ModelText::default(), &mut errors);
        assert_eq!(errors, []);
        options
    }

    #[test]
    fn fittings() {
        // The snapshots in data/epanet have nominal K times 0.99988 with EPANET's gravity.
        let option = options("[OPTIONS]\nHeadloss D-W\n");
        assert!((option.loss_coefficient(1.0) - 0.99988).abs() < 1e-5);
    }

    #[test]
    fn units() {
        let us = options("[OPTIONS]\nUnits GPM\nHeadloss D-W\nViscosity 1.1e-5\n");
        // 448.831 gpm are a cubic foot per second.
        assert!((us.flow_m3_s * 448.831 / FT3 - 1.0).abs() < 1e-6);
        assert!((us.viscosity_m2_s() - 1.021_933e-6).abs() < 1e-12);
        assert!((us.pressure_m() * 0.4333 - 0.3048).abs() < 1e-12);
        let si = options("[OPTIONS]\nUnits LPS\nSpecific Gravity 0.5\nPressure kPa\n");
        assert_eq!((si.flow_m3_s, si.density_kg_m3()), (1e-3, 500.0));
        // 1 kPa of a liquid of half the weight of water: 1000/(500 * 9.81) = 0.2039 m
        assert!((si.pressure_m() - 0.2039).abs() < 3e-4);
        // 1 kW: 1000/(1000 * 9.81) m4/s, with EPANET's rounded horsepower.
        assert!((si.head_times_flow_m4_s(1.0) * 9.81 - 1.0).abs() < 1e-3);
    }
}

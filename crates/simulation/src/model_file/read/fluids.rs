//! `[fluid]`: which medium it describes.

use super::ModelReader;
use crate::diagnostic::Diagnostic;
use crate::model::Place;
use crate::model_file::{FluidEntry, FluidKind};
use crate::temperatures::Temperatures;
use crate::wording::refused;
use anergy_core::medium::glycol::{Glycol, LARGEST_SHARE};
use anergy_core::medium::{Liquid, Medium};

const CONSTANTS: [&str; 4] =
    ["density_kg_m3", "heat_capacity_j_kg_k", "viscosity_pa_s", "conductivity_w_m_k"];
/// Fields of liquids with properties over temperature.
const OF_TABLES: [&str; 2] = ["reference_temperature_k", "follow_temperature"];
const LIMITS: [&str; 2] = ["min_temperature_k", "max_temperature_k"];

impl ModelReader<'_> {
    /// Temperatures of the water.
    pub(super) fn water(&self) -> Temperatures {
        Temperatures::of_liquid(&self.medium)
    }

    /// The medium; `None` after a report.
    pub(super) fn medium(&mut self, fluid: &FluidEntry, place: &Place) -> Option<Medium> {
        let before = self.reader.problems.len();
        let constants = Medium {
            density_kg_m3: fluid.density_kg_m3,
            heat_capacity_j_kg_k: fluid.heat_capacity_j_kg_k,
            viscosity_pa_s: fluid.viscosity_pa_s,
            conductivity_w_m_k: fluid.conductivity_w_m_k,
            liquid: Liquid::ConstantWater,
        };
        let medium = match fluid.kind {
            FluidKind::ConstantWater => {
                self.foreign(place, "constant_water", &[&OF_TABLES, &["share"], &LIMITS]);
                self.positive_constants(&constants, place);
                Some(constants)
            }
            FluidKind::Brine => {
                self.foreign(place, "brine", &[&OF_TABLES, &["share"]]);
                self.positive_constants(&constants, place);
                self.limits(fluid, place).map(|(min_k, max_k)| Medium {
                    liquid: Liquid::Brine { min_k, max_k },
                    ..constants
                })
            }
            FluidKind::Water => {
                self.foreign(place, "water", &[&CONSTANTS, &["share"], &LIMITS]);
                let medium = Medium::water(fluid.reference_temperature_k);
                self.reference(&medium, fluid, place).then_some(medium)
            }
            FluidKind::EthyleneGlycol => self.glycol(Glycol::Ethylene, fluid, place),
            FluidKind::PropyleneGlycol => self.glycol(Glycol::Propylene, fluid, place),
        };
        medium.filter(|_| self.reader.problems.len() == before)
    }

    fn refuse(&mut self, place: &Place, field: &str, message: &str, hint: &str) {
        let problem = refused("[fluid]", place, Some(field), message);
        self.reader.report(if hint.is_empty() { problem } else { problem.with_hint(hint) });
    }

    /// Fields that belong to another kind.
    fn foreign(&mut self, place: &Place, kind: &str, fields: &[&[&str]]) {
        for field in fields.iter().flat_map(|fields| fields.iter()) {
            if let Some(written) = place.fields.iter().find(|written| written.si() == *field) {
                let message = format!("[fluid]: kind = \"{kind}\" takes no {}", written.name());
                let hint = match *field {
                    "share" => {
                        "an antifreeze is kind = \"ethylene_glycol\" or \"propylene_glycol\""
                    }
                    "min_temperature_k" | "max_temperature_k" => {
                        "only a brine has limits of its own: kind = \"brine\""
                    }
                    "reference_temperature_k" | "follow_temperature" => {
                        "constants do not change: kind = \"water\" or a glycol has properties over temperature"
                    }
                    _ => {
                        "its constants follow from reference_temperature; own ones are for \
                          \"constant_water\" and \"brine\""
                    }
                };
                let problem = Diagnostic::new(message, written.span.range());
                self.reader.report(problem.with_hint(hint));
            }
        }
    }

    fn positive_constants(&mut self, medium: &Medium, place: &Place) {
        let values = [
            medium.density_kg_m3,
            medium.heat_capacity_j_kg_k,
            medium.viscosity_pa_s,
            medium.conductivity_w_m_k,
        ];
        for (field, value) in CONSTANTS.iter().zip(values) {
            if value <= 0.0 {
                self.refuse(place, field, &format!("{field} = {value} must be positive"), "");
            }
        }
    }

    /// A brine is what its constants and limits say.
    fn limits(&mut self, fluid: &FluidEntry, place: &Place) -> Option<(f64, f64)> {
        let missing: Vec<&str> =
            CONSTANTS.into_iter().chain(LIMITS).filter(|field| !place.has(field)).collect();
        if !missing.is_empty() {
            let message = format!("[fluid]: a brine needs {}", missing.join(", "));
            let problem = Diagnostic::new(message, place.span.range());
            let hint = "take them from the data sheet at the usual temperature; limits: min_temperature_degc, \
                        max_temperature_degc";
            self.reader.report(problem.with_hint(hint));
            return None;
        }
        let (min_k, max_k) = fluid.min_temperature_k.zip(fluid.max_temperature_k)?;
        if min_k < max_k {
            return Some((min_k, max_k));
        }
        let message = format!("min_temperature_k = {min_k} must be below max_temperature");
        self.refuse(place, "min_temperature_k", &message, "");
        None
    }

    fn glycol(&mut self, glycol: Glycol, fluid: &FluidEntry, place: &Place) -> Option<Medium> {
        let kind = match glycol {
            Glycol::Ethylene => "ethylene_glycol",
            Glycol::Propylene => "propylene_glycol",
        };
        self.foreign(place, kind, &[&CONSTANTS, &LIMITS]);
        let Some(share) = fluid.share else {
            let message = format!("[fluid]: kind = \"{kind}\" needs its share");
            let hint = "share of the mass, for example share = 0.3 (freezes near -14 degC)";
            self.reader.report(Diagnostic::new(message, place.span.range()).with_hint(hint));
            return None;
        };
        if !(share > 0.0 && share <= LARGEST_SHARE) {
            let message = format!("share = {share} must lie between 0 and {LARGEST_SHARE}");
            self.refuse(place, "share", &message, "it is a share of the mass: 0.3, not 30");
            return None;
        }
        let medium = Medium::glycol(glycol, share, fluid.reference_temperature_k);
        self.reference(&medium, fluid, place).then_some(medium)
    }

    /// Whether the liquid exists at its reference temperature.
    fn reference(&mut self, medium: &Medium, fluid: &FluidEntry, place: &Place) -> bool {
        let (range, t_k) = (Temperatures::of_liquid(medium), fluid.reference_temperature_k);
        let problem = range.problem("[fluid]", "reference_temperature_k", t_k, place);
        let good = problem.is_none();
        self.reader.problems.extend(problem);
        good
    }
}

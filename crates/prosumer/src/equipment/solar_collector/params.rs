//! Solar thermal collectors as written in a model file.

use super::{CELLS, SolarCollector};
use crate::equipment::liquid;
use crate::equipment::pv::SkyModel;
use crate::thermal_unit::{UnitError, not_negative, positive, share};
use anergy_core::medium::Medium;
use anergy_core::solar::Plane;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the pump of a collector sets its flow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CollectorFlow {
    /// By how much the collector is warmer than what comes back.
    #[default]
    Difference,
    /// So that the supply has its set temperature.
    Supply,
}

/// Collectors of known coefficients.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CollectorType {
    /// Flat plate: eta0 0.78, a1 3.6 W/(m2 K), a2 0.014 W/(m2 K2), b0 0.15.
    #[default]
    FlatPlate,
    /// Tubes with mirrors (CPC): eta0 0.642, a1 0.885 W/(m2 K), a2 0.001 W/(m2 K2), b0 0.
    Cpc,
}

impl CollectorType {
    /// eta0, a1, a2, b0.
    fn coefficients(self) -> [f64; 4] {
        match self {
            Self::FlatPlate => [0.78, 3.6, 0.014, 0.15],
            Self::Cpc => [0.642, 0.885, 0.001, 0.0],
        }
    }
}

/// Solar thermal collectors as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SolarCollectorParams {
    /// Which collectors: gives the coefficients that are not stated.
    pub collector: CollectorType,
    /// Area of the collectors, m2.
    pub area_m2: f64,
    /// Efficiency without losses.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub eta0: Option<f64>,
    /// Linear loss, W/(m2 K).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub a1_w_m2_k: Option<f64>,
    /// Quadratic loss, W/(m2 K2).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub a2: Option<f64>,
    /// Change of the efficiency with the angle of incidence of the beam.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub b0: Option<f64>,
    /// Efficiency for diffuse irradiance over that of beam at a right angle.
    pub k_diffuse: f64,
    /// Heat capacity with content, J/(m2 K).
    pub capacity_j_m2_k: f64,
    /// Tilt from the horizontal, rad.
    pub tilt_rad: f64,
    /// Where they look, from south, west positive, rad.
    pub azimuth_rad: f64,
    /// Albedo of the ground before them.
    pub albedo: f64,
    /// How the sky shines.
    pub sky: SkyModel,
    /// How the pump sets its flow.
    pub flow_control: CollectorFlow,
    /// Full flow, as water of the same capacity flow, m3/s.
    pub v_flow_max_m3_s: f64,
    /// The pump starts where the collector is warmer by more, K.
    pub start_difference_k: f64,
    /// It stops where the collector is warmer by less, K.
    pub stop_difference_k: f64,
    /// With `difference`: above this the flow rises, K.
    pub flow_from_difference_k: f64,
    /// With `difference`: from here on the flow is full, K.
    pub flow_full_difference_k: f64,
    /// With `supply`: the set supply temperature, K.
    pub supply_set_k: f64,
    /// With `supply`: that where the water comes back warmer than `supply_set_k`, K.
    pub supply_high_k: f64,
    /// The pump rests while the water comes back warmer: the storage is full, K.
    pub return_max_k: f64,
    /// The pump does not start while the collector is hotter: it stagnates, K.
    pub collector_max_k: f64,
    /// Electricity of the pump, W.
    pub pump_w: f64,
    /// 1 releases the pump, 0 keeps it off, while nothing drives it.
    pub enable: f64,
    /// Outdoor temperature while neither weather nor anything else drives it, K.
    pub t_outdoor_k: f64,
}

impl Default for SolarCollectorParams {
    fn default() -> Self {
        Self {
            collector: CollectorType::FlatPlate,
            area_m2: 12.0,
            eta0: None,
            a1_w_m2_k: None,
            a2: None,
            b0: None,
            k_diffuse: 0.9,
            capacity_j_m2_k: 7000.0,
            tilt_rad: 35.0_f64.to_radians(),
            azimuth_rad: 0.0,
            albedo: 0.2,
            sky: SkyModel::Perez,
            flow_control: CollectorFlow::Difference,
            v_flow_max_m3_s: 20.0 / 60_000.0,
            start_difference_k: 3.0,
            stop_difference_k: 2.0,
            flow_from_difference_k: 3.0,
            flow_full_difference_k: 7.0,
            supply_set_k: 333.15,
            supply_high_k: 353.15,
            return_max_k: 358.15,
            collector_max_k: 368.15,
            pump_w: 40.0,
            enable: 1.0,
            t_outdoor_k: 283.15,
        }
    }
}

/// Coefficients of a collector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coefficients {
    pub eta0: f64,
    pub a1_w_m2_k: f64,
    pub a2: f64,
    pub b0: f64,
}

impl SolarCollectorParams {
    fn coefficients(&self) -> Result<Coefficients, UnitError> {
        let [eta0, a1, a2, b0] = self.collector.coefficients();
        Ok(Coefficients {
            eta0: share("eta0", self.eta0.unwrap_or(eta0))?,
            a1_w_m2_k: positive("a1_w_m2_k", self.a1_w_m2_k.unwrap_or(a1))?,
            a2: not_negative("a2", self.a2.unwrap_or(a2))?,
            b0: share("b0", self.b0.unwrap_or(b0))?,
        })
    }

    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<SolarCollector, UnitError> {
        for (field, value) in [
            ("area_m2", self.area_m2),
            ("capacity_j_m2_k", self.capacity_j_m2_k),
            ("v_flow_max_m3_s", self.v_flow_max_m3_s),
            ("t_outdoor_k", self.t_outdoor_k),
        ] {
            positive(field, value)?;
        }
        for (field, value) in [
            ("k_diffuse", self.k_diffuse),
            ("stop_difference_k", self.stop_difference_k),
            ("flow_from_difference_k", self.flow_from_difference_k),
            ("pump_w", self.pump_w),
        ] {
            not_negative(field, value)?;
        }
        share("albedo", self.albedo)?;
        share("enable", self.enable)?;
        let above = |field, value, least, requirement| match value > least {
            true => Ok(()),
            false => Err(UnitError::OutOfRange { field, value, requirement }),
        };
        above(
            "start_difference_k",
            self.start_difference_k,
            self.stop_difference_k,
            "must be above stop_difference_k",
        )?;
        above(
            "flow_full_difference_k",
            self.flow_full_difference_k,
            self.flow_from_difference_k,
            "must be above flow_from_difference_k",
        )?;
        for (field, value) in [
            ("supply_set_k", self.supply_set_k),
            ("supply_high_k", self.supply_high_k),
            ("return_max_k", self.return_max_k),
            ("collector_max_k", self.collector_max_k),
        ] {
            liquid(medium, field, value)?;
        }
        for (field, value) in [("tilt_rad", self.tilt_rad), ("azimuth_rad", self.azimuth_rad)] {
            if !value.is_finite() {
                let requirement = "must be finite";
                return Err(UnitError::OutOfRange { field, value, requirement });
            }
        }
        let cell_m2 = self.area_m2 / CELLS as f64;
        Ok(SolarCollector {
            coefficients: self.coefficients()?,
            plane: Plane::new(self.tilt_rad, self.azimuth_rad, self.albedo),
            cell_j_k: self.capacity_j_m2_k * cell_m2,
            cell_m2,
            most_kg_s: self.v_flow_max_m3_s * medium.density_kg_m3,
            params: self.clone(),
            medium: *medium,
        })
    }
}

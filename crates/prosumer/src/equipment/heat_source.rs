//! Heat for the water that passes: a fixed supply temperature, one that follows the outdoor temperature, or a
//! given heat flow.
//!
//! **Equation** `T_out = T_supply`, or `T_out = f(T_outdoor)` with straight lines between the points of
//! the curve and its end values beyond them, or `T_out = T_in + Q/(|m| cp)`; standing water takes up nothing.
//! **Assumptions** any heat is available at once, also cold for water that is too warm; the flow is that of the
//! edge. **Validity** steps longer than the time constant of the control of a real boiler (a few minutes); a heat
//! flow only where enough water passes to take it: water that would boil or freeze ends the run.
//!
//! **Sources** sliding supply temperature of district heating, `frederiksen2013`.

use crate::thermal_unit::{
    Exchange, ThermalUnit, UnitError, UnitInput, UnitOutput, UnitPort, capacity_w_k,
};
use anergy_core::medium::Medium;
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A heat source as written in a model file: with `supply_k`, `outdoor_curve_k` or `heat_w`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeatSourceParams {
    /// Temperature of the water that leaves, K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub supply_k: Option<f64>,
    /// Points of outdoor and supply temperature, K, by rising outdoor temperature.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outdoor_curve_k: Vec<(f64, f64)>,
    /// Outdoor temperature while nothing drives it, K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outdoor_k: Option<f64>,
    /// Heat into the water that passes, whatever its flow and temperature, W; negative takes heat from it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heat_w: Option<f64>,
}

impl Default for HeatSourceParams {
    fn default() -> Self {
        Self { supply_k: Some(353.15), outdoor_curve_k: Vec::new(), outdoor_k: None, heat_w: None }
    }
}

#[derive(Debug, Clone, PartialEq)]
enum Supply {
    Fixed(f64),
    Curve { points: Vec<(f64, f64)>, outdoor_k: f64 },
    Heat(f64),
}

/// A heat source ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatSource {
    supply: Supply,
    medium: Medium,
}

/// Outdoor temperature while nothing is said of it, K.
const OUTDOOR_K: f64 = 273.15;

impl HeatSourceParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range or missing.
    pub fn build(&self, medium: &Medium) -> Result<HeatSource, UnitError> {
        let fields = |problem: &str| Err(UnitError::Fields { problem: problem.to_owned() });
        let needs_curve = || fields("outdoor_k (outdoor_degc) needs an outdoor_curve_degc");
        let supply = match (self.supply_k, self.outdoor_curve_k.as_slice(), self.heat_w) {
            (Some(_), [], None) | (None, [], Some(_)) if self.outdoor_k.is_some() => {
                return needs_curve();
            }
            (Some(t_k), [], None) => Supply::Fixed(super::liquid(medium, "supply_k", t_k)?),
            (None, [], Some(heat_w)) if heat_w.is_finite() => Supply::Heat(heat_w),
            (None, [], Some(value)) => {
                let requirement = "must be a finite number";
                return Err(UnitError::OutOfRange { field: "heat_w", value, requirement });
            }
            (None, points @ [_, ..], None) => {
                for pair in points.windows(2) {
                    if pair[1].0 <= pair[0].0 || pair[1].0.is_nan() {
                        return fields("outdoor_curve: the outdoor temperatures must rise");
                    }
                }
                for point in points {
                    super::liquid(medium, "outdoor_curve_k", point.1)?;
                }
                let outdoor_k = self.outdoor_k.unwrap_or(OUTDOOR_K);
                Supply::Curve { points: points.to_vec(), outdoor_k }
            }
            _ => {
                return fields(
                    "give one of supply_k (supply_degc), outdoor_curve_k (outdoor_curve_degc) and heat_w (heat_kw)",
                );
            }
        };
        Ok(HeatSource { supply, medium: *medium })
    }
}

/// Straight lines between the points, their end values beyond.
fn interpolated(points: &[(f64, f64)], x: f64) -> f64 {
    let next = points.partition_point(|point| point.0 <= x);
    match (next.checked_sub(1).map(|i| points[i]), points.get(next)) {
        (Some((x0, y0)), Some((x1, y1))) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (Some((_, y)), None) | (None, Some(&(_, y))) => y,
        (None, None) => f64::NAN,
    }
}

impl HeatSource {
    fn outlet(&self, signals: &Signals<'_>) -> Outlet {
        match &self.supply {
            Supply::Fixed(_) => Outlet::Temperature(signals.get(0)),
            Supply::Curve { points, .. } => {
                Outlet::Temperature(interpolated(points, signals.get(0)))
            }
            Supply::Heat(_) => Outlet::HeatFlow(signals.get(0)),
        }
    }
}

impl ThermalUnit for HeatSource {
    fn ports(&self) -> Vec<UnitPort> {
        vec![UnitPort { sets_flow: false, ..UnitPort::ONLY }]
    }

    fn inputs(&self) -> Vec<UnitInput> {
        let (name, unit, initial, min, follows) = match &self.supply {
            Supply::Fixed(t_k) => ("supply_k", "k", *t_k, 0.0, None),
            Supply::Curve { outdoor_k, .. } => {
                ("outdoor_k", "k", *outdoor_k, 0.0, Some("weather.t_outdoor_k"))
            }
            Supply::Heat(heat_w) => ("heat_w", "w", *heat_w, f64::NEG_INFINITY, None),
        };
        vec![UnitInput { name, unit, initial, min, max: f64::INFINITY, follows }]
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        let mut outputs = vec![
            UnitOutput::new("q_flow_w", "W"),
            UnitOutput::new("m_flow_kg_s", "kg s-1"),
            UnitOutput::new("t_in_k", "K"),
            UnitOutput::new("t_out_k", "K"),
        ];
        if !matches!(self.supply, Supply::Heat(_)) {
            outputs.push(UnitOutput::new("supply_set_k", "K"));
        }
        outputs
    }

    fn initial_state(&self, _initial_k: f64) -> Vec<f64> {
        Vec::new()
    }

    fn request(
        &self,
        signals: &Signals<'_>,
        _got: &[PortFlow],
        _state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        wanted[0] = PortRequest { m_flow_kg_s: 0.0, outlet: self.outlet(signals) };
    }

    fn advance(
        &self,
        _dt_s: f64,
        signals: &Signals<'_>,
        ports: &[PortFlow],
        _state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange {
        let PortFlow { m_flow_kg_s, t_in_k, t_out_k } = ports[0];
        out[0] = capacity_w_k(&self.medium, m_flow_kg_s) * (t_out_k - t_in_k);
        out[1] = m_flow_kg_s;
        out[2] = t_in_k;
        out[3] = t_out_k;
        if let Outlet::Temperature(supply_k) = self.outlet(signals) {
            out[4] = supply_k;
        }
        Exchange { external_w: out[0], ..Exchange::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn supply_degc(params: &HeatSourceParams, signal_degc: f64) -> f64 {
        let unit = params.build(&Medium::default()).unwrap();
        let mut wanted = [PortRequest::default()];
        unit.request(&Signals(&[signal_degc + 273.15]), &[], &mut [], &mut wanted);
        let Outlet::Temperature(t_k) = wanted[0].outlet else { panic!() };
        t_k - 273.15
    }

    #[test]
    fn supply_follows_the_outdoor_temperature() {
        let curve = |points: &[(f64, f64)]| HeatSourceParams {
            supply_k: None,
            outdoor_curve_k: points.iter().map(|(x, y)| (x + 273.15, y + 273.15)).collect(),
            ..HeatSourceParams::default()
        };
        // -12 degC: 90, 15 degC: 70; at 3 degC: 90 - 20 * 15/27 = 78.888...
        let params = curve(&[(-12.0, 90.0), (15.0, 70.0)]);
        for (outdoor, supply) in
            [(-20.0, 90.0), (-12.0, 90.0), (3.0, 90.0 - 300.0 / 27.0), (15.0, 70.0), (30.0, 70.0)]
        {
            assert!((supply_degc(&params, outdoor) - supply).abs() < 1e-9, "{outdoor}");
        }
        assert_eq!(params.build(&Medium::default()).unwrap().inputs()[0].name, "outdoor_k");
        for points in [&[(15.0, 70.0), (-12.0, 90.0)][..], &[(0.0, 120.0)][..], &[][..]] {
            assert!(curve(points).build(&Medium::default()).is_err(), "{points:?}");
        }
    }

    #[test]
    fn a_fixed_supply_is_its_signal() {
        assert!((supply_degc(&HeatSourceParams::default(), 65.0) - 65.0).abs() < 1e-9);
        let both = HeatSourceParams { outdoor_k: Some(270.0), ..HeatSourceParams::default() };
        assert!(both.build(&Medium::default()).is_err());
        // 1 kg/s from 50 to 80 degC: 4180 * 30 = 125.4 kW
        let unit = HeatSourceParams::default().build(&Medium::default()).unwrap();
        let (mut out, got) =
            ([0.0; 5], PortFlow { m_flow_kg_s: 1.0, t_in_k: 323.15, t_out_k: 353.15 });
        unit.advance(1.0, &Signals(&[353.15]), &[got], &mut [], &mut out);
        assert!((out[0] - 125_400.0).abs() < 1e-6);
    }

    #[test]
    fn a_heat_flow_is_its_signal() {
        let heat = |heat_w: f64| HeatSourceParams {
            supply_k: None,
            heat_w: Some(heat_w),
            ..HeatSourceParams::default()
        };
        let unit = heat(-5000.0).build(&Medium::default()).unwrap();
        assert_eq!((unit.inputs()[0].name, unit.inputs()[0].initial), ("heat_w", -5000.0));
        let mut wanted = [PortRequest::default()];
        unit.request(&Signals(&[-4180.0]), &[], &mut [], &mut wanted);
        assert_eq!(wanted[0].outlet, Outlet::HeatFlow(-4180.0));
        // 0.5 kg/s cooled by 2 K: 4180 * 0.5 * 2 = 4180 W
        let (mut out, got) =
            ([0.0; 4], PortFlow { m_flow_kg_s: 0.5, t_in_k: 323.15, t_out_k: 321.15 });
        unit.advance(1.0, &Signals(&[-4180.0]), &[got], &mut [], &mut out);
        assert!((out[0] + 4180.0).abs() < 1e-6);
        assert_eq!(unit.outputs().len(), 4);
        for wrong in [
            HeatSourceParams { supply_k: Some(340.0), ..heat(1.0) },
            HeatSourceParams { outdoor_k: Some(270.0), ..heat(1.0) },
            heat(f64::NAN),
        ] {
            assert!(wrong.build(&Medium::default()).is_err(), "{wrong:?}");
        }
    }
}

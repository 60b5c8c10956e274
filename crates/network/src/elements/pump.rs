//! A speed-controlled circulation pump: affinity laws on a head curve, actuator lag, electric power.
//!
//! **Equation** at relative speed u and `V = m/rho`: `p_b - p_a = u^2 H(V/u)`; quadratic curve
//! `H = H0 - a V|V|` with `a = H0/V_free^2`, so `p_a - p_b = -u^2 H0 + a V|V|`; or a table of points
//! with monotone interpolation, continued linearly beyond its end and by `H0 + s|V| + a V^2` for
//! reverse flow. Power `P = V dp/(eta_h eta_m)` for pumping flow, plus standby.
//!
//! **Assumptions** at rest the impeller is an orifice of the curve's curvature. **Validity** any flow:
//! reverse flow is resisted, flow beyond the curve makes the pump a resistance.
//!
//! **Numerics** `V|V|` is regularised below `delta_m` times the nominal flow; table curves are blended
//! into the orifice below 5 % speed. Below `speed_min` the pump is off.
//!
//! **Sources** `licklederer2021`, `wetter2014`, `elizarov2021` (rise time).

use crate::two_port::{
    Actuator, Characteristic, EdgeState, ElementError, TwoPort, not_negative, positive, ratio,
};
use anergy_core::linear::Linear;
use anergy_core::medium::Medium;
use anergy_core::numerics::interpolate::Pchip;
use anergy_core::numerics::regularize::{quadratic, quadratic_slope_at_zero, smoothstep};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Below this speed a table curve is blended into the impeller at rest.
const BLEND_SPEED: f64 = 0.05;

/// Slope of a table at its ends, at least, as a share of the first and last secant.
const END_SLOPE_SHARE: f64 = 0.1;

/// A pump as written in a model file: either `head_max_pa` and `free_flow_m3_s`, or the two columns
/// `curve_v_flow_m3_s` and `curve_head_pa`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PumpParams {
    /// Head at zero flow and full speed, Pa (quadratic curve).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub head_max_pa: Option<f64>,
    /// Flow at zero head and full speed, m3/s (quadratic curve).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free_flow_m3_s: Option<f64>,
    /// Flows of the curve table at full speed, m3/s, rising from 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve_v_flow_m3_s: Vec<f64>,
    /// Heads of the curve table, Pa, falling.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve_head_pa: Vec<f64>,
    /// Relative speed commanded while nothing else drives it.
    #[serde(default)]
    pub speed: f64,
    /// Relative speed at the start of a run.
    #[serde(default)]
    pub initial_speed: f64,
    /// Below this relative speed the pump is off.
    #[serde(default)]
    pub speed_min: f64,
    /// Largest relative speed.
    #[serde(default = "one")]
    pub speed_max: f64,
    /// Time in which the speed follows a step by 99.6 %, s.
    #[serde(default = "default_rise_time")]
    pub rise_time_s: f64,
    /// Hydraulic efficiency.
    #[serde(default = "default_efficiency")]
    pub efficiency_hydraulic: f64,
    /// Motor efficiency.
    #[serde(default = "default_efficiency")]
    pub efficiency_motor: f64,
    /// Electric power while off, W.
    #[serde(default)]
    pub standby_w: f64,
    /// Regularised below this share of the nominal flow (half the free flow).
    #[serde(default = "default_delta_m")]
    pub delta_m: f64,
}

fn one() -> f64 {
    1.0
}

fn default_rise_time() -> f64 {
    8.0
}

fn default_efficiency() -> f64 {
    0.7
}

fn default_delta_m() -> f64 {
    0.01
}

impl Default for PumpParams {
    /// The published feed-in pump (`FeedInQuadratic`): 402.21 hPa, 55.33 l/min.
    fn default() -> Self {
        Self {
            head_max_pa: Some(40_221.0),
            free_flow_m3_s: Some(55.33 / 60_000.0),
            curve_v_flow_m3_s: Vec::new(),
            curve_head_pa: Vec::new(),
            speed: 0.0,
            initial_speed: 0.0,
            speed_min: 0.0,
            speed_max: one(),
            rise_time_s: default_rise_time(),
            efficiency_hydraulic: default_efficiency(),
            efficiency_motor: default_efficiency(),
            standby_w: 0.0,
            delta_m: default_delta_m(),
        }
    }
}

/// A table curve with its continuation.
#[derive(Debug, Clone, PartialEq)]
struct TableCurve {
    points: Pchip,
    slope_at_zero: f64,
}

/// A pump ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct Pump {
    head_max_pa: f64,
    /// Curvature over the mass flow, Pa/(kg/s)^2.
    curvature: f64,
    m_turbulent_kg_s: f64,
    m_flow_nominal_kg_s: f64,
    table: Option<TableCurve>,
    efficiency: f64,
    standby_w: f64,
    actuator: Actuator,
    speed_min: f64,
}

impl PumpParams {
    /// The runtime pump.
    ///
    /// # Errors
    /// Names the field that is out of range, or the point at which the curve does not fall.
    pub fn build(&self, medium: &Medium) -> Result<Pump, ElementError> {
        let rho = medium.density_kg_m3;
        let has_table = !self.curve_v_flow_m3_s.is_empty() || !self.curve_head_pa.is_empty();
        let (head_max_pa, free_flow, curve) = match (self.head_max_pa, self.free_flow_m3_s) {
            (Some(head), Some(flow)) if !has_table => {
                (positive("head_max_pa", head)?, positive("free_flow_m3_s", flow)?, None)
            }
            (None, None) if has_table => {
                let curve = checked_curve(&self.curve_v_flow_m3_s, &self.curve_head_pa)?;
                let (first, last) = (self.curve_head_pa[0], curve.range().1);
                // Quadratic through the ends of the table: curvature and reverse flow.
                let end_head = curve.at(last).value;
                (first, last * (first / (first - end_head)).sqrt(), Some(curve))
            }
            _ => {
                return Err(ElementError::Fields {
                    problem: "give either head_max_pa and free_flow_m3_s, or the table \
                              curve_v_flow_m3_s and curve_head_pa"
                        .into(),
                });
            }
        };
        let speed_max = positive("speed_max", self.speed_max)?;
        for (field, value) in [
            ("speed", self.speed),
            ("initial_speed", self.initial_speed),
            ("speed_min", self.speed_min),
        ] {
            if !(0.0..=speed_max).contains(&value) {
                return Err(ElementError::OutOfRange {
                    field,
                    value,
                    requirement: "must lie between 0 and speed_max",
                });
            }
        }
        let efficiency =
            positive(
                "efficiency_hydraulic",
                ratio("efficiency_hydraulic", self.efficiency_hydraulic)?,
            )? * positive("efficiency_motor", ratio("efficiency_motor", self.efficiency_motor)?)?;
        let m_free = free_flow * rho;
        let m_flow_nominal_kg_s = 0.5 * m_free;
        let curvature = head_max_pa / (m_free * m_free);
        let m_turbulent_kg_s = positive("delta_m", self.delta_m)? * m_flow_nominal_kg_s;
        let table = curve.map(|curve| {
            // The slope at zero is that of the regularised quadratic where the table is flatter, as
            // far as the curve stays monotone (three times the first secant).
            let floor = quadratic_slope_at_zero(curvature, m_turbulent_kg_s) * rho;
            let floor = floor.min(-2.0 * curve.secant(0));
            let slope_at_zero = curve.at(0.0).slope.min(-floor);
            TableCurve { points: curve.with_first_slope(slope_at_zero), slope_at_zero }
        });
        Ok(Pump {
            head_max_pa,
            curvature,
            m_turbulent_kg_s,
            m_flow_nominal_kg_s,
            table,
            efficiency,
            standby_w: not_negative("standby_w", self.standby_w)?,
            actuator: Actuator {
                position: "speed",
                command: "speed",
                unit: "",
                initial_command: self.speed,
                initial_position: self.initial_speed,
                rise_time_s: not_negative("rise_time_s", self.rise_time_s)?,
                min: 0.0,
                max: speed_max,
            },
            speed_min: self.speed_min,
        })
    }
}

/// The table as a curve that starts at zero flow and falls strictly.
fn checked_curve(v_flow: &[f64], head: &[f64]) -> Result<Pchip, ElementError> {
    let curve = Pchip::new(v_flow, head)
        .map_err(|error| ElementError::Table {
            field: "curve_v_flow_m3_s",
            problem: error.to_string(),
        })?
        .with_end_slopes(END_SLOPE_SHARE);
    if v_flow[0] != 0.0 {
        return Err(ElementError::Table {
            field: "curve_v_flow_m3_s",
            problem: format!("the curve must start at zero flow, not at {}", v_flow[0]),
        });
    }
    if head[0] <= 0.0 {
        return Err(ElementError::Table {
            field: "curve_head_pa",
            problem: format!("the head at zero flow must be positive, not {}", head[0]),
        });
    }
    if let Some(i) = (1..head.len()).find(|&i| head[i] >= head[i - 1]) {
        return Err(ElementError::Table {
            field: "curve_head_pa",
            problem: format!(
                "the head must fall strictly with the flow: point {} has {} Pa, the point before {} Pa",
                i + 1,
                head[i],
                head[i - 1]
            ),
        });
    }
    Ok(curve)
}

impl Pump {
    fn head_loss(&self, m: f64, speed: f64, density: f64) -> Linear {
        let at_rest = quadratic(m, self.curvature, self.m_turbulent_kg_s);
        let Some(table) = &self.table else {
            return Linear::new(at_rest.value - speed * speed * self.head_max_pa, at_rest.slope);
        };
        let weight = smoothstep(speed / BLEND_SPEED);
        let reference_speed = speed.max(BLEND_SPEED);
        let v = m / density / reference_speed;
        let head = if v >= 0.0 {
            table.points.at(v)
        } else {
            let curvature = self.curvature * density * density;
            Linear::new(
                self.head_max_pa + table.slope_at_zero * v + curvature * v * v,
                table.slope_at_zero + 2.0 * curvature * v,
            )
        };
        let square = speed * speed;
        Linear::new(
            -weight * square * head.value
                + (1.0 - weight) * (at_rest.value - square * self.head_max_pa),
            -weight * square * head.slope / (density * reference_speed)
                + (1.0 - weight) * at_rest.slope,
        )
    }
}

impl TwoPort for Pump {
    fn characteristic(&self, m: f64, state: &EdgeState) -> Characteristic {
        Characteristic::PressureLoss(self.head_loss(m, state.position, state.density_kg_m3))
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        self.m_flow_nominal_kg_s
    }

    fn actuator(&self) -> Option<Actuator> {
        Some(self.actuator)
    }

    fn target_position(&self, command: f64) -> f64 {
        let speed = command.clamp(0.0, self.actuator.max);
        if speed < self.speed_min { 0.0 } else { speed }
    }

    fn electric_power_w(&self, m: f64, state: &EdgeState) -> Option<f64> {
        let head = -self.head_loss(m, state.position, state.density_kg_m3).value;
        let hydraulic = m / state.density_kg_m3 * head;
        let pumping = state.position > 0.0 && m > 0.0 && head > 0.0;
        Some(self.standby_w + if pumping { hydraulic / self.efficiency } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(speed: f64) -> EdgeState {
        EdgeState { position: speed, density_kg_m3: 1000.0, viscosity_pa_s: 1e-3 }
    }

    fn head(pump: &Pump, m: f64, speed: f64) -> f64 {
        -pump.head_loss(m, speed, 1000.0).value
    }

    #[test]
    fn published_quadratic_curve() {
        // a = 402.21/55.33^2 = 0.131381 hPa/(l/min)^2; at 10 l/min, u = 0.7:
        // 0.49 * 402.21 - 0.131381 * 100 = 183.9448 hPa
        let pump = PumpParams::default().build(&Medium::default()).unwrap();
        assert!((head(&pump, 10.0 / 60.0, 0.7) - 18_394.48).abs() < 0.02);
        assert!(head(&pump, 55.33 / 60.0, 1.0).abs() < 1e-9);
        // Reverse flow is resisted more than standing water.
        assert!(head(&pump, -0.1, 1.0) > head(&pump, 0.0, 1.0));
    }

    #[test]
    fn affinity_laws() {
        let table = PumpParams {
            head_max_pa: None,
            free_flow_m3_s: None,
            curve_v_flow_m3_s: vec![0.0, 0.4 / 3600.0, 2.0 / 3600.0, 4.0 / 3600.0],
            curve_head_pa: vec![3.2536e5, 3.1654e5, 2.8224e5, 1.6856e5],
            ..PumpParams::default()
        };
        for params in [PumpParams::default(), table] {
            let pump = params.build(&Medium::default()).unwrap();
            let full = head(&pump, 0.3, 1.0);
            assert!((head(&pump, 0.15, 0.5) / (0.25 * full) - 1.0).abs() < 1e-12);
            let power = |m, u| pump.electric_power_w(m, &state(u)).unwrap();
            assert!((power(0.15, 0.5) / (0.125 * power(0.3, 1.0)) - 1.0).abs() < 1e-12);
            // P = V dp/0.49
            assert!((power(0.3, 1.0) / (3e-4 * full / 0.49) - 1.0).abs() < 1e-12);
            assert_eq!(power(0.1, 0.0), 0.0);
        }
    }

    #[test]
    fn awkward_tables_stay_strictly_monotone() {
        for heads in [[1000.0, 100.0, 90.0], [1000.0, 999.99, 500.0], [1000.0, 10.0, 9.999]] {
            let pump = PumpParams {
                head_max_pa: None,
                free_flow_m3_s: None,
                curve_v_flow_m3_s: vec![0.0, 1e-4, 2e-4],
                curve_head_pa: heads.to_vec(),
                ..PumpParams::default()
            }
            .build(&Medium::default())
            .unwrap();
            let flows: Vec<f64> = (-300..=500).map(|i| f64::from(i) * 1e-3).collect();
            let law = |m| pump.head_loss(m, 1.0, 1000.0);
            anergy_core::testing::check_monotone(law, &flows).unwrap();
        }
    }

    #[test]
    fn a_rising_curve_is_refused_with_its_point() {
        let params = PumpParams {
            head_max_pa: None,
            free_flow_m3_s: None,
            curve_v_flow_m3_s: vec![0.0, 1e-4, 2e-4],
            curve_head_pa: vec![100.0, 110.0, 50.0],
            ..PumpParams::default()
        };
        let error = params.build(&Medium::default()).unwrap_err().to_string();
        assert!(error.contains("point 2 has 110 Pa"), "{error}");
    }
}

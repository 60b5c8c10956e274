//! A circulation pump that holds a speed, a flow or a head: affinity laws on a head curve, actuator lag,
//! electric power.
//!
//! **Equation** at relative speed u and `V = m/rho`: `p_b - p_a = u^2 H(V/u)`. The curve H at full speed
//! is one of: quadratic `H = H0 - a V|V|` with `a = H0/V_free^2`, so `p_a - p_b = -u^2 H0 + a V|V|`;
//! power law `H = H0 - H0 (V/V_free)^n`, odd in the flow, straight beyond `+-V_free`; a table of points
//! with monotone interpolation; or a polynomial `H = sum c_i V^i` up to its first zero. The last two are
//! continued linearly beyond their end and by `H0 + s|V| + a V^2` for reverse flow. Power
//! `P = V dp/eta` for pumping flow, plus standby, with `eta = eta_h eta_m` or a table `eta(V/u)`; with
//! `heat_to_water = f` the water takes up the heat `max(f P - V dp, 0)` in the pump (without the standby
//! power). The work `V dp` itself is not given back where it dissipates: friction warms no water.
//!
//! With `mode = "flow"`, `"head"` or `"proportional_head"` the pump chooses the speed that holds its set
//! value, up to the full one and down to standstill: a median of three rising laws (`mode.rs`).
//!
//! **Assumptions** at rest the impeller is an orifice of the curve's curvature. Where a table or
//! polynomial does not fall, the nearest falling curve is taken and said so, up to 10 % of H0.
//! **Validity** any flow: reverse flow is resisted, flow beyond the curve makes the pump a resistance.
//!
//! **Numerics** `V|V|` and `V^n` are regularised below `delta_m` times the nominal flow, high powers up
//! to where they have the slope of the quadratic law at zero; all but the quadratic curve are blended into the orifice below 5 % speed. Below `speed_min` the pump is off.
//! Polynomials are sampled with their slopes, which is exact up to the third power.
//!
//! **Sources** `licklederer2021`, `wetter2014`, `elizarov2021` (rise time).

mod curve;
mod efficiency;
mod mode;

pub use mode::PumpMode;

use crate::two_port::{
    Actuator, Characteristic, EdgeState, ElementError, TwoPort, not_negative, positive, ratio,
};
use anergy_core::linear::Linear;
use anergy_core::medium::Medium;
use curve::HeadCurve;
use efficiency::Efficiency;
use mode::Proportional;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
/// `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PumpParams {
    /// Head at zero flow and full speed, Pa (quadratic curve or power law).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub head_max_pa: Option<f64>,
    /// Flow at zero head and full speed, m3/s (quadratic curve or power law).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free_flow_m3_s: Option<f64>,
    /// Exponent of the flow between the two. Absent: 2, the quadratic curve.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve_exponent: Option<f64>,
    /// Flows of the curve table at full speed, m3/s, rising from 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve_v_flow_m3_s: Vec<f64>,
    /// Heads of the curve table, Pa, falling.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve_head_pa: Vec<f64>,
    /// Head at full speed as a polynomial of the flow, Pa over m3/s: coefficients of increasing powers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve_polynomial: Vec<f64>,
    /// Largest flow of the polynomial, m3/s. Absent: where its head becomes zero.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve_v_flow_max_m3_s: Option<f64>,
    /// What the pump holds and its command means.
    #[serde(default)]
    pub mode: PumpMode,
    /// Mass flow commanded while nothing else drives it, kg/s, with `mode = "flow"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub m_flow_set_kg_s: Option<f64>,
    /// Head commanded while nothing else drives it, Pa, with `mode = "head"`; with
    /// `mode = "proportional_head"` that from the design flow on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub head_pa: Option<f64>,
    /// Flow from which on a proportional head is `head_pa`, kg/s. Absent: where the curve at full speed has
    /// this head.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub m_flow_design_kg_s: Option<f64>,
    /// Share of `head_pa` that a proportional head has at zero flow. Absent: half of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub zero_flow_share: Option<f64>,
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
    /// Time in which the speed, or what else is commanded, follows a step by 99.6 %, s.
    #[serde(default = "default_rise_time")]
    pub rise_time_s: f64,
    /// Hydraulic efficiency.
    #[serde(default = "default_efficiency")]
    pub efficiency_hydraulic: f64,
    /// Motor efficiency.
    #[serde(default = "default_efficiency")]
    pub efficiency_motor: f64,
    /// Flows of the efficiency table at full speed, m3/s.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub efficiency_v_flow_m3_s: Vec<f64>,
    /// Overall efficiencies of the table, from wire to water, instead of the two constants.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub efficiency: Vec<f64>,
    /// Share of the electric power (without the standby power) that ends in the water: 1 for a wet
    /// rotor, `efficiency_motor` for a dry motor in the open. Absent: the pump does not warm the water.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heat_to_water: Option<f64>,
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
            curve_exponent: None,
            curve_v_flow_m3_s: Vec::new(),
            curve_head_pa: Vec::new(),
            curve_polynomial: Vec::new(),
            curve_v_flow_max_m3_s: None,
            mode: PumpMode::default(),
            m_flow_set_kg_s: None,
            head_pa: None,
            m_flow_design_kg_s: None,
            zero_flow_share: None,
            speed: 0.0,
            initial_speed: 0.0,
            speed_min: 0.0,
            speed_max: one(),
            rise_time_s: default_rise_time(),
            efficiency_hydraulic: default_efficiency(),
            efficiency_motor: default_efficiency(),
            efficiency_v_flow_m3_s: Vec::new(),
            efficiency: Vec::new(),
            heat_to_water: None,
            standby_w: 0.0,
            delta_m: default_delta_m(),
        }
    }
}

/// A pump ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct Pump {
    curve: HeadCurve,
    mode: PumpMode,
    proportional: Option<Proportional>,
    efficiency: Efficiency,
    heat_to_water: Option<f64>,
    standby_w: f64,
    actuator: Actuator,
    speed_min: f64,
    speed_max: f64,
}

impl PumpParams {
    /// The runtime pump.
    ///
    /// # Errors
    /// Names the field that is out of range, or the point at which the curve rises too far.
    pub fn build(&self, medium: &Medium) -> Result<Pump, ElementError> {
        let curve = self.head_curve(medium.density_kg_m3)?;
        let speed_max = positive("speed_max", self.speed_max)?;
        let proportional = self.proportional(&curve, speed_max, medium.density_kg_m3)?;
        let actuator = self.actuator(&curve, speed_max)?;
        let actuator = match proportional {
            // As at zero flow, until a flow is known.
            Some(line) => Actuator {
                initial_position: line.head_pa(actuator.initial_command, 0.0),
                ..actuator
            },
            None => actuator,
        };
        Ok(Pump {
            proportional,
            curve,
            mode: self.mode,
            efficiency: self.overall_efficiency()?,
            heat_to_water: self
                .heat_to_water
                .map(|share| ratio("heat_to_water", share))
                .transpose()?,
            standby_w: not_negative("standby_w", self.standby_w)?,
            actuator,
            speed_min: self.speed_min,
            speed_max,
        })
    }

    /// What is commanded: the speed, or the flow or head up to what the curve has at full speed. Only a
    /// speed starts elsewhere than where its command leads.
    fn actuator(&self, curve: &HeadCurve, speed_max: f64) -> Result<Actuator, ElementError> {
        let within = |field, value, max, requirement| {
            if (0.0..=max).contains(&value) {
                Ok(value)
            } else {
                Err(ElementError::OutOfRange { field, value, requirement })
            }
        };
        let mut speeds = [0.0; 3];
        for (i, (field, value)) in [
            ("speed", self.speed),
            ("initial_speed", self.initial_speed),
            ("speed_min", self.speed_min),
        ]
        .into_iter()
        .enumerate()
        {
            speeds[i] = within(field, value, speed_max, "must lie between 0 and speed_max")?;
        }
        let (position, unit, max) = match self.mode {
            PumpMode::Speed => ("speed", "", speed_max),
            PumpMode::Flow => ("m_flow_set_kg_s", "kg_s", speed_max * curve.m_free_kg_s),
            PumpMode::Head | PumpMode::ProportionalHead => {
                ("head_pa", "pa", speed_max * speed_max * curve.head_max_pa)
            }
        };
        let foreign = [
            (
                "speed, initial_speed and speed_min",
                speeds.iter().any(|&s| s != 0.0),
                &[PumpMode::Speed][..],
            ),
            ("m_flow_set_kg_s", self.m_flow_set_kg_s.is_some(), &[PumpMode::Flow]),
            ("head_pa", self.head_pa.is_some(), &[PumpMode::Head, PumpMode::ProportionalHead]),
        ];
        if let Some((fields, ..)) =
            foreign.iter().find(|(_, given, modes)| *given && !modes.contains(&self.mode))
        {
            return Err(ElementError::Fields {
                problem: format!("{fields} given, but by its mode this pump holds {position}"),
            });
        }
        let requirement = "must lie between 0 and what the curve has at full speed";
        let initial_command = match self.mode {
            PumpMode::Speed => self.speed,
            PumpMode::Flow => {
                within("m_flow_set_kg_s", self.m_flow_set_kg_s.unwrap_or(0.0), max, requirement)?
            }
            PumpMode::Head | PumpMode::ProportionalHead => {
                within("head_pa", self.head_pa.unwrap_or(0.0), max, requirement)?
            }
        };
        let starts_at_its_command = self.mode != PumpMode::Speed;
        Ok(Actuator {
            position,
            command: position,
            unit,
            initial_command,
            initial_position: if starts_at_its_command {
                initial_command
            } else {
                self.initial_speed
            },
            rise_time_s: not_negative("rise_time_s", self.rise_time_s)?,
            min: 0.0,
            max,
        })
    }
}

impl Pump {
    /// The relative speed at which the pump has `p_a - p_b = dp_pa` at a flow: the nearest one within
    /// its limits.
    pub fn speed_at(&self, m_flow_kg_s: f64, dp_pa: f64, density_kg_m3: f64) -> f64 {
        self.curve.speed_at(m_flow_kg_s, dp_pa, density_kg_m3, self.speed_max)
    }

    /// Whether the losses of the pump warm the water that passes.
    pub fn warms_water(&self) -> bool {
        self.heat_to_water.is_some()
    }

    /// The relative speed at a flow: commanded, or what the mode leads to.
    pub fn speed(&self, m_flow_kg_s: f64, state: &EdgeState) -> f64 {
        match self.mode {
            PumpMode::Speed => state.position,
            PumpMode::Flow | PumpMode::Head | PumpMode::ProportionalHead => {
                let dp_pa = self.loss(m_flow_kg_s, state).value;
                self.speed_at(m_flow_kg_s, dp_pa, state.density_kg_m3)
            }
        }
    }

    fn loss(&self, m: f64, state: &EdgeState) -> Linear {
        self.mode.loss(&self.curve, m, state.position, state.density_kg_m3, self.speed_max)
    }

    /// Hydraulic power, W, zero where the pump is off or a resistance, and the efficiency.
    fn pumping(&self, m: f64, state: &EdgeState) -> (f64, f64) {
        let (head, v) = (-self.loss(m, state).value, m / state.density_kg_m3);
        if m <= 0.0 || head <= 0.0 {
            return (0.0, 1.0);
        }
        let speed = self.speed(m, state);
        if speed > 0.0 { (v * head, self.efficiency.at(v / speed)) } else { (0.0, 1.0) }
    }
}

impl TwoPort for Pump {
    fn characteristic(&self, m: f64, state: &EdgeState) -> Characteristic {
        Characteristic::PressureLoss(self.loss(m, state))
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        0.5 * self.curve.m_free_kg_s
    }

    fn actuator(&self) -> Option<Actuator> {
        Some(self.actuator)
    }

    fn target_position(&self, command: f64) -> f64 {
        let target = command.clamp(0.0, self.actuator.max);
        if self.mode == PumpMode::Speed && target < self.speed_min { 0.0 } else { target }
    }

    fn follows_flow(&self) -> bool {
        self.proportional.is_some()
    }

    fn target_at_flow(&self, command: f64, m: f64) -> f64 {
        let target = self.target_position(command);
        self.proportional.map_or(target, |line| line.head_pa(target, m))
    }

    fn note(&self) -> Option<&str> {
        self.curve.note.as_deref()
    }

    fn electric_power_w(&self, m: f64, state: &EdgeState) -> Option<f64> {
        let (hydraulic_w, efficiency) = self.pumping(m, state);
        Some(self.standby_w + hydraulic_w / efficiency)
    }

    fn heat_to_water_w(&self, m: f64, state: &EdgeState) -> f64 {
        let Some(share) = self.heat_to_water else { return 0.0 };
        let (hydraulic_w, efficiency) = self.pumping(m, state);
        (share * hydraulic_w / efficiency - hydraulic_w).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(speed: f64) -> EdgeState {
        EdgeState { position: speed, density_kg_m3: 1000.0, viscosity_pa_s: 1e-3 }
    }

    fn head(pump: &Pump, m: f64, speed: f64) -> f64 {
        -pump.curve.loss(m, speed, 1000.0).value
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
    fn efficiency_follows_the_flow_and_the_losses_heat_the_water() {
        let params = PumpParams {
            efficiency_v_flow_m3_s: vec![0.0, 4e-4, 9e-4],
            efficiency: vec![0.0, 0.4, 0.2],
            standby_w: 3.0,
            heat_to_water: Some(1.0),
            ..PumpParams::default()
        };
        let pump = params.build(&Medium::default()).unwrap();
        // 0.4 l/s at full speed: H = 40221 - 4.72972e4 * 0.16 = 32653.4 Pa, V H = 13.06138 W,
        // P = 32.65344 W + 3 W; the water gets 32.65344 - 13.06138 = 19.59206 W.
        assert!((pump.electric_power_w(0.4, &state(1.0)).unwrap() - 35.65344).abs() < 1e-3);
        assert!((pump.heat_to_water_w(0.4, &state(1.0)) - 19.59206).abs() < 1e-3);
        // Half speed at half the flow has the same efficiency and an eighth of the power.
        let running = pump.electric_power_w(0.2, &state(0.5)).unwrap() - 3.0;
        assert!((running - 32.65344 / 8.0).abs() < 1e-3);
        // Off, or driven backwards, nothing but the standby power, and no heat.
        assert_eq!(pump.electric_power_w(0.2, &state(0.0)), Some(3.0));
        assert_eq!(pump.heat_to_water_w(-0.2, &state(1.0)), 0.0);
        // A dry motor, eta_m = 0.7 of 0.49: 0.7 P - V H = V H (0.7/0.49 - 1)
        let dry = PumpParams { heat_to_water: Some(0.7), ..PumpParams::default() };
        let dry = dry.build(&Medium::default()).unwrap();
        assert!((dry.heat_to_water_w(0.4, &state(1.0)) - 13.06138 * 0.428_571).abs() < 1e-3);
        let silent = PumpParams::default().build(&Medium::default()).unwrap();
        assert_eq!(silent.heat_to_water_w(0.4, &state(1.0)), 0.0);
        let params = PumpParams { efficiency: vec![70.0, 60.0, 50.0], ..params };
        assert_eq!(params.build(&Medium::default()).unwrap_err().field(), Some("efficiency"));
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
            let law = |m| pump.curve.loss(m, 1.0, 1000.0);
            anergy_core::testing::check_monotone(law, &flows).unwrap();
        }
    }

    /// A pump with a table at 0, 0.1 and 0.2 l/s.
    fn of_table(heads: [f64; 3]) -> Result<Pump, ElementError> {
        let params = PumpParams {
            head_max_pa: None,
            free_flow_m3_s: None,
            curve_v_flow_m3_s: vec![0.0, 1e-4, 2e-4],
            curve_head_pa: heads.to_vec(),
            ..PumpParams::default()
        };
        params.build(&Medium::default())
    }

    #[test]
    fn a_curve_that_rises_a_little_is_repaired_and_says_so() {
        // The nearest falling heads to 100, 104: their mean 102 twice, but tilted by 0.1 % of 100 Pa
        // over 0.2 l/s, 0.05 Pa per point: 102.025 and 101.975. Farthest: 104 - 101.975 = 2.025 Pa.
        let pump = of_table([100.0, 104.0, 50.0]).unwrap();
        assert!((head(&pump, 0.0, 1.0) - 102.025).abs() < 1e-9);
        assert!((head(&pump, 0.1, 1.0) - 101.975).abs() < 1e-9);
        assert!((head(&pump, 0.2, 1.0) - 50.0).abs() < 1e-9);
        let note = pump.note().unwrap();
        assert!(note.contains("104 Pa at 1.0000e-4 m3/s follow 100 Pa"), "{note}");
        assert!(note.contains("at most 2 Pa (2.03 % of"), "{note}");
        assert_eq!(of_table([100.0, 90.0, 50.0]).unwrap().note(), None);
        // 100 and 130 become 115: 15 % are too much.
        let error = of_table([100.0, 130.0, 50.0]).unwrap_err().to_string();
        assert!(error.starts_with("curve_head_pa") && error.contains("15 Pa away"), "{error}");
    }

    fn of_polynomial(coefficients: &[f64], end: Option<f64>) -> Result<Pump, ElementError> {
        let params = PumpParams {
            head_max_pa: None,
            free_flow_m3_s: None,
            curve_polynomial: coefficients.to_vec(),
            curve_v_flow_max_m3_s: end,
            ..PumpParams::default()
        };
        params.build(&Medium::default())
    }

    #[test]
    fn polynomials_end_where_their_head_does() {
        // H = 4e4 (1 - x - x^2 + x^3) with x = V/1 l/s: (1 - x)^2 (1 + x), zero at x = 1 only, twice;
        // with a linear term of -1.2 the zero is a simple one below 1.
        let scaled = |c: [f64; 4]| {
            let powers = c.iter().enumerate().map(|(i, c)| 4e4 * c * 1e3_f64.powi(i as i32));
            powers.collect::<Vec<f64>>()
        };
        let pump = of_polynomial(&scaled([1.0, -1.2, -1.0, 1.0]), None).unwrap();
        // x = 0.5: 1 - 0.6 - 0.25 + 0.125 = 0.275
        assert!((head(&pump, 0.5, 1.0) - 11_000.0).abs() < 1e-6);
        // Half speed, same x at 0.25 l/s: a quarter.
        assert!((head(&pump, 0.25, 0.5) - 2_750.0).abs() < 1e-6);
        let m_free = pump.curve.m_free_kg_s;
        let x = m_free;
        assert!((1.0 - 1.2 * x - x * x + x * x * x).abs() < 1e-12, "{x}");
        // No zero: the end must be given, and the curve goes on straight behind it.
        let open = scaled([1.0, -1.0, 0.5, 0.0]);
        let error = of_polynomial(&open, None).unwrap_err().to_string();
        assert!(error.contains("curve_v_flow_max_m3_s"), "{error}");
        let pump = of_polynomial(&open, Some(0.8e-3)).unwrap();
        // x = 0.8: 1 - 0.8 + 0.32 = 0.52, slope -0.2
        assert!((head(&pump, 0.8, 1.0) - 4e4 * 0.52).abs() < 1e-6);
        assert!((head(&pump, 0.9, 1.0) - 4e4 * 0.50).abs() < 1e-6);
        // Rising by up to 1 % before it falls: 1 + 0.2 x - x^2 has its top at x = 0.1.
        let pump = of_polynomial(&scaled([1.0, 0.2, -1.0, 0.0]), None).unwrap();
        assert!(pump.note().unwrap().contains("% of the head at zero flow"));
        assert!((head(&pump, 0.6, 1.0) - 4e4 * 0.76).abs() < 4e4 * 1e-5);
        let flows: Vec<f64> = (-300..=1500).map(|i| f64::from(i) * 1e-3).collect();
        anergy_core::testing::check_monotone(|m| pump.curve.loss(m, 1.0, 1000.0), &flows).unwrap();
    }

    #[test]
    fn power_law_with_any_exponent() {
        // H0 40 kPa, free flow 1 l/s, n = 1.5: at 0.25 l/s 40 (1 - 0.125) = 35 kPa; at half speed and
        // 0.125 l/s a quarter of it; beyond the free flow with the slope -1.5 * 40 kPa s/l.
        let of = |exponent| {
            let params = PumpParams {
                head_max_pa: Some(4e4),
                free_flow_m3_s: Some(1e-3),
                curve_exponent: Some(exponent),
                ..PumpParams::default()
            };
            params.build(&Medium::default()).unwrap()
        };
        let pump = of(1.5);
        assert!((head(&pump, 0.25, 1.0) - 35_000.0).abs() < 1e-6);
        assert!((head(&pump, 0.125, 0.5) - 8_750.0).abs() < 1e-6);
        assert!((head(&pump, 1.1, 1.0) + 6_000.0).abs() < 1e-6);
        assert!((head(&pump, -0.25, 1.0) - 45_000.0).abs() < 1e-6);
        let quadratic = PumpParams {
            head_max_pa: Some(4e4),
            free_flow_m3_s: Some(1e-3),
            ..PumpParams::default()
        };
        assert_eq!(of(2.0), quadratic.build(&Medium::default()).unwrap());
    }

    #[test]
    fn a_head_belongs_to_a_speed() {
        let table = of_table([100.0, 90.0, 50.0]).unwrap();
        for pump in [table, PumpParams::default().build(&Medium::default()).unwrap()] {
            for speed in [0.0, 0.02, 0.3, 0.99] {
                let dp = -head(&pump, 0.05, speed);
                let found = pump.speed_at(0.05, dp, 1000.0);
                assert!((found - speed).abs() < 1e-7, "{found} for {speed}");
            }
            assert_eq!(pump.speed_at(0.05, -1e9, 1000.0), 1.0);
            assert_eq!(pump.speed_at(0.05, 1e9, 1000.0), 0.0);
        }
    }

    /// The published pump in a mode, at full speed 402.21 hPa and 0.9222 kg/s.
    fn in_mode(mode: PumpMode) -> Pump {
        PumpParams { mode, ..PumpParams::default() }.build(&Medium::default()).unwrap()
    }

    #[test]
    fn a_flow_is_held_while_the_speed_allows_it() {
        let pump = in_mode(PumpMode::Flow);
        let set = state(0.4);
        let head = |m: f64| -pump.loss(m, &set).value;
        // Any head between rest (-4.72972e4 * 0.16 = -7567.5 Pa) and full speed (32653.5 Pa) belongs to
        // the set flow within 1e-4.
        assert!(head(0.4 * (1.0 - 1e-4)) > 30_000.0 && head(0.4 * (1.0 + 1e-4)) < -7_000.0);
        assert!(head(0.4).abs() < 1.0);
        // Away from it the pump is at full speed or at rest: at 0.3 kg/s 40221 - 4256.7 = 35964.3 Pa,
        // at 0.5 kg/s -11824.3 Pa.
        assert!((head(0.3) - 35_964.3).abs() < 0.1, "{}", head(0.3));
        assert!((head(0.5) + 11_824.3).abs() < 0.1, "{}", head(0.5));
        assert!((pump.speed(0.3, &set) - 1.0).abs() < 1e-6);
        assert!(pump.speed(0.5, &set) < 1e-3);
        // Half way, head 0 at 0.4 kg/s: u^2 H0 = 7567.5 Pa, u = 0.43377.
        assert!((pump.speed(0.4, &set) - 0.43377).abs() < 1e-4);
        // P = V H/0.49 at the head where the pump really is: 20 kPa belongs to 0.39998 kg/s.
        let m = 0.4 * (1.0 - 1e-4 * 20_000.0 / 40_221.0);
        assert!((pump.electric_power_w(m, &set).unwrap() - 4e-4 * 20_000.0 / 0.49).abs() < 0.01);
        // Off, it is at rest.
        assert_eq!(pump.loss(0.0, &state(0.0)).value, 0.0);
        assert_eq!(pump.loss(0.2, &state(0.0)), pump.curve.loss(0.2, 0.0, 1000.0));
    }

    #[test]
    fn a_head_is_held_while_the_speed_allows_it() {
        let pump = in_mode(PumpMode::Head);
        let set = state(20_000.0);
        let head = |m: f64| -pump.loss(m, &set).value;
        // Droop 1e-3 * 20 kPa at 0.46108 kg/s: 20000 - 0.3/0.46108 * 20 = 19986.99 Pa
        assert!((head(0.3) - 19_986.99).abs() < 0.1, "{}", head(0.3));
        // u^2 H0 = 19986.99 + 4256.7 Pa: u = 0.77638
        assert!((pump.speed(0.3, &set) - 0.77638).abs() < 1e-4);
        // Full speed has 40221 - 4.72972e4 * 0.49 = 17045.4 Pa at 0.7 kg/s.
        assert!((head(0.7) - 17_045.4).abs() < 0.2, "{}", head(0.7));
        // Reverse flow: at rest it is resisted by 20 kPa at -0.65028 kg/s, so at -0.8 kg/s the pump
        // stands still, 30270.2 Pa.
        assert!((head(-0.8) - 30_270.2).abs() < 0.2, "{}", head(-0.8));
        assert!(pump.speed(-0.8, &set) < 1e-3);
        assert_eq!(pump.target_position(1e6), 40_221.0);
    }

    #[test]
    fn set_values_of_another_mode_are_refused() {
        let params =
            PumpParams { mode: PumpMode::Flow, head_pa: Some(1e4), ..PumpParams::default() };
        let error = params.build(&Medium::default()).unwrap_err().to_string();
        assert_eq!(error, "head_pa given, but by its mode this pump holds m_flow_set_kg_s");
        let params = PumpParams {
            mode: PumpMode::Flow,
            m_flow_set_kg_s: Some(5.0),
            ..PumpParams::default()
        };
        assert_eq!(params.build(&Medium::default()).unwrap_err().field(), Some("m_flow_set_kg_s"));
    }
}

//! The 36 published cases of weighted PI control: three bidirectional stations in line, seven hours, set heats
//! whose sum is zero (`licklederer2024`, restated in the repository's own words and numbers).
//!
//! A case is named by a letter for the pairing (A crossover, B same side, C mixed 1, D mixed 2), a number for
//! the network (1 without heat loss, 2 with, 3 with the small pump) and a letter for the weights (a none: each
//! loop one objective; b the usual thirds; c quarters).
//!
//! Set up as published, except that: the first head of the large pump is raised by 4 kPa, so that its curve
//! falls; the volume of water of the pump (3 s) is in the exchanger; the wall of the pipes is left out; the
//! published station has halves of half the diameter, which is the option [`Case::halved`].

use std::fmt::Write as _;

/// Times of the slots, s: each lasts to the next.
pub const SLOTS_S: [f64; 7] = [0.0, 3600.0, 7200.0, 10_800.0, 14_400.0, 18_000.0, 21_600.0];
/// Length of a slot, s.
pub const SLOT_S: f64 = 3600.0;
/// Set heats, kW: positive feeds in.
pub const SET_KW: [[f64; 7]; 3] = [
    [4.0, -4.0, 10.0, -10.0, -6.0, 6.0, 10.0],
    [-10.0, 10.0, -4.0, 4.0, 10.0, -10.0, -4.0],
    [6.0, -6.0, -6.0, 6.0, -4.0, 4.0, -6.0],
];
/// Wanted temperatures: hot primary and secondary, degC, and both differences, K.
pub const WANTED: [f64; 4] = [53.5, 50.0, 20.0, 20.0];

const LARGE_PUMP: [&str; 2] = [
    "[0, 1, 2, 4, 6, 8, 10, 10.77]",
    "[117757.14, 117679.8, 107873.15, 80414.53, 57859.235, 35303.94, 17651.97, 0]",
];
const SMALL_PUMP: [&str; 2] = ["[0, 3.45]", "[40530, 0]"];

/// One case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// A, B, C or D.
    pub pairing: char,
    /// 1, 2 or 3.
    pub network: u8,
    /// a, b or c.
    pub weights: char,
    /// Whether the halves of the station's pipe have half the diameter, as in the published library.
    pub halved: bool,
    /// Gain of the pump, published 1.5.
    pub pump_gain: f64,
    /// Step, s.
    pub step_s: f64,
}

impl Case {
    /// All 36.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for pairing in ['A', 'B', 'C', 'D'] {
            for network in 1..=3 {
                for weights in ['a', 'b', 'c'] {
                    all.push(Self::published(pairing, network, weights));
                }
            }
        }
        all
    }

    /// One of them.
    pub fn published(pairing: char, network: u8, weights: char) -> Self {
        Self { pairing, network, weights, halved: false, pump_gain: 1.5, step_s: 1.0 }
    }

    /// Its name, for example `A1b`.
    pub fn name(&self) -> String {
        format!("{}{}{}", self.pairing, self.network, self.weights)
    }

    /// Word of the pairing in a model file.
    pub fn variant(&self) -> &'static str {
        match self.pairing {
            'A' => "crossover",
            'B' => "same_side",
            'C' => "mixed_1",
            _ => "mixed_2",
        }
    }

    /// Whether the loops of feed-in and of extraction look after the other side.
    pub fn crossover(&self) -> [bool; 2] {
        [matches!(self.pairing, 'A' | 'D'), matches!(self.pairing, 'A' | 'C')]
    }

    /// Weights of the heat: primary and secondary loop of feed-in, then of extraction.
    pub fn alpha(&self) -> [[f64; 2]; 2] {
        let large = match self.weights {
            'a' => 1.0,
            'b' => 2.0 / 3.0,
            _ => 0.75,
        };
        let [fed, drawn] = self.crossover();
        let of = |primary_large: bool| {
            if primary_large { [large, 1.0 - large] } else { [1.0 - large, large] }
        };
        [of(fed), of(!drawn)]
    }

    /// The model.
    pub fn text(&self) -> String {
        let resistance = if self.network == 2 { 5.0 } else { 1e5 };
        let [flows, heads] = if self.network == 3 { SMALL_PUMP } else { LARGE_PUMP };
        let diameter_mm = if self.halved { 11 } else { 22 };
        let [fed, drawn] = self.alpha();
        let mut text = format!(
            r#"format = 1

[model]
name = "weighted PI control, case {}"

[run]
until = "7h"
step = "{}s"
record = "10s"
initial_degc = 40

[fluid]
kind = "constant_water"
density_kg_m3 = 995.586
heat_capacity_j_kg_k = 4184
viscosity_pa_s = 1e-3

[ground]
temperature_degc = 12

[pipe_type.line]
inner_diameter_mm = 22
roughness_mm = 0.011
zeta = 3.5
insulation_resistance_k_m_w = {resistance}

[station_type.published]
kind = "bidirectional"
stub = {{ length_m = 5, inner_diameter_mm = {diameter_mm}, roughness_mm = 0.011, zeta = 1.75, insulation_resistance_k_m_w = {resistance} }}
heat_exchanger = {{ dp_nominal_pa = 15500, m_flow_nominal_kg_s = 0.358, ua_w_k = 6034, flow_exponent = 0.6, volume_l = 1 }}
feed_in_pump = {{ curve_v_flow_m3_h = {flows}, curve_head_pa = {heads}, rise_time_s = 8, speed = 0 }}
feed_in_check_valve = {{ kvs_m3_h = 11, leakage = 1e-3, m_flow_nominal_kg_s = 0.358 }}
extraction_valve = {{ kvs_m3_h = 2.5, leakage = 2e-3, command = "kappa", kappa = 0, stroke_time_s = 35, m_flow_nominal_kg_s = 0.358 }}
extraction_check_valve = {{ kvs_m3_h = 11, leakage = 1e-3, m_flow_nominal_kg_s = 0.358 }}

[[trench]]
from = "b1"
to = "b2"
length_m = 100
pipe = "line"

[[trench]]
from = "b2"
to = "b3"
length_m = 100
pipe = "line"

[pressure_reference]
node = "b1.hot"
pressure_bar = 1.5
"#,
            self.name(),
            self.step_s,
        );
        for (i, set_kw) in SET_KW.iter().enumerate() {
            let site = format!("b{}", i + 1);
            let points = |value: &dyn Fn(f64) -> f64| {
                let points: Vec<String> = SLOTS_S
                    .iter()
                    .zip(set_kw)
                    .map(|(t_s, kw)| format!("[{t_s}, {}]", value(*kw)))
                    .collect();
                points.join(", ")
            };
            let sent = |kw: f64| if kw > 0.0 { 55.0 } else { 30.0 };
            let _ = write!(
                text,
                r#"
[[site]]
id = "{site}"
x_m = {}
y_m = 0

[[station]]
site = "{site}"
type = "published"

[[unit]]
site = "{site}"
kind = "ideal_house"
sent_degc = {}

[[controller]]
kind = "weighted_pi"
station = "{site}.station"
variant = "{}"
feed_in_primary_gain = {}
feed_in_primary_alpha = {}
feed_in_secondary_alpha = {}
extraction_primary_alpha = {}
extraction_secondary_alpha = {}
start_share = 1

[[schedule]]
signal = "{site}.controller.q_flow_w"
unit = "kW"
interpolation = "hold"
points = [{}]

[[schedule]]
signal = "{site}.unit.sent_k"
unit = "degC"
interpolation = "hold"
points = [{}]
"#,
                100 * i,
                sent(set_kw[0]),
                self.variant(),
                self.pump_gain,
                fed[0],
                fed[1],
                drawn[0],
                drawn[1],
                points(&|kw| kw),
                points(&sent),
            );
        }
        text
    }
}

//! A coil in the tank: water that passes the layers without mixing with theirs.
//!
//! **Equation** layer by layer from the inlet, `T_out,i = T_l + (T_in,i - T_l) exp(-(U A)_i/(m cp))` with the
//! area divided by the height; `U = U_0 (|m|/m_nom)^a (|dT|/dT_nom)^b`, by default constant. The content of
//! the coil, if it has one, is mixed at its outlet while water flows, and meets its layers while it stands.
//! **Assumptions** no storage in the wall of the coil. **Numerics** a layer is warmed by a stream of constant
//! temperature exactly over a part of a step, so no part is too long for the coil; all of it is linear in
//! the temperature of the inlet.
//!
//! **Sources** effectiveness of an exchanger with one well mixed side, `incropera2007`.

use super::layers::Cells;
use anergy_core::port::PortFlow;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A coil as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StorageCoil {
    /// Area of its surface, m2.
    pub area_m2: f64,
    /// Heat transfer coefficient at nominal flow and temperature difference, W/(m2 K).
    #[serde(default = "default_transfer")]
    pub u_w_m2_k: f64,
    /// Volume of the water in it, m3.
    #[serde(default)]
    pub volume_m3: f64,
    /// Height above the bottom at which its water enters, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inlet_m: Option<f64>,
    /// Height above the bottom at which its water leaves, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outlet_m: Option<f64>,
    /// Layer at which its water enters, counted from 1 at the bottom, instead of a height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inlet_layer: Option<usize>,
    /// Layer at which its water leaves, counted from 1 at the bottom, instead of a height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outlet_layer: Option<usize>,
    /// Flow at which `u_w_m2_k` holds, and that is expected until water has flowed, kg/s.
    #[serde(default = "default_flow")]
    pub m_flow_nominal_kg_s: f64,
    /// Exponent of the flow in the heat transfer coefficient.
    #[serde(default)]
    pub flow_exponent: f64,
    /// Temperature difference at which `u_w_m2_k` holds, K.
    #[serde(default = "default_difference")]
    pub nominal_difference_k: f64,
    /// Exponent of the difference of inlet and mean layer in the heat transfer coefficient.
    #[serde(default)]
    pub difference_exponent: f64,
}

fn default_transfer() -> f64 {
    675.0
}

fn default_flow() -> f64 {
    0.1
}

fn default_difference() -> f64 {
    10.0
}

/// A coil ready to run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Coil {
    /// Share of the area in each layer.
    pub(super) share: Vec<f64>,
    /// Whether its water rises at positive flow.
    pub(super) rises: bool,
    pub(super) ua_nominal_w_k: f64,
    pub(super) content_kg: f64,
    pub(super) m_flow_nominal_kg_s: f64,
    pub(super) flow_exponent: f64,
    pub(super) nominal_difference_k: f64,
    pub(super) difference_exponent: f64,
}

/// The outlet over a part of a step as a line over the temperature of the inlet, K.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Line {
    pub(super) constant_k: f64,
    pub(super) of_inlet: f64,
}

impl Line {
    pub(super) fn at(&self, t_in_k: f64) -> f64 {
        self.constant_k + self.of_inlet * t_in_k
    }
}

impl Coil {
    fn ua_w_k(&self, m_flow_kg_s: f64, difference_k: f64) -> f64 {
        let mut ua = self.ua_nominal_w_k;
        if self.flow_exponent != 0.0 {
            ua *= (m_flow_kg_s.abs() / self.m_flow_nominal_kg_s).powf(self.flow_exponent);
        }
        if self.difference_exponent != 0.0 {
            ua *= (difference_k.abs() / self.nominal_difference_k).powf(self.difference_exponent);
        }
        ua
    }

    /// Share of the inlet that reaches the outlet, and the outlet, if the cells stay as they are.
    pub(super) fn at_rest<const N: usize>(
        &self,
        cells: &Cells<N>,
        share: &[f64],
        stream: &PortFlow,
        heat_capacity_j_kg_k: f64,
    ) -> Line {
        let mut unmoved = cells.clone();
        self.warm(&mut unmoved, share, stream, heat_capacity_j_kg_k, 0.0)
    }

    /// Passes a stream through the cells for a part of a step; returns where it leaves their surfaces.
    pub(super) fn warm<const N: usize>(
        &self,
        cells: &mut Cells<N>,
        share: &[f64],
        stream: &PortFlow,
        heat_capacity_j_kg_k: f64,
        dt_s: f64,
    ) -> Line {
        let capacity_w_k = stream.m_flow_kg_s.abs() * heat_capacity_j_kg_k;
        let mean_k: f64 = (0..cells.count).map(|i| share[i] * cells.t_k[i]).sum();
        let ua_w_k = self.ua_w_k(stream.m_flow_kg_s, stream.t_in_k - mean_k);
        let mut line = Line { constant_k: 0.0, of_inlet: 1.0 };
        let rises = self.rises == (stream.m_flow_kg_s >= 0.0);
        for step in 0..cells.count {
            let i = if rises { step } else { cells.count - 1 - step };
            if share[i] <= 0.0 {
                continue;
            }
            let effectiveness = -(-ua_w_k * share[i] / capacity_w_k).exp_m1();
            let c_j_k = cells.mass_kg[i] * heat_capacity_j_kg_k;
            // The cell goes to the temperature of the stream with the rate m cp effectiveness/C; the mean
            // over the part of what the stream gives up of its difference:
            let x = capacity_w_k * effectiveness * dt_s / c_j_k;
            let approach = -(-x).exp_m1();
            let given = if x > 1e-9 { effectiveness * approach / x } else { effectiveness };
            let (before_k, stream_k) = (cells.t_k[i], line.at(stream.t_in_k));
            line.constant_k += given * (before_k - line.constant_k);
            line.of_inlet -= given * line.of_inlet;
            cells.t_k[i] = before_k + (stream_k - before_k) * approach;
        }
        line
    }

    /// The content of the coil over a part of a step in which water of a temperature reaches it; returns the
    /// outlet.
    pub(super) fn flush(
        &self,
        content_k: &mut f64,
        arriving: Line,
        stream: &PortFlow,
        dt_s: f64,
    ) -> Line {
        if self.content_kg <= 0.0 {
            return arriving;
        }
        let x = stream.m_flow_kg_s.abs() * dt_s / self.content_kg;
        let of_content = if x > 1e-9 { -(-x).exp_m1() / x } else { 1.0 };
        let arriving_k = arriving.at(stream.t_in_k);
        let line = Line {
            constant_k: of_content * *content_k + (1.0 - of_content) * arriving.constant_k,
            of_inlet: (1.0 - of_content) * arriving.of_inlet,
        };
        *content_k = arriving_k + (*content_k - arriving_k) * (-x).exp();
        line
    }

    /// The content of the coil and its cells while no water flows.
    pub(super) fn stand<const N: usize>(
        &self,
        content_k: &mut f64,
        cells: &mut Cells<N>,
        share: &[f64],
        heat_capacity_j_kg_k: f64,
        dt_s: f64,
    ) {
        if self.content_kg <= 0.0 {
            return;
        }
        let mean_k: f64 = (0..cells.count).map(|i| share[i] * cells.t_k[i]).sum();
        let rate = self.ua_nominal_w_k / (self.content_kg * heat_capacity_j_kg_k);
        let risen_k = (mean_k - *content_k) * -(-rate * dt_s).exp_m1();
        *content_k += risen_k;
        for (i, share) in share.iter().enumerate().take(cells.count) {
            cells.t_k[i] -= risen_k * self.content_kg * share / cells.mass_kg[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CP: f64 = 4180.0;

    fn coil(content_kg: f64) -> Coil {
        Coil {
            share: vec![0.5, 0.5],
            rises: false,
            ua_nominal_w_k: 836.0,
            content_kg,
            m_flow_nominal_kg_s: 0.1,
            flow_exponent: 0.0,
            nominal_difference_k: 10.0,
            difference_exponent: 0.0,
        }
    }

    fn tank() -> Cells<4> {
        let mut cells = Cells::empty();
        cells.push(100.0, 20.0);
        cells.push(100.0, 40.0);
        cells
    }

    #[test]
    fn a_stream_through_two_layers() {
        // 0.1 kg/s: 418 W/K; NTU 1 per layer. 80 degC into 40: 40 + 40/e = 54.715; into 20: 20 +
        // 34.715/e = 32.771.
        let stream = PortFlow { m_flow_kg_s: 0.1, t_in_k: 80.0, t_out_k: 0.0 };
        let line = coil(0.0).at_rest(&tank(), &[0.5, 0.5], &stream, CP);
        assert!((line.at(80.0) - 32.771).abs() < 1e-3, "{line:?}");
        assert!((line.of_inlet - (-2.0_f64).exp()).abs() < 1e-12);
        // Reversed it meets 20 first: 20 + 60/e = 42.073; then 40 + 2.073/e = 40.763.
        let back = PortFlow { m_flow_kg_s: -0.1, ..stream };
        assert!(
            (coil(0.0).at_rest(&tank(), &[0.5, 0.5], &back, CP).at(80.0) - 40.763).abs() < 1e-3
        );
    }

    #[test]
    fn heat_of_the_coil_is_in_the_layers_for_any_part() {
        let stream = PortFlow { m_flow_kg_s: 0.1, t_in_k: 80.0, t_out_k: 0.0 };
        for dt_s in [1.0, 60.0, 3600.0, 1e6] {
            let mut cells = tank();
            let line = coil(0.0).warm(&mut cells, &[0.5, 0.5], &stream, CP, dt_s);
            let given = 418.0 * (80.0 - line.at(80.0)) * dt_s;
            let taken = (cells.content_kg_k() - 6000.0) * CP;
            assert!((given - taken).abs() < 1e-9 * taken.abs(), "{dt_s}: {given} {taken}");
            assert!((20.0..=80.0).contains(&line.at(80.0)) && cells.t_k[1] <= 80.0);
        }
    }

    #[test]
    fn content_of_a_coil() {
        // 10 kg at 20 degC, 0.1 kg/s of 60 degC for 100 s: one content, mean 60 - 40 (1 - 1/e)/1 = 34.715.
        let stream = PortFlow { m_flow_kg_s: 0.1, t_in_k: 60.0, t_out_k: 0.0 };
        let arriving = Line { constant_k: 0.0, of_inlet: 1.0 };
        let mut content = 20.0;
        let line = coil(10.0).flush(&mut content, arriving, &stream, 100.0);
        assert!((line.at(60.0) - 34.715).abs() < 1e-3);
        assert!((content - (60.0 - 40.0 / 1.0_f64.exp())).abs() < 1e-9);
        // What it stored is what did not leave: 10 (45.285 - 20) = 10 kg (60 - 34.715).
        assert!((content - 20.0 - (60.0 - line.at(60.0))).abs() < 1e-9);
        // At rest it goes to the mean of its layers, 30 degC, and heat stays.
        let mut cells = tank();
        let before = 10.0 * content + cells.content_kg_k();
        coil(10.0).stand(&mut content, &mut cells, &[0.5, 0.5], CP, 1e5);
        assert!((10.0 * content + cells.content_kg_k() - before).abs() < 1e-9);
        assert!((content - 30.0).abs() < 1e-9);
    }
}

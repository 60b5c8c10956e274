//! An electric rod in the tank.
//!
//! **Equation** `Q = share P`, evenly over the stretch of the height it fills; with steps the share is
//! rounded down to one that exists. **Assumptions** its own thermostat sees the mean of its stretch: off at
//! the set temperature or at the highest one, on again when it is colder by the hysteresis. No water of its
//! stretch is heated beyond the highest temperature, and only the electricity for what it heats is drawn. **Validity** a rod whose
//! own heat capacity is small.

use super::layers::Cells;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A rod as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StorageRod {
    /// Electric power, W.
    pub power_w: f64,
    /// Height above the bottom at which it begins, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bottom_m: Option<f64>,
    /// Height above the bottom at which it ends, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub top_m: Option<f64>,
    /// The layer it is in, counted from 1 at the bottom, instead of the heights.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layer: Option<usize>,
    /// Steps of its power, none if it is continuous.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steps: Option<u32>,
    /// Temperature at which it is shut off, K.
    #[serde(default = "default_max")]
    pub t_max_k: f64,
    /// How much colder it must be before it heats again, K.
    #[serde(default = "default_hysteresis")]
    pub hysteresis_k: f64,
}

fn default_max() -> f64 {
    368.15
}

fn default_hysteresis() -> f64 {
    10.0
}

/// A rod ready to run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Rod {
    /// Share of its heat in each layer.
    pub(super) share: Vec<f64>,
    pub(super) power_w: f64,
    pub(super) steps: Option<u32>,
    pub(super) t_max_k: f64,
    pub(super) hysteresis_k: f64,
}

impl Rod {
    /// What it draws when it is on, W.
    pub(super) fn wanted_w(&self, share: f64) -> f64 {
        let share = share.clamp(0.0, 1.0);
        self.power_w
            * match self.steps {
                // A share that is a step up to rounding is that step.
                Some(steps) => (share * f64::from(steps) + 1e-9).floor() / f64::from(steps),
                None => share,
            }
    }

    /// Heats for a part of a step; `blocked` is its thermostat. Returns the electricity, J.
    pub(super) fn heat<const N: usize>(
        &self,
        cells: &mut Cells<N>,
        share: &[f64],
        (wanted_w, set_k): (f64, f64),
        heat_capacity_j_kg_k: f64,
        dt_s: f64,
        blocked: &mut bool,
    ) -> f64 {
        let limit_k = set_k.min(self.t_max_k);
        let capacity_j_k = |i: usize| cells.mass_kg[i] * heat_capacity_j_kg_k;
        let seen_k: f64 = (0..cells.count).map(|i| share[i] * cells.t_k[i]).sum();
        if seen_k >= limit_k {
            *blocked = true;
        } else if seen_k <= limit_k - self.hysteresis_k {
            *blocked = false;
        }
        if *blocked || wanted_w <= 0.0 {
            return 0.0;
        }
        let wanted_j = wanted_w * dt_s;
        // What it sees rises by sum share^2/C per heat.
        let seen_k_j: f64 = (0..cells.count).map(|i| share[i] * share[i] / capacity_j_k(i)).sum();
        let mut heat_j = wanted_j.min((limit_k - seen_k) / seen_k_j);
        for i in (0..cells.count).filter(|i| share[*i] > 0.0) {
            let room_j = capacity_j_k(i) * (self.t_max_k - cells.t_k[i]);
            heat_j = heat_j.min(room_j.max(0.0) / share[i]);
        }
        if heat_j < wanted_j {
            *blocked = true;
        }
        for (i, share) in share.iter().enumerate().take(cells.count) {
            cells.t_k[i] += heat_j * share / (cells.mass_kg[i] * heat_capacity_j_kg_k);
        }
        heat_j
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thermostat_and_steps() {
        let rod = Rod {
            share: vec![0.0, 1.0],
            power_w: 6000.0,
            steps: Some(3),
            t_max_k: 368.15,
            hysteresis_k: 10.0,
        };
        assert_eq!(
            [0.0, 0.3, 0.34, 0.7, 1.0, 7.0].map(|s| rod.wanted_w(s)),
            [0.0, 0.0, 2000.0, 4000.0, 6000.0, 6000.0]
        );
        let mut cells = Cells::<4>::empty();
        cells.push(50.0, 350.0);
        cells.push(50.0, 350.0);
        let mut blocked = false;
        let mut heat = |cells: &mut Cells<4>, set_k: f64, dt_s: f64| {
            rod.heat(cells, &[0.0, 1.0], (6000.0, set_k), 4180.0, dt_s, &mut blocked)
        };
        // 6 kW for 209 s: 1.254 MJ, 6 K in 50 kg.
        assert_eq!(heat(&mut cells, 400.0, 209.0), 1.254e6);
        assert!((cells.t_k[1] - 356.0).abs() < 1e-12 && cells.t_k[0] == 350.0);
        // To the limit of 368.15 K only: 12.15 K * 209 kJ/K = 2.53935 MJ.
        assert!((heat(&mut cells, 400.0, 3600.0) - 2.539_35e6).abs() < 1e-3);
        assert!((cells.t_k[1] - 368.15).abs() < 1e-9);
        cells.t_k[1] = 358.5;
        assert_eq!(heat(&mut cells, 400.0, 1.0), 0.0);
        cells.t_k[1] = 358.0;
        assert_eq!(heat(&mut cells, 400.0, 1.0), 6000.0);
        // A set temperature below.
        assert_eq!(heat(&mut cells, 350.0, 1.0), 0.0);
    }
}

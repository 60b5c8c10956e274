//! A performance map as a table over modulation, source temperature and water temperature.
//!
//! **Equation** linear between the neighbouring points of every axis (multilinear), the end values beyond.
//! **Assumptions** as good as the data: heat and electricity are interpolated, their ratio follows.
//! **Validity** the range of the axes; a table with one modulation scales heat and electricity with the modulation.
//! **Sources** data sheets by EN 14511.

use super::{Operation, Performance};

/// Which water temperature a map is over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Water {
    /// The one that arrives.
    Return,
    /// The one that leaves.
    Supply,
}

/// A table ready to be asked. Values lie in the order modulation, source, water, the last running fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct MapTable {
    pub(super) modulation: Vec<f64>,
    pub(super) source_k: Vec<f64>,
    pub(super) water_k: Vec<f64>,
    pub(super) water: Water,
    pub(super) useful_w: Vec<f64>,
    pub(super) electric_w: Vec<f64>,
}

/// Lower of the two neighbours and the share of the upper one; the end points beyond the axis.
fn between(axis: &[f64], x: f64) -> (usize, f64) {
    let last = axis.len() - 1;
    if last == 0 || x <= axis[0] {
        return (0, 0.0);
    }
    if x >= axis[last] {
        return (last - 1, 1.0);
    }
    let i = axis.partition_point(|point| *point <= x) - 1;
    (i, (x - axis[i]) / (axis[i + 1] - axis[i]))
}

impl MapTable {
    /// Heat or cold and electricity.
    pub fn at(&self, operation: &Operation) -> Performance {
        let water_k = match self.water {
            Water::Return => operation.return_k,
            Water::Supply => operation.supply_k,
        };
        let (i, of_i) = between(&self.modulation, operation.modulation);
        let (j, of_j) = between(&self.source_k, operation.source_in_k);
        let (k, of_k) = between(&self.water_k, water_k);
        let mut sum = Performance::default();
        for corner in 0..8_usize {
            let weight = |bit: usize, share: f64| match corner & bit {
                0 => 1.0 - share,
                _ => share,
            };
            let weight = weight(4, of_i) * weight(2, of_j) * weight(1, of_k);
            if weight == 0.0 {
                continue;
            }
            let (i, j, k) = (i + (corner >> 2), j + ((corner >> 1) & 1), k + (corner & 1));
            let at = (i * self.source_k.len() + j) * self.water_k.len() + k;
            sum.useful_w += weight * self.useful_w[at];
            sum.electric_w += weight * self.electric_w[at];
        }
        if let [_] = self.modulation[..] {
            let m = operation.modulation.clamp(0.0, 1.0);
            return Performance { useful_w: m * sum.useful_w, electric_w: m * sum.electric_w };
        }
        sum
    }

    /// The smallest modulation that the table knows.
    pub fn modulation_min(&self) -> f64 {
        match self.modulation[..] {
            [_] => 0.0,
            _ => self.modulation[0],
        }
    }
}

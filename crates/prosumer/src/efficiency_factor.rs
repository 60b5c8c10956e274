//! How much better or worse a generator is than its map says, at all loads and at part load.
//!
//! **Equation** `eta = f g(load) eta_map`, where `g` is straight between factors at 20, 40 and 60 % of the load and 1 at full load; below
//! 20 % it stays. Heat is that of the map: fuel or electricity change. **Validity** any load.

use crate::thermal_unit::UnitError;

/// The loads at which factors are given.
const LOADS: [f64; 4] = [0.2, 0.4, 0.6, 1.0];

/// A factor over the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EfficiencyFactor {
    at_loads: [f64; 4],
}

impl EfficiencyFactor {
    /// From the fields `efficiency_factor` and `part_load_factor` of a unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub(crate) fn new(level: f64, part_load: &[f64]) -> Result<Self, UnitError> {
        crate::thermal_unit::positive("efficiency_factor", level)?;
        let field = "part_load_factor";
        if !matches!(part_load.len(), 0 | 3) {
            let problem = format!(
                "{field} has {} values: give three, at 20, 40 and 60 % of the load",
                part_load.len()
            );
            return Err(UnitError::Within { field, problem });
        }
        let mut at_loads = [level; 4];
        for (at, factor) in at_loads.iter_mut().zip(part_load) {
            *at *= crate::thermal_unit::positive(field, *factor)?;
        }
        Ok(Self { at_loads })
    }

    /// The factor at a load.
    pub(crate) fn at(&self, load: f64) -> f64 {
        let right = LOADS.partition_point(|known| *known <= load);
        match right {
            0 => self.at_loads[0],
            4.. => self.at_loads[3],
            _ => {
                let share = (load - LOADS[right - 1]) / (LOADS[right] - LOADS[right - 1]);
                let (a, b) = (self.at_loads[right - 1], self.at_loads[right]);
                a + share * (b - a)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_straight_between_the_loads() {
        let factor = EfficiencyFactor::new(0.9, &[0.8, 1.0, 1.1]).unwrap();
        for (load, expected) in
            [(0.1, 0.72), (0.2, 0.72), (0.3, 0.81), (0.5, 0.945), (0.8, 0.945), (1.0, 0.9)]
        {
            assert!((factor.at(load) - expected).abs() < 1e-12, "{load}: {}", factor.at(load));
        }
        let none = EfficiencyFactor::new(1.0, &[]).unwrap();
        assert!([0.0, 0.3, 0.7, 1.0].iter().all(|load| none.at(*load) == 1.0));
        assert!(EfficiencyFactor::new(1.0, &[1.0]).is_err());
    }
}

//! The metal of a boiler beside its burner: what it has stored comes out with the water that passes, or goes into it.
//!
//! **Equation** `C dT/dt = -m cp (1 - exp(-K/(m cp))) (T - T_in)`: metal of one temperature along the way of the water. What the burner
//! stores in metal while it starts and stops is in the tables of start and stop; this is what a change of the return
//! temperature, or a pause, has left.
//!
//! **Assumptions** metal keeps its temperature while no water passes. **Validity** steps of any length: exact with the flow and the
//! return temperature of the step before; water that passes an idle boiler leaves no hotter or colder than its metal, however much
//! less it is than in the step before. **Sources** lumped capacity, `carslaw1959`; capacity and conductance assumed.

/// The metal of a boiler. Its state: temperature, K; flow in the last step, kg/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Metal {
    /// Heat capacity, J/K.
    pub heat_capacity_j_k: f64,
    /// Conductance to the water, W/K.
    pub conductance_w_k: f64,
}

impl Metal {
    /// None where there is nothing to store.
    pub(super) fn new(heat_capacity_j_k: f64, conductance_w_k: f64) -> Option<Self> {
        (heat_capacity_j_k > 0.0).then_some(Self { heat_capacity_j_k, conductance_w_k })
    }

    /// Mean heat into the water over a step over how much hotter the metal begins than the water enters, W/K: water of this heat
    /// capacity flow.
    pub(super) fn w_k(&self, capacity_w_k: f64, dt_s: f64) -> f64 {
        if capacity_w_k <= 0.0 {
            return 0.0;
        }
        let into_w_k = -capacity_w_k * (-self.conductance_w_k / capacity_w_k).exp_m1();
        let x = into_w_k * dt_s / self.heat_capacity_j_k;
        let mean = if x > 1e-9 { -(-x).exp_m1() / x } else { 1.0 };
        into_w_k * mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metal_gives_what_it_holds_over_entering_water_and_no_more() {
        let metal = Metal { heat_capacity_j_k: 5000.0, conductance_w_k: 100.0 };
        // 400 W/K: 400 (1 - exp(-0.25)) = 88.480 W/K at first.
        assert!((metal.w_k(400.0, 0.0) - 88.480).abs() < 0.001);
        // 5000/88.480 = 56.51 s: over 60 s 1 - exp(-1.06176) = 0.65415 of 5000 J/K, 54.51 W/K.
        assert!((metal.w_k(400.0, 60.0) - 54.51).abs() < 0.01);
        // All of it, over a long step.
        assert!((metal.w_k(400.0, 1e6) - 0.005).abs() < 1e-10);
        assert_eq!(metal.w_k(0.0, 60.0), 0.0);
        assert_eq!(Metal::new(0.0, 100.0), None);
    }
}

//! A circuit of a house: one stream of water through the ports of several units, back to the first.
//!
//! **Equation** every member states its outlet as a linear function of its inlet, `T_out = c + f T_in`; the water
//! comes round unchanged, so the inlet of the first is `T = c' + f' T` with the composed function. **Assumptions**
//! the flow is what the pump wants (thermal only: no pressure); the water in the pipes of the house has no
//! volume. **Numerics** exact: what one member gives off the others take up, to rounding. A limit of a
//! temperature is held by trying, at most three times per member. **Validity** some member must hold the
//! temperature: between members that only add heat it is undefined.

use anergy_core::port::{Outlet, PortFlow, PortRequest};

/// Below this share of the inlet that is not kept, the temperature of a circuit is undefined.
pub(crate) const LEAST_HOLD: f64 = 1e-12;

/// Ports in the order of the flow.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Circuit {
    /// Slots of the ports.
    pub members: Vec<usize>,
    /// The member whose unit sets the flow; `None` where the circuit has its own pump.
    pub driver: Option<usize>,
}

/// A circuit in which nothing holds the temperature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Undefined;

/// What limits the temperature of a member that gives off heat.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Limit {
    None,
    /// The coldest, or the hottest outlet.
    Bound,
    Passes,
}

/// Limits of the members of one circuit, two bits each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Limits(u128);

/// As many members as their limits have bits for.
pub const MOST_MEMBERS: usize = 64;

impl Limits {
    pub(crate) fn of(self, member: usize) -> Limit {
        match (self.0 >> (2 * member)) & 3 {
            0 => Limit::None,
            1 => Limit::Bound,
            _ => Limit::Passes,
        }
    }

    pub(crate) fn set(&mut self, member: usize, limit: Limit) {
        self.0 = self.0 & !(3 << (2 * member)) | ((limit as u128) << (2 * member));
    }
}

/// `c` and `f` of a member that is passed in its direction.
pub(crate) fn relation(outlet: &Outlet, limit: Limit, capacity_w_k: f64) -> (f64, f64) {
    let warmed = |q_w: f64| if capacity_w_k > 0.0 { (q_w / capacity_w_k, 1.0) } else { (0.0, 1.0) };
    match *outlet {
        Outlet::Temperature(t_k) | Outlet::Ends { b_k: t_k, .. } => (t_k, 0.0),
        Outlet::HeatFlow(q_w) => warmed(q_w),
        Outlet::Linear { constant_k, of_inlet } => (constant_k, of_inlet),
        Outlet::Exchange { w_k, other_k } => Outlet::of_exchange(w_k, other_k, capacity_w_k),
        Outlet::Stirred { t_k, heat_w, heat_capacity_j_k, dt_s } => {
            Outlet::of_stirred(t_k, heat_w, heat_capacity_j_k, dt_s, capacity_w_k)
        }
        Outlet::Cooled { .. } | Outlet::Warmed { .. } => {
            let (q_w, bound_k) = bounded(outlet).unwrap_or_default();
            match limit {
                Limit::None => warmed(q_w),
                Limit::Bound => (bound_k, 0.0),
                Limit::Passes => (0.0, 1.0),
            }
        }
    }
}

/// Which limit acts on a member that water reaches with a temperature; `None` where it has none.
pub(crate) fn limit_at(outlet: &Outlet, t_k: f64, capacity_w_k: f64) -> Option<Limit> {
    let (q_w, bound_k) = bounded(outlet)?;
    let (c, f) = relation(&Outlet::HeatFlow(q_w), Limit::None, capacity_w_k);
    // Away from the bound, whichever side it is on.
    let sign = if q_w > 0.0 { -1.0 } else { 1.0 };
    Some(match sign * (c + f * t_k - bound_k) {
        0.0.. => Limit::None,
        _ if sign * (t_k - bound_k) > 0.0 => Limit::Bound,
        _ => Limit::Passes,
    })
}

/// Heat into the water and the temperature that its outlet does not pass.
pub(crate) fn bounded(outlet: &Outlet) -> Option<(f64, f64)> {
    match *outlet {
        Outlet::Cooled { wanted_w, coldest_k } => Some((-wanted_w, coldest_k)),
        Outlet::Warmed { wanted_w, hottest_k } => Some((wanted_w, hottest_k)),
        _ => None,
    }
}

impl Circuit {
    /// Flow, kg/s, given what the unit that sets it wants.
    pub fn m_flow_kg_s(&self, wanted: &[PortRequest]) -> f64 {
        self.driver.map_or(0.0, |slot| wanted[slot].m_flow_kg_s.abs())
    }

    /// The temperatures around the circuit with a flow; at zero flow what would arrive and leave first. Whether the limits of
    /// temperatures settled.
    ///
    /// # Errors
    /// [`Undefined`] when no member holds the temperature and heat is brought in.
    pub fn solve(
        &self,
        m_flow_kg_s: f64,
        heat_capacity_j_kg_k: f64,
        wanted: &[PortRequest],
        got: &mut [PortFlow],
    ) -> Result<bool, Undefined> {
        let capacity_w_k = m_flow_kg_s * heat_capacity_j_kg_k;
        let mut limits = Limits::default();
        let mut rounds = 3 * self.members.len();
        loop {
            let of = |member: usize| {
                relation(&wanted[self.members[member]].outlet, limits.of(member), capacity_w_k)
            };
            let (mut constant_k, mut of_inlet) = (0.0, 1.0);
            for member in 0..self.members.len() {
                let (c, f) = of(member);
                (constant_k, of_inlet) = (c + f * constant_k, f * of_inlet);
            }
            let defined = 1.0 - of_inlet > LEAST_HOLD;
            if !defined && constant_k != 0.0 {
                return Err(Undefined);
            }
            let mut t_k =
                if defined { constant_k / (1.0 - of_inlet) } else { got[self.members[0]].t_in_k };
            let mut next = limits;
            for member in 0..self.members.len() {
                let (c, f) = of(member);
                let slot = self.members[member];
                let t_out_k = c + f * t_k;
                if let Some(limit) = limit_at(&wanted[slot].outlet, t_k, capacity_w_k) {
                    next.set(member, limit);
                }
                got[slot] = PortFlow { m_flow_kg_s, t_in_k: t_k, t_out_k };
                t_k = t_out_k;
            }
            if next == limits || rounds == 0 {
                return Ok(next == limits);
            }
            limits = next;
            rounds -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CP: f64 = 4200.0;

    fn solved(m: f64, outlets: &[Outlet]) -> Result<Vec<PortFlow>, Undefined> {
        let circuit = Circuit { members: (0..outlets.len()).collect(), driver: Some(0) };
        let wanted: Vec<PortRequest> =
            outlets.iter().map(|outlet| PortRequest { m_flow_kg_s: m, outlet: *outlet }).collect();
        let mut got = vec![PortFlow { t_in_k: 290.0, ..PortFlow::default() }; outlets.len()];
        assert!(circuit.solve(circuit.m_flow_kg_s(&wanted), CP, &wanted, &mut got)?);
        let heat: f64 = got.iter().map(|got| m.abs() * CP * (got.t_out_k - got.t_in_k)).sum();
        assert!(heat.abs() < 1e-6, "{heat} W are left: {got:?}");
        Ok(got)
    }

    #[test]
    fn a_heat_pump_charges_a_store() {
        // 8 400 W into 0.4 kg/s from a layer of 35 degC: 35 + 8400/(0.4 4200) = 40 degC
        let got = solved(0.4, &[Outlet::HeatFlow(8400.0), Outlet::Temperature(308.15)]).unwrap();
        assert!((got[0].t_in_k - 308.15).abs() < 1e-9 && (got[1].t_in_k - 313.15).abs() < 1e-9);
    }

    #[test]
    fn a_radiator_between_a_boiler_and_nothing_else_finds_its_temperature() {
        // T_out = 293.15 + 0.5 (T_in - 293.15); the boiler adds 10 K: T_in = T_out + 10
        // T_in - 293.15 = 20 K
        let radiator = Outlet::Linear { constant_k: 0.5 * 293.15, of_inlet: 0.5 };
        let got = solved(0.1, &[Outlet::HeatFlow(4200.0), radiator]).unwrap();
        assert!((got[1].t_in_k - 313.15).abs() < 1e-9, "{got:?}");
        assert!((got[0].t_in_k - 303.15).abs() < 1e-9, "{got:?}");
    }

    #[test]
    fn water_is_not_cooled_below_its_limit_and_colder_water_passes() {
        // 0.1 kg/s from 300 K less 8 400 W would be 280 K
        let cooled = |coldest_k| Outlet::Cooled { wanted_w: 8400.0, coldest_k };
        let of = |coldest_k| {
            solved(0.1, &[cooled(coldest_k), Outlet::Temperature(300.0)]).unwrap()[0].t_out_k
        };
        assert!((of(270.0) - 280.0).abs() < 1e-9);
        assert!((of(290.0) - 290.0).abs() < 1e-9);
        assert!((of(310.0) - 300.0).abs() < 1e-9);
    }

    #[test]
    fn water_is_not_warmed_above_its_limit_and_hotter_water_passes() {
        let warmed = |hottest_k| Outlet::Warmed { wanted_w: 8400.0, hottest_k };
        let of = |hottest_k| {
            solved(0.1, &[warmed(hottest_k), Outlet::Temperature(300.0)]).unwrap()[0].t_out_k
        };
        assert!((of(330.0) - 320.0).abs() < 1e-9);
        assert!((of(310.0) - 310.0).abs() < 1e-9);
        assert!((of(290.0) - 300.0).abs() < 1e-9);
    }

    #[test]
    fn standing_water_shows_what_would_come() {
        let got = solved(0.0, &[Outlet::HeatFlow(0.0), Outlet::Temperature(308.15)]).unwrap();
        assert!(got[0].t_in_k == 308.15 && got[0].m_flow_kg_s == 0.0, "{got:?}");
    }

    #[test]
    fn heat_that_nothing_takes_is_an_error() {
        let heated = [Outlet::HeatFlow(10.0), Outlet::HeatFlow(0.0)];
        assert_eq!(solved(0.1, &heated), Err(Undefined));
        assert!(solved(0.1, &[Outlet::HeatFlow(0.0), Outlet::HeatFlow(0.0)]).is_ok());
    }
}

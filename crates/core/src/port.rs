//! The sign convention, once for the whole program.
//!
//! - Every edge has two ports, `a` and `b`. Nothing is an inlet or an outlet: direction is a result.
//! - `m_flow > 0` flows from a to b.
//! - `dp = p_a - p_b`: positive for a passive element with positive flow, negative across a
//!   running pump.
//! - A heat flow is positive into the water of the component.
//! - A station's flow is positive in feed-in (from the cold to the hot line), negative in extraction.

use serde::{Deserialize, Serialize};

/// One of the two ports of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Port {
    /// The port where positive flow enters.
    A,
    /// The port where positive flow leaves.
    B,
}

impl Port {
    /// The port through which the water enters an edge; port a at zero flow.
    #[inline]
    pub fn upstream(m_flow_kg_s: f64) -> Self {
        if m_flow_kg_s < 0.0 { Self::B } else { Self::A }
    }

    /// The other port.
    #[inline]
    pub fn opposite(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }
}

/// What a thermal unit wants of the stream through one of its ports.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PortRequest {
    /// Wanted flow, kg/s; positive feeds in (leaves the unit warm), negative extracts. Behind an
    /// exchanger its magnitude is the flow of the unit's own circulation.
    pub m_flow_kg_s: f64,
    /// What happens to the water on its way through the unit.
    pub outlet: Outlet,
}

/// What happens to water that passes a unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Outlet {
    /// It leaves with this temperature, K, at whichever end.
    Temperature(f64),
    /// It takes up this heat flow, W (negative: gives it off).
    HeatFlow(f64),
    /// It gives off heat, but is not cooled below a temperature; water that is colder stays as it is.
    Cooled {
        /// Heat flow that is wanted of it, W.
        wanted_w: f64,
        /// Lowest temperature at which it leaves, K.
        coldest_k: f64,
    },
    /// It takes up heat, but leaves no hotter than a temperature; water that is hotter stays as it is. The limit
    /// holds in circuits of houses and behind exchangers; water of the network itself takes up all of the heat.
    Warmed {
        /// Heat flow that is wanted into it, W.
        wanted_w: f64,
        /// Highest temperature at which it leaves, K.
        hottest_k: f64,
    },
    /// It leaves as what stands at that end: a store between two lines.
    Ends {
        /// Temperature at which it leaves through port a, where negative flow leaves, K.
        a_k: f64,
        /// Temperature at which it leaves through port b, where positive flow leaves, K.
        b_k: f64,
    },
    /// It exchanges heat with another stream, `w_k (other - T_in)` at any flow that can carry it.
    Exchange {
        /// Heat per difference of the two inlet temperatures, W/K.
        w_k: f64,
        /// Inlet temperature of the other stream, K.
        other_k: f64,
    },
    /// It passes a stirred content that is heated: it leaves as the content is on average over the step.
    Stirred {
        /// Temperature of the content at the start of the step, K.
        t_k: f64,
        /// Heat into it besides that of the water, W.
        heat_w: f64,
        /// Its heat capacity, J/K.
        heat_capacity_j_k: f64,
        /// Length of the step, s; 0 in a steady state.
        dt_s: f64,
    },
    /// It approaches a temperature: it leaves with `constant_k + of_inlet T_in`.
    Linear {
        /// What is added, K.
        constant_k: f64,
        /// Share of the inlet temperature that remains, 0 to 1.
        of_inlet: f64,
    },
}

impl Outlet {
    /// The heat flow into the water where no limit of the temperature acts, W; `None` where it depends on the
    /// temperature of the water.
    pub fn heat_flow_w(&self) -> Option<f64> {
        match *self {
            Self::Temperature(_)
            | Self::Ends { .. }
            | Self::Exchange { .. }
            | Self::Stirred { .. }
            | Self::Linear { .. } => None,
            Self::HeatFlow(q_w) | Self::Warmed { wanted_w: q_w, .. } => Some(q_w),
            Self::Cooled { wanted_w, .. } => Some(-wanted_w),
        }
    }

    /// Constant part and share of the inlet temperature with which a flow of this capacity, W/K, leaves an exchange.
    #[inline]
    pub fn of_exchange(w_k: f64, other_k: f64, capacity_w_k: f64) -> (f64, f64) {
        let share = if capacity_w_k > w_k { w_k / capacity_w_k } else { 1.0 };
        (share * other_k, 1.0 - share)
    }

    /// Constant part and share of the inlet temperature with which a flow of this capacity, W/K, leaves a stirred
    /// content: with `x = W dt/C` and `phi = (1 - e^-x)/x` it is `phi T_0 + (1 - phi) (T_in + Q/W)` on average.
    #[inline]
    pub fn of_stirred(
        t_k: f64,
        heat_w: f64,
        heat_capacity_j_k: f64,
        dt_s: f64,
        capacity_w_k: f64,
    ) -> (f64, f64) {
        if dt_s <= 0.0 {
            let steady = capacity_w_k > 0.0;
            return if steady { (heat_w / capacity_w_k, 1.0) } else { (t_k, 0.0) };
        }
        let x = capacity_w_k * dt_s / heat_capacity_j_k;
        // Below, the series of (1 - phi)/x is exact to rounding.
        let passed_of_x =
            if x > 1e-4 { (1.0 + (-x).exp_m1() / x) / x } else { 0.5 - x / 6.0 + x * x / 24.0 };
        let passed = passed_of_x * x;
        let warmed_k = heat_w * dt_s / heat_capacity_j_k * passed_of_x;
        ((1.0 - passed) * t_k + warmed_k, passed)
    }

    /// The temperature at which a flow leaves where it does not depend on the inlet, K.
    #[inline]
    pub fn temperature_k(&self, m_flow_kg_s: f64) -> Option<f64> {
        match *self {
            Self::Temperature(t_k) => Some(t_k),
            Self::Ends { a_k, .. } if m_flow_kg_s < 0.0 => Some(a_k),
            Self::Ends { b_k, .. } => Some(b_k),
            _ => None,
        }
    }
}

impl Default for PortRequest {
    fn default() -> Self {
        Self { m_flow_kg_s: 0.0, outlet: Outlet::HeatFlow(0.0) }
    }
}

/// What a unit got through one of its ports during a step; means over the step.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct PortFlow {
    /// Flow through the unit, kg/s, with the sign of [`PortRequest::m_flow_kg_s`].
    pub m_flow_kg_s: f64,
    /// Temperature of the water arriving at the unit, K.
    pub t_in_k: f64,
    /// Temperature of the water leaving the unit, K.
    pub t_out_k: f64,
}

//! The linear fits of the public database of heat pumps hplib.
//!
//! **Equation** with temperatures in degC: `P = P_ref (p1 T_in + p2 T_out + p3 + p4 T_amb)`, `COP = p1 T_in + p2
//! T_out + p3 + p4 T_amb` with their own coefficients, `Q = P COP`; `T_in` of the source that arrives, `T_out` of the
//! water that leaves, `T_amb` of the air outdoors, which is `T_in` where air is the source. Cooling the same with
//! EER, and the electricity of air of at least 25 degC.
//!
//! **Assumptions** a regulated unit (groups 1 to 3) was measured by EN 14825 with the load that belongs to the outdoor
//! temperature: its fit already has the part load, and the modulation here scales heat and electricity of that
//! point; its electricity is at least a quarter of that at -7 degC. An on/off unit (groups 4 to 6) knows no
//! modulation. Where the COP falls to 1 the electric rod of the database takes over with the reference heat.
//!
//! **Validity** straight lines, mean errors of 10 to 20 % in the database; source and supply within the points of
//! EN 14825. **Numerics** `p1` and `p4` of units with air are large and cancel. **Sources** `hplib2021`.

use super::{Operation, Performance, degc};

/// Coefficients of `T_in`, `T_out`, one and `T_amb`, temperatures in degC.
pub type Coefficients = [f64; 4];

/// A row of the database.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HplibFit {
    /// 1 air, 2 brine, 3 water, regulated; 4 air, 5 brine, 6 water, on/off.
    pub group: u8,
    /// Heat at the reference point, W (in cooling: not used).
    pub reference_heat_w: f64,
    /// Electricity at the reference point, W.
    pub reference_electric_w: f64,
    /// Electricity relative to it.
    pub electric: Coefficients,
    /// COP, or EER.
    pub ratio: Coefficients,
    /// Whether this is the cooling fit.
    pub cooling: bool,
}

fn line(p: &Coefficients, t_in: f64, t_out: f64, t_amb: f64) -> f64 {
    p[0] * t_in + p[1] * t_out + p[2] + p[3] * t_amb
}

/// Outdoor temperature at which the least electricity of a regulated unit is defined, degC.
const COLD_DEGC: f64 = -7.0;
/// Share of it.
const LEAST_SHARE: f64 = 0.25;
/// Lowest temperature of the air of the electricity in cooling, degC.
const COOLING_AIR_DEGC: f64 = 25.0;

impl HplibFit {
    /// Whether the source is air.
    pub fn of_air(&self) -> bool {
        matches!(self.group, 1 | 4)
    }

    /// Whether the compressor has a variable speed.
    pub fn regulated(&self) -> bool {
        self.group <= 3
    }

    /// An on/off unit has only its full speed.
    pub fn modulation_min(&self) -> f64 {
        if self.regulated() { 0.0 } else { 1.0 }
    }

    /// Heat or cold and electricity.
    pub fn at(&self, operation: &Operation) -> Performance {
        let (t_in, t_out) = (degc(operation.source_in_k), degc(operation.supply_k));
        let t_amb = if self.of_air() { t_in } else { degc(operation.ambient_k) };
        let m = if self.regulated() { operation.modulation.clamp(0.0, 1.0) } else { 1.0 };
        let ratio = line(&self.ratio, t_in, t_out, t_amb);
        let electric_w = |t_in: f64, t_amb: f64| {
            self.reference_electric_w * line(&self.electric, t_in, t_out, t_amb)
        };
        if self.cooling {
            let t_air = t_in.max(COOLING_AIR_DEGC);
            let electric_w = m * electric_w(t_air, t_air);
            if electric_w <= 0.0 || ratio < 1.0 {
                return Performance::default();
            }
            return Performance { useful_w: ratio * electric_w, electric_w };
        }
        if ratio <= 1.0 {
            let rod_w = m * self.reference_heat_w;
            return Performance { useful_w: rod_w, electric_w: rod_w };
        }
        let mut power_w = electric_w(t_in, t_amb);
        if self.regulated() {
            let coldest = match self.group {
                1 => electric_w(COLD_DEGC, COLD_DEGC),
                2 => electric_w(t_in, COLD_DEGC),
                _ => power_w,
            };
            power_w = power_w.max(LEAST_SHARE * coldest);
        }
        let power_w = m * power_w.max(0.0);
        Performance { useful_w: ratio * power_w, electric_w: power_w }
    }
}

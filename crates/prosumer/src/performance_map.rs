//! Performance maps of heat pumps: heat (or cold) and electric power over modulation and temperatures.
//!
//! **Equation** one of five forms: the reference air-source unit as a product of polynomials ([`mod@reference`]), the reference brine
//! unit as polynomials ([`brine`]), a table
//! ([`table`]), the linear fits of the public database hplib ([`hplib`]), a share of Carnot ([`carnot`]).
//! The heat taken from the source follows in every form from `Q_source = Q - eta_int P` in heating, the heat given
//! to the sink from `Q_sink = Q_cold + eta_int P` in cooling, never from a second map.
//!
//! **Assumptions** steady; what time does is in [`crate::compressor`]. **Validity** arguments are clamped to the
//! range of each form, except the fits of hplib, which are straight lines.
//!
//! **Numerics** a map may ask for temperatures that depend on its own result (of the supplied water, of the water
//! that leaves the evaporator): [`PerformanceMap::settled`] iterates over them, see there.
//!
//! **Sources** see each form.

pub mod brine;
pub mod carnot;
pub mod hplib;
pub mod params;
pub mod reference;
pub mod table;

use anergy_core::medium::ZERO_CELSIUS_K;

/// Where a heat pump works: temperatures in K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Operation {
    /// Share of the full speed of the compressor.
    pub modulation: f64,
    /// Air, brine or water that arrives at the source side (in cooling: at the side that takes up the heat), K.
    pub source_in_k: f64,
    /// The same where it leaves, K; air leaves as it came.
    pub source_out_k: f64,
    /// Water that arrives on the useful side, K.
    pub return_k: f64,
    /// Water that leaves on the useful side, K.
    pub supply_k: f64,
    /// Air outdoors, K.
    pub ambient_k: f64,
}

/// What a heat pump does in steady operation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Performance {
    /// Heat in heating, cold in cooling, W.
    pub useful_w: f64,
    /// Electricity of the compressor and its unit, W.
    pub electric_w: f64,
}

impl Performance {
    /// Useful heat per electricity; 0 without electricity.
    pub fn ratio(&self) -> f64 {
        if self.electric_w > 0.0 { self.useful_w / self.electric_w } else { 0.0 }
    }

    /// The same of a unit of another size.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self { useful_w: factor * self.useful_w, electric_w: factor * self.electric_w }
    }

    /// Heat that the other side gives in heating, or takes in cooling, W.
    pub fn other_side_w(&self, cooling: bool, heat_share: f64) -> f64 {
        let inside_w = heat_share * self.electric_w;
        if cooling { self.useful_w + inside_w } else { self.useful_w - inside_w }
    }

    /// Not more useful heat per electricity than `most`.
    fn capped(self, most: f64) -> Self {
        Self { electric_w: self.electric_w.max(self.useful_w / most), ..self }
    }
}

/// How the flow of one side follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stream {
    /// It leaves with the temperature at which it came: air.
    Unchanged,
    /// The temperature difference is held by the flow, as far as the limits of the flow let it.
    Difference {
        /// K, positive.
        difference_k: f64,
        /// Smallest capacity flow, W/K.
        least_w_k: f64,
        /// Largest capacity flow, W/K.
        most_w_k: f64,
    },
    /// The flow is held, W/K.
    Flow(f64),
}

impl Stream {
    /// The capacity flow with which a heat flow leaves, W/K.
    pub fn capacity_w_k(&self, heat_w: f64) -> f64 {
        match *self {
            Self::Unchanged => 0.0,
            Self::Difference { difference_k, least_w_k, most_w_k } => {
                (heat_w.abs() / difference_k).clamp(least_w_k, most_w_k)
            }
            Self::Flow(capacity_w_k) => capacity_w_k,
        }
    }

    /// The change of temperature by a heat flow into the water, K.
    fn change_k(&self, heat_w: f64) -> f64 {
        let capacity_w_k = self.capacity_w_k(heat_w);
        if capacity_w_k > 0.0 { heat_w / capacity_w_k } else { 0.0 }
    }
}

/// The two sides of a heat pump while its map is asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sides {
    /// Whether the useful side is cooled.
    pub cooling: bool,
    /// Air, brine or water that arrives at the source side, K.
    pub source_in_k: f64,
    /// Flow of the source side.
    pub source: Stream,
    /// Water that arrives on the useful side, K.
    pub return_k: f64,
    /// Flow of the useful side.
    pub useful: Stream,
    /// Air outdoors, K.
    pub ambient_k: f64,
    /// Share of the electricity that becomes heat of the refrigerant.
    pub heat_share: f64,
}

/// The map of one mode of a heat pump.
#[derive(Debug, Clone, PartialEq)]
pub enum PerformanceMap {
    /// The reference unit in heating.
    Reference(reference::ReferenceHeating),
    /// The reference unit in cooling.
    ReferenceCooling(reference::ReferenceCooling),
    /// Table.
    Table(table::MapTable),
    /// Fit of the database hplib.
    Hplib(hplib::HplibFit),
    /// Share of Carnot.
    Carnot(carnot::CarnotShare),
    /// The reference brine unit.
    Brine(brine::BrineFit),
}

/// Change of a temperature that no longer counts, K.
const SETTLED_K: f64 = 1e-9;
/// Rounds after which a map is taken as it is: the change shrinks at least by half a round once damped.
const MOST_ROUNDS: usize = 60;

impl PerformanceMap {
    /// Heat or cold and electricity where all temperatures are known.
    pub fn at(&self, operation: &Operation) -> Performance {
        match self {
            Self::Reference(map) => map.at(operation),
            Self::ReferenceCooling(map) => map.at(operation),
            Self::Table(map) => map.at(operation),
            Self::Hplib(map) => map.at(operation),
            Self::Carnot(map) => map.at(operation),
            Self::Brine(map) => map.at(operation),
        }
    }

    /// The smallest modulation that the form knows.
    pub fn modulation_min(&self) -> f64 {
        match self {
            Self::Reference(_) | Self::ReferenceCooling(_) => reference::MODULATION_MIN,
            Self::Table(map) => map.modulation_min(),
            Self::Hplib(map) => map.modulation_min(),
            Self::Carnot(_) => 0.0,
            Self::Brine(_) => 1.0,
        }
    }

    /// Heat or cold and electricity with the temperatures that they lead to.
    ///
    /// Both outlets are iterated, `T_supply = T_return +- Q/C` and `T_source,out = T_source,in -+ Q_source/C`. A
    /// warmer supply lowers the heat and a colder evaporator the heat taken from it, so the iteration swings round
    /// its answer; it is damped as soon as a round changes more than the one before.
    pub fn settled(&self, sides: &Sides, modulation: f64) -> (Performance, Operation) {
        let sign = if sides.cooling { -1.0 } else { 1.0 };
        let mut operation = Operation {
            modulation,
            source_in_k: sides.source_in_k,
            source_out_k: sides.source_in_k,
            return_k: sides.return_k,
            supply_k: sides.return_k,
            ambient_k: sides.ambient_k,
        };
        if let Stream::Difference { difference_k, .. } = sides.useful {
            operation.supply_k += sign * difference_k;
        }
        if let Stream::Difference { difference_k, .. } = sides.source {
            operation.source_out_k -= sign * difference_k;
        }
        let (mut before_k, mut share) = (f64::INFINITY, 1.0);
        for _ in 0..MOST_ROUNDS {
            let performance = self.at(&operation);
            let other_w = performance.other_side_w(sides.cooling, sides.heat_share);
            let supply_k = sides.return_k + sides.useful.change_k(sign * performance.useful_w);
            let source_out_k = sides.source_in_k + sides.source.change_k(-sign * other_w);
            let supply_change_k = supply_k - operation.supply_k;
            let source_change_k = source_out_k - operation.source_out_k;
            let change_k = supply_change_k.abs().max(source_change_k.abs());
            if change_k < SETTLED_K {
                break;
            }
            if change_k > 0.5 * before_k {
                share *= 0.5;
            }
            before_k = change_k;
            operation.supply_k += share * supply_change_k;
            operation.source_out_k += share * source_change_k;
        }
        (self.at(&operation), operation)
    }
}

/// K as degC, in which fits and published maps are given.
fn degc(t_k: f64) -> f64 {
    t_k - ZERO_CELSIUS_K
}

#[cfg(test)]
mod tests;

//! The seam between the solver and the hydraulic components.
//!
//! A component states what it imposes between its ports as a value and its slope over the mass flow.
//! The solver owns the equations, the matrix and the iteration; it never sees a component type, and
//! a component never sees the matrix.

use crate::film::nusselt;
use crate::graph::Regulation;
use anergy_core::linear::Linear;
use thiserror::Error;

/// What an edge imposes between its ports.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Characteristic {
    /// Pressure loss `p_a - p_b` in Pa and its slope in Pa s/kg over the mass flow; slope > 0 always.
    PressureLoss(Linear),
    /// The flow is given, the pressure difference follows.
    ImposedFlow {
        /// Mass flow from a to b, kg/s.
        m_flow_kg_s: f64,
    },
    /// The pressure difference is given, the flow follows (ideal head source). An edge that answers
    /// so once must always do.
    ImposedPressure {
        /// `p_a - p_b`, Pa.
        dp_pa: f64,
    },
}

/// Pressure losses of which the middle one holds: the law is `max(lower, min(line, upper))`, but for rounded
/// corners. The line is straight and steeper than the others, which it crosses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pieces {
    /// The least loss: what the component does at its one limit.
    pub lower: Linear,
    /// What it does between its limits.
    pub line: Linear,
    /// The largest loss: at the other limit.
    pub upper: Linear,
}

/// What an element is told about its edge at the moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeState {
    /// Actuator position: pump speed, valve opening, imposed flow or head.
    pub position: f64,
    /// Mean density of the water in the edge, kg/m3.
    pub density_kg_m3: f64,
    /// Mean dynamic viscosity, Pa s.
    pub viscosity_pa_s: f64,
}

/// How water passes through an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EdgeThermal {
    /// It leaves as it entered.
    Pass,
    /// It travels as moving parcels and loses heat.
    PlugFlow(PlugFlowPipe),
    /// It exchanges heat with a second stream, then passes a mixed volume.
    Exchanger(Exchanger),
}

/// Thermal data of a plug-flow pipe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlugFlowPipe {
    /// Water content, kg.
    pub water_kg: f64,
    /// Heat capacity of the wall, as kg of water; 0 without.
    pub wall_kg: f64,
    /// Where that heat is stored.
    pub wall: Wall,
    /// Heat capacity that moves as parcels, as kg of water: the water, and a wall in equilibrium with it.
    pub content_kg: f64,
    /// Time constant of the heat loss of water and wall together, s; infinite without loss.
    pub loss_time_constant_s: f64,
    /// Multiplies the heat loss while the water stands still.
    pub standstill_loss_factor: f64,
    /// Slower water stands still for that, kg/s.
    pub standing_kg_s: f64,
    /// Axial dispersion between the halves of the pipe, as a flow that is exchanged: `rho A D/L`, kg/s.
    pub dispersion_kg_s: f64,
}

/// How the wall of a pipe stores heat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wall {
    /// Not at all.
    None,
    /// In one mixed volume at port b.
    EndVolume,
    /// All along, at the temperature of the water.
    Equilibrium,
    /// All along, behind the film of the water.
    Film(Film),
}

/// The film between water and wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Film {
    /// Reynolds number over the mass flow, s/kg.
    pub re_per_kg_s: f64,
    /// Prandtl number.
    pub prandtl: f64,
    /// Heat conductance over the whole length by Nusselt number, as kg/s of water.
    pub per_nusselt_kg_s: f64,
}

impl Film {
    /// Heat conductance between water and wall over the whole length, as kg/s of water.
    pub fn conductance_kg_s(&self, m_flow_kg_s: f64) -> f64 {
        self.per_nusselt_kg_s * nusselt(self.re_per_kg_s * m_flow_kg_s.abs(), self.prandtl)
    }
}

impl PlugFlowPipe {
    /// Heat capacity of water and wall, as kg of water.
    pub fn capacity_kg(&self) -> f64 {
        self.water_kg + self.wall_kg
    }

    /// Time constant of the heat loss of water and wall together at a flow, s.
    #[inline]
    pub fn loss_time_constant_s(&self, m_flow_kg_s: f64) -> f64 {
        if m_flow_kg_s.abs() < self.standing_kg_s {
            self.loss_time_constant_s / self.standstill_loss_factor
        } else {
            self.loss_time_constant_s
        }
    }

    /// Whether the water is described by cells: it exchanges heat with what it passes.
    #[inline]
    pub fn has_cells(&self) -> bool {
        self.dispersion_kg_s > 0.0 || matches!(self.wall, Wall::Film(_))
    }

    /// Transfer units of the heat loss of the water in the steady state.
    pub fn steady_ntu(&self, m_flow_kg_s: f64) -> f64 {
        match self.wall {
            Wall::Film(_) => self.loss_kg_s(m_flow_kg_s) / m_flow_kg_s.abs(),
            // Transit time over time constant; the former is infinite for a rounding error of a flow (1e-320 kg/s).
            _ if self.loss_time_constant_s.is_infinite() => 0.0,
            _ => self.content_kg / m_flow_kg_s.abs() / self.loss_time_constant_s(m_flow_kg_s),
        }
    }

    /// Heat conductance from the water to the surroundings over the whole length, as kg/s of water.
    pub fn loss_kg_s(&self, m_flow_kg_s: f64) -> f64 {
        let outer = self.capacity_kg() / self.loss_time_constant_s(m_flow_kg_s);
        match self.wall {
            Wall::None | Wall::Equilibrium => outer,
            Wall::EndVolume => outer * self.water_kg / self.capacity_kg(),
            Wall::Film(film) => {
                let inner = film.conductance_kg_s(m_flow_kg_s);
                inner * outer / (inner + outer)
            }
        }
    }
}

/// Thermal data of a heat exchanger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exchanger {
    /// Heat transfer coefficient times area at nominal flows, W/K.
    pub ua_nominal_w_k: f64,
    /// Exponent of the flow dependence of both film coefficients; 0 for a constant UA.
    pub flow_exponent: f64,
    /// Nominal flow of this edge, kg/s.
    pub m_flow_nominal_kg_s: f64,
    /// Nominal flow of the other stream, kg/s.
    pub m_flow_nominal_secondary_kg_s: f64,
    /// Counter-flow (true) or parallel flow (false) at nominal directions.
    pub counter_flow: bool,
    /// Where `|1 - Cmin/Cmax|` is below this, `NTU/(1 + NTU)` is used.
    pub equal_capacity_band: f64,
    /// Mixed water volume of this side and half of the wall as water of the same capacity, kg.
    pub volume_kg: f64,
    /// The wall's part of it, kg.
    pub wall_kg: f64,
}

/// A command and how the position follows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Actuator {
    /// Name of the position (`speed`, `opening`, `m_flow_kg_s`, `head_pa`).
    pub position: &'static str,
    /// Name of the command signal; differs from the position for linearised valve commands.
    pub command: &'static str,
    /// Suffix of the unit, empty for ratios.
    pub unit: &'static str,
    /// Command while nothing drives it.
    pub initial_command: f64,
    /// Position at the start of a run.
    pub initial_position: f64,
    /// Time after which the position has followed a step by 99.6 %, s; 0 follows at once.
    pub rise_time_s: f64,
    /// Smallest command.
    pub min: f64,
    /// Largest command.
    pub max: f64,
}

/// A hydraulic component between two nodes.
pub trait TwoPort {
    /// What the edge imposes at this flow (positive from a to b).
    fn characteristic(&self, m_flow_kg_s: f64, state: &EdgeState) -> Characteristic;

    /// Change of the pressure loss with the position at a given flow, Pa per unit of the position; zero
    /// where the position is itself the flow or the pressure difference, and where there is none. At a
    /// kink that of one side.
    fn loss_by_position(&self, _m_flow_kg_s: f64, _state: &EdgeState) -> f64 {
        0.0
    }

    /// The pieces of a law with corners sharper than a Newton step can foresee.
    fn pieces(&self, _m_flow_kg_s: f64, _state: &EdgeState) -> Option<Pieces> {
        None
    }

    /// Whether the law has such corners.
    fn has_corners(&self) -> bool {
        false
    }

    /// A typical flow, kg/s: start value of a cold solve.
    fn m_flow_nominal_kg_s(&self) -> f64;

    /// How water passes.
    fn thermal(&self) -> EdgeThermal {
        EdgeThermal::Pass
    }

    /// The command of this element, if it has one.
    fn actuator(&self) -> Option<Actuator> {
        None
    }

    /// The position that a command asks for in the end.
    fn target_position(&self, command: f64) -> f64 {
        self.actuator().map_or(command, |actuator| command.clamp(actuator.min, actuator.max))
    }

    /// Whether what a command asks for depends on the flow.
    fn follows_flow(&self) -> bool {
        false
    }

    /// The position that a command asks for at a flow.
    fn target_at_flow(&self, command: f64, _m_flow_kg_s: f64) -> f64 {
        self.target_position(command)
    }

    /// The pressure that the element holds by itself, if it does.
    fn regulation(&self) -> Option<Regulation> {
        None
    }

    /// Electric power drawn, W; `None` for elements without a motor.
    fn electric_power_w(&self, _m_flow_kg_s: f64, _state: &EdgeState) -> Option<f64> {
        None
    }

    /// Heat that the element itself gives to the water passing it, W: losses of a pump.
    fn heat_to_water_w(&self, _m_flow_kg_s: f64, _state: &EdgeState) -> f64 {
        0.0
    }

    /// What the author of the model should know of this element, for example how its curve had to be
    /// changed.
    fn note(&self) -> Option<&str> {
        None
    }

    /// Length along the route, m; zero for what is not a pipe.
    fn length_m(&self) -> f64 {
        0.0
    }

    /// Length over cross-section, 1/m: what the water inside withstands a change of its flow with, where the
    /// network counts inertia; zero for what is not a pipe.
    fn inertance_1_m(&self) -> f64 {
        0.0
    }
}

/// A parameter of an element that cannot be.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum ElementError {
    /// A number outside its range.
    #[error("{field} = {value} {requirement}")]
    OutOfRange {
        /// Field of the model file, in SI.
        field: &'static str,
        /// What was given.
        value: f64,
        /// For example `must be positive`.
        requirement: &'static str,
    },
    /// Two fields of which exactly one must be given, or a field that another one needs.
    #[error("{problem}")]
    Fields {
        /// Sentence naming the fields.
        problem: String,
    },
    /// A table that cannot carry a curve.
    #[error("{field}: {problem}")]
    Table {
        /// Field of the model file, in SI.
        field: &'static str,
        /// What is wrong with it.
        problem: String,
    },
}

impl ElementError {
    /// The field concerned, where one field is.
    pub fn field(&self) -> Option<&'static str> {
        match self {
            Self::OutOfRange { field, .. } | Self::Table { field, .. } => Some(field),
            Self::Fields { .. } => None,
        }
    }
}

/// `value` must be finite and positive.
///
/// # Errors
/// Names field and value.
pub fn positive(field: &'static str, value: f64) -> Result<f64, ElementError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(ElementError::OutOfRange { field, value, requirement: "must be positive" })
    }
}

/// `value` must be finite and not negative.
///
/// # Errors
/// Names field and value.
pub fn not_negative(field: &'static str, value: f64) -> Result<f64, ElementError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(ElementError::OutOfRange { field, value, requirement: "must not be negative" })
    }
}

/// `value` must lie in 0..=1.
///
/// # Errors
/// Names field and value.
pub fn ratio(field: &'static str, value: f64) -> Result<f64, ElementError> {
    if (0.0..=1.0).contains(&value) {
        Ok(value)
    } else {
        Err(ElementError::OutOfRange { field, value, requirement: "must lie between 0 and 1" })
    }
}

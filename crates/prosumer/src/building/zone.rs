//! A room of two elements: an exterior wall and the interior walls, after VDI 6007-1.
//!
//! **Equation** seven resistances and two capacities:
//! - air, without or with a capacity: convection `h A` to the surface of both elements, convective gains;
//! - exterior element: surface - `R` - capacity - `R_remaining` - outer surface - `h_out A` - outdoors;
//! - interior element: surface - `R` - capacity, nothing behind it;
//! - radiation between the surfaces `h_rad min(A_ext, A_int)`; radiative gains on the surfaces by their area.
//!
//! The ideal heater gives the air what keeps its mean over a step at the set point, within its limits.
//! **Assumptions** one temperature of the air; linear radiation; the walls of one kind in one element.
//! **Validity** time scales of hours to days, as the guideline says.
//! **Numerics** exact over a step, see [`super::rc`]. **Sources** `vdi6007`; checked against five of its cases
//! by `tests/prosumers/building.rs`.

use super::rc::{Node, RcNetwork};

/// One of the two elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Area of the surface in the room, m2.
    pub area_m2: f64,
    /// Convection between surface and air, W/(m2 K).
    pub convection_w_m2_k: f64,
    /// Resistance between surface and capacity, K/W.
    pub resistance_k_w: f64,
    /// Capacity, J/K.
    pub capacity_j_k: f64,
}

/// A room.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zone {
    /// Capacity of the air, J/K; 0: the air follows its surroundings at once.
    pub air_j_k: f64,
    /// Walls to the outside.
    pub exterior: Element,
    /// From the capacity of the exterior element to what is outside, with the outer film, K/W.
    pub outside_k_w: f64,
    /// Walls within.
    pub interior: Element,
    /// Radiation between surfaces, W/(m2 K).
    pub radiation_w_m2_k: f64,
}

/// Where the room is in its network.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ZoneNodes {
    /// The air.
    pub air: Node,
    exterior: Node,
    interior: Node,
    share_of_exterior: f64,
}

impl Zone {
    /// Puts the room into a network; outside is the boundary of an input.
    pub fn put(&self, network: &mut RcNetwork, outside: usize) -> ZoneNodes {
        let air = network.node(self.air_j_k);
        let mut surface = |element: &Element| {
            let (surface, mass) = (network.node(0.0), network.node(element.capacity_j_k));
            network.link(air, surface, element.convection_w_m2_k * element.area_m2);
            network.link(surface, mass, 1.0 / element.resistance_k_w);
            (surface, mass)
        };
        let (exterior, exterior_mass) = surface(&self.exterior);
        let (interior, _) = surface(&self.interior);
        network.boundary(exterior_mass, outside, 1.0 / self.outside_k_w);
        network.link(exterior, interior, self.radiation_w_k());
        let share_of_exterior =
            self.exterior.area_m2 / (self.exterior.area_m2 + self.interior.area_m2);
        ZoneNodes { air, exterior, interior, share_of_exterior }
    }

    fn radiation_w_k(&self) -> f64 {
        self.radiation_w_m2_k * self.exterior.area_m2.min(self.interior.area_m2)
    }

    /// Resistance between the air and the surface of the exterior element in a steady state, K/W: convection,
    /// and beside it radiation to the interior surface with the convection of that one.
    pub fn inner_film_k_w(&self) -> f64 {
        let convection = |element: &Element| element.convection_w_m2_k * element.area_m2;
        let by_radiation = 1.0 / (1.0 / self.radiation_w_k() + 1.0 / convection(&self.interior));
        1.0 / (convection(&self.exterior) + by_radiation)
    }
}

impl ZoneNodes {
    /// Heat of an input: a share of it radiation onto the surfaces, the rest into the air.
    pub fn gain(&self, network: &mut RcNetwork, input: usize, radiative: f64) {
        network.gain(self.air, input, 1.0 - radiative);
        network.gain(self.exterior, input, radiative * self.share_of_exterior);
        network.gain(self.interior, input, radiative * (1.0 - self.share_of_exterior));
    }
}

/// Heat that brings a mean temperature to its set point, W, within limits: `mean_k` without it, and what each
/// watt raises it by, K/W.
pub fn ideal_heat_w(set_k: f64, mean_k: f64, rise_k_w: f64, limits_w: (f64, f64)) -> f64 {
    ((set_k - mean_k) / rise_k_w).clamp(limits_w.0, limits_w.1)
}

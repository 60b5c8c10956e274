//! Three rooms in one network: the living area, the roof space above and the cellar below.
//!
//! **Equation** three rooms of two elements ([`super::zone`]); the top ceiling and the floor above the cellar are
//! conductances `U A` between their airs, windows and air exchange `V n rho cp` conductances to the outdoor air:
//! ```text
//! outer wall: capacity behind a tenth of the resistance; all resistances of a part sum to 1/(U A)
//! behind it: outdoor air and what the sun warms it, T_out + 0.5 I/25 W/(m2 K); ground around the cellar
//! ```
//! **Assumptions** after `prohmo`: 60 Wh/(m2 K) with the air of the living area (with furniture), 90 Wh/(m2 K) in its
//! inner walls; roof of tiles and boards, cellar of concrete (constants below, assumed); no long-wave exchange with
//! the sky. Window: no heat capacity. **Numerics** nine capacities, advanced exactly ([`super::rc`]).

use super::envelope::{Areas, UValues};
use super::rc::{Node, RcModel, RcNetwork};
use super::zone::{Element, Zone};

/// Most capacities.
pub const STATES: usize = 9;
/// The model of a house.
pub type HouseModel = RcModel<STATES, { Input::COUNT }, { Output::COUNT }>;

/// Inputs of the network of a house.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// Outdoor air, K.
    Outdoor,
    /// Outdoor air with what the sun adds at the walls, K.
    WallOutside,
    /// Outdoor air with what the sun adds at the roof, K.
    RoofOutside,
    /// Ground around the cellar, K.
    Ground,
    /// Sun through the windows, W.
    Sun,
    /// People and appliances, W.
    Internal,
    /// Emitter, W.
    Emitter,
    /// Heat into the air of the living area: more air exchange, W.
    Air,
    /// Heat into the air of the cellar, W.
    Cellar,
}

impl Input {
    /// How many.
    pub const COUNT: usize = 9;
}

/// Outputs of the network of a house: means over a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// Air of the living area, K.
    Living,
    /// Air of the roof space, K.
    Roof,
    /// Air of the cellar, K.
    Cellar,
    /// Heat from outdoors, W (usually negative).
    FromOutdoors,
    /// Heat from the ground, W.
    FromGround,
}

impl Output {
    /// How many.
    pub const COUNT: usize = 5;
}

/// Convection at outer walls and at inner walls, and radiation, W/(m2 K), as in the rooms of the guideline.
const OUTER_CONVECTION: f64 = 2.7;
const INNER_CONVECTION: f64 = 2.24;
const RADIATION: f64 = 5.0;
/// Film outside, W/(m2 K).
pub const OUTER_FILM_W_M2_K: f64 = 25.0;
/// Share of the resistance of a wall before its capacity, as in the rooms of the guideline.
const BEFORE_CAPACITY: f64 = 0.1;
/// Resistance between surface and capacity of inner walls, m2 K/W, as in the heavy room of the guideline.
const INNER_RESISTANCE: f64 = 0.045;
/// Inner surfaces (walls, floors, ceilings) per floor area.
const INNER_PER_FLOOR: f64 = 3.0;
/// Outer walls, J/(m2 K).
const WALL_CAPACITY: f64 = 150e3;
/// Roof of tiles on boards: U in W/(m2 K), capacity of itself and of the ceiling below, J/(m2 K).
const ROOF_U: f64 = 2.0;
const ROOF_CAPACITY: f64 = 30e3;
const CEILING_CAPACITY: f64 = 50e3;
/// Cellar of concrete with the soil near it: U in W/(m2 K), capacities in J/(m2 K).
const CELLAR_U: f64 = 0.6;
const CELLAR_CAPACITY: f64 = 300e3;
const CELLAR_WALLS_CAPACITY: f64 = 150e3;
/// Air exchange of roof space and cellar, 1/s.
const ROOF_EXCHANGE: f64 = 2.0 / 3600.0;
const CELLAR_EXCHANGE: f64 = 0.3 / 3600.0;
/// Heat capacity of air, J/(m3 K).
pub const AIR_J_M3_K: f64 = 1.2 * 1005.0;
/// Radiative share of the sun behind a window (VDI 6007-1) and of people and appliances.
const SUN_RADIATIVE: f64 = 0.91;
const INTERNAL_RADIATIVE: f64 = 0.5;

/// A house.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct House {
    /// Areas and volumes.
    pub areas: Areas,
    /// Heated area, m2.
    pub living_m2: f64,
    /// U-values of the living area.
    pub u: UValues,
    /// Air and furniture of the living area per heated area, J/(m2 K).
    pub air_j_m2_k: f64,
    /// Inner walls of the living area per heated area, J/(m2 K).
    pub inner_j_m2_k: f64,
    /// Air exchange of the living area that is always there, 1/s.
    pub exchange_1_s: f64,
    /// Radiative share of the emitter.
    pub emitter_radiative: f64,
}

/// A part whose U-value leaves nothing for the wall itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoWall;

/// A room with an outer element of area and U-value, W/(m2 K), and inner walls.
fn room(
    air_j_k: f64,
    (outer_m2, u_w_m2_k, outer_j_m2_k): (f64, f64, f64),
    (inner_m2, inner_j_k): (f64, f64),
    outer_film_w_m2_k: f64,
) -> Result<Zone, NoWall> {
    let element = |area_m2, convection_w_m2_k, resistance_k_w, capacity_j_k| Element {
        area_m2,
        convection_w_m2_k,
        resistance_k_w,
        capacity_j_k,
    };
    let mut zone = Zone {
        air_j_k,
        exterior: element(outer_m2, OUTER_CONVECTION, 0.0, outer_j_m2_k * outer_m2),
        outside_k_w: 0.0,
        interior: element(inner_m2, INNER_CONVECTION, INNER_RESISTANCE / inner_m2, inner_j_k),
        radiation_w_m2_k: RADIATION,
    };
    let outer_film = 1.0 / (outer_film_w_m2_k * outer_m2);
    let wall_k_w = 1.0 / (u_w_m2_k * outer_m2) - zone.inner_film_k_w() - outer_film;
    if wall_k_w <= 0.0 {
        return Err(NoWall);
    }
    zone.exterior.resistance_k_w = BEFORE_CAPACITY * wall_k_w;
    zone.outside_k_w = (1.0 - BEFORE_CAPACITY) * wall_k_w + outer_film;
    Ok(zone)
}

impl House {
    /// The network of the three rooms.
    ///
    /// # Errors
    /// When the U-value of the outer walls is above that of the films alone.
    pub fn model(&self) -> Result<HouseModel, NoWall> {
        let Areas { footprint_m2, .. } = self.areas;
        let living = room(
            self.air_j_m2_k * self.living_m2,
            (self.areas.wall_m2, self.u.wall_w_m2_k, WALL_CAPACITY),
            (INNER_PER_FLOOR * self.living_m2, self.inner_j_m2_k * self.living_m2),
            OUTER_FILM_W_M2_K,
        )?;
        let roof = room(
            self.areas.roof_m3 * AIR_J_M3_K,
            (self.areas.roof_m2, ROOF_U, ROOF_CAPACITY),
            (footprint_m2, CEILING_CAPACITY * footprint_m2),
            OUTER_FILM_W_M2_K,
        )?;
        let cellar = room(
            self.areas.cellar_m3 * AIR_J_M3_K,
            (self.areas.cellar_m2, CELLAR_U, CELLAR_CAPACITY),
            (footprint_m2, CELLAR_WALLS_CAPACITY * footprint_m2),
            f64::INFINITY,
        )?;
        let mut network = RcNetwork::default();
        let living = living.put(&mut network, Input::WallOutside as usize);
        let roof = roof.put(&mut network, Input::RoofOutside as usize);
        let cellar = cellar.put(&mut network, Input::Ground as usize);
        network.link(living.air, roof.air, self.u.ceiling_w_m2_k * footprint_m2);
        network.link(living.air, cellar.air, self.u.floor_w_m2_k * footprint_m2);
        let mut outdoors = |air: Node, conductance_w_k| {
            network.boundary(air, Input::Outdoor as usize, conductance_w_k);
        };
        let exchange = self.exchange_1_s * self.areas.living_m3 * AIR_J_M3_K;
        outdoors(living.air, self.u.window_w_m2_k * self.areas.window_m2 + exchange);
        outdoors(roof.air, ROOF_EXCHANGE * self.areas.roof_m3 * AIR_J_M3_K);
        outdoors(cellar.air, CELLAR_EXCHANGE * self.areas.cellar_m3 * AIR_J_M3_K);
        living.gain(&mut network, Input::Sun as usize, SUN_RADIATIVE);
        living.gain(&mut network, Input::Internal as usize, INTERNAL_RADIATIVE);
        living.gain(&mut network, Input::Emitter as usize, self.emitter_radiative);
        living.gain(&mut network, Input::Air as usize, 0.0);
        cellar.gain(&mut network, Input::Cellar as usize, 0.0);
        for (output, air) in
            [(Output::Living, living.air), (Output::Roof, roof.air), (Output::Cellar, cellar.air)]
        {
            network.observe(output as usize, air, 1.0);
        }
        for input in [Input::Outdoor, Input::WallOutside, Input::RoofOutside] {
            network.observe_boundary(Output::FromOutdoors as usize, input as usize);
        }
        network.observe_boundary(Output::FromGround as usize, Input::Ground as usize);
        network.model().ok_or(NoWall)
    }

    /// Temperatures at the start of a run, K: of the living area, the roof space and the cellar.
    pub fn initial_k(living_k: f64, roof_k: f64, cellar_k: f64) -> [f64; STATES] {
        let mut t_k = [living_k; STATES];
        t_k[3..6].fill(roof_k);
        t_k[6..9].fill(cellar_k);
        t_k
    }
}

#[cfg(test)]
mod tests {
    use super::super::envelope::{Construction, Layout, Shape};
    use super::*;

    fn house(construction: Construction) -> House {
        let shape = Shape {
            living_m2: 300.0,
            floors: 2.0,
            height_m: 2.6,
            layout: Layout::Compact,
            attached: 0,
            window_share: 0.15,
            dormers: false,
        };
        House {
            areas: shape.areas(),
            living_m2: 300.0,
            u: construction.u_values(),
            air_j_m2_k: 216e3,
            inner_j_m2_k: 324e3,
            exchange_1_s: 0.3 / 3600.0,
            emitter_radiative: 0.3,
        }
    }

    /// Inputs with an outdoor and a ground temperature.
    fn inputs(outdoor_k: f64, ground_k: f64) -> [f64; Input::COUNT] {
        let mut inputs = [0.0; Input::COUNT];
        inputs[..3].fill(outdoor_k);
        inputs[3] = ground_k;
        inputs
    }

    #[test]
    fn steady_loss_is_the_sum_of_u_times_a() {
        // Living area held at 21 degC by heat into the air, outdoors and ground 0 degC, by hand:
        //   walls 0.28 * 211.334 = 59.17, windows 1.4 * 45 = 63, air 0.3/3600 * 780 * 1206 = 78.39 W/K;
        //   ceiling 0.22 * 150 = 33 in series with the roof 2 * 246.156 + 2/3600 * 344.69 * 1206 = 723.25: 31.560;
        //   floor 0.35 * 150 = 52.5 in series with the cellar 0.6 * 258.449 + 0.3/3600 * 330 * 1206 = 188.23: 41.050;
        //   sum 273.17 W/K, 5737 W.
        let house = house(Construction::EnEv2007);
        let model = house.model().unwrap();
        let mut t_k = House::initial_k(294.15, 280.0, 280.0);
        let mut heat_w = 0.0;
        for _ in 0..400 {
            let mut step = model.begin(86_400.0, &t_k, inputs(273.15, 273.15));
            let rise = model.response(&step, Output::Living as usize, Input::Air as usize);
            heat_w = (294.15 - model.mean(&step, Output::Living as usize)) / rise;
            model.add(&mut step, Input::Air as usize, heat_w);
            model.finish(&step, &mut t_k);
        }
        let a = house.areas;
        let series = |a: f64, b: f64| a * b / (a + b);
        let by_hand = 0.28 * a.wall_m2
            + 63.0
            + 0.3 / 3600.0 * 780.0 * 1206.0
            + series(33.0, 2.0 * a.roof_m2 + 2.0 / 3600.0 * a.roof_m3 * 1206.0)
            + series(52.5, 0.6 * a.cellar_m2 + 0.3 / 3600.0 * a.cellar_m3 * 1206.0);
        assert!((by_hand - 273.17).abs() < 0.05, "{by_hand}");
        assert!((heat_w - 21.0 * by_hand).abs() < 1e-6 * heat_w, "{heat_w} {}", 21.0 * by_hand);
    }

    #[test]
    fn free_float_is_slow_where_it_is_insulated() {
        // From 21 degC in a frost of -10 degC without heat. Two thirds of the 540 kJ/(m2 K) of the living area behind
        // 273 W/K are a time constant of days: after 12 h it is cool, not cold; an old house cools faster.
        let after_12_h = |construction| {
            let model = house(construction).model().unwrap();
            let mut t_k = House::initial_k(294.15, 274.65, 280.15);
            for _ in 0..144 {
                let step = model.begin(300.0, &t_k, inputs(263.15, 283.15));
                model.finish(&step, &mut t_k);
            }
            (t_k[0], t_k[3], t_k[6])
        };
        let (new, roof, cellar) = after_12_h(Construction::EnEv2016);
        let (old, ..) = after_12_h(Construction::Until1978);
        assert!(new > 291.0 && new < 293.5 && old < new - 1.5 && old > 284.0, "{new} {old}");
        assert!(
            roof > 263.15 && roof < 270.0 && cellar > 278.0 && cellar < 286.0,
            "{roof} {cellar}"
        );
    }

    #[test]
    fn a_wall_that_is_not_there_is_refused() {
        let mut house = house(Construction::EnEv2007);
        house.u.wall_w_m2_k = 9.0;
        assert_eq!(house.model().unwrap_err(), NoWall);
    }
}

//! A house: three zones, a radiator or floor heating, thermostats; it can cool with the floor.
//!
//! **Equation** zones [`crate::building::house`], emitter [`crate::building::emitter`], set points and thermostats
//! [`crate::building::comfort`], sun `building/sun.rs`. The heat `Q` of the emitter and of the air exchange that people add
//! raises the mean of the room over the step by its linear response, so that both are solved with it:
//! ```text
//! T_room = A + R_e Q + R_a H (T_out - T_room),   Q = q_0 - y T_room      (means of the step)
//! ```
//! **Assumptions** the living area is one room. The thermostat sees its air. The time of day runs from
//! `start_time_s`. Port `heating` extracts, port `cooling` feeds in; both lead through the same emitter.
//! **Validity** steps up to an hour or so, which the thermostats limit, not the rooms.
//! **Numerics** the outlet is linear in the inlet, found with the step length before and the room at the start;
//! what the water gave off is booked exactly. State: 9 temperatures of zones, 5 of the emitter, 10 numbers more (192 bytes).
//! **Sources** `prohmo`, `vdi6007`, `loga2015`.

mod build;
mod input;
mod params;
mod sun;

pub use params::{BuildingParams, EmitterKind};

use crate::building::comfort::{Comfort, DAY_S, discomfort_k, running_mean_k};
use crate::building::emitter::{CELLS, Emitter, Passage, Stream};
use crate::building::house::{House, HouseModel, Input, Output, STATES};
use crate::calendar::{DaysOff, Moment};
use crate::thermal_unit::{Exchange, START_UNIX, ThermalUnit, UnitInput, UnitOutput, UnitPort};
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
use anergy_core::solar::{HorizontalIrradiance, SunPosition};
use smol_str::SmolStr;
use sun::Sun;

/// Places in the state, behind the temperatures of the zones.
mod at {
    use super::{CELLS, STATES};
    use std::ops::Range;

    /// Temperatures of the emitter, K.
    pub const CELLS_K: Range<usize> = STATES..STATES + CELLS;
    const AFTER: usize = STATES + CELLS;
    /// Conductance of the emitter, W/K.
    pub const CONDUCTANCE: usize = AFTER;
    /// Running mean of the outdoor temperature, K; 0 before the first step.
    pub const MEAN_OUTDOOR: usize = AFTER + 1;
    /// Time of day, or with days off time since the start, s.
    pub const TIME: usize = AFTER + 2;
    /// Integral parts of the thermostats.
    pub const HEATING: usize = AFTER + 3;
    pub const COOLING: usize = AFTER + 4;
    /// Length of the step before, s.
    pub const STEP: usize = AFTER + 5;
    /// Discomfort, K s.
    pub const DC_HEAT: usize = AFTER + 6;
    pub const DC_COOL: usize = AFTER + 7;
    /// Heat from the water of `heating`, and into that of `cooling`, J.
    pub const HEAT_J: usize = AFTER + 8;
    pub const COLD_J: usize = AFTER + 9;
    /// Length of the state.
    pub const LENGTH: usize = AFTER + 10;
}

/// The step length that the first request is made for: long, so that the emitter is not overfilled, s.
const FIRST_STEP_S: f64 = 3600.0;

/// Half open at the set point.
const AT_SET_POINT: f64 = 0.5;

/// A building ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Building {
    params: BuildingParams,
    model: Box<HouseModel>,
    emitter: Emitter,
    comfort: Comfort,
    days_off: Option<DaysOff>,
    sun: Sun,
    /// Air exchange that people add, W/K.
    more_exchange_w_k: f64,
    /// Heat of everybody, W.
    people_w: f64,
    m_flow_max_kg_s: f64,
    heat_capacity_j_kg_k: f64,
}

/// What the thermostats want.
#[derive(Debug, Clone, Copy)]
struct Wish {
    set_k: f64,
    /// Errors in the direction of the action, K.
    heating_k: f64,
    cooling_k: f64,
    /// Flows, kg/s.
    m_heating_kg_s: f64,
    m_cooling_kg_s: f64,
    season: bool,
}

impl Building {
    /// The moment at which a step begins: of the calendar, where days off matter, else of a day of its own.
    fn moment(&self, signals: &Signals<'_>, state: &[f64]) -> Moment {
        match &self.days_off {
            Some(days) => {
                Moment::after(signals.get(input::START), days.utc_offset_s, state[at::TIME])
            }
            None => Moment { day: 0, time_s: state[at::TIME] },
        }
    }

    fn wish(&self, signals: &Signals<'_>, state: &[f64]) -> Wish {
        let presence = signals.get(input::PRESENCE);
        let Moment { day, time_s } = self.moment(signals, state);
        let off = self.days_off.as_ref().is_some_and(|days| days.is_off(day));
        let set_k = self.comfort.set_k(signals.get(input::ROOM_SET), presence, time_s, off);
        let (heating_k, cooling_k) = (set_k - state[0], state[0] - signals.get(input::COOLING_SET));
        let mean_k = state[at::MEAN_OUTDOOR];
        let season =
            self.comfort.heats(if mean_k > 0.0 { mean_k } else { signals.get(input::OUTDOOR) });
        let heats = self.params.heating && season && signals.get(input::HEATING_ENABLED) > 0.5;
        let heating = if heats { self.comfort.opening(heating_k, state[at::HEATING]) } else { 0.0 };
        let cools =
            self.params.cooling && heating == 0.0 && signals.get(input::COOLING_ENABLED) > 0.5;
        let cooling = if cools { self.comfort.opening(cooling_k, state[at::COOLING]) } else { 0.0 };
        Wish {
            set_k,
            heating_k,
            cooling_k,
            m_heating_kg_s: heating * self.m_flow_max_kg_s,
            m_cooling_kg_s: cooling * self.m_flow_max_kg_s,
            season,
        }
    }

    /// Port of heating and of cooling.
    fn places(&self) -> (Option<usize>, Option<usize>) {
        let cooling = if self.params.heating { 1 } else { 0 };
        (self.params.heating.then_some(0), self.params.cooling.then_some(cooling))
    }

    /// The outlet of the emitter over its inlet at a flow, for a step as long as the last.
    fn outlet(&self, state: &[f64], m_flow_kg_s: f64) -> Outlet {
        let stream = Stream { capacity_w_k: m_flow_kg_s * self.heat_capacity_j_kg_k, t_in_k: 0.0 };
        let cells_k = &state[at::CELLS_K];
        if m_flow_kg_s <= 0.0 {
            return Outlet::Linear { constant_k: cells_k[CELLS - 1], of_inlet: 0.0 };
        }
        let passage =
            self.emitter.passage(state[at::STEP], state[at::CONDUCTANCE], stream, cells_k);
        Outlet::Linear {
            constant_k: passage.outlet_k.at(state[0]),
            of_inlet: passage.of_inlet.clamp(0.0, 1.0),
        }
    }

    /// The water of all ports as one stream, and the heat it gave off, W.
    fn stream(&self, ports: &[PortFlow]) -> (Stream, f64) {
        let (mut capacity_w_k, mut inflow_w, mut water_w) = (0.0, 0.0, 0.0);
        for port in ports {
            let k = port.m_flow_kg_s.abs() * self.heat_capacity_j_kg_k;
            capacity_w_k += k;
            inflow_w += k * port.t_in_k;
            water_w += k * (port.t_in_k - port.t_out_k);
        }
        let t_in_k = if capacity_w_k > 0.0 { inflow_w / capacity_w_k } else { 0.0 };
        (Stream { capacity_w_k, t_in_k }, water_w)
    }
}

const K: (f64, f64) = (0.0, 500.0);
const SHARE: (f64, f64) = (0.0, 1.0);
const POSITIVE: (f64, f64) = (0.0, f64::INFINITY);
const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

impl ThermalUnit for Building {
    fn serves(&self) -> bool {
        true
    }

    fn ports(&self) -> Vec<UnitPort> {
        let port = |name| UnitPort { name: SmolStr::new_static(name), ..UnitPort::ONLY };
        let heating = self.params.heating.then(|| port("heating"));
        let cooling = self.params.cooling.then(|| port("cooling"));
        heating.into_iter().chain(cooling).collect()
    }

    fn takes_heat(&self, port: usize) -> bool {
        self.params.heating && port == 0
    }

    fn inputs(&self) -> Vec<UnitInput> {
        let input = |name, unit, initial, (min, max), follows| UnitInput {
            name,
            unit,
            initial,
            min,
            max,
            follows,
        };
        let weather =
            |name, unit, initial, range, follows| input(name, unit, initial, range, Some(follows));
        let p = &self.params;
        vec![
            input("room_set_k", "k", p.room_set_k, K, None),
            input("cooling_set_k", "k", p.cooling_set_k, K, None),
            input("presence", "", 1.0, SHARE, Some("site.presence")),
            input("appliances_w", "w", 0.0, POSITIVE, Some("site.appliances_w")),
            input("cellar_gain_w", "w", 0.0, ANY, None),
            input("heating_enabled", "", 1.0, SHARE, None),
            input("cooling_enabled", "", 1.0, SHARE, None),
            weather("outdoor_k", "k", p.outdoor_k, K, "weather.t_outdoor_k"),
            weather("ground_k", "k", p.ground_k, K, "weather.t_ground_k"),
            weather("global_w_m2", "w_m2", 0.0, POSITIVE, "weather.global_horizontal_w_m2"),
            weather("beam_w_m2", "w_m2", 0.0, POSITIVE, "weather.beam_normal_w_m2"),
            weather("diffuse_w_m2", "w_m2", 0.0, POSITIVE, "weather.diffuse_horizontal_w_m2"),
            weather("sun_elevation_rad", "rad", 0.0, ANY, "weather.sun_elevation_rad"),
            weather("sun_azimuth_rad", "rad", 0.0, ANY, "weather.sun_azimuth_rad"),
            weather("start_unix_s", "s", 0.0, ANY, START_UNIX),
        ]
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        let mut outputs = vec![
            UnitOutput::state("t_room_k", "K"),
            UnitOutput::state("t_roof_k", "K"),
            UnitOutput::state("t_cellar_k", "K"),
            UnitOutput::new("set_k", "K"),
            UnitOutput::new("emitted_w", "W"),
            UnitOutput::new("loss_w", "W"),
            UnitOutput::new("sun_w", "W"),
            UnitOutput::new("internal_w", "W"),
            UnitOutput::new("season", "1"),
            UnitOutput::new("dc_heat_k_s", "K s"),
            UnitOutput::new("dc_cool_k_s", "K s"),
        ];
        let names: [(bool, [&'static str; 5]); 2] = [
            (
                self.params.heating,
                ["heating_w", "heating_kg_s", "heating_in_k", "heating_out_k", "heat_j"],
            ),
            (
                self.params.cooling,
                ["cooling_w", "cooling_kg_s", "cooling_in_k", "cooling_out_k", "cold_j"],
            ),
        ];
        for (_, names) in names.iter().filter(|(present, _)| *present) {
            let units = ["W", "kg s-1", "K", "K", "J"];
            outputs.extend(names.iter().zip(units).map(|(name, unit)| UnitOutput::new(name, unit)));
        }
        outputs
    }

    fn initial_state(&self, _initial_k: f64) -> Vec<f64> {
        let p = &self.params;
        let mut state = vec![0.0; at::LENGTH];
        state[..STATES].copy_from_slice(&House::initial_k(
            p.initial_living_k,
            p.initial_roof_k,
            p.initial_cellar_k,
        ));
        state[at::CELLS_K].fill(p.initial_living_k);
        state[at::CONDUCTANCE] = self.emitter.conductance_w_k(0.0);
        state[at::TIME] = if self.days_off.is_some() { 0.0 } else { p.start_time_s % DAY_S };
        state[at::HEATING] = AT_SET_POINT;
        state[at::COOLING] = AT_SET_POINT;
        state[at::STEP] = FIRST_STEP_S;
        state
    }

    fn request(
        &self,
        signals: &Signals<'_>,
        _got: &[PortFlow],
        state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        let wish = self.wish(signals, state);
        let (heating, cooling) = self.places();
        let flows = [(heating, wish.m_heating_kg_s, -1.0), (cooling, wish.m_cooling_kg_s, 1.0)];
        for (port, m_flow_kg_s, sign) in flows {
            if let Some(port) = port {
                let outlet = self.outlet(state, m_flow_kg_s);
                wanted[port] = PortRequest { m_flow_kg_s: sign * m_flow_kg_s, outlet };
            }
        }
    }

    fn advance(
        &self,
        dt_s: f64,
        signals: &Signals<'_>,
        ports: &[PortFlow],
        state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange {
        let wish = self.wish(signals, state);
        let (stream, water_w) = self.stream(ports);
        let outdoor_k = signals.get(input::OUTDOOR);
        let presence = signals.get(input::PRESENCE);
        let horizontal = HorizontalIrradiance {
            global_w_m2: signals.get(input::GLOBAL),
            beam_normal_w_m2: signals.get(input::BEAM),
            diffuse_w_m2: signals.get(input::DIFFUSE),
        };
        let shine = self.sun.shines(
            horizontal,
            SunPosition {
                elevation_rad: signals.get(input::ELEVATION),
                azimuth_rad: signals.get(input::AZIMUTH),
            },
        );
        let internal_w = self.people_w * presence + signals.get(input::APPLIANCES);
        let mut given = [0.0; Input::COUNT];
        given[Input::Outdoor as usize] = outdoor_k;
        given[Input::WallOutside as usize] = outdoor_k + shine.wall_k;
        given[Input::RoofOutside as usize] = outdoor_k + shine.roof_k;
        given[Input::Ground as usize] = signals.get(input::GROUND);
        given[Input::Sun as usize] = shine.windows_w;
        given[Input::Internal as usize] = internal_w;
        given[Input::Cellar as usize] = signals.get(input::CELLAR);

        let mut step = self.model.begin(dt_s, &state[..STATES], given);
        let without_k = self.model.mean(&step, Output::Living as usize);
        let response = |input| self.model.response(&step, Output::Living as usize, input as usize);
        let (by_emitter, by_air) = (response(Input::Emitter), response(Input::Air));
        let exchange_w_k = self.more_exchange_w_k * presence;
        let room_k = |passage: &Passage| {
            let emitted = passage.emitted_w;
            (without_k + by_emitter * emitted.at_zero + by_air * exchange_w_k * outdoor_k)
                / (1.0 - by_emitter * emitted.per_k + by_air * exchange_w_k)
        };
        let mut conductance = state[at::CONDUCTANCE];
        let cells_k = &mut state[at::CELLS_K];
        let (passage, t_room_k) =
            self.emitter.settled_passage(dt_s, &mut conductance, stream, cells_k, room_k);
        let emitted_w = passage.emitted_w.at(t_room_k);
        let exchange_w = exchange_w_k * (outdoor_k - t_room_k);
        self.emitter.advance(dt_s, &passage, t_room_k, stream, water_w, cells_k);
        self.model.add(&mut step, Input::Emitter as usize, emitted_w);
        self.model.add(&mut step, Input::Air as usize, exchange_w);
        let means = self.model.finish(&step, &mut state[..STATES]);

        let loss_w =
            -exchange_w - means[Output::FromOutdoors as usize] - means[Output::FromGround as usize];
        if dt_s > 0.0 {
            state[at::CONDUCTANCE] = conductance;
            let mean_k = state[at::MEAN_OUTDOOR];
            state[at::MEAN_OUTDOOR] =
                running_mean_k(dt_s, outdoor_k, if mean_k > 0.0 { mean_k } else { outdoor_k });
            let (cold_k, warm_k) = discomfort_k(t_room_k, self.moment(signals, state).time_s);
            state[at::DC_HEAT] += dt_s * cold_k;
            state[at::DC_COOL] += dt_s * warm_k;
            let time_s = state[at::TIME] + dt_s;
            let wraps = time_s >= DAY_S && self.days_off.is_none();
            state[at::TIME] = if wraps { time_s % DAY_S } else { time_s };
            state[at::HEATING] = self.comfort.integral(dt_s, wish.heating_k, state[at::HEATING]);
            state[at::COOLING] = self.comfort.integral(dt_s, wish.cooling_k, state[at::COOLING]);
            state[at::STEP] = dt_s;
        }
        out[..3].copy_from_slice(&means[..3]);
        out[3] = wish.set_k;
        out[4] = emitted_w;
        out[5] = loss_w;
        out[6] = shine.windows_w;
        out[7] = internal_w;
        out[8] = f64::from(u8::from(wish.season));
        out[9] = state[at::DC_HEAT];
        out[10] = state[at::DC_COOL];
        let (heating, cooling) = self.places();
        let mut next = 11;
        for (port, sign, sum) in [(heating, 1.0, at::HEAT_J), (cooling, -1.0, at::COLD_J)] {
            if let Some(port) = port {
                let PortFlow { m_flow_kg_s, t_in_k, t_out_k } = ports[port];
                let capacity_w_k = m_flow_kg_s.abs() * self.heat_capacity_j_kg_k;
                let q_w = sign * capacity_w_k * (t_in_k - t_out_k);
                state[sum] += dt_s * q_w;
                out[next..next + 5].copy_from_slice(&[
                    q_w,
                    m_flow_kg_s.abs(),
                    t_in_k,
                    t_out_k,
                    state[sum],
                ]);
                next += 5;
            }
        }
        let external_w = internal_w + shine.windows_w + signals.get(input::CELLAR) - loss_w;
        Exchange { electric_w: 0.0, external_w }
    }

    fn stored_j(&self, state: &[f64]) -> f64 {
        self.model.stored_j(&state[..STATES]) + self.emitter.stored_j(&state[at::CELLS_K])
    }
}

#[cfg(test)]
mod tests;

//! The indicators as JSON, in the units of the trade that their names end with.

use super::{Passed, StationSums, m3};
use crate::plan::{Plan, PlannedUnit};
use crate::simulation::Simulation;
use crate::state::State;
use anergy_core::medium::ZERO_CELSIUS_K;
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Add;

const J_PER_KWH: f64 = 3.6e6;
const S_PER_H: f64 = 3600.0;
const PA_PER_BAR: f64 = 1e5;

fn degc(t_k: f64) -> f64 {
    t_k - ZERO_CELSIUS_K
}

/// Numbers by name; what has no value is left out.
type Numbers = Map<String, Value>;

/// Adds a number, if it is one.
fn add(to: &mut Numbers, name: &str, value: f64) {
    if value.is_finite() {
        // Without the sign of an empty sum.
        to.insert(name.to_owned(), json!(value + 0.0));
    }
}

/// A ratio in percent; none over nothing.
fn add_percent(to: &mut Numbers, name: &str, part: f64, whole: f64) {
    if whole > 0.0 {
        add(to, name, 100.0 * part / whole);
    }
}

/// All indicators of a run up to now.
pub(crate) fn kpis(simulation: &Simulation) -> Value {
    let (plan, state) = (simulation.plan(), simulation.state());
    let mut sites = sites(plan);
    let stations = stations(plan, state, &mut sites);
    let units = units(plan, state, &mut sites);
    let sites: Numbers = sites
        .into_iter()
        .filter(|(_, site)| *site != Site::default())
        .map(|(name, site)| (name.to_owned(), Value::Object(site.numbers())))
        .collect();
    json!({
        "network": network(plan, state),
        "nodes": nodes(plan, state),
        "sites": sites,
        "stations": stations,
        "units": units,
    })
}

/// Sums of a site; what is not there stays none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Site {
    given_j: f64,
    taken_j: f64,
    has_station: bool,
    pumps_j: f64,
    units_j: f64,
    /// Heat, cold and electricity of what draws electricity for them.
    generated_j: Option<[f64; 3]>,
    starts: Option<f64>,
    discomfort_heating_k_s: Option<f64>,
    discomfort_cooling_k_s: Option<f64>,
    cost_eur: Option<f64>,
    /// Heat and cold that people got.
    demand_j: Option<f64>,
    fuel_j: f64,
    /// Electricity of what makes heat or cold without fuel.
    generators_j: f64,
}

impl Site {
    fn numbers(&self) -> Numbers {
        let mut to = Numbers::new();
        if self.has_station {
            add(&mut to, "heat_given_kwh", self.given_j / J_PER_KWH);
            add(&mut to, "heat_taken_kwh", self.taken_j / J_PER_KWH);
        }
        add(&mut to, "pump_electricity_kwh", self.pumps_j / J_PER_KWH);
        add(&mut to, "unit_electricity_kwh", self.units_j / J_PER_KWH);
        let optional = [
            ("generated_heat_kwh", self.generated_j.map(|[heat_j, ..]| heat_j), J_PER_KWH),
            ("generated_cold_kwh", self.generated_j.map(|[_, cold_j, _]| cold_j), J_PER_KWH),
            ("starts", self.starts, 1.0),
            ("discomfort_heating_k_h", self.discomfort_heating_k_s, S_PER_H),
            ("discomfort_cooling_k_h", self.discomfort_cooling_k_s, S_PER_H),
            ("cost_eur", self.cost_eur, 1.0),
            ("demand_kwh", self.demand_j, J_PER_KWH),
        ];
        for (name, value, per) in optional {
            add(&mut to, name, value.map_or(f64::NAN, |value| value / per));
        }
        if let Some([heat_j, cold_j, electric_j]) = self.generated_j {
            add(&mut to, "seasonal_cop", (heat_j + cold_j) / electric_j);
        }
        let put_in_j = self.fuel_j + self.generators_j;
        if put_in_j > 0.0 {
            add(&mut to, "fuel_and_generators_kwh", put_in_j / J_PER_KWH);
        }
        let supplied_j = put_in_j + self.taken_j;
        if let Some(demand_j) = self.demand_j.filter(|_| supplied_j > 0.0) {
            add(&mut to, "efficiency", (demand_j + self.given_j) / supplied_j);
        }
        to
    }
}

/// The sites of a plan.
fn sites(plan: &Plan) -> BTreeMap<&str, Site> {
    let names: BTreeSet<&str> = plan.nodes_on_map.iter().map(|node| node.site.as_str()).collect();
    names.into_iter().filter(|name| !name.is_empty()).map(|name| (name, Site::default())).collect()
}

/// The site in front of a name.
fn site_of<'a>(sites: &'a mut BTreeMap<&str, Site>, name: &str) -> Option<&'a mut Site> {
    sites.get_mut(name.split_once('.')?.0)
}

fn stations(plan: &Plan, state: &State, sites: &mut BTreeMap<&str, Site>) -> Numbers {
    let sums = &state.kpis;
    let mut pumps_j: BTreeMap<&str, f64> = BTreeMap::new();
    for (pump, j) in plan.pumps.iter().zip(&sums.pumps_j) {
        let station = plan.edges_on_map[*pump].station.as_str();
        if !station.is_empty() {
            *pumps_j.entry(station).or_default() += j;
        }
        if let Some(site) = site_of(sites, &plan.edge_names[*pump]) {
            site.pumps_j += j;
        }
    }
    let given_j: f64 = sums.stations.iter().map(|station| station.given_j).sum();
    let fed_in_kg: f64 = sums.stations.iter().map(|station| station.fed_in.kg).sum();
    let mut all = Numbers::new();
    for (i, name) in plan.station_names.iter().enumerate() {
        let (sums, mut to) = (&sums.stations[i], Numbers::new());
        add(&mut to, "heat_given_kwh", sums.given_j / J_PER_KWH);
        add(&mut to, "heat_taken_kwh", sums.taken_j / J_PER_KWH);
        add_percent(&mut to, "share_of_heat_given_percent", sums.given_j, given_j);
        add_percent(&mut to, "share_of_water_fed_in_percent", sums.fed_in.kg, fed_in_kg);
        water(plan, sums, &mut to);
        if sums.requested_kg > 0.0 {
            let medium = &plan.network.medium;
            add(&mut to, "water_requested_m3", m3(medium, sums.requested_kg));
            add(&mut to, "water_delivered_m3", m3(medium, sums.delivered_kg));
            add(&mut to, "blocked_h", state.stations[i].blocked_s / S_PER_H);
        }
        let pumps = pumps_j.get(name.as_str());
        add(&mut to, "pump_electricity_kwh", pumps.map_or(f64::NAN, |j| j / J_PER_KWH));
        if let Some((min, max)) = sums.dp_pa.seen() {
            add(&mut to, "dp_min_bar", min / PA_PER_BAR);
            add(&mut to, "dp_max_bar", max / PA_PER_BAR);
        }
        if let Some(site) = site_of(sites, name) {
            site.has_station = true;
            site.given_j += sums.given_j;
            site.taken_j += sums.taken_j;
        }
        all.insert(name.clone(), Value::Object(to));
    }
    all
}

/// Water of both directions: what is sent to the hot line is supply, what is sent to the cold line returns.
fn water(plan: &Plan, sums: &StationSums, to: &mut Numbers) {
    let directions = [("fed_in", "supply", &sums.fed_in), ("extracted", "return", &sums.extracted)];
    for (passed, sent, Passed { kg, kg_k, flowing_s, k_s, arriving_k }) in directions {
        add(to, &format!("water_{passed}_m3"), m3(&plan.network.medium, *kg));
        if *flowing_s > 0.0 {
            add(to, &format!("{passed}_h"), flowing_s / S_PER_H);
            add(to, &format!("{sent}_mean_by_flow_degc"), degc(kg_k / kg));
            add(to, &format!("{sent}_mean_by_time_degc"), degc(k_s / flowing_s));
        }
        if let Some((min, max)) = arriving_k.seen() {
            add(to, &format!("{passed}_arriving_min_degc"), degc(min));
            add(to, &format!("{passed}_arriving_max_degc"), degc(max));
        }
    }
}

fn units(plan: &Plan, state: &State, sites: &mut BTreeMap<&str, Site>) -> Numbers {
    let mut all = Numbers::new();
    for (i, unit) in plan.units.iter().enumerate() {
        let (sums, mut to) = (&state.kpis.units[i], Numbers::new());
        let output = |name| Some(state.unit_outputs[unit.output(name)?]);
        let (heat_j, cold_j) = (output("heat_j"), output("cold_j"));
        let (electric_j, fuel_j) = (output("electric_j"), output("fuel_j"));
        let starts = output("starts");
        let cost_eur = cost_eur(unit, state);
        let discomfort = (output("dc_heat_k_s"), output("dc_cool_k_s"));
        let shown = [
            ("starts", starts, 1.0),
            ("operating_h", output("operating_s"), S_PER_H),
            ("defrosting_h", output("defrosting_s"), S_PER_H),
            ("exchanger_h", output("exchanger_s"), S_PER_H),
            ("heat_kwh", heat_j, J_PER_KWH),
            ("cold_kwh", cold_j, J_PER_KWH),
            ("discomfort_heating_k_h", discomfort.0, S_PER_H),
            ("discomfort_cooling_k_h", discomfort.1, S_PER_H),
            ("fuel_kwh", fuel_j, J_PER_KWH),
            ("generated_kwh", output("generated_j"), J_PER_KWH),
            ("imported_kwh", output("import_j"), J_PER_KWH),
            ("exported_kwh", output("export_j"), J_PER_KWH),
            ("self_consumption_percent", output("self_consumption"), 0.01),
            ("self_sufficiency_percent", output("self_sufficiency"), 0.01),
            ("full_cycles", output("full_cycles"), 1.0),
            ("water_drawn_m3", output("drawn_m3"), 1.0),
            ("discomfort_water_k_l", output("dc_water_k_m3"), 1e-3),
            ("electricity_cost_eur", output("electricity_cost_eur"), 1.0),
            ("fuel_cost_eur", output("fuel_cost_eur"), 1.0),
            ("revenue_eur", output("revenue_eur"), 1.0),
            ("cost_eur", cost_eur, 1.0),
            ("shortfall_k_h", output("shortfall_k_s"), S_PER_H),
            ("unmet_kwh", plan.kpi_places.unmet[i].map(|_| sums.unmet_j), J_PER_KWH),
        ];
        for (name, value, per) in shown {
            add(&mut to, name, value.map_or(f64::NAN, |value| value / per));
        }
        let serves = unit.equipment.serves();
        if (serves || unit.slots.len() == 1) && heat_j.is_none() && cold_j.is_none() {
            add(&mut to, "heat_to_water_kwh", sums.given_j / J_PER_KWH);
            add(&mut to, "heat_from_water_kwh", sums.taken_j / J_PER_KWH);
        }
        let useful_j = heat_j.unwrap_or(0.0) + cold_j.unwrap_or(0.0);
        if let Some(electric_j) = electric_j {
            add(&mut to, "electricity_kwh", electric_j / J_PER_KWH);
            if fuel_j.is_none() {
                add(&mut to, "seasonal_cop", useful_j / electric_j);
            }
        } else if sums.electric_j != 0.0 {
            add(&mut to, "electricity_kwh", sums.electric_j / J_PER_KWH);
        }
        if let Some(site) = site_of(sites, &unit.name) {
            let more = |sum: &mut Option<f64>, value: Option<f64>| {
                if let Some(value) = value {
                    *sum = Some(sum.unwrap_or(0.0) + value);
                }
            };
            site.units_j += electric_j.unwrap_or(sums.electric_j);
            more(&mut site.starts, starts);
            more(&mut site.discomfort_heating_k_s, discomfort.0);
            more(&mut site.discomfort_cooling_k_s, discomfort.1);
            more(&mut site.cost_eur, cost_eur);
            more(&mut site.demand_j, serves.then_some(sums.given_j + sums.taken_j));
            site.fuel_j += fuel_j.unwrap_or(0.0);
            if fuel_j.is_none() && !serves && !unit.slots.is_empty() {
                site.generators_j += electric_j.unwrap_or(sums.electric_j);
            }
            if let Some(electric_j) = electric_j.filter(|_| fuel_j.is_none()) {
                let parts = [heat_j.unwrap_or(0.0), cold_j.unwrap_or(0.0), electric_j];
                let sums = site.generated_j.get_or_insert_default();
                sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
            }
        }
        all.insert(unit.name.to_string(), Value::Object(to));
    }
    all
}

/// What a connection to the electric grid paid for electricity and fuel, less what it got.
fn cost_eur(unit: &PlannedUnit, state: &State) -> Option<f64> {
    let eur = |name| Some(state.unit_outputs[unit.output(name)?]);
    Some(eur("electricity_cost_eur")? + eur("fuel_cost_eur")? - eur("revenue_eur")?)
}

/// Ranges of the nodes of the grid.
fn nodes(plan: &Plan, state: &State) -> Numbers {
    let mut all = Numbers::new();
    for (node, ranges) in plan.kpi_places.ranged.iter().zip(&state.kpis.nodes) {
        let mut to = Numbers::new();
        if let (Some(t_k), Some(p_pa)) = (ranges.t_k.seen(), ranges.p_pa.seen()) {
            add(&mut to, "t_min_degc", degc(t_k.0));
            add(&mut to, "t_max_degc", degc(t_k.1));
            add(&mut to, "p_min_bar", p_pa.0 / PA_PER_BAR);
            add(&mut to, "p_max_bar", p_pa.1 / PA_PER_BAR);
        }
        all.insert(plan.node_names[*node].to_string(), Value::Object(to));
    }
    all
}

fn network(plan: &Plan, state: &State) -> Numbers {
    let (sums, mut to) = (&state.kpis, Numbers::new());
    let given_j: f64 = sums.stations.iter().map(|station| station.given_j).sum();
    let taken_j: f64 = sums.stations.iter().map(|station| station.taken_j).sum();
    add(&mut to, "heat_given_kwh", given_j / J_PER_KWH);
    add(&mut to, "heat_taken_kwh", taken_j / J_PER_KWH);
    add(&mut to, "pump_electricity_kwh", state.electric_j / J_PER_KWH);
    add(&mut to, "unit_electricity_kwh", state.units_electric_j / J_PER_KWH);
    add(&mut to, "heat_lost_kwh", state.loss_j / J_PER_KWH);
    if taken_j > 0.0 {
        add(&mut to, "pump_kwh_per_mwh_taken", 1000.0 * state.electric_j / taken_j);
        add_percent(&mut to, "heat_lost_of_taken_percent", state.loss_j, taken_j);
    }
    add(&mut to, "exergy_lost_by_mixing_kwh", sums.mixing_j / J_PER_KWH);
    if plan.kpi_places.balances.contains(&true) {
        let balances = || sums.stations.iter().zip(&plan.kpi_places.balances).filter(|(_, b)| **b);
        let given_j: f64 = balances().map(|(station, _)| station.given_j).sum();
        let taken_j: f64 = balances().map(|(station, _)| station.taken_j).sum();
        add(&mut to, "balancing_heat_given_kwh", given_j / J_PER_KWH);
        add(&mut to, "balancing_heat_taken_kwh", taken_j / J_PER_KWH);
    }
    let demand_j = sums.demand_heat_j + sums.demand_cold_j;
    if demand_j > 0.0 {
        add(&mut to, "demand_overlap", 2.0 * sums.coincident_j / demand_j);
    }
    let mut dp_pa = super::Range::default();
    for (min, max) in sums.stations.iter().filter_map(|station| station.dp_pa.seen()) {
        dp_pa.see(min);
        dp_pa.see(max);
    }
    if let Some((min, max)) = dp_pa.seen() {
        add(&mut to, "dp_min_bar", min / PA_PER_BAR);
        add(&mut to, "dp_max_bar", max / PA_PER_BAR);
    }
    let extremes = [("coldest", sums.coldest), ("hottest", sums.hottest)];
    for (which, extreme) in extremes.into_iter().filter_map(|(which, e)| Some((which, e?))) {
        add(&mut to, &format!("{which}_node_degc"), degc(extreme.t_k));
        to.insert(format!("{which}_node"), json!(plan.node_names[extreme.node]));
    }
    let unmet_j =
        plan.kpi_places.unmet.iter().zip(&sums.units).filter(|(place, _)| place.is_some());
    if let Some(unmet_j) = unmet_j.map(|(_, unit)| unit.unmet_j).reduce(f64::add) {
        add(&mut to, "unmet_kwh", unmet_j / J_PER_KWH);
    }
    let shortfalls = plan.units.iter().filter_map(|unit| unit.output("shortfall_k_s"));
    let shortfall_k_s = shortfalls.map(|place| state.unit_outputs[place]).reduce(f64::add);
    add(&mut to, "shortfall_k_h", shortfall_k_s.map_or(f64::NAN, |k_s| k_s / S_PER_H));
    let costs_eur = plan.units.iter().filter_map(|unit| cost_eur(unit, state)).reduce(f64::add);
    add(&mut to, "cost_eur", costs_eur.unwrap_or(f64::NAN));
    let blocked_s: f64 = state.stations.iter().map(|station| station.blocked_s).sum();
    add(&mut to, "blocked_h", blocked_s / S_PER_H);
    let hunting_s: f64 = state.swings.iter().map(|swing| swing.hunting_s).sum();
    let oscillating_s: f64 = state.swings.iter().map(|swing| swing.oscillating_s).sum();
    add(&mut to, "hunting_h", hunting_s / S_PER_H);
    add(&mut to, "oscillating_h", oscillating_s / S_PER_H);
    to
}

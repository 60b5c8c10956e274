//! Generators that burn gas: condensing boiler, gas engine with heat and power, Stirling engine with an auxiliary boiler.
//!
//! **Equation** heat, fuel and electricity of a [steady state](map) times what time does to the
//! [burner](crate::burner). The flow keeps the difference of supply and return, `m = Q/(cp dT)`, is constant, or keeps
//! the supply, `m = Q/(cp (T_set - T_return))`. An auxiliary boiler and an electric rod, where the unit has them, heat
//! the same water. All fuel that does not become heat or electricity is lost: `Q = E_drawn + (H - losses)`, where
//! electricity generated counts negative; heat that start and stop shift between metal and water is part of the losses.
//!
//! **Internal control** the load is the command, or what lifts a constant flow to the set supply: then the unit
//! stops where its smallest load overshoots by `BAND_K`, and starts again where it no longer does. Return and
//! supply above their limits stop the unit; it may start again when both are below by the restart difference.
//!
//! **Assumptions** no content, unless an engine is given one (`combustion/engine.rs`), or a boiler its metal (`combustion/metal.rs`). Where the water takes less heat than planned (less flow, a supply that would be too hot),
//! fuel and electricity shrink in proportion. **Validity** that of each map, whose arguments are clamped. **Numerics** map and limits take the
//! return temperature of the step before; what the water got is booked.
//!
//! **Sources** `zinsmeister2022`, `prohmo`; values without a source are marked assumed in `docs/src/generators.md`.

pub mod boiler;
pub mod chp;
mod engine;
mod flow;
mod load;
pub mod map;
mod metal;
mod plan;
pub mod stirling;

use crate::burner::{Burner, BurnerState};
use crate::efficiency_factor::EfficiencyFactor;
use crate::thermal_unit::{
    Exchange, Flag, ThermalUnit, UnitInput, UnitOutput, UnitPort, capacity_w_k,
};
use anergy_core::medium::{Medium, ZERO_CELSIUS_K};
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
use engine::EngineContent;
use flow::FlowRule;
pub use flow::{GeneratorCommand, GeneratorFlow};
use map::SteadyMap;
use metal::Metal;

/// The set supply may be missed by this before a unit that holds it stops, K.
const BAND_K: f64 = 5.0;

/// Where the unit stops.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Limits {
    return_max_k: f64,
    supply_max_k: f64,
    restart_k: f64,
}

/// A burner with what it does in steady operation.
#[derive(Debug, Clone, PartialEq)]
struct Stage {
    burner: Burner,
    map: SteadyMap,
}

/// A generator that burns gas, ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Combustion {
    main: Stage,
    aux: Option<Stage>,
    rod_rated_w: f64,
    command: GeneratorCommand,
    flow: FlowRule,
    limits: Limits,
    /// The content of an engine, where it has one.
    engine: Option<EngineContent>,
    /// The metal of a boiler, where it counts; never beside an engine.
    metal: Option<Metal>,
    /// How much better it is than its map.
    factor: EfficiencyFactor,
    /// Electricity while nothing burns, and while something does, W.
    idle_w: f64,
    running_w: f64,
    /// Size over that of the unit whose data these are.
    size: f64,
    initial: [f64; 5],
    medium: Medium,
}

/// State: length of the step, s; return and supply, K; whether a limit tripped; whether the set supply is overshot at
/// the smallest load; heat, fuel, electricity drawn and generated so far, J; then the burners.
const STEP_S: usize = 0;
const RETURN_K: usize = 1;
const SUPPLY_K: usize = 2;
const TRIPPED: usize = 3;
const OVERSHOT: usize = 4;
const HEAT_J: usize = 5;
const FUEL_J: usize = 6;
const ELECTRIC_J: usize = 7;
const GENERATED_J: usize = 8;
const BURNERS: usize = 9;

const MODULATION: usize = 0;
const ENABLE: usize = 1;
const SUPPLY_SET: usize = 2;
const AUX: usize = 3;
const ROD: usize = 4;

impl Combustion {
    /// Where the state of the engine, or of the metal, begins: behind that of the burners.
    fn engine_at(&self) -> usize {
        BURNERS + BurnerState::LEN * if self.aux.is_some() { 2 } else { 1 }
    }
}

impl ThermalUnit for Combustion {
    fn ports(&self) -> Vec<UnitPort> {
        vec![UnitPort { name: "water".into(), sets_flow: true, leads: false }]
    }

    fn inputs(&self) -> Vec<UnitInput> {
        let ratio = |i: usize, name| UnitInput {
            name,
            unit: "",
            initial: self.initial[i],
            min: 0.0,
            max: 1.0,
            follows: None,
        };
        let supply_set =
            UnitInput { unit: "k", max: f64::INFINITY, ..ratio(SUPPLY_SET, "supply_set_k") };
        let mut inputs = vec![ratio(MODULATION, "modulation"), ratio(ENABLE, "enable"), supply_set];
        if self.aux.is_some() {
            inputs.extend([ratio(AUX, "aux_modulation"), ratio(ROD, "rod_modulation")]);
        }
        inputs
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        let mut outputs = vec![
            UnitOutput::new("q_flow_w", "W"),
            UnitOutput::new("electric_w", "W"),
            UnitOutput::new("fuel_w", "W"),
            UnitOutput::new("efficiency", "1"),
            UnitOutput::new("t_supply_k", "K"),
            UnitOutput::new("load", "1"),
            UnitOutput::new("phase", "1"),
            UnitOutput::new("tripped", "1"),
            UnitOutput::new("starts", "1"),
            UnitOutput::new("operating_s", "s"),
            UnitOutput::new("heat_j", "J"),
            UnitOutput::new("fuel_j", "J"),
            UnitOutput::new("electric_j", "J"),
            UnitOutput::new("generated_w", "W"),
            UnitOutput::new("generated_j", "J"),
        ];
        if self.aux.is_some() {
            outputs.extend([
                UnitOutput::new("aux_w", "W"),
                UnitOutput::new("aux_phase", "1"),
                UnitOutput::new("aux_starts", "1"),
                UnitOutput::new("rod_w", "W"),
            ]);
        }
        if self.engine.is_some() {
            outputs.extend([
                UnitOutput::state("t_engine_k", "K"),
                UnitOutput::new("loss_w", "W"),
                UnitOutput::new("loss_j", "J"),
            ]);
        }
        if self.metal.is_some() {
            outputs.push(UnitOutput::state("t_metal_k", "K"));
        }
        outputs
    }

    fn initial_state(&self, initial_k: f64) -> Vec<f64> {
        let mut state = vec![0.0; self.engine_at()];
        state[RETURN_K] = initial_k;
        state[SUPPLY_K] = initial_k;
        for burner in state[BURNERS..].chunks_exact_mut(BurnerState::LEN) {
            BurnerState::new().write(burner);
        }
        if let Some(engine) = self.engine {
            state.extend([engine.initial_k.unwrap_or(initial_k), 0.0, 0.0]);
        }
        if self.metal.is_some() {
            state.extend([initial_k, 0.0]);
        }
        state
    }

    fn begin(&self, dt_s: f64, state: &mut [f64]) {
        state[STEP_S] = dt_s;
    }

    fn request(
        &self,
        signals: &Signals<'_>,
        got: &[PortFlow],
        state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        if let Some(got) = got.first() {
            state[RETURN_K] = got.t_in_k;
        }
        let plan = self.plan(signals, state);
        let (m_flow_kg_s, heat_w) = (plan.m_flow_kg_s, plan.heat_w() + plan.metal_w);
        // The supply is no hotter where the water arrives warmer than before, and not beyond what stops the unit.
        let outlet = match self.flow {
            _ if self.engine.is_some() => {
                let engine = &state[self.engine_at()..];
                self.engine.map_or(Outlet::HeatFlow(heat_w), |content| {
                    content.outlet(engine[0], heat_w, state[STEP_S])
                })
            }
            // What others send through an idle boiler is known only now.
            _ if self.metal.is_some() && m_flow_kg_s == 0.0 && plan.heat_w() == 0.0 => {
                Outlet::Exchange { w_k: plan.metal_w_k, other_k: state[self.engine_at()] }
            }
            flow if heat_w > 0.0 && m_flow_kg_s > 0.0 => {
                let planned_k = heat_w / capacity_w_k(&self.medium, m_flow_kg_s);
                let hottest_k = match flow {
                    FlowRule::Supply(_) => signals.get(SUPPLY_SET).max(state[RETURN_K] + planned_k),
                    _ => self.limits.supply_max_k + BAND_K,
                };
                Outlet::Warmed { wanted_w: heat_w, hottest_k }
            }
            _ => Outlet::HeatFlow(heat_w),
        };
        wanted[0] = PortRequest { m_flow_kg_s, outlet };
    }

    fn advance(
        &self,
        dt_s: f64,
        signals: &Signals<'_>,
        ports: &[PortFlow],
        state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange {
        state[STEP_S] = dt_s;
        let plan = self.plan(signals, state);
        let PortFlow { m_flow_kg_s, t_in_k, t_out_k } = ports[0];
        let q_w = capacity_w_k(&self.medium, m_flow_kg_s) * (t_out_k - t_in_k);
        // What the water took of what was planned; a content takes it all.
        let planned_w = plan.heat_w();
        let partly = planned_w > 0.0 && self.engine.is_none();
        let share = if partly { ((q_w - plan.metal_w) / planned_w).clamp(0.0, 1.0) } else { 1.0 };
        let on = plan.main.on.max(plan.aux.on);
        let rod_w = share * plan.rod_w;
        let fuel_w = share * (plan.main.fuel_w + plan.aux.fuel_w);
        let power_w = share * (plan.main.power_w + plan.aux.power_w);
        let electric_w = self.idle_w * (1.0 - on) + self.running_w * on + rod_w - power_w;
        plan.next_main.write(&mut state[BURNERS..]);
        if self.aux.is_some() {
            plan.next_aux.write(&mut state[BURNERS + BurnerState::LEN..]);
        }
        state[TRIPPED] = f64::from(u8::from(plan.tripped));
        state[OVERSHOT] = f64::from(u8::from(plan.overshot));
        state[RETURN_K] = t_in_k;
        state[SUPPLY_K] = t_out_k;
        state[HEAT_J] += dt_s * q_w;
        state[FUEL_J] += dt_s * fuel_w;
        state[ELECTRIC_J] += dt_s * electric_w;
        state[GENERATED_J] += dt_s * power_w.max(0.0);
        let useful_w = q_w - rod_w + power_w.max(0.0);
        out[..15].copy_from_slice(&[
            q_w,
            electric_w,
            fuel_w,
            if fuel_w > 0.0 { useful_w / fuel_w } else { 0.0 },
            t_out_k,
            plan.main.modulation * plan.main.on,
            plan.next_main.phase.number(),
            state[TRIPPED],
            plan.next_main.starts,
            plan.next_main.operating_s,
            state[HEAT_J],
            state[FUEL_J],
            state[ELECTRIC_J],
            power_w.max(0.0),
            state[GENERATED_J],
        ]);
        if self.aux.is_some() {
            out[15..].copy_from_slice(&[
                share * plan.aux.heat_w,
                plan.next_aux.phase.number(),
                plan.next_aux.starts,
                rod_w,
            ]);
        }
        let mut kept_w = 0.0;
        if let Some(content) = self.engine {
            let engine = &mut state[self.engine_at()..];
            let lost_w = content.lost_w(engine[0], dt_s);
            kept_w = if dt_s > 0.0 { planned_w - lost_w - q_w } else { 0.0 };
            engine[0] += dt_s * kept_w / content.heat_capacity_j_k;
            engine[1] = f64::from(u8::from(plan.pump));
            engine[2] += dt_s * lost_w;
            out[15..].copy_from_slice(&[engine[0], lost_w, engine[2]]);
        }
        if let Some(metal) = self.metal {
            let own = &mut state[self.engine_at()..];
            // What the water took beside the heat of fuel came from the metal.
            kept_w = if dt_s > 0.0 { share * planned_w - q_w } else { 0.0 };
            own[0] += dt_s * kept_w / metal.heat_capacity_j_k;
            own[1] = m_flow_kg_s.abs();
            out[15] = own[0];
        }
        Exchange { electric_w, external_w: q_w + kept_w - electric_w }
    }

    fn longest_step_s(&self, _ports: &[PortFlow], state: &[f64]) -> f64 {
        let longest_s = |content: EngineContent| {
            let heat_w = self.main.map.at(1.0, state[RETURN_K]).heat_w;
            content.longest_step_s(state[self.engine_at()], heat_w, self.limits.supply_max_k)
        };
        self.engine.map_or(f64::INFINITY, longest_s)
    }

    fn stored_j(&self, state: &[f64]) -> f64 {
        let capacity_j_k = self.engine.map(|engine| engine.heat_capacity_j_k);
        let capacity_j_k = capacity_j_k.or(self.metal.map(|metal| metal.heat_capacity_j_k));
        capacity_j_k.map_or(0.0, |c| c * (state[self.engine_at()] - ZERO_CELSIUS_K))
    }

    fn flags(&self) -> &'static [Flag] {
        &[Flag {
            output: "tripped",
            meaning: "return or supply above its limit: it stops until both are below by the restart difference",
        }]
    }

    fn remarks(&self) -> Vec<String> {
        let mut remarks = crate::thermal_unit::scaled_far(self.size);
        let warm_up = &self.main.burner.warm_up;
        let twice_kwh = 0.5 * warm_up.heat_w * warm_up.lasts_s / 3.6e6;
        if self.engine.is_some() && twice_kwh > 0.0 {
            remarks.push(format!(
                "content_kj_k takes the heat of a cold start, and warm_up_kw another {twice_kwh:.2} kWh: leave warm_up_kw \
                 out, unless the engine has metal that warms up slower than its water"
            ));
        }
        remarks
    }
}

#[cfg(test)]
mod tests;

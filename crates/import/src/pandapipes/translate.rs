//! Junctions and branches of a pandapipes net as entries of a model.

use super::Friction;
use super::boundaries::{circulation, fixed};
use super::links::{BRANCHES, Branch, branches, reached};
use super::pumps::coefficients;
use super::tables::{Table, Tables};
use super::water::{Water, water};
use crate::model_text::ModelText;
use crate::{ImportError, NoteKind};
use std::collections::{HashMap, HashSet};
use std::f64::consts::PI;

/// Tables that say nothing of the flow.
const WITHOUT_FLOW: [&str; 3] = ["junction_geodata", "pipe_geodata", "controller"];
/// Tables at junctions: their sign for water that enters.
const AT_JUNCTIONS: [(&str, f64); 3] = [("sink", -1.0), ("source", 1.0), ("mass_storage", -1.0)];
/// An open valve without loss has this coefficient: 5 Pa at 1 m/s.
const LEAST_LOSS: f64 = 0.01;
/// The largest flow of a consumer, m3/s: none.
const ANY_FLOW_M3_S: f64 = 1e3;

/// The nearest temperature at which water is a liquid that anergy describes.
fn liquid(t_k: f64) -> f64 {
    t_k.clamp(0.5 + 273.15, 99.0 + 273.15)
}

pub(super) fn translate(
    net: &Tables,
    friction: Friction,
    text: &mut ModelText,
) -> Result<(), ImportError> {
    let junctions = net.table("junction")?;
    let temperatures: Vec<f64> =
        junctions.in_service().filter_map(|row| junctions.maybe(row, "tfluid_k")).collect();
    let initial_k = temperatures.iter().sum::<f64>() / temperatures.len().max(1) as f64;
    let water = water(net, initial_k)?;
    if let Some(t_k) = temperatures.iter().find(|t_k| liquid(**t_k) != **t_k) {
        let what = format!(
            "temperatures of junctions such as {t_k} K are not of liquid water: within 0.5 to 99 degC here"
        );
        text.note(NoteKind::Changed, None, what);
    }
    let what = format!("the friction law is {}, for which the file has no word", friction.word());
    text.note(NoteKind::Changed, None, what);
    let name = net.get("name");
    let name = name.as_deref().and_then(|name| name.as_str()).unwrap_or_default();
    let title = if name.is_empty() { "pandapipes net" } else { name };
    text.section("model").text("name", title).number("gravity", 9.81);
    text.section("run").number("initial_k", liquid(initial_k));
    text.section("fluid")
        .number("density_kg_m3", water.density)
        .number("heat_capacity_j_kg_k", water.heat_capacity)
        .number("viscosity_pa_s", water.viscosity);

    let usable: HashSet<i64> = junctions.in_service().map(|row| row.index).collect();
    let (fixed, mut m_flow) = (fixed(net, text)?, HashMap::new());
    circulation(net, &mut m_flow)?;
    for (name, sign) in AT_JUNCTIONS {
        let table = net.table(name)?;
        for row in table.in_service() {
            let flow =
                table.number(row, "mdot_kg_per_s")? * table.maybe(row, "scaling").unwrap_or(1.0);
            *m_flow.entry(table.integer(row, "junction")?).or_insert(0.0) += sign * flow;
        }
    }
    let tables: Vec<Table> =
        BRANCHES.iter().map(|(name, ..)| net.table(name)).collect::<Result<_, _>>()?;
    let branches = branches(net, &tables)?;
    let mut reached = reached(&branches, fixed.keys().copied(), &usable);
    reached.retain(|junction| {
        branches.iter().any(|branch| branch.from == *junction || branch.to == *junction)
    });
    for row in junctions.rows.iter().filter(|row| !reached.contains(&row.index)) {
        let takes = m_flow.get(&row.index).is_some_and(|flow| *flow != 0.0);
        let kind = if takes { NoteKind::Problem } else { NoteKind::NotTranslated };
        let what = "out of service, or without a way to an external grid";
        text.note(kind, None, format!("left out: junction {}: {what}", row.index));
    }
    let mut writer =
        Writer { net, text, water, friction, elevation: HashMap::new(), pipe_ends: HashMap::new() };
    let places = net.table("junction_geodata")?;
    for row in junctions.rows.iter().filter(|row| reached.contains(&row.index)) {
        let height = junctions.maybe(row, "height_m").unwrap_or(0.0);
        writer.elevation.insert(row.index, height);
        let start_k = junctions.maybe(row, "tfluid_k").map(liquid);
        let entry = writer.text.node(&node(row.index)).number("elevation_m", height);
        let flow = m_flow.get(&row.index).filter(|flow| **flow != 0.0);
        let entry = match (fixed.get(&row.index), flow) {
            (Some(fixed), _) => entry
                .text("kind", "pressure_boundary")
                .number("pressure_pa", fixed.pressure_pa)
                .maybe("temperature_k", fixed.temperature_k),
            (None, Some(flow)) => entry
                .text("kind", "source")
                .number("m_flow_kg_s", *flow)
                .maybe("temperature_k", start_k),
            (None, None) => entry,
        };
        if let Some(place) = places.rows.iter().find(|place| place.index == row.index) {
            let (x, y) = (places.maybe(place, "x"), places.maybe(place, "y"));
            entry.maybe("x_m", x).maybe("y_m", y);
        }
    }
    // Valves at pipes first: they change where the pipes end.
    let kept =
        |branch: &&Branch<'_>| reached.contains(&branch.from) && reached.contains(&branch.to);
    let (at_pipes, others): (Vec<&Branch<'_>>, Vec<&Branch<'_>>) =
        branches.iter().filter(kept).partition(|branch| branch.at_pipe.is_some());
    for branch in at_pipes.into_iter().chain(others) {
        writer.branch(branch)?;
    }
    others_noted(net, &tables, text);
    Ok(())
}

/// The name of a junction.
fn node(junction: i64) -> String {
    format!("junction{junction}")
}

/// Tables that no entry stands for, and rows out of service.
fn others_noted(net: &Tables, branches: &[Table], text: &mut ModelText) {
    let known = ["junction", "ext_grid", "circ_pump_mass", "circ_pump_pressure"];
    for (name, rows) in net.filled() {
        let branch = BRANCHES.iter().any(|(known, ..)| *known == name);
        let at_junction = AT_JUNCTIONS.iter().any(|(known, _)| *known == name);
        if branch || at_junction || known.contains(&name) || name.starts_with("res_") {
            continue;
        }
        if name == "junction_geodata" {
            continue;
        }
        let kind =
            if WITHOUT_FLOW.contains(&name) { NoteKind::NotTranslated } else { NoteKind::Problem };
        text.note(kind, None, format!("table {name} with {rows} rows"));
    }
    for table in branches {
        for row in &table.rows {
            if !table.flag(row, "in_service") || !table.flag(row, "opened") {
                let what = "left out, as it is closed or out of service";
                text.note(NoteKind::Changed, None, format!("{} {}: {what}", table.name, row.index));
            }
        }
    }
}

struct Writer<'a> {
    net: &'a Tables,
    text: &'a mut ModelText,
    water: Water,
    friction: Friction,
    elevation: HashMap<i64, f64>,
    /// Nodes between a pipe and the valve at its end, by pipe and junction.
    pipe_ends: HashMap<(i64, i64), String>,
}

impl Writer<'_> {
    fn branch(&mut self, branch: &Branch<'_>) -> Result<(), ImportError> {
        let Branch { table, row, .. } = branch;
        let id = format!("{}{}", table.name, row.index);
        let ends = [node(branch.from), node(branch.to)];
        match table.name.as_str() {
            "pipe" => self.pipe(branch, &id)?,
            "valve" => {
                let mut ends = ends;
                if let Some(pipe) = branch.at_pipe {
                    ends[1] = format!("{id}.pipe{pipe}");
                    let height = self.elevation.get(&branch.from).copied().unwrap_or(0.0);
                    self.text.node(&ends[1]).number("elevation_m", height);
                    self.pipe_ends.insert((pipe, branch.from), ends[1].clone());
                }
                self.resistance(branch, &id, &ends)?;
            }
            "pump" => self.pump(branch, &id, &ends)?,
            "heat_exchanger" => {
                self.resistance(branch, &id, &ends)?;
                self.heat(branch, &id);
            }
            "heat_consumer" => self.consumer(branch, &id, &ends)?,
            "flow_control" if !table.flag(row, "control_active") => {
                self.resistance_of(&id, &ends, LEAST_LOSS, 0.1);
            }
            "flow_control" => {
                let m_flow = table.number(row, "controlled_mdot_kg_per_s")?;
                let [from, to] = &ends;
                self.text.edge(&id, "flow_source", from, to).number("m_flow_kg_s", m_flow);
            }
            _ => self.pressure_control(branch, &id, &ends)?,
        }
        Ok(())
    }

    fn pipe(&mut self, branch: &Branch<'_>, id: &str) -> Result<(), ImportError> {
        let Branch { table, row, .. } = branch;
        let end = |junction: i64| match self.pipe_ends.get(&(row.index, junction)) {
            Some(between) => between.clone(),
            None => node(junction),
        };
        let (from, to) = (end(branch.from), end(branch.to));
        let diameter_m = table.diameter_m(row)?;
        if table.number(row, "length_km")? == 0.0 {
            let loss = table.maybe(row, "loss_coefficient").unwrap_or(0.0);
            self.resistance_of(id, &[from, to], loss, diameter_m);
            let what = format!("{id} has no length: it is a resistance");
            self.text.note(NoteKind::Changed, None, what);
            return Ok(());
        }
        let u = ["u_w_per_m2k", "alpha_w_per_m2k"].iter().find_map(|key| table.maybe(row, key));
        let outer_m = table.maybe(row, "outer_diameter_mm").map_or(diameter_m, |mm| 1e-3 * mm);
        let u = u.filter(|u| *u > 0.0);
        let entry = self
            .text
            .edge(id, "pipe", &from, &to)
            .number("length_m", 1e3 * table.positive(row, "length_km")?)
            .number("inner_diameter_m", diameter_m)
            .number("roughness_m", 1e-3 * table.number(row, "k_mm")?)
            .number_unless(0.0, "zeta", table.maybe(row, "loss_coefficient").unwrap_or(0.0))
            .text("friction", self.friction.word())
            .maybe("insulation_resistance_k_m_w", u.map(|u| 1.0 / (u * PI * outer_m)));
        let surroundings = table.maybe(row, "text_k").filter(|t_k| u.is_some() && *t_k > 200.0);
        entry.maybe("surroundings_k", surroundings);
        if table.maybe(row, "qext_w").is_some_and(|heat| heat != 0.0) {
            let what = format!("{id}: its heat qext_w, which pandapipes has given up too");
            self.text.note(NoteKind::NotTranslated, None, what);
        }
        Ok(())
    }

    /// What an exchanger takes from the water that passes its resistance.
    fn heat(&mut self, Branch { table, row, .. }: &Branch<'_>, port: &str) {
        if let Some(heat_w) = table.maybe(row, "qext_w").filter(|heat| *heat != 0.0) {
            self.text
                .entry("unit")
                .text("id", &format!("{port}.heat"))
                .text("kind", "heat_source")
                .text("port", port)
                .number("heat_w", -heat_w);
        }
    }

    fn resistance(
        &mut self,
        branch: &Branch<'_>,
        id: &str,
        ends: &[String; 2],
    ) -> Result<(), ImportError> {
        let Branch { table, row, .. } = branch;
        let loss = table.maybe(row, "loss_coefficient").unwrap_or(0.0);
        self.resistance_of(id, ends, loss, table.diameter_m(row)?);
        Ok(())
    }

    fn resistance_of(&mut self, id: &str, [from, to]: &[String; 2], loss: f64, diameter_m: f64) {
        let density = self.water.density;
        self.text
            .edge(id, "resistance", from, to)
            .number("dp_nominal_pa", loss.max(LEAST_LOSS) * density / 2.0)
            .number("m_flow_nominal_kg_s", density * PI / 4.0 * diameter_m * diameter_m)
            .number("delta_m", 1e-3);
    }

    fn pump(
        &mut self,
        branch: &Branch<'_>,
        id: &str,
        [from, to]: &[String; 2],
    ) -> Result<(), ImportError> {
        let Branch { table, row, .. } = branch;
        let name = table.text(row, "std_type").unwrap_or_default();
        let Some(curve) = coefficients(self.net, name) else {
            return Err(table.error(row, &format!("there is no pump type \"{name}\"")));
        };
        match curve[..] {
            [] => return Err(table.error(row, &format!("the curve of \"{name}\" is empty"))),
            [head_pa] => {
                self.text.edge(id, "pressure_source", from, to).number("head_pa", head_pa);
            }
            _ => {
                self.text
                    .edge(id, "pump", from, to)
                    .number("speed", 1.0)
                    .number("initial_speed", 1.0)
                    .number("delta_m", 1e-4)
                    .numbers("curve_polynomial", &curve);
            }
        }
        Ok(())
    }

    /// A flow with a heat load on it.
    fn consumer(
        &mut self,
        branch: &Branch<'_>,
        id: &str,
        [from, to]: &[String; 2],
    ) -> Result<(), ImportError> {
        let Branch { table, row, .. } = branch;
        let get = |column| table.maybe(row, column);
        let (heat, m_flow) = (get("qext_w"), get("controlled_mdot_kg_per_s"));
        let (difference, return_k) = (get("deltat_k"), get("treturn_k"));
        let cp = self.water.heat_capacity;
        let heat = heat.or_else(|| Some(m_flow? * cp * difference?));
        let difference = difference.or_else(|| Some(heat? / (cp * m_flow?)));
        let load = heat.filter(|heat| *heat > 0.0);
        match (load, difference.filter(|k| *k > 0.0), return_k) {
            (Some(load), difference, return_k) if difference.is_some() || return_k.is_some() => {
                let return_k = if difference.is_some() { None } else { return_k };
                // The port of a unit that takes heat stands against its flow.
                self.text.edge(id, "flow_source", to, from);
                self.text
                    .entry("unit")
                    .text("id", &format!("{id}.load"))
                    .text("kind", "heat_load")
                    .text("port", id)
                    .number("load_w", load)
                    .maybe("temperature_difference_k", difference)
                    .maybe("return_k", return_k)
                    .number("v_flow_max_m3_s", ANY_FLOW_M3_S)
                    .number("coldest_return_k", 273.65);
            }
            _ if m_flow.is_some() => {
                self.text.edge(id, "flow_source", from, to).maybe("m_flow_kg_s", m_flow);
                if heat != Some(0.0) {
                    let what = format!("{id}: its heat; the flow is as given");
                    self.text.note(NoteKind::NotTranslated, None, what);
                }
            }
            _ => return Err(table.error(row, "neither its flow nor its heat can be told")),
        }
        Ok(())
    }

    /// An ideal head that follows from the pressure of a junction.
    fn pressure_control(
        &mut self,
        branch: &Branch<'_>,
        id: &str,
        ends: &[String; 2],
    ) -> Result<(), ImportError> {
        let Branch { table, row, .. } = branch;
        if !table.flag(row, "control_active") {
            self.resistance_of(id, ends, LEAST_LOSS, 0.1);
            return Ok(());
        }
        let [from, to] = ends;
        self.text.edge(id, "pressure_source", from, to).number("head_pa", 0.0);
        let controlled = node(table.integer(row, "controlled_junction")?);
        self.text
            .entry("prescribed")
            .text("id", &format!("{id}.control"))
            .text("quantity", &format!("{controlled}.p_pa"))
            .number("value", 1e5 * table.number(row, "controlled_p_bar")?)
            .text("free", &format!("{id}.head_pa"));
        Ok(())
    }
}

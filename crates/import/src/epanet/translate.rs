//! Nodes and pipes of an EPANET network as entries of a model.

use super::EpanetOptions;
use super::network::{Link, LinkKind, Network, NodeKind, Status};
use super::reach::Reach;
use super::units::{HeadLoss, Options};
use crate::NoteKind;
use crate::model_text::ModelText;
use std::f64::consts::PI;

/// Velocity at which the loss of a fitting is written, m/s.
pub(super) const VELOCITY_M_S: f64 = 1.0;
/// Loss of an open check valve at that velocity, Pa: nothing beside a pipe.
const CHECK_VALVE_PA: f64 = 0.1;
/// Share of the flow at that velocity below which it is linear: a steep law would leave little of the
/// numbers beside the shut valve.
const CHECK_VALVE_DELTA_M: f64 = 1.0;
/// Flow back through a shut check valve at 1 bar, kg/s: half of what EPANET lets through a closed link.
const CHECK_VALVE_LEAK_KG_S: f64 = 1e-4;
/// A fitting without loss has this coefficient: 0.5 mm of water at 1 m/s.
pub(super) const LEAST_MINOR_LOSS: f64 = 0.01;
/// Largest roughness of a pipe over its diameter.
const ROUGHEST: f64 = 0.1;
/// A smaller pipe is a placeholder.
const LEAST_DIAMETER_M: f64 = 1e-3;
/// Roughness of a pipe that does not give one.
const DEFAULT_ROUGHNESS_M: f64 = 5e-5;
/// Level of a full or empty tank, m.
const LEVEL_M: f64 = 1e-4;

/// What is at hand while a network is written.
pub(super) struct Writer<'a> {
    pub network: &'a Network,
    pub options: &'a Options,
    pub text: &'a mut ModelText,
    pub wanted: EpanetOptions,
}

/// Writes the model.
pub(super) fn translate(
    network: &Network,
    options: &Options,
    wanted: EpanetOptions,
    title: &[&str],
    text: &mut ModelText,
) {
    text.reserve(
        network.nodes.iter().map(|node| node.id.as_str()),
        network.links.iter().map(|link| link.id.as_str()),
    );
    let reach = Reach::of(network);
    reach.note_closed(network, text);
    reach.note_cut_off(network, options, text);
    head(options, wanted, title, text);
    let mut writer = Writer { network, options, text, wanted };
    for (i, _) in network.nodes.iter().enumerate().filter(|(i, _)| reach.nodes[*i]) {
        writer.node(i);
    }
    for (i, link) in network.links.iter().enumerate().filter(|(i, _)| reach.links[*i]) {
        match &link.kind {
            LinkKind::Pipe { check_valve, .. } => {
                let ends = writer.guarded(i, *check_valve);
                writer.pipe(link, &ends);
            }
            LinkKind::Pump { head_times_flow_m4_s: Some(_), .. }
                if reach.leads_nowhere(network, options, i) =>
            {
                writer.idle_pump(link);
            }
            LinkKind::Pump { .. } => writer.pump(i),
            LinkKind::Valve { .. } => writer.valve(i),
        }
    }
    if !wanted.steady {
        writer.schedules(&reach);
    } else if options.duration_s > 0.0 {
        let what = "patterns after t = 0, as only the state at t = 0 is wanted";
        text.note(NoteKind::NotTranslated, None, what.into());
    }
    if network.links.iter().any(Link::has_loss) {
        let what = format!(
            "loss coefficients are {:.5} of those of the original, as EPANET rounds the loss of a fitting \
             to 0.02517 K q2/d4 in feet",
            options.loss_coefficient(1.0)
        );
        text.note(NoteKind::Changed, None, what);
    }
    if network.nodes.iter().any(|node| matches!(node.kind, NodeKind::Tank { .. })) {
        let what = "tanks hold their level of t = 0, they do not fill or run empty";
        text.note(NoteKind::Changed, None, what.into());
    }
}

/// What is said once.
fn head(options: &Options, wanted: EpanetOptions, title: &[&str], text: &mut ModelText) {
    let rest = title.get(1..).unwrap_or_default().join(" ");
    let mut model = text.section("model").text("name", title.first().unwrap_or(&"EPANET network"));
    if !rest.is_empty() {
        model = model.text("description", &rest);
    }
    model.number("gravity", options.gravity_m_s2());
    if options.duration_s > 0.0 && !wanted.steady {
        let seconds = |s: f64| format!("{s}s");
        text.section("run")
            .text("until", &seconds(options.duration_s))
            .text("step", &seconds(options.hydraulic_step_s))
            .text("record", &seconds(options.report_step_s));
    }
    let density = options.density_kg_m3();
    text.section("fluid")
        .number("density_kg_m3", density)
        .number("viscosity_pa_s", options.viscosity_m2_s() * density);
}

impl Writer<'_> {
    fn node(&mut self, i: usize) {
        let (network, options) = (self.network, self.options);
        let node = &network.nodes[i];
        let demand = match &node.kind {
            NodeKind::Junction { demands, .. } => {
                let has_demand = demands.iter().any(|demand| demand.base_m3_s != 0.0);
                has_demand.then(|| network.demand_m3_s(demands, options, 0))
            }
            _ => None,
        };
        let factor = match &node.kind {
            NodeKind::Reservoir { pattern } => network.factor(pattern.as_ref(), options, 0),
            _ => 1.0,
        };
        let entry = self.text.node(&node.id);
        let entry = match (node.head_m(), demand) {
            (Some(head), _) => entry
                .text("kind", "pressure_boundary")
                .number("pressure_pa", 0.0)
                .number("elevation_m", head * factor),
            (None, Some(demand)) => entry
                .text("kind", "source")
                .number("m_flow_kg_s", 0.0 - demand * options.density_kg_m3())
                .number("elevation_m", node.elevation_m),
            (None, None) => entry.number("elevation_m", node.elevation_m),
        };
        let (x, y) = node.place.unzip();
        entry.maybe("x_m", x).maybe("y_m", y);
        if let NodeKind::Junction { emitter, .. } = node.kind
            && emitter > 0.0
        {
            self.emitter(i, emitter);
        }
    }

    /// An emitter, `q = c p^e`, is a resistance into the open with the exponent 1/e.
    fn emitter(&mut self, i: usize, coefficient: f64) {
        let (node, options) = (&self.network.nodes[i], self.options);
        let exponent = 1.0 / options.emitter_exponent;
        if !(0.5..=4.0).contains(&exponent) {
            let what = format!(
                "emitter of \"{}\": the exponent {} is not between 0.25 and 2; nothing flows out",
                node.id, options.emitter_exponent
            );
            self.text.note(NoteKind::Problem, node.line, what);
            return;
        }
        let orifice = (exponent - 2.0).abs() < 1e-9;
        let outside = self.text.new_node_id(&format!("{}.outside", node.id));
        let edge = self.text.new_edge_id(&format!("{}.emitter", node.id));
        self.text
            .node(&outside)
            .text("kind", "pressure_boundary")
            .number("pressure_pa", 0.0)
            .number("elevation_m", node.elevation_m);
        self.text
            .edge(&edge, "resistance", &node.id, &outside)
            .number("dp_nominal_pa", options.pressure_m() * options.pa_m())
            .number(
                "m_flow_nominal_kg_s",
                coefficient * options.flow_m3_s * options.density_kg_m3(),
            )
            .number("delta_m", 1e-3)
            .maybe("exponent", (!orifice).then_some(exponent));
        let what = format!("the emitter of \"{}\" is the resistance \"{edge}\"", node.id);
        self.text.note(NoteKind::Changed, node.line, what);
    }

    fn pipe(&mut self, link: &Link, [from, to]: &[String; 2]) {
        let LinkKind::Pipe { length_m, diameter_m, roughness, minor_loss, .. } = link.kind else {
            return;
        };
        let (law, roughest) = (self.options.head_loss, ROUGHEST * diameter_m);
        if law == HeadLoss::DarcyWeisbach && roughness > roughest {
            let what = format!(
                "its roughness of {roughness:.3} m is more than a tenth of its diameter, which is taken"
            );
            link.note(self.text, NoteKind::Problem, &what);
        }
        if diameter_m < LEAST_DIAMETER_M {
            let what = format!("its diameter of {} mm lets nothing through", 1e3 * diameter_m);
            link.note(self.text, NoteKind::Problem, &what);
        }
        let zeta = self.options.loss_coefficient(minor_loss);
        let mut entry = self
            .text
            .edge(&link.id, "pipe", from, to)
            .number("length_m", length_m)
            .number("inner_diameter_m", diameter_m)
            .number_unless(0.0, "zeta", zeta);
        if law != HeadLoss::DarcyWeisbach && DEFAULT_ROUGHNESS_M > roughest {
            entry = entry.number("roughness_m", 0.0);
        }
        match law {
            HeadLoss::DarcyWeisbach => entry
                .number("roughness_m", roughness.min(roughest))
                .text("friction", "swamee_jain")
                .text("transition", "dunlop"),
            HeadLoss::HazenWilliams => {
                entry.number("hazen_williams_c", roughness).text("friction", "hazen_williams")
            }
            HeadLoss::ChezyManning => {
                entry.number("manning_n", roughness).text("friction", "chezy_manning")
            }
        };
    }

    /// The ends of a link, the second one replaced by a new node before a check valve where water must
    /// not flow back, and the first one where a tank is full or empty.
    pub(super) fn guarded(&mut self, i: usize, check_valve: bool) -> [String; 2] {
        let link = &self.network.links[i];
        let mut ends = [link.from, link.to].map(|node| self.network.nodes[node].id.clone());
        if check_valve {
            ends[1] = self.check_valve(link, "check", &ends[1].clone(), true);
            let what = "the check valve is an edge of its own";
            link.note(self.text, NoteKind::Changed, what);
        }
        for (end, node) in [(0, link.from), (1, link.to)] {
            let NodeKind::Tank { level_m, min_m, max_m, overflows } = self.network.nodes[node].kind
            else {
                continue;
            };
            let full = level_m >= max_m - LEVEL_M && !overflows;
            let empty = level_m <= min_m + LEVEL_M;
            if full == empty {
                continue;
            }
            // Out of a full tank, into an empty one.
            let towards_to = (end == 0) == full;
            let name = if full { "full" } else { "empty" };
            let tank = ends[end].clone();
            ends[end] = self.check_valve(link, name, &tank, (end == 1) == towards_to);
            let what = format!("a check valve stands for the tank \"{tank}\", which is {name}");
            link.note(self.text, NoteKind::Changed, &what);
        }
        ends
    }

    /// A check valve between a link and a node, which lets water pass into the node or out of it; gives
    /// the node between.
    fn check_valve(&mut self, link: &Link, name: &str, node: &str, into: bool) -> String {
        let at = self.network.node_at(node).unwrap_or(link.to);
        let elevation = self.network.nodes[at].head_m();
        let elevation = elevation.unwrap_or(self.network.nodes[at].elevation_m);
        let between = self.text.new_node_id(&format!("{}.{name}", link.id));
        let edge = self.text.new_edge_id(&format!("{}.{name}_valve", link.id));
        let m_flow = self.nominal_m_flow_kg_s(link);
        let density = self.options.density_kg_m3();
        let leakage = CHECK_VALVE_LEAK_KG_S / (m_flow * (1e5 / CHECK_VALVE_PA).sqrt());
        self.text.node(&between).number("elevation_m", elevation);
        let (from, to) = if into { (between.as_str(), node) } else { (node, between.as_str()) };
        self.text
            .edge(&edge, "check_valve", from, to)
            .number("kvs_m3_h", kv_m3_h(CHECK_VALVE_PA, m_flow, density))
            .number("leakage", leakage)
            .number("m_flow_nominal_kg_s", m_flow)
            .number("delta_m", CHECK_VALVE_DELTA_M);
        between
    }

    /// Flow of a link at 1 m/s, kg/s; of a pump, which has no diameter, that of its curve.
    fn nominal_m_flow_kg_s(&self, link: &Link) -> f64 {
        let density = self.options.density_kg_m3();
        match link.kind {
            LinkKind::Pipe { diameter_m, .. } | LinkKind::Valve { diameter_m, .. } => {
                m_flow_at_velocity(diameter_m, density)
            }
            LinkKind::Pump { .. } => density * self.pump_flow_m3_s(link),
        }
    }
}

/// Mass flow at 1 m/s.
pub(super) fn m_flow_at_velocity(diameter_m: f64, density: f64) -> f64 {
    density * VELOCITY_M_S * PI / 4.0 * diameter_m * diameter_m
}

/// The coefficient of a fitting with a given loss at a given flow, m3/h at 1 bar.
pub(super) fn kv_m3_h(dp_pa: f64, m_flow_kg_s: f64, density: f64) -> f64 {
    m_flow_kg_s / density * 3600.0 * (density / 1000.0 * 1e5 / dp_pa).sqrt()
}

/// Whether a link lets water pass at the start.
pub(super) fn is_open(link: &Link) -> bool {
    link.status != Status::Closed
}

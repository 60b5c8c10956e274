//! Valves of an EPANET network.

use super::network::{Link, LinkKind, Status, ValveKind};
use super::pumps::straight_pieces;
use super::translate::{LEAST_MINOR_LOSS, VELOCITY_M_S, Writer, kv_m3_h, m_flow_at_velocity};
use crate::NoteKind;

/// Band of a self-acting valve, around the pressure it holds, and its leakage.
const BAND_PA: f64 = 100.0;
const LEAKAGE: f64 = 1e-6;
/// EPANET opens a position control valve at least so far.
const LEAST_COEFFICIENT: f64 = 1e-3;
/// Share of the flow at 1 m/s below which the loss of a valve is regularised.
const DELTA_M: f64 = 1e-3;

impl Writer<'_> {
    pub(super) fn valve(&mut self, i: usize) {
        let network = self.network;
        let link = &network.links[i];
        let LinkKind::Valve { kind, diameter_m, minor_loss, .. } = link.kind else { return };
        let holds_pressure =
            matches!(kind, ValveKind::Prv | ValveKind::Psv) && link.status == Status::Active;
        // EPANET's let no water back; an ideal one that would have to is shut anyway.
        let ends = self.guarded(i, holds_pressure && self.wanted.self_acting);
        if link.status == Status::Open {
            self.throttle(link, &ends, minor_loss);
            return;
        }
        match kind {
            ValveKind::Prv | ValveKind::Psv => self.pressure_valve(link, kind, &ends, minor_loss),
            ValveKind::Fcv => {
                let (density, flow) = (self.options.density_kg_m3(), self.options.flow_m3_s);
                let kvs_m3_h = self.kvs_m3_h(diameter_m, minor_loss);
                self.text
                    .edge(&link.id, "flow_limiter", &ends[0], &ends[1])
                    .number("kvs_m3_h", kvs_m3_h)
                    .number("m_flow_set_kg_s", link.setting * flow * density);
            }
            ValveKind::Tcv => self.throttle(link, &ends, link.setting),
            ValveKind::Pbv => {
                let drop = link.setting * self.options.pressure_m() * self.options.pa_m();
                self.text
                    .edge(&link.id, "pressure_source", &ends[0], &ends[1])
                    .number("head_pa", -drop);
                let what = "a pressure source that takes its pressure away at any flow";
                link.note(self.text, NoteKind::Changed, what);
            }
            ValveKind::Gpv => self.general_purpose(link, &ends),
            ValveKind::Pcv => {
                // The flow coefficient relative to that of the open valve, at least EPANET's.
                let relative = self.relative_coefficient(link).max(LEAST_COEFFICIENT);
                self.throttle(link, &ends, minor_loss / (relative * relative));
            }
        }
    }

    /// The points of the curve of a valve, as written.
    fn curve(&self, link: &Link) -> &[(f64, f64)] {
        let LinkKind::Valve { curve: Some(id), .. } = &link.kind else { return &[] };
        self.network.curves.get(id).map(Vec::as_slice).unwrap_or_default()
    }

    /// Flow coefficient of a valve in its position over that of the open one: straight between the points
    /// of its curve, the position itself without one.
    fn relative_coefficient(&self, link: &Link) -> f64 {
        let position = link.setting.clamp(0.0, 100.0);
        let ends = [(0.0, 0.0), (100.0, 100.0)];
        let mut points = vec![ends[0]];
        points.extend(self.curve(link).iter().filter(|(x, _)| *x > 0.0 && *x < 100.0));
        points.push(ends[1]);
        let next = points.partition_point(|(x, _)| *x <= position).clamp(1, points.len() - 1);
        let ((x0, y0), (x1, y1)) = (points[next - 1], points[next]);
        (y0 + (y1 - y0) * (position - x0) / (x1 - x0)) / 100.0
    }

    /// A valve whose loss follows a curve, as straight pieces.
    fn general_purpose(&mut self, link: &Link, ends: &[String; 2]) {
        let (flow, head_pa) =
            (self.options.flow_m3_s, self.options.length_m() * self.options.pa_m());
        let points: Vec<(f64, f64)> =
            self.curve(link).iter().map(|(q, h)| (q * flow, h * head_pa)).collect();
        let rises = |pair: &[(f64, f64)]| pair[1].0 > pair[0].0 && pair[1].1 > pair[0].1;
        let rising = points.windows(2).all(rises)
            && points
                .first()
                .is_some_and(|(q, h)| (*q > 0.0 && *h > 0.0) || (*q == 0.0 && *h == 0.0));
        let from_zero = points.first().filter(|(q, _)| *q > 0.0).map(|_| (0.0, 0.0));
        let points: Vec<(f64, f64)> = from_zero.into_iter().chain(points).collect();
        if !rising || points.len() < 2 {
            let what = "left out: the loss of its curve does not rise with the flow from zero on";
            link.note(self.text, NoteKind::Problem, what);
            return;
        }
        let (flows, losses): (Vec<f64>, Vec<f64>) = straight_pieces(&points).into_iter().unzip();
        self.text
            .edge(&link.id, "resistance", &ends[0], &ends[1])
            .numbers("curve_v_flow_m3_s", &flows)
            .numbers("curve_dp_pa", &losses);
        let what = if from_zero.is_some() {
            "the straight pieces of its curve are rounded within 0.1 % beside the points; the first one begins \
             at no flow and no loss"
        } else {
            "the straight pieces of its curve are rounded within 0.1 % beside the points"
        };
        link.note(self.text, NoteKind::Changed, what);
    }

    /// A resistance with a loss coefficient.
    fn throttle(&mut self, link: &Link, ends: &[String; 2], coefficient: f64) {
        let LinkKind::Valve { diameter_m, .. } = link.kind else { return };
        let density = self.options.density_kg_m3();
        let loss_pa = self.loss_pa(coefficient);
        self.text
            .edge(&link.id, "resistance", &ends[0], &ends[1])
            .number("dp_nominal_pa", loss_pa)
            .number("m_flow_nominal_kg_s", m_flow_at_velocity(diameter_m, density))
            .number("delta_m", DELTA_M);
    }

    /// Loss at 1 m/s.
    fn loss_pa(&self, coefficient: f64) -> f64 {
        let density = self.options.density_kg_m3();
        let coefficient = self.options.loss_coefficient(coefficient).max(LEAST_MINOR_LOSS);
        coefficient * density / 2.0 * VELOCITY_M_S * VELOCITY_M_S
    }

    fn kvs_m3_h(&self, diameter_m: f64, minor_loss: f64) -> f64 {
        let density = self.options.density_kg_m3();
        kv_m3_h(self.loss_pa(minor_loss), m_flow_at_velocity(diameter_m, density), density)
    }

    /// A valve whose opening follows from the pressure behind it (PRV) or before it (PSV).
    fn pressure_valve(
        &mut self,
        link: &Link,
        kind: ValveKind,
        ends: &[String; 2],
        minor_loss: f64,
    ) {
        let LinkKind::Valve { diameter_m, .. } = link.kind else { return };
        let node = if kind == ValveKind::Prv { link.to } else { link.from };
        let node = &self.network.nodes[node];
        if node.head_m().is_some() {
            let what = format!("left out: it cannot hold the pressure of \"{}\"", node.id);
            link.note(self.text, NoteKind::Problem, &what);
            return;
        }
        let kvs_m3_h = self.kvs_m3_h(diameter_m, minor_loss);
        let pressure_pa = link.setting * self.options.pressure_m() * self.options.pa_m();
        if self.wanted.self_acting {
            let kind = match kind {
                ValveKind::Prv => "pressure_reducing_valve",
                _ => "pressure_sustaining_valve",
            };
            self.text
                .edge(&link.id, kind, &ends[0], &ends[1])
                .number("kvs_m3_h", kvs_m3_h)
                .number("pressure_set_pa", pressure_pa - 0.5 * BAND_PA)
                .number("band_pressure_pa", BAND_PA)
                .text("sensed_node", &node.id)
                .number("leakage", LEAKAGE)
                .number("delta_m", DELTA_M);
            let what = format!("it is self-acting and holds its pressure within {BAND_PA} Pa");
            link.note(self.text, NoteKind::Changed, &what);
            return;
        }
        self.text
            .edge(&link.id, "valve", &ends[0], &ends[1])
            .number("kvs_m3_h", kvs_m3_h)
            .text("characteristic", "linear")
            .number("leakage", 0.0)
            .number("opening", 1.0)
            .number("m_flow_nominal_kg_s", m_flow_at_velocity(diameter_m, 1000.0));
        let control = format!("{}.control", link.id);
        self.text
            .entry("prescribed")
            .text("id", &control)
            .text("quantity", &format!("{}.p_pa", node.id))
            .number("value", pressure_pa)
            .text("free", &format!("{}.opening", link.id));
        let what = format!("its opening is found so that \"{}\" has its pressure", node.id);
        link.note(self.text, NoteKind::Changed, &what);
    }
}

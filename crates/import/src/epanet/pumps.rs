//! Pumps of an EPANET network: power-law curves, points, constant power.

use super::network::{Link, LinkKind};
use super::translate::Writer;
use crate::NoteKind;

/// EPANET's head at zero flow over that of a curve of one point.
const ONE_POINT_HEAD: f64 = 1.33334;
/// Heads between which a pump of constant power has a curve, m, and the ratio of neighbours: between
/// them the curve is off by 1e-6.
const POWER_HEADS_M: (f64, f64) = (1000.0, 1.0);
const POWER_STEP: f64 = 1.02;
/// Places of more points on each straight piece of a curve: only what is beside a given point is rounded.
const PLACES: [f64; 7] = [0.001, 0.01, 0.1, 0.5, 0.9, 0.99, 0.999];
/// Loss of a pump that moves no water, Pa.
const IDLE_PA: f64 = 1000.0;
/// Share of the free flow below which a curve is regularised.
const DELTA_M: f64 = 1e-4;

/// Head of a pump over its flow at full speed.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum HeadCurve {
    /// `h = h0 (1 - (q/q0)^n)`
    Power { head_m: f64, free_flow_m3_s: f64, exponent: f64 },
    /// Points from zero flow on.
    Points { flow_m3_s: Vec<f64>, head_m: Vec<f64> },
}

impl HeadCurve {
    /// Flow for which the pump is made.
    fn flow_m3_s(&self) -> f64 {
        match self {
            Self::Power { free_flow_m3_s, .. } => 0.5 * free_flow_m3_s,
            Self::Points { flow_m3_s, .. } => flow_m3_s[flow_m3_s.len() / 2],
        }
    }
}

/// Curve of a pump that gives its power to the water at any flow: a hyperbola of points.
pub(super) fn of_constant_power(head_times_flow_m4_s: f64) -> HeadCurve {
    let (highest, lowest) = POWER_HEADS_M;
    let steps = ((highest / lowest).ln() / POWER_STEP.ln()).ceil() as i32;
    let heads = (0..=steps).map(|i| highest * POWER_STEP.powi(-i));
    let flows = heads.clone().map(|head| head_times_flow_m4_s / head);
    // A curve begins at zero flow: there the hyperbola is left along its tangent.
    HeadCurve::Points {
        flow_m3_s: std::iter::once(0.0).chain(flows).collect(),
        head_m: std::iter::once(2.0 * highest).chain(heads).collect(),
    }
}

/// Curve through points of flow and head.
pub(super) fn through(points: &[(f64, f64)]) -> Result<HeadCurve, String> {
    match points {
        [] => Err("its curve has no points".into()),
        [(q, h)] => power_law(ONE_POINT_HEAD * h, (*q, *h), (2.0 * q, 0.0)),
        [(first, h0), one, two] if *first == 0.0 => power_law(*h0, *one, *two),
        _ => of_points(points),
    }
}

/// The power law through zero flow and two points.
fn power_law(h0: f64, (q1, h1): (f64, f64), (q2, h2): (f64, f64)) -> Result<HeadCurve, String> {
    let exponent = ((h0 - h2) / (h0 - h1)).ln() / (q2 / q1).ln();
    let falls = h0 > h1 && h1 > h2 && q1 > 0.0 && q2 > q1;
    if !(falls && exponent > 0.0 && exponent <= 20.0) {
        return Err("no power law goes through its curve".into());
    }
    let coefficient = (h0 - h1) / q1.powf(exponent);
    let free_flow_m3_s = (h0 / coefficient).powf(1.0 / exponent);
    Ok(HeadCurve::Power { head_m: h0, free_flow_m3_s, exponent })
}

/// Straight pieces through all points, the first one continued to zero flow.
fn of_points(points: &[(f64, f64)]) -> Result<HeadCurve, String> {
    let falls = |pair: &[(f64, f64)]| pair[1].0 > pair[0].0 && pair[1].1 < pair[0].1;
    if !points.windows(2).all(falls) || points[0].0 < 0.0 {
        return Err("its curve does not fall from point to point".into());
    }
    let mut points = points.to_vec();
    let [(q0, h0), (q1, h1), ..] = points[..] else {
        return Err("its curve has no points".into());
    };
    if q0 > 0.0 {
        points.insert(0, (0.0, h0 + (h0 - h1) / (q1 - q0) * q0));
    }
    let (flow_m3_s, head_m) = straight_pieces(&points).into_iter().unzip();
    Ok(HeadCurve::Points { flow_m3_s, head_m })
}

/// More points on the straight lines between points, so that a smooth curve follows them.
pub(super) fn straight_pieces(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut all: Vec<(f64, f64)> = points.first().copied().into_iter().collect();
    for pair in points.windows(2) {
        let [(qa, ha), (qb, hb)] = [pair[0], pair[1]];
        all.extend(PLACES.map(|share| (qa + share * (qb - qa), ha + share * (hb - ha))));
        all.push((qb, hb));
    }
    all
}

impl Writer<'_> {
    fn head_curve(&self, link: &Link) -> Result<HeadCurve, String> {
        let LinkKind::Pump { head_times_flow_m4_s, curve, .. } = &link.kind else {
            return Err("it is no pump".into());
        };
        if let Some(power) = head_times_flow_m4_s {
            return Ok(of_constant_power(*power));
        }
        let id = curve.as_deref().unwrap_or_default();
        let points = self.network.curves.get(id).map(Vec::as_slice).unwrap_or_default();
        let (flow, length) = (self.options.flow_m3_s, self.options.length_m());
        let points: Vec<(f64, f64)> = points.iter().map(|(q, h)| (q * flow, h * length)).collect();
        through(&points).map_err(|problem| format!("{problem} \"{id}\""))
    }

    /// Flow for which a pump is made, m3/s.
    pub(super) fn pump_flow_m3_s(&self, link: &Link) -> f64 {
        self.head_curve(link).map_or(0.1, |curve| curve.flow_m3_s())
    }

    /// A pump of constant power that moves no water: EPANET gives it no head then.
    pub(super) fn idle_pump(&mut self, link: &Link) {
        let [from, to] = [link.from, link.to].map(|node| self.network.nodes[node].id.as_str());
        let m_flow = self.options.density_kg_m3() * self.pump_flow_m3_s(link);
        self.text
            .edge(&link.id, "resistance", from, to)
            .number("dp_nominal_pa", IDLE_PA)
            .number("m_flow_nominal_kg_s", m_flow);
        let what = "nothing flows behind it, where constant power has no head: it is a resistance, and the \
                    heads between it and the next closed link mean nothing";
        link.note(self.text, NoteKind::Problem, what);
    }

    pub(super) fn pump(&mut self, i: usize) {
        let network = self.network;
        let link = &network.links[i];
        let LinkKind::Pump { head_times_flow_m4_s, curve: points, .. } = &link.kind else { return };
        let curve = match self.head_curve(link) {
            Ok(curve) => curve,
            Err(problem) => {
                link.note(self.text, NoteKind::Problem, &format!("left out: {problem}"));
                return;
            }
        };
        // EPANET lets no water back through a pump.
        let [from, to] = self.guarded(i, true);
        let pa_m = self.options.pa_m();
        // The power is that of EPANET whatever the speed.
        let speed = if head_times_flow_m4_s.is_some() { 1.0 } else { link.setting };
        let speed_max = self.highest_speed(link).max(1.0);
        let entry = self
            .text
            .edge(&link.id, "pump", &from, &to)
            .number("speed", speed)
            .number("initial_speed", speed)
            .number("rise_time_s", 0.0)
            .number("speed_max", speed_max)
            .number("delta_m", DELTA_M);
        match &curve {
            HeadCurve::Power { head_m, free_flow_m3_s, exponent } => {
                entry
                    .number("head_max_pa", head_m * pa_m)
                    .number("free_flow_m3_s", *free_flow_m3_s)
                    .number("curve_exponent", *exponent);
            }
            HeadCurve::Points { flow_m3_s, head_m } => {
                let head_pa: Vec<f64> = head_m.iter().map(|head| head * pa_m).collect();
                entry.numbers("curve_v_flow_m3_s", flow_m3_s).numbers("curve_head_pa", &head_pa);
            }
        }
        let what = match (&curve, points) {
            (HeadCurve::Power { .. }, _) => return,
            (_, Some(id)) => format!(
                "the straight pieces of its curve \"{id}\" are rounded within 0.1 % beside the points"
            ),
            _ => format!(
                "constant power as a curve of points from {} m to {} m of head",
                POWER_HEADS_M.1, POWER_HEADS_M.0
            ),
        };
        link.note(self.text, NoteKind::Changed, &what);
    }

    fn highest_speed(&self, link: &Link) -> f64 {
        let LinkKind::Pump { pattern, .. } = &link.kind else { return link.setting };
        let factors = pattern.as_ref().and_then(|id| self.network.patterns.get(id));
        factors.into_iter().flatten().fold(link.setting, |most, factor| most.max(*factor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_of_one_and_three_points() {
        // Net1: 1500 gpm at 250 ft; EPANET's own coefficients are in data/epanet.
        let curve = through(&[(0.094_635_294_6, 76.2)]).unwrap();
        let HeadCurve::Power { head_m, free_flow_m3_s, exponent } = curve else { panic!() };
        assert!((head_m - 101.600_508).abs() < 1e-9);
        assert!((exponent - 1.999_978_36).abs() < 1e-8);
        let r = head_m / free_flow_m3_s.powf(exponent);
        assert!((r / 2_836.050_548 - 1.0).abs() < 1e-6, "{r}");
        // Net3, pump 10.
        let points = [(0.0, 31.6992), (0.126_180_392_8, 28.0416), (0.252_360_785_6, 19.2024)];
        let HeadCurve::Power { exponent, .. } = through(&points).unwrap() else { panic!() };
        assert!((exponent - 1.772_589_504).abs() < 1e-8);
    }

    #[test]
    fn curves_of_points_are_straight() {
        let curve = through(&[(1.0, 30.0), (2.0, 20.0), (4.0, 10.0)]).unwrap();
        let HeadCurve::Points { flow_m3_s, head_m } = curve else { panic!() };
        assert_eq!((flow_m3_s[0], head_m[0]), (0.0, 40.0));
        assert_eq!(flow_m3_s.len(), 25);
        assert!((flow_m3_s[20] - 3.0).abs() < 1e-12 && (head_m[20] - 15.0).abs() < 1e-12);
        assert!(through(&[(1.0, 10.0), (2.0, 20.0)]).is_err());
        assert!(through(&[]).is_err());
        assert!(through(&[(0.0, 10.0), (1.0, 20.0), (2.0, 5.0)]).is_err());
        assert!(through(&[(0.0, 0.0)]).is_err());
    }
}

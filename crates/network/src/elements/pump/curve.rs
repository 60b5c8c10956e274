//! Head of a pump over its flow: the curve at full speed in its four forms, the affinity laws, and the
//! repair of curves that do not fall. The equations are in [`super`].

use super::PumpParams;
use crate::two_port::{ElementError, positive};
use anergy_core::linear::Linear;
use anergy_core::numerics::interpolate::Pchip;
use anergy_core::numerics::regularize::{power, quadratic, quadratic_slope_at_zero, smoothstep};

/// Below this speed every curve but the quadratic one is blended into the impeller at rest.
const BLEND_SPEED: f64 = 0.05;
/// Slope of a table at its ends, at least, as a share of the first and last secant.
const END_SLOPE_SHARE: f64 = 0.1;
/// Slope of a polynomial at its samples, at least, as a share of the secants beside them.
const LEAST_SLOPE_SHARE: f64 = 0.01;
/// A curve that has to be repaired falls everywhere by at least this share of the head at zero flow over
/// its whole length.
const LEAST_FALL: f64 = 1e-3;
/// A repair may change the head by this share of the head at zero flow; more is a wrong curve.
const LARGEST_REPAIR: f64 = 0.1;
/// Pieces of a sampled polynomial.
const SAMPLES: u32 = 64;
/// Step of the search for the flow without head: this many samples per e-fold.
const SEARCH_PER_E_FOLD: f64 = 100.0;
/// Halvings of an interval until neighbouring numbers are left.
const BISECTIONS: u32 = 60;

/// The head curve at full speed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HeadCurve {
    /// Head at zero flow, Pa.
    pub(super) head_max_pa: f64,
    /// Flow without head at the density of the medium, kg/s.
    pub(super) m_free_kg_s: f64,
    /// Curvature of the impeller at rest over the mass flow, Pa/(kg/s)^2.
    curvature: f64,
    m_turbulent_kg_s: f64,
    form: Form,
    /// How the curve differs from what was given.
    pub(super) note: Option<String>,
}

#[derive(Debug, Clone, PartialEq)]
enum Form {
    Quadratic,
    Power { exponent: f64, v_free_m3_s: f64, v_turbulent_m3_s: f64 },
    Points { points: Pchip, slope_at_zero: f64 },
}

impl PumpParams {
    /// The one head curve that is given.
    pub(super) fn head_curve(&self, density_kg_m3: f64) -> Result<HeadCurve, ElementError> {
        let delta_m = positive("delta_m", self.delta_m)?;
        let formula = self.head_max_pa.is_some()
            || self.free_flow_m3_s.is_some()
            || self.curve_exponent.is_some();
        let table = !self.curve_v_flow_m3_s.is_empty() || !self.curve_head_pa.is_empty();
        let polynomial = !self.curve_polynomial.is_empty() || self.curve_v_flow_max_m3_s.is_some();
        match (formula, table, polynomial, self.head_max_pa, self.free_flow_m3_s) {
            (true, false, false, Some(head), Some(flow)) => {
                let head = positive("head_max_pa", head)?;
                let flow = positive("free_flow_m3_s", flow)?;
                let exponent = positive("curve_exponent", self.curve_exponent.unwrap_or(2.0))?;
                if exponent > 20.0 {
                    return Err(ElementError::OutOfRange {
                        field: "curve_exponent",
                        value: exponent,
                        requirement: "must not be above 20",
                    });
                }
                Ok(HeadCurve::power_law(head, flow, exponent, density_kg_m3, delta_m))
            }
            (false, true, false, ..) => {
                let curve = Points::of_table(&self.curve_v_flow_m3_s, &self.curve_head_pa)?;
                Ok(HeadCurve::through(curve, density_kg_m3, delta_m))
            }
            (false, false, true, ..) => {
                let end = self.curve_v_flow_max_m3_s;
                let curve = Points::of_polynomial(&self.curve_polynomial, end)?;
                Ok(HeadCurve::through(curve, density_kg_m3, delta_m))
            }
            _ => Err(ElementError::Fields {
                problem: "give one curve: head_max_pa and free_flow_m3_s, or the table \
                          curve_v_flow_m3_s and curve_head_pa, or curve_polynomial"
                    .into(),
            }),
        }
    }
}

impl HeadCurve {
    fn power_law(head_max_pa: f64, v_free: f64, exponent: f64, rho: f64, delta_m: f64) -> Self {
        let m_free_kg_s = v_free * rho;
        // High powers are flat far beyond the threshold of the quadratic law: theirs is where half the
        // slope of the power is the slope of that law at zero flow.
        let flattest = quadratic_slope_at_zero(1.0, 0.5 * delta_m);
        let share =
            if exponent > 2.0 { (2.0 * flattest).powf(1.0 / (exponent - 1.0)) } else { 0.0 };
        let v_turbulent_m3_s = v_free * share.max(0.5 * delta_m);
        let form = if exponent == 2.0 {
            Form::Quadratic
        } else {
            Form::Power { exponent, v_free_m3_s: v_free, v_turbulent_m3_s }
        };
        Self {
            head_max_pa,
            m_free_kg_s,
            curvature: head_max_pa / (m_free_kg_s * m_free_kg_s),
            m_turbulent_kg_s: 0.5 * delta_m * m_free_kg_s,
            form,
            note: None,
        }
    }

    fn through(Points { points, note }: Points, rho: f64, delta_m: f64) -> Self {
        let (first, end) = (points.at(0.0).value, points.at(points.range().1).value);
        // Quadratic through the ends of the curve: curvature and reverse flow.
        let v_free = points.range().1 * (first / (first - end)).sqrt();
        let at_rest = Self::power_law(first, v_free, 2.0, rho, delta_m);
        // The slope at zero is that of the regularised quadratic where the curve is flatter, as far as
        // the curve stays monotone (three times the first secant).
        let floor = quadratic_slope_at_zero(at_rest.curvature, at_rest.m_turbulent_kg_s) * rho;
        let floor = floor.min(-2.0 * points.secant(0));
        let slope_at_zero = points.at(0.0).slope.min(-floor);
        let points = points.with_first_slope(slope_at_zero);
        Self { form: Form::Points { points, slope_at_zero }, note, ..at_rest }
    }

    /// Head and its slope over the volume flow at full speed.
    fn head(&self, v: f64, density: f64) -> Linear {
        let h0 = self.head_max_pa;
        match &self.form {
            Form::Quadratic => {
                let law = quadratic(v * density, self.curvature, self.m_turbulent_kg_s);
                Linear::new(h0 - law.value, -law.slope * density)
            }
            Form::Power { exponent, v_free_m3_s: v_free, v_turbulent_m3_s } => {
                let coefficient = h0 / v_free.powf(*exponent);
                let law =
                    power(v.clamp(-v_free, *v_free), coefficient, *exponent, *v_turbulent_m3_s);
                // Beyond the curve a straight line: a high power would leave all sense behind.
                let beyond = v - v.clamp(-v_free, *v_free);
                Linear::new(h0 - law.value - law.slope * beyond, -law.slope)
            }
            Form::Points { points, .. } if v >= 0.0 => points.at(v),
            Form::Points { slope_at_zero, .. } => {
                let curvature = self.curvature * density * density;
                Linear::new(
                    h0 + slope_at_zero * v + curvature * v * v,
                    slope_at_zero + 2.0 * curvature * v,
                )
            }
        }
    }

    /// `p_a - p_b` at a relative speed: the affinity laws.
    pub(super) fn loss(&self, m: f64, speed: f64, density: f64) -> Linear {
        let at_rest = quadratic(m, self.curvature, self.m_turbulent_kg_s);
        let square = speed * speed;
        let as_quadratic = Linear::new(at_rest.value - square * self.head_max_pa, at_rest.slope);
        if self.form == Form::Quadratic {
            return as_quadratic;
        }
        let weight = smoothstep(speed / BLEND_SPEED);
        let reference_speed = speed.max(BLEND_SPEED);
        let head = self.head(m / density / reference_speed, density);
        let affine =
            Linear::new(-square * head.value, -square * head.slope / (density * reference_speed));
        affine.scaled(weight) + as_quadratic.scaled(1.0 - weight)
    }

    /// Change of `p_a - p_b` with the relative speed at a given flow, Pa.
    pub(super) fn loss_by_speed(&self, m: f64, speed: f64, density: f64) -> f64 {
        let square = speed * speed;
        let as_quadratic = -2.0 * speed * self.head_max_pa;
        if self.form == Form::Quadratic {
            return as_quadratic;
        }
        let reference_speed = speed.max(BLEND_SPEED);
        let v = m / density / reference_speed;
        let head = self.head(v, density);
        if speed >= BLEND_SPEED {
            // -u^2 H(V/u)
            return -2.0 * speed * head.value + speed * v * head.slope;
        }
        let x = speed / BLEND_SPEED;
        let (weight, weight_slope) = (smoothstep(x), 6.0 * x * (1.0 - x) / BLEND_SPEED);
        let at_rest = quadratic(m, self.curvature, self.m_turbulent_kg_s).value;
        let between = -square * head.value - (at_rest - square * self.head_max_pa);
        weight_slope * between - 2.0 * speed * weight * head.value + (1.0 - weight) * as_quadratic
    }

    /// Flow at which the pump has a head at a speed, kg/s: at least a hundredth of the free flow.
    pub(super) fn flow_at(&self, head_pa: f64, speed: f64, density: f64) -> f64 {
        let (mut low, mut high) = (0.0, 2.0 * speed * self.m_free_kg_s);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if -self.loss(middle, speed, density).value > head_pa {
                low = middle;
            } else {
                high = middle;
            }
        }
        low.max(0.01 * self.m_free_kg_s)
    }

    /// The speed up to `speed_max` at which `p_a - p_b` is `dp_pa`, or the nearest one.
    pub(super) fn speed_at(&self, m: f64, dp_pa: f64, density: f64, speed_max: f64) -> f64 {
        let head_at_rest_pa = -self.loss(m, 0.0, density).value;
        if self.form == Form::Quadratic {
            let square = (-dp_pa - head_at_rest_pa) / self.head_max_pa;
            return square.max(0.0).sqrt().min(speed_max);
        }
        if dp_pa >= -head_at_rest_pa {
            return 0.0;
        }
        if dp_pa <= self.loss(m, speed_max, density).value {
            return speed_max;
        }
        bisect(0.0, speed_max, |speed| self.loss(m, speed, density).value > dp_pa)
    }
}

/// The place in an interval up to which a condition holds.
fn bisect(low: f64, high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if holds(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// A falling curve from zero flow on, and how it was repaired.
struct Points {
    points: Pchip,
    note: Option<String>,
}

impl Points {
    fn of_table(v_flow: &[f64], head: &[f64]) -> Result<Self, ElementError> {
        let wrong = |field, problem| Err(ElementError::Table { field, problem });
        if let Err(error) = Pchip::new(v_flow, head) {
            return wrong("curve_v_flow_m3_s", error.to_string());
        }
        if v_flow[0] != 0.0 {
            let problem = format!("the curve must start at zero flow, not at {}", v_flow[0]);
            return wrong("curve_v_flow_m3_s", problem);
        }
        if head[0] <= 0.0 {
            let problem = format!("the head at zero flow must be positive, not {}", head[0]);
            return wrong("curve_head_pa", problem);
        }
        let (head, note) = falling(v_flow, head, "curve_head_pa")?;
        match Pchip::new(v_flow, &head) {
            Ok(points) => Ok(Self { points: points.with_end_slopes(END_SLOPE_SHARE), note }),
            Err(error) => wrong("curve_head_pa", error.to_string()),
        }
    }

    /// The polynomial sampled from zero flow to `end` (absent: where its head is zero) with its own
    /// slopes, so that cubic polynomials are exact.
    fn of_polynomial(coefficients: &[f64], end: Option<f64>) -> Result<Self, ElementError> {
        let wrong = |problem: &str| {
            Err(ElementError::Table { field: "curve_polynomial", problem: problem.into() })
        };
        if coefficients.len() < 2 || coefficients.iter().any(|c| !c.is_finite()) {
            return wrong("needs at least two finite coefficients");
        }
        if coefficients[0] <= 0.0 {
            return wrong("the first coefficient, the head at zero flow, must be positive");
        }
        let end = match end {
            Some(end) => positive("curve_v_flow_max_m3_s", end)?,
            None => match first_zero(coefficients) {
                Some(end) => end,
                None => {
                    return wrong("has no flow without head: give its end, curve_v_flow_max_m3_s");
                }
            },
        };
        let v_flow: Vec<f64> =
            (0..=SAMPLES).map(|i| end * f64::from(i) / f64::from(SAMPLES)).collect();
        let samples: Vec<Linear> = v_flow.iter().map(|&v| polynomial(coefficients, v)).collect();
        let given: Vec<f64> = samples.iter().map(|sample| sample.value).collect();
        let (head, note) = falling(&v_flow, &given, "curve_polynomial")?;
        match Pchip::new(&v_flow, &head) {
            Ok(points) if note.is_none() => {
                let slopes: Vec<f64> = samples.iter().map(|sample| sample.slope).collect();
                Ok(Self { points: points.with_slopes(&slopes, LEAST_SLOPE_SHARE), note })
            }
            Ok(points) => Ok(Self { points: points.with_end_slopes(END_SLOPE_SHARE), note }),
            Err(error) => wrong(&error.to_string()),
        }
    }
}

/// Value and slope of a polynomial with coefficients of increasing powers (Horner).
fn polynomial(coefficients: &[f64], v: f64) -> Linear {
    let step = |sum: Linear, c: &f64| Linear::new(sum.value * v + c, sum.slope * v + sum.value);
    coefficients.iter().rev().fold(Linear::new(0.0, 0.0), step)
}

/// The smallest positive zero of a polynomial that is positive at zero, searched between the bounds of
/// Fujiwara for the sizes of its zeros.
fn first_zero(coefficients: &[f64]) -> Option<f64> {
    let degree = coefficients.iter().rposition(|&c| c != 0.0)?;
    let size = |i: usize, over: usize, power: usize| {
        (coefficients[i] / coefficients[over]).abs().powf(1.0 / power as f64)
    };
    let largest = |sizes: &mut dyn Iterator<Item = f64>| 2.0 * sizes.fold(0.0, f64::max);
    let low = 1.0 / largest(&mut (1..=degree).map(|i| size(i, 0, i)));
    let high = largest(&mut (0..degree).map(|i| size(i, degree, degree - i)));
    if !low.is_finite() || !high.is_finite() || low > high {
        return None;
    }
    let steps = (SEARCH_PER_E_FOLD * (high / low).ln()).ceil().max(1.0);
    let place = |i: f64| low * (high / low).powf(i / steps);
    let positive_at = |v: f64| polynomial(coefficients, v).value > 0.0;
    let end = (0..=steps as u32).map(f64::from).find(|&i| !positive_at(place(i)))?;
    Some(bisect(if end == 0.0 { 0.0 } else { place(end - 1.0) }, place(end), positive_at))
}

/// Heads that fall strictly: as given, or the nearest ones (least squares, pooling of neighbours that
/// rise), with a sentence that says how far away they are.
fn falling(
    v_flow: &[f64],
    head: &[f64],
    field: &'static str,
) -> Result<(Vec<f64>, Option<String>), ElementError> {
    let Some(rising) = (1..head.len()).find(|&i| head[i] >= head[i - 1]) else {
        return Ok((head.to_vec(), None));
    };
    // Falling faster than a line is falling after that line is added.
    let least_slope = LEAST_FALL * head[0] / v_flow[v_flow.len() - 1];
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for (v, h) in v_flow.iter().zip(head) {
        pools.push((h + least_slope * v, 1));
        while let [.., before, last] = pools.as_slice() {
            if last.0 < before.0 {
                break;
            }
            let points = before.1 + last.1;
            let mean = (before.0 * before.1 as f64 + last.0 * last.1 as f64) / points as f64;
            pools.truncate(pools.len() - 2);
            pools.push((mean, points));
        }
    }
    let pooled = pools.iter().flat_map(|(mean, points)| std::iter::repeat_n(mean, *points));
    let repaired: Vec<f64> = pooled.zip(v_flow).map(|(h, v)| h - least_slope * v).collect();
    let change = repaired.iter().zip(head).fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()));
    let share = change / head[0];
    let place = format!(
        "the head must fall strictly with the flow: {:.0} Pa at {:.4e} m3/s follow {:.0} Pa before",
        head[rising],
        v_flow[rising],
        head[rising - 1]
    );
    if share > LARGEST_REPAIR {
        let problem = format!(
            "{place}; the nearest falling curve is {change:.0} Pa away, too far to take it"
        );
        return Err(ElementError::Table { field, problem });
    }
    let percent = 100.0 * share;
    Ok((
        repaired,
        Some(format!(
            "{place}; taken is the nearest falling curve, at most {change:.0} Pa \
         ({percent:.2} % of the head at zero flow) away"
        )),
    ))
}

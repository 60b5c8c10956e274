//! What a search has found.

use crate::explain::{Finding, Verdict};
use crate::next::Addition;
use crate::unknown::Unknown;

/// What the search settled on.
pub(crate) struct Settled {
    pub(crate) verdict: Verdict,
    pub(crate) because: String,
    /// Places among the candidates.
    pub(crate) taken: Vec<usize>,
    pub(crate) effects: Vec<Finding>,
    pub(crate) class: Vec<Finding>,
    pub(crate) tried: Vec<Finding>,
    /// Candidates with which the model does not run, and why.
    pub(crate) fail: Vec<(usize, String)>,
    /// Readings with the tolerances fitted, without an effect.
    pub(crate) null_readings: Vec<f64>,
    /// What would tell the members of the class apart, the most telling first.
    pub(crate) additions: Vec<Addition>,
    /// The unknowns without an effect, and their values.
    pub(crate) null: (Vec<Unknown>, Vec<f64>),
    /// The unknowns of the last fit, and their values.
    pub(crate) chosen: Option<(Vec<Unknown>, Vec<f64>)>,
    /// Standard deviations of all samples, as the sensors of the last fit show what might have been.
    pub(crate) sigma: Vec<f64>,
}

impl Settled {
    /// Before anything was tried.
    pub(super) fn nothing() -> Self {
        Self {
            verdict: Verdict::Nothing,
            because: String::new(),
            taken: Vec::new(),
            effects: Vec::new(),
            class: Vec::new(),
            tried: Vec::new(),
            fail: Vec::new(),
            null_readings: Vec::new(),
            additions: Vec::new(),
            null: (Vec::new(), Vec::new()),
            chosen: None,
            sigma: Vec::new(),
        }
    }

    /// Every unknown of the last fit, without an effect of that of the tolerances: its name, value, and distance from the middle of its range in standard deviations.
    pub(crate) fn strained(&self) -> Vec<(String, f64, f64)> {
        let of =
            |(u, at): (&Unknown, &f64)| (u.target.to_string(), u.value(*at), (at - u.mean) / u.sd);
        let (unknowns, at) = self.chosen.as_ref().unwrap_or(&self.null);
        let mut all: Vec<_> = unknowns.iter().zip(at).map(of).collect();
        all.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
        all
    }
}

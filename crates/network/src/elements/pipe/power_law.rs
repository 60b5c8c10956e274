//! Which friction a pipe has: a factor after Darcy, or a power law with its coefficient.

use super::PipeParams;
use crate::friction::{Correlation, PowerFriction, Transition};
use crate::two_port::{ElementError, positive};

impl PipeParams {
    /// The power law, with exactly the coefficient that it needs.
    pub(super) fn power_friction(
        &self,
        diameter_m: f64,
    ) -> Result<Option<PowerFriction>, ElementError> {
        let problem = |problem: &str| Err(ElementError::Fields { problem: problem.into() });
        if self.transition == Transition::Dunlop && self.friction != Correlation::SwameeJain {
            return problem("transition = \"dunlop\" needs friction = \"swamee_jain\"");
        }
        match (self.friction, self.hazen_williams_c, self.manning_n) {
            (Correlation::HazenWilliams, Some(c), None) => {
                let c = positive("hazen_williams_c", c)?;
                Ok(Some(PowerFriction::hazen_williams(c, diameter_m)))
            }
            (Correlation::ChezyManning, None, Some(n)) => {
                let n = positive("manning_n", n)?;
                Ok(Some(PowerFriction::chezy_manning(n, diameter_m)))
            }
            (Correlation::HazenWilliams, ..) => {
                problem("friction = \"hazen_williams\" needs hazen_williams_c and no manning_n")
            }
            (Correlation::ChezyManning, ..) => {
                problem("friction = \"chezy_manning\" needs manning_n and no hazen_williams_c")
            }
            (_, None, None) => Ok(None),
            (_, Some(_), _) => problem("hazen_williams_c needs friction = \"hazen_williams\""),
            (_, None, Some(_)) => problem("manning_n needs friction = \"chezy_manning\""),
        }
    }
}

//! The modes of a weighted PI controller, its errors and its update.

use super::{Loop, WeightedPi};
use crate::controller::{Balance, ControlError, Controller, Inputs, SetPoint, Timing};

/// What a station does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mode {
    Idle,
    FeedIn,
    Extraction,
}

impl Mode {
    /// The number that stands for it in the state, and the sign of its heat.
    fn sign(self) -> f64 {
        match self {
            Self::Idle => 0.0,
            Self::FeedIn => 1.0,
            Self::Extraction => -1.0,
        }
    }
}

/// Output of the pump, the valve, the secondary flow.
const PUMP: usize = 0;
const VALVE: usize = 1;
const SECONDARY: usize = 2;

impl WeightedPi {
    fn mode(&self, set_points: &[f64]) -> Mode {
        if set_points[0] >= self.params.idle_band_w {
            Mode::FeedIn
        } else if set_points[0] <= -self.params.idle_band_w {
            Mode::Extraction
        } else {
            Mode::Idle
        }
    }

    fn loops(&self, mode: Mode) -> Option<&[Loop; 2]> {
        match mode {
            Mode::Idle => None,
            Mode::FeedIn => Some(&self.loops[0]),
            Mode::Extraction => Some(&self.loops[1]),
        }
    }

    /// The weighted errors of the primary and the secondary loop; zero while idle.
    pub fn errors(&self, inputs: &Inputs) -> [f64; 2] {
        let mode = self.mode(inputs.set_points);
        let Some(loops) = self.loops(mode) else { return [0.0; 2] };
        let &[q_w, primary_hot_k, primary_cold_k, secondary_hot_k, secondary_cold_k] =
            inputs.measured
        else {
            return [f64::NAN; 2];
        };
        let &[q_set_w, primary_set_k, secondary_set_k, primary_by_k, secondary_by_k] =
            inputs.set_points
        else {
            return [f64::NAN; 2];
        };
        // Errors of the two temperature objectives of a mode: of the primary side, of the secondary side.
        let of_sides = match mode {
            Mode::Extraction => {
                [primary_by_k - (primary_hot_k - primary_cold_k), secondary_set_k - secondary_hot_k]
            }
            _ => [
                primary_set_k - primary_hot_k,
                secondary_by_k - (secondary_hot_k - secondary_cold_k),
            ],
        };
        let heat = (q_set_w - q_w) * mode.sign() / self.params.q_flow_norm_w;
        std::array::from_fn(|side| {
            let at = &loops[side];
            let temperature = if at.crossover { of_sides[1 - side] } else { -of_sides[side] };
            at.alpha * heat + (1.0 - at.alpha) * temperature / self.params.norm_difference_k
        })
    }

    /// The output that a loop drives, and the sign of its values.
    fn output(mode: Mode, side: usize) -> (usize, f64) {
        match (side, mode) {
            (0, Mode::Extraction) => (VALVE, 1.0),
            (0, _) => (PUMP, 1.0),
            _ => (SECONDARY, mode.sign()),
        }
    }

    /// The range of values of an output, the size of which is much for it.
    fn range(&self, output: usize) -> f64 {
        [self.params.speed_max, self.params.kappa_max, self.params.v_flow_max_m3_s][output]
    }
}

impl Controller for WeightedPi {
    fn timing(&self) -> Timing {
        Timing { interval_s: self.params.interval_s, offset_s: self.params.offset_s }
    }

    fn set_points(&self) -> Vec<SetPoint> {
        let of = |name, unit, value| SetPoint { name, unit, value };
        let params = &self.params;
        vec![
            of("q_flow_w", "w", params.q_flow_w),
            of("primary_hot_k", "k", params.primary_hot_k),
            of("secondary_hot_k", "k", params.secondary_hot_k),
            of("primary_difference_k", "k", params.primary_difference_k),
            of("secondary_difference_k", "k", params.secondary_difference_k),
        ]
    }

    fn initial_state(&self) -> Vec<f64> {
        vec![0.0; 3]
    }

    fn output_limits(&self, output: usize, (min, max): (f64, f64)) -> (f64, f64) {
        let largest = self.range(output);
        let smallest = if output == SECONDARY { -largest } else { 0.0 };
        (smallest.clamp(min, max), largest.clamp(min, max))
    }

    fn update(
        &self,
        dt_s: f64,
        inputs: &Inputs,
        state: &mut [f64],
        outputs: &mut [f64],
    ) -> Result<(), ControlError> {
        let inputs = inputs.checked()?;
        let mode = self.mode(inputs.set_points);
        outputs.fill(0.0);
        let entered = state[2] != mode.sign();
        state[2] = mode.sign();
        let Some(loops) = self.loops(mode) else {
            return Ok(());
        };
        let errors = self.errors(inputs);
        for (side, (at, error)) in loops.iter().zip(errors).enumerate() {
            let integral = &mut state[side];
            let mut share = dt_s / at.integral_time_s;
            if entered {
                *integral = at.min + self.params.start_share * (at.max - at.min);
                share = 0.0;
            }
            let push = at.gain * error;
            *integral += push * share;
            let unlimited = *integral + push;
            let limited = unlimited.clamp(at.min, at.max);
            *integral += (limited - unlimited) * share.min(1.0);
            let (output, sign) = Self::output(mode, side);
            outputs[output] = sign * limited;
        }
        Ok(())
    }

    fn limits_now(&self, output: usize, inputs: &Inputs) -> (f64, f64) {
        let mode = self.mode(inputs.set_points);
        let loops = self.loops(mode).into_iter().flatten().enumerate();
        for (side, at) in loops {
            let (driven, sign) = Self::output(mode, side);
            if driven == output {
                return if sign > 0.0 { (at.min, at.max) } else { (-at.max, -at.min) };
            }
        }
        (0.0, 0.0)
    }

    fn balance(&self, inputs: &Inputs, _outputs: &[f64], balance: &mut [Balance]) {
        balance.fill(Balance { miss: 0.0, scale: 1.0 });
        let mode = self.mode(inputs.set_points);
        for (side, error) in self.errors(inputs).into_iter().enumerate() {
            let (output, sign) = Self::output(mode, side);
            balance[output].miss = sign * error;
        }
    }

    fn rest(&self, inputs: &Inputs, outputs: &[f64], state: &mut [f64]) {
        let mode = self.mode(inputs.set_points);
        state.copy_from_slice(&[0.0, 0.0, mode.sign()]);
        if let Some(loops) = self.loops(mode) {
            for (side, at) in loops.iter().enumerate() {
                let (output, sign) = Self::output(mode, side);
                state[side] = (sign * outputs[output]).clamp(at.min, at.max);
            }
        }
    }

    fn tracks(&self) -> bool {
        false
    }

    fn gain(&self) -> f64 {
        self.params.feed_in_primary_gain
    }
}

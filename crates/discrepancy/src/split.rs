//! Which samples are fitted, which choose, and which are shown: blocks of time, not samples at random.

use crate::error::ExplainError;
use crate::experiment::Experiment;
use serde::{Deserialize, Serialize};

/// What a sample is used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Use {
    /// Effects are fitted to it.
    Identify,
    /// It decides which effect is taken.
    Validate,
    /// It is looked at once, for the final numbers.
    Show,
}

/// A block of a split file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Block {
    /// Run; every run where absent.
    pub run: Option<String>,
    /// What it is for.
    pub role: Use,
    /// First time, s; from the beginning where absent.
    pub from_s: Option<f64>,
    /// Last time, s; to the end where absent.
    pub until_s: Option<f64>,
}

/// A split file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SplitFile {
    /// Its blocks; the first one that holds a sample decides.
    #[serde(default)]
    pub block: Vec<Block>,
}

impl SplitFile {
    /// Reads the file.
    ///
    /// # Errors
    /// What is wrong, with line and column.
    pub fn from_toml(text: &str) -> Result<Self, ExplainError> {
        toml::from_str(text).map_err(|error| ExplainError::Split { problem: error.to_string() })
    }
}

/// Blocks of a run without a split file, and what they are used for in turn.
const BLOCKS: f64 = 12.0;
const TURNS: [Use; 4] = [Use::Identify, Use::Validate, Use::Identify, Use::Show];

/// The use of every sample; none for those outside of all blocks.
///
/// # Errors
/// A block that holds nothing, a use without samples.
pub fn split(
    experiment: &Experiment,
    file: Option<&SplitFile>,
) -> Result<Vec<Option<Use>>, ExplainError> {
    let uses: Vec<Option<Use>> = experiment
        .samples
        .iter()
        .map(|sample| {
            let run = &experiment.runs[sample.run];
            match file {
                None => {
                    let share = (sample.time_s - run.span_s.0) / (run.span_s.1 - run.span_s.0);
                    let block = (share * BLOCKS).floor().clamp(0.0, BLOCKS - 1.0) as usize;
                    Some(TURNS[block % TURNS.len()])
                }
                Some(file) => {
                    let holds = |block: &&Block| {
                        block.run.as_ref().is_none_or(|name| *name == run.name)
                            && block.from_s.is_none_or(|from| sample.time_s >= from)
                            && block.until_s.is_none_or(|until| sample.time_s <= until)
                    };
                    file.block.iter().find(holds).map(|block| block.role)
                }
            }
        })
        .collect();
    for (wanted, word) in
        [(Use::Identify, "identify"), (Use::Validate, "validate"), (Use::Show, "show")]
    {
        if !uses.contains(&Some(wanted)) {
            let problem = format!("no sample is in a block of role = \"{word}\"");
            return Err(ExplainError::Split { problem });
        }
    }
    Ok(uses)
}

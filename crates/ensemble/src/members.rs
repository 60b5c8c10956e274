//! Which values each member gets.
//!
//! **Numerics** a variation draws from a stream of its own, told by the seed and its place in the file. Draws of a Monte
//! Carlo sample follow each other, so that a larger sample begins with the smaller one. A Latin hypercube of `n` members
//! puts one into each of the `n` intervals of a variation, in random order, at a random place within.
//! **Sources** `mckay1979`.

use crate::definition::{Definition, Design};
use rand_distr::{Distribution, Open01};
use rand_pcg::Pcg64;
use serde_json::Value;

/// The members of a definition.
#[derive(Debug, Clone, PartialEq)]
pub struct Members {
    count: usize,
    /// Per variation the coordinates of all members; empty for grids and lists.
    unit: Vec<Vec<f64>>,
}

impl Members {
    /// The members.
    pub fn of(definition: &Definition) -> Self {
        let entry = &definition.ensemble;
        let variations = &definition.variations;
        let counts = || variations.iter().filter_map(|variation| variation.spread.count());
        let drawn = entry.members.unwrap_or(0);
        let streams =
            || (0..variations.len()).map(|k| Pcg64::new(u128::from(entry.seed), k as u128));
        match entry.design {
            Design::Grid => Self { count: counts().product(), unit: Vec::new() },
            Design::List => Self { count: counts().next().unwrap_or(0), unit: Vec::new() },
            Design::MonteCarlo => {
                let unit = streams().map(|mut random| monte_carlo(&mut random, drawn)).collect();
                Self { count: drawn, unit }
            }
            Design::LatinHypercube => {
                let unit = streams().map(|mut random| latin(&mut random, drawn)).collect();
                Self { count: drawn, unit }
            }
            Design::Points => {
                let column = |k: usize| entry.points.iter().map(|row| row[k]).collect();
                let unit = (0..variations.len()).map(column).collect();
                Self { count: entry.points.len(), unit }
            }
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The values of a member, one per variation, as written in the definition.
    pub fn values(&self, definition: &Definition, member: usize) -> Vec<Value> {
        let variations = &definition.variations;
        if !self.unit.is_empty() {
            let pairs = variations.iter().zip(&self.unit);
            return pairs.map(|(variation, unit)| variation.spread.at(unit[member])).collect();
        }
        if definition.ensemble.design == Design::List {
            return variations.iter().map(|variation| variation.spread.nth(member)).collect();
        }
        let mut rest = member;
        let mut values: Vec<Value> = variations
            .iter()
            .rev()
            .map(|variation| {
                let count = variation.spread.count().unwrap_or(1);
                let n = rest % count;
                rest /= count;
                variation.spread.nth(n)
            })
            .collect();
        values.reverse();
        values
    }
}

fn monte_carlo(random: &mut Pcg64, count: usize) -> Vec<f64> {
    Open01.sample_iter(random).take(count).collect()
}

fn latin(random: &mut Pcg64, count: usize) -> Vec<f64> {
    let mut place = |among: usize| {
        let u: f64 = Open01.sample(random);
        ((u * among as f64) as usize).min(among - 1)
    };
    let mut order: Vec<usize> = (0..count).collect();
    for last in (1..count).rev() {
        order.swap(last, place(last + 1));
    }
    let within: Vec<f64> = Open01.sample_iter(random).take(count).collect();
    order.iter().zip(within).map(|(n, u)| (*n as f64 + u) / count as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn members(text: &str) -> (Definition, Members) {
        let definition = Definition::from_toml(&format!("format = 1\n{text}")).unwrap();
        let members = Members::of(&definition);
        (definition, members)
    }

    #[test]
    fn a_grid_is_every_value_with_every_other() {
        let text = "[[variation]]\nparameter = \"a.x\"\nvalues = [1, 2]\n\
                    [[variation]]\nparameter = \"b.y\"\nlow = 0.0\nhigh = 1.0\ncount = 3\n";
        let (definition, members) = members(text);
        let all: Vec<_> = (0..members.len()).map(|i| members.values(&definition, i)).collect();
        let pair = |x: i32, y: f64| vec![json!(x), json!(y)];
        let expected = [(1, 0.0), (1, 0.5), (1, 1.0), (2, 0.0), (2, 0.5), (2, 1.0)];
        assert_eq!(all, expected.map(|(x, y)| pair(x, y)));
    }

    #[test]
    fn a_list_goes_through_the_values_together() {
        let text = "[ensemble]\ndesign = \"list\"\n[[variation]]\nparameter = \"a.x\"\nvalues = [1, 2]\n\
                    [[variation]]\nparameter = \"b.y\"\nvalues = [\"p\", \"q\"]\n";
        let (definition, members) = members(text);
        assert_eq!(members.len(), 2);
        assert_eq!(members.values(&definition, 1), [json!(2), json!("q")]);
    }

    fn sample(design: &str, count: usize, seed: u32) -> Vec<Vec<f64>> {
        let text = format!(
            "[ensemble]\ndesign = \"{design}\"\nmembers = {count}\nseed = {seed}\n\
             [[variation]]\nparameter = \"a.x\"\nlow = 0.0\nhigh = 1.0\n\
             [[variation]]\nparameter = \"b.y\"\nlow = 0.0\nhigh = 1.0\n"
        );
        let (definition, members) = members(&text);
        let number = |value: &Value| value.as_f64().unwrap();
        (0..count).map(|i| members.values(&definition, i).iter().map(number).collect()).collect()
    }

    #[test]
    fn a_latin_hypercube_meets_every_interval_once() {
        let n = 97;
        let points = sample("latin_hypercube", n, 3);
        for k in 0..2 {
            let mut met: Vec<usize> = points.iter().map(|p| (p[k] * n as f64) as usize).collect();
            assert_ne!(met, (0..n).collect::<Vec<_>>(), "in random order");
            met.sort_unstable();
            assert_eq!(met, (0..n).collect::<Vec<_>>());
        }
        // Independent: the correlation of 97 pairs has a standard deviation of 0.1.
        let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / n as f64;
        let (a, b) = (mean(0), mean(1));
        let covariance = points.iter().map(|p| (p[0] - a) * (p[1] - b)).sum::<f64>() / n as f64;
        assert!((covariance * 12.0).abs() < 0.3, "{covariance}");
        assert_eq!(points, sample("latin_hypercube", n, 3));
        assert_ne!(points, sample("latin_hypercube", n, 4));
    }

    #[test]
    fn a_larger_monte_carlo_sample_begins_with_the_smaller_one() {
        assert_eq!(sample("monte_carlo", 100, 7)[..40], sample("monte_carlo", 40, 7));
        // Mean 1/2 with a standard deviation of sqrt(1/12/4000) = 0.0046.
        let mean = sample("monte_carlo", 4000, 7).iter().map(|p| p[1]).sum::<f64>() / 4000.0;
        assert!((mean - 0.5).abs() < 0.02, "{mean}");
    }
}

//! Which channels of a recording are wanted, and in which units.

use anergy_core::recorder::Channel;
use anergy_core::units::{UNITS, Unit, alternatives};
use thiserror::Error;

/// What was asked of a recording is not there.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SelectionError {
    /// A pattern that no channel matches.
    #[error("no channel matches \"{pattern}\": {hint}")]
    UnknownChannel {
        /// The pattern.
        pattern: String,
        /// The nearest name, or where the names stand.
        hint: String,
    },
    /// A word that is no unit.
    #[error("\"{unit}\" is no unit of files; there are {known}")]
    UnknownUnit {
        /// The word.
        unit: String,
        /// The units.
        known: String,
    },
}

/// A channel that was chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// Its index in the recording.
    pub index: usize,
    /// Its name, with the unit at its end.
    pub name: String,
    /// The unit; `None` where it stays in SI.
    pub unit: Option<Unit>,
}

/// The channels that match the patterns, in their order; all of them without a pattern.
///
/// A pattern is the name of a channel or of a component (then all of its channels), or has `*` for any
/// text and `?` for any character. A unit is the end of a name, for example `degc`, and is taken by all
/// channels of its dimension; their names then end in it.
///
/// # Errors
/// A pattern that matches nothing, a word that is no unit.
pub fn choose(
    channels: &[Channel],
    patterns: &[String],
    units: &[String],
) -> Result<Vec<Chosen>, SelectionError> {
    let units: Vec<Unit> = units.iter().map(|unit| find_unit(unit)).collect::<Result<_, _>>()?;
    let mut taken = vec![false; channels.len()];
    let mut order = Vec::new();
    for pattern in patterns {
        let before = order.len();
        let mut known = false;
        for (index, channel) in channels.iter().enumerate() {
            if matches(pattern, channel) {
                known = true;
                if !std::mem::replace(&mut taken[index], true) {
                    order.push(index);
                }
            }
        }
        if !known && order.len() == before {
            return Err(unknown_channel(pattern, channels));
        }
    }
    if patterns.is_empty() {
        order = (0..channels.len()).collect();
    }
    Ok(order.into_iter().map(|index| chosen(index, &channels[index], &units)).collect())
}

fn chosen(index: usize, channel: &Channel, units: &[Unit]) -> Chosen {
    let other = alternatives(&channel.quantity).find(|(_, unit)| units.contains(unit));
    match other {
        Some((quantity, unit)) => {
            let name = match channel.name.strip_suffix(&channel.quantity) {
                Some(component) => format!("{component}{quantity}"),
                None => quantity,
            };
            Chosen { index, name, unit: Some(unit) }
        }
        None => Chosen { index, name: channel.name.clone(), unit: None },
    }
}

fn find_unit(word: &str) -> Result<Unit, SelectionError> {
    Unit::find(&word.to_lowercase()).ok_or_else(|| SelectionError::UnknownUnit {
        unit: word.to_owned(),
        known: UNITS.iter().map(|unit| unit.suffix).collect::<Vec<_>>().join(", "),
    })
}

fn matches(pattern: &str, channel: &Channel) -> bool {
    if pattern.contains(['*', '?']) {
        return glob(pattern, &channel.name);
    }
    let below = |name: &str| {
        name.strip_prefix(pattern).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    below(&channel.name) || below(&channel.component)
}

/// Whether a text has the form of a pattern, in which `*` is any text and `?` any character.
pub fn glob(pattern: &str, text: &str) -> bool {
    let (pattern, text): (Vec<char>, Vec<char>) =
        (pattern.chars().collect(), text.chars().collect());
    // Greedy, with one place to go back to.
    let (mut p, mut t) = (0, 0);
    let mut star: Option<(usize, usize)> = None;
    while t < text.len() {
        match pattern.get(p) {
            Some('*') => {
                star = Some((p, t));
                p += 1;
            }
            Some(c) if *c == '?' || *c == text[t] => {
                p += 1;
                t += 1;
            }
            _ => match star {
                Some((at, from)) => {
                    star = Some((at, from + 1));
                    p = at + 1;
                    t = from + 1;
                }
                None => return false,
            },
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}

fn unknown_channel(pattern: &str, channels: &[Channel]) -> SelectionError {
    let names = channels.iter().flat_map(|channel| [&channel.name, &channel.component]);
    let nearest = names
        .map(|name| (strsim::damerau_levenshtein(pattern, name), name))
        .filter(|(distance, name)| *distance <= 2 + name.chars().count() / 4)
        .min();
    let hint = match nearest {
        Some((_, name)) => format!("did you mean \"{name}\"?"),
        None => {
            let some: Vec<&str> =
                channels.iter().take(3).map(|channel| channel.name.as_str()).collect();
            match some.is_empty() {
                true => "the recording has no channels".to_owned(),
                false => format!("the recording has for example {}", some.join(", ")),
            }
        }
    };
    SelectionError::UnknownChannel { pattern: pattern.to_owned(), hint }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anergy_core::recorder::ChannelGroup;

    fn channels() -> Vec<Channel> {
        [
            ("sf1.pump", "m_flow_kg_s"),
            ("sf1.pump", "dp_pa"),
            ("sf10.hot", "t_k"),
            ("sf10", "t_difference_k"),
        ]
        .into_iter()
        .map(|(component, quantity)| Channel {
            name: format!("{component}.{quantity}"),
            unit: String::new(),
            group: ChannelGroup::Edges,
            component: component.into(),
            quantity: quantity.into(),
        })
        .collect()
    }

    fn names(patterns: &[&str], units: &[&str]) -> Result<Vec<String>, SelectionError> {
        let owned =
            |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
        let chosen = choose(&channels(), &owned(patterns), &owned(units))?;
        Ok(chosen.into_iter().map(|chosen| chosen.name).collect())
    }

    #[test]
    fn patterns_choose_in_their_order() {
        assert_eq!(names(&[], &[]).unwrap().len(), 4);
        assert_eq!(names(&["sf1"], &[]).unwrap(), ["sf1.pump.m_flow_kg_s", "sf1.pump.dp_pa"]);
        assert_eq!(
            names(&["*.dp_pa", "sf1.pump"], &[]).unwrap(),
            ["sf1.pump.dp_pa", "sf1.pump.m_flow_kg_s"]
        );
        assert_eq!(names(&["sf1?.hot.*"], &[]).unwrap(), ["sf10.hot.t_k"]);
        assert_eq!(names(&["*_k"], &[]).unwrap(), ["sf10.hot.t_k", "sf10.t_difference_k"]);
    }

    #[test]
    fn units_rename_what_they_convert() {
        // A temperature difference stays in kelvin.
        assert_eq!(
            names(&[], &["degC", "mbar"]).unwrap(),
            ["sf1.pump.m_flow_kg_s", "sf1.pump.dp_mbar", "sf10.hot.t_degc", "sf10.t_difference_k"]
        );
    }

    #[test]
    fn what_is_not_there_is_named() {
        let message = names(&["sf1.pmup.dp_pa"], &[]).unwrap_err().to_string();
        assert!(message.contains("did you mean \"sf1.pump.dp_pa\""), "{message}");
        let message = names(&["zzzzzzzzzzzzzzzz*"], &[]).unwrap_err().to_string();
        assert!(message.contains("for example sf1.pump.m_flow_kg_s"), "{message}");
        assert!(names(&[], &["furlong"]).unwrap_err().to_string().contains("l_min"));
    }
}

//! Conditions as a person writes them: `storage.soc < 0.6 and storage.t_8_k < 65 degC`.
//!
//! ```text
//! condition  = all { "or" all }
//! all        = one { "and" one }
//! one        = "not" one | "(" condition ")" | comparison | RULE
//! comparison = sum ( "<" | "<=" | ">" | ">=" ) sum
//! sum        = [ "-" ] value { ( "+" | "-" ) value }
//! value      = NUMBER [ UNIT ] | CHANNEL
//! ```
//! A `RULE` is the name of another rule: whether it is on. Names with other characters than letters, digits, `_`, `.` and an
//! inner `-` stand in single quotes; a minus between names stands between spaces.
//!
//! **Equation** each comparison is a sum of channels and numbers, in SI, that is above or below 0. **Numerics** no
//! allocation when it is evaluated.

use crate::condition_words::{Token, Words};
use anergy_core::medium::ZERO_CELSIUS_K;
use std::fmt;

/// What is wrong with the text of a condition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Malformed(pub String);

impl fmt::Display for Malformed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// A number of a comparison, with the unit that it is written in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constant {
    /// Value in SI, with its sign.
    pub(crate) si: f64,
    /// SI suffix of its unit; empty without one.
    pub unit: &'static str,
    /// Whether it counts from 0 degC.
    pub from_zero_celsius: bool,
}

/// One comparison: a sum that is above or below 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Places of channels among the names, each with the sign of the side that it is on.
    channels: Vec<(usize, f64)>,
    /// Numbers, those of the right side with the other sign; the last field of each is that sign.
    constants: Vec<(Constant, f64)>,
    sum_si: f64,
    above: bool,
    or_equal: bool,
}

#[derive(Debug, Clone, PartialEq)]
enum Node {
    Any(Vec<Node>),
    All(Vec<Node>),
    Not(Box<Node>),
    Compare(Comparison),
    /// Another rule, by its place among the names.
    On(usize),
}

/// A condition, ready to be evaluated.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    root: Node,
}

/// Channel that says whether a rule is on.
pub(crate) const ON: &str = "on";

impl Condition {
    /// Reads a condition; the channels that it needs are appended to `names` where they are not there yet.
    ///
    /// # Errors
    /// What is wrong with the text.
    pub fn parse(text: &str, names: &mut Vec<String>) -> Result<Self, Malformed> {
        let mut parser = Parser { words: Words::new(text)?, names };
        let root = parser.any()?;
        match parser.words.next() {
            None => Ok(Self { root }),
            Some(token) => Err(parser.words.unexpected(&token, "`and`, `or` or its end")),
        }
    }

    /// Whether it holds.
    pub fn holds(&self, measured: &[f64]) -> bool {
        holds(&self.root, measured)
    }

    /// Its comparisons.
    pub fn comparisons(&self) -> Vec<&Comparison> {
        fn collect<'a>(node: &'a Node, all: &mut Vec<&'a Comparison>) {
            match node {
                Node::Any(nodes) | Node::All(nodes) => nodes.iter().for_each(|n| collect(n, all)),
                Node::Not(node) => collect(node, all),
                Node::Compare(comparison) => all.push(comparison),
                Node::On(_) => {}
            }
        }
        let mut all = Vec::new();
        collect(&self.root, &mut all);
        all
    }
}

fn holds(node: &Node, measured: &[f64]) -> bool {
    match node {
        Node::Any(nodes) => nodes.iter().any(|node| holds(node, measured)),
        Node::All(nodes) => nodes.iter().all(|node| holds(node, measured)),
        Node::Not(node) => !holds(node, measured),
        Node::Compare(comparison) => comparison.holds(measured),
        Node::On(name) => measured[*name] > 0.5,
    }
}

impl Constant {
    /// Whether it is 0 without a unit.
    pub fn is_nothing(&self) -> bool {
        self.unit.is_empty() && self.si == 0.0
    }
}

impl Comparison {
    /// Places of the channels among the names, each with the sign of its side.
    pub fn channels(&self) -> &[(usize, f64)] {
        &self.channels
    }

    /// The numbers, each with the sign of its side.
    pub fn constants(&self) -> &[(Constant, f64)] {
        &self.constants
    }

    fn holds(&self, measured: &[f64]) -> bool {
        let sum =
            self.channels.iter().fold(self.sum_si, |sum, (i, sign)| sum + sign * measured[*i]);
        let sum = if self.above { sum } else { -sum };
        sum > 0.0 || self.or_equal && sum == 0.0
    }
}

/// The text with another name for each channel and rule.
///
/// # Errors
/// What is wrong with the text.
pub fn renamed(text: &str, rename: impl Fn(&str) -> String) -> Result<String, Malformed> {
    let mut words = Words::new(text)?;
    let (mut out, mut at) = (String::new(), 0);
    while let Some(token) = words.next() {
        if let Token::Name(name) = token {
            let span = words.last_span();
            out.push_str(&text[at..span.start]);
            out.push_str(&crate::condition_words::quoted(&rename(&name)));
            at = span.end;
        }
    }
    out.push_str(&text[at..]);
    Ok(out)
}

struct Parser<'a> {
    words: Words<'a>,
    names: &'a mut Vec<String>,
}

impl Parser<'_> {
    fn any(&mut self) -> Result<Node, Malformed> {
        let mut nodes = vec![self.all()?];
        while self.words.take(&Token::Or) {
            nodes.push(self.all()?);
        }
        Ok(one_of(nodes, Node::Any))
    }

    fn all(&mut self) -> Result<Node, Malformed> {
        let mut nodes = vec![self.one()?];
        while self.words.take(&Token::And) {
            nodes.push(self.one()?);
        }
        Ok(one_of(nodes, Node::All))
    }

    fn one(&mut self) -> Result<Node, Malformed> {
        if self.words.take(&Token::Not) {
            return Ok(Node::Not(Box::new(self.one()?)));
        }
        if self.words.take(&Token::Open) {
            let node = self.any()?;
            return match self.words.next() {
                Some(Token::Close) => Ok(node),
                Some(token) => Err(self.words.unexpected(&token, "`)`")),
                None => Err(Malformed("`)` is missing at its end".into())),
            };
        }
        let (mut channels, mut constants) = (Vec::new(), Vec::new());
        self.sum(1.0, &mut channels, &mut constants)?;
        let (above, or_equal) = match self.words.peek() {
            Some(Token::Less(or_equal)) => (false, *or_equal),
            Some(Token::Greater(or_equal)) => (true, *or_equal),
            _ => return self.rule(&channels, &constants),
        };
        self.words.next();
        self.sum(-1.0, &mut channels, &mut constants)?;
        if channels.is_empty() {
            return Err(Malformed("it compares numbers only: name a channel".into()));
        }
        let channels = channels.into_iter().map(|(name, sign)| (self.place(name), sign)).collect();
        let sum_si = constants.iter().map(|(constant, _)| constant.si).sum();
        Ok(Node::Compare(Comparison { channels, constants, sum_si, above, or_equal }))
    }

    /// The name of another rule stands for whether it is on.
    fn rule(
        &mut self,
        channels: &[(String, f64)],
        constants: &[(Constant, f64)],
    ) -> Result<Node, Malformed> {
        match (channels, constants) {
            ([(name, 1.0)], []) => Ok(Node::On(self.place(format!("{name}.{ON}")))),
            _ => Err(Malformed(match self.words.next() {
                Some(token) => {
                    self.words.unexpected(&token, "`<` or `>` behind what it compares").0
                }
                None => "`<` or `>` is missing behind what it compares".into(),
            })),
        }
    }

    fn sum(
        &mut self,
        side: f64,
        channels: &mut Vec<(String, f64)>,
        constants: &mut Vec<(Constant, f64)>,
    ) -> Result<(), Malformed> {
        let mut negative = self.words.take(&Token::Minus);
        let mut sign = side;
        loop {
            match self.words.next() {
                Some(Token::Name(name)) => {
                    channels.push((name, if negative { -sign } else { sign }));
                }
                // -5 degC is 268.15 K, not -278.15 K.
                Some(Token::Number(mut constant)) if negative => {
                    constant.si = if constant.from_zero_celsius {
                        2.0 * ZERO_CELSIUS_K - constant.si
                    } else {
                        -constant.si
                    };
                    constant.si *= sign;
                    constants.push((constant, sign));
                }
                Some(Token::Number(mut constant)) => {
                    constant.si *= sign;
                    constants.push((constant, sign));
                }
                Some(token) => return Err(self.words.unexpected(&token, "a channel or a number")),
                None => {
                    return Err(Malformed("a channel or a number is missing at its end".into()));
                }
            }
            negative = false;
            sign = if self.words.take(&Token::Plus) {
                side
            } else if self.words.take(&Token::Minus) {
                -side
            } else {
                return Ok(());
            };
        }
    }

    fn place(&mut self, name: String) -> usize {
        self.names.iter().position(|known| *known == name).unwrap_or_else(|| {
            self.names.push(name);
            self.names.len() - 1
        })
    }
}

fn one_of(mut nodes: Vec<Node>, several: impl Fn(Vec<Node>) -> Node) -> Node {
    match (nodes.len(), nodes.pop()) {
        (1, Some(node)) => node,
        (_, last) => {
            nodes.extend(last);
            several(nodes)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> (Condition, Vec<String>) {
        let mut names = Vec::new();
        let condition =
            Condition::parse(text, &mut names).unwrap_or_else(|e| panic!("{text}: {e}"));
        (condition, names)
    }

    #[test]
    fn a_row_of_the_table_reads_as_it_is_written() {
        let (on, names) = parsed("storage.soc < 0.60 and storage.t_8_k < 65 degC");
        assert_eq!(names, ["storage.soc", "storage.t_8_k"]);
        assert!(on.holds(&[0.59, 338.0]) && !on.holds(&[0.61, 338.0]) && !on.holds(&[0.59, 338.2]));
        // and before or; a name alone is another rule
        let (off, names) =
            parsed("(tank.t_7_k > 55 degC or not top) and tank.t_2_k > 40 degC or not hp");
        assert_eq!(names, ["tank.t_7_k", "top.on", "tank.t_2_k", "hp.on"]);
        let degc = |t: f64| t + 273.15;
        assert!(off.holds(&[degc(56.0), 1.0, degc(41.0), 1.0]));
        assert!(off.holds(&[degc(50.0), 0.0, degc(41.0), 1.0]));
        assert!(!off.holds(&[degc(56.0), 0.0, degc(39.0), 1.0]));
        assert!(off.holds(&[degc(20.0), 1.0, degc(20.0), 0.0]));
    }

    #[test]
    fn sums_and_differences_on_both_sides() {
        let (warmer, names) = parsed("collector.t_k - storage.t_5_k > 3 K");
        assert_eq!(names.len(), 2);
        assert!(warmer.holds(&[323.2, 320.0]) && !warmer.holds(&[322.9, 320.0]));
        let (colder, _) = parsed("s.t_5_k < m.supply_set_k - 5 K");
        assert!(colder.holds(&[300.0, 305.1]) && !colder.holds(&[300.0, 304.9]));
        // at the limit
        for (text, expected) in
            [("a < 1", false), ("a <= 1", true), ("a > 1", false), ("1 >= a", true)]
        {
            assert_eq!(parsed(text).0.holds(&[1.0]), expected, "{text}");
        }
        let (negative, _) = parsed("w.t < -5 degC");
        assert!(negative.holds(&[268.0]) && !negative.holds(&[268.2]));
        let (power, _) = parsed("grid.grid_w < -0.5 kW");
        assert!(power.holds(&[-501.0]) && !power.holds(&[-499.0]));
    }

    #[test]
    fn names_get_the_site_of_their_house() {
        let text = "not top and  'a b.t_k' < -5 degC";
        let renamed = renamed(text, |name| format!("h1.{name}")).unwrap();
        assert_eq!(renamed, "not h1.top and  'h1.a b.t_k' < -5 degC");
        assert_eq!(parsed(&renamed).1, ["h1.top.on", "h1.a b.t_k"]);
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, expected) in [
            ("", "a channel or a number is missing at its end"),
            ("a <", "a channel or a number is missing at its end"),
            ("a < 5 degF", "unit `degF`"),
            ("a < 5 and", "a channel or a number is missing"),
            ("(a < 5", "`)` is missing"),
            ("a < 5 b", "unit `b`"),
            ("a < 5 < 6", "`<` stands where"),
            ("a = 5", "`=`"),
            ("3 < 5", "numbers only"),
            ("a - b", "`<` or `>` is missing"),
            ("'a < 5", "the quote"),
            ("a < 5 ) ", "`)` stands where"),
            ("a < 1e999", "1e999"),
        ] {
            let error = Condition::parse(text, &mut Vec::new()).unwrap_err();
            assert!(error.0.contains(expected), "{text}: {error}");
        }
    }
}

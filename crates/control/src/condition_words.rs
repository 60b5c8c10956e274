//! The words of a condition.

use crate::condition::{Constant, Malformed};
use anergy_core::units::{SI_SUFFIXES, UNITS, Unit};
use std::ops::Range;

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Token {
    Name(String),
    Number(Constant),
    And,
    Or,
    Not,
    Open,
    Close,
    /// With whether equal is enough.
    Less(bool),
    Greater(bool),
    Plus,
    Minus,
}

/// The words of a text, each with its place.
pub(crate) struct Words<'a> {
    text: &'a str,
    tokens: Vec<(Token, Range<usize>)>,
    at: usize,
}

impl<'a> Words<'a> {
    pub(crate) fn new(text: &'a str) -> Result<Self, Malformed> {
        let mut tokens = Vec::new();
        let mut at = 0;
        while let Some(first) = text[at..].chars().next() {
            let rest = &text[at..];
            if first.is_whitespace() {
                at += first.len_utf8();
                continue;
            }
            let (token, length) = if first == '\'' {
                let close = rest[1..]
                    .find('\'')
                    .ok_or_else(|| Malformed(format!("the quote at `{rest}` is not closed")))?;
                (Token::Name(rest[1..=close].to_owned()), close + 2)
            } else if first.is_ascii_digit() || first == '.' {
                number(rest)?
            } else if first.is_alphabetic() || first == '_' {
                word(rest)
            } else {
                sign(rest)?
            };
            tokens.push((token, at..at + length));
            at += length;
        }
        Ok(Self { text, tokens, at: 0 })
    }

    pub(crate) fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at).map(|(token, _)| token)
    }

    pub(crate) fn next(&mut self) -> Option<Token> {
        let token = self.peek().cloned();
        self.at += usize::from(token.is_some());
        token
    }

    /// Takes the next word if it is this one.
    pub(crate) fn take(&mut self, token: &Token) -> bool {
        let found = self.peek() == Some(token);
        self.at += usize::from(found);
        found
    }

    /// Place of the word that was taken last.
    pub(crate) fn last_span(&self) -> Range<usize> {
        self.tokens[self.at - 1].1.clone()
    }

    pub(crate) fn unexpected(&self, _token: &Token, expected: &str) -> Malformed {
        let word = &self.text[self.last_span()];
        Malformed(format!("`{word}` stands where {expected} is expected"))
    }
}

fn is_plain(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '.'
}

/// A name as it stands in a condition.
pub(crate) fn quoted(name: &str) -> String {
    let starts = name.chars().next().is_some_and(|c| c.is_alphabetic() || c == '_');
    match starts && word(name) == (Token::Name(name.to_owned()), name.len()) {
        true => name.to_owned(),
        false => format!("'{name}'"),
    }
}

fn word(text: &str) -> (Token, usize) {
    let mut length = 0;
    for (i, c) in text.char_indices() {
        // A minus belongs to a name that goes on behind it.
        let inner = c == '-' && text[i + 1..].chars().next().is_some_and(char::is_alphanumeric);
        if !is_plain(c) && !inner {
            break;
        }
        length = i + c.len_utf8();
    }
    let name = &text[..length];
    let token = match name {
        "and" => Token::And,
        "or" => Token::Or,
        "not" => Token::Not,
        _ => Token::Name(name.to_owned()),
    };
    (token, length)
}

fn number(text: &str) -> Result<(Token, usize), Malformed> {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        from + bytes[from..].iter().take_while(|b| b.is_ascii_digit() || **b == b'.').count()
    };
    let mut length = digits(0);
    if bytes.get(length).is_some_and(|b| b"eE".contains(b)) {
        let signed =
            length + 1 + usize::from(bytes.get(length + 1).is_some_and(|b| b"+-".contains(b)));
        if bytes.get(signed).is_some_and(u8::is_ascii_digit) {
            length = digits(signed);
        }
    }
    let digits = &text[..length];
    let value = digits.parse::<f64>().ok().filter(|value| value.is_finite());
    let value = value.ok_or_else(|| Malformed(format!("`{digits}` is no number")))?;
    let gap = text[length..].len() - text[length..].trim_start().len();
    let word = &text[length + gap..];
    let of_unit = |c: char| c.is_alphanumeric() || "/%_".contains(c);
    let word = &word[..word.find(|c| !of_unit(c)).unwrap_or(word.len())];
    let plain = Constant { si: value, unit: "", from_zero_celsius: false };
    if ["", "and", "or"].contains(&word) {
        return Ok((Token::Number(plain), length));
    }
    let suffix = if word == "%" { "percent".into() } else { word.to_lowercase().replace('/', "_") };
    let constant = match Unit::find(&suffix) {
        Some(unit) => Constant {
            si: unit.to_si(value),
            unit: unit.si,
            from_zero_celsius: unit.suffix == "degc",
        },
        None => {
            let unit = SI_SUFFIXES.iter().find(|si| **si == suffix).ok_or_else(|| {
                let known = UNITS.iter().map(|unit| unit.suffix);
                let near = known.filter(|known| known.starts_with(&suffix[..1.min(suffix.len())]));
                let near: Vec<&str> = near.collect();
                Malformed(format!(
                    "`{digits} {word}`: unit `{word}` is not known ({})",
                    near.join(", ")
                ))
            })?;
            Constant { unit, ..plain }
        }
    };
    Ok((Token::Number(constant), length + gap + word.len()))
}

fn sign(text: &str) -> Result<(Token, usize), Malformed> {
    let bytes = text.as_bytes();
    let or_equal = bytes.get(1) == Some(&b'=');
    let token = match bytes[0] {
        b'(' => Token::Open,
        b')' => Token::Close,
        b'+' => Token::Plus,
        b'-' => Token::Minus,
        b'<' => return Ok((Token::Less(or_equal), 1 + usize::from(or_equal))),
        b'>' => return Ok((Token::Greater(or_equal), 1 + usize::from(or_equal))),
        _ => {
            let c = text.chars().next().unwrap_or(' ');
            let message = format!(
                "`{c}` is no part of a condition: it has <, <=, >, >=, and, or, not, ( and )"
            );
            return Err(Malformed(message));
        }
    };
    Ok((token, 1))
}

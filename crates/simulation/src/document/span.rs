//! Places in a model text, small: there is one for every value of a large file.

use std::ops::Range;

/// Bytes of the text, or of the tables numbered on behind it; nothing for what came from no text, or lies
/// beyond 4 GB.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    start: u32,
    end: u32,
}

impl Span {
    /// No place.
    pub const NONE: Self = Self { start: u32::MAX, end: u32::MAX };

    /// The bytes.
    pub fn range(self) -> Option<Range<usize>> {
        (self != Self::NONE).then_some(self.start as usize..self.end as usize)
    }

    /// This place, or another where there is none.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        if self == Self::NONE { other } else { self }
    }
}

impl Default for Span {
    fn default() -> Self {
        Self::NONE
    }
}

impl From<Range<usize>> for Span {
    fn from(range: Range<usize>) -> Self {
        match (u32::try_from(range.start), u32::try_from(range.end)) {
            (Ok(start), Ok(end)) => Self { start, end },
            _ => Self::NONE,
        }
    }
}

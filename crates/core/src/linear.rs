//! A value and its slope: what a component tells the solver at the present flow.

/// First-order model of a quantity over the mass flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear {
    /// Value at the given flow.
    pub value: f64,
    /// Derivative with respect to the mass flow at the given flow.
    pub slope: f64,
}

impl Linear {
    /// A value with its slope.
    #[inline]
    pub const fn new(value: f64, slope: f64) -> Self {
        Self { value, slope }
    }

    /// Both multiplied by a factor.
    #[inline]
    pub fn scaled(self, factor: f64) -> Self {
        Self::new(self.value * factor, self.slope * factor)
    }
}

impl std::ops::Add for Linear {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.value + other.value, self.slope + other.slope)
    }
}

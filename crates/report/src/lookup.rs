//! Finds the column of a quantity of a component.

use anergy_core::recorder::{Channel, ChannelGroup, Recording};
use std::collections::BTreeMap;

/// Columns of a recording by component and quantity.
pub struct Lookup<'a> {
    /// The recording.
    pub recording: &'a Recording,
    /// Number of rows that all of time and the shown columns have.
    pub rows: usize,
    index: BTreeMap<(&'a str, &'a str), usize>,
}

impl<'a> Lookup<'a> {
    /// Indexes all channels once.
    pub fn new(recording: &'a Recording) -> Self {
        let key = |channel: &'a Channel| (channel.component.as_str(), channel.quantity.as_str());
        let channels = recording.channels.iter().enumerate();
        let index = channels.map(|(i, channel)| (key(channel), i)).collect();
        let rows = drawable_rows(&recording.time_s);
        Self { recording, rows, index }
    }

    /// The column of a quantity, if it was recorded.
    pub fn column(&self, component: &str, quantity: &str) -> Option<&'a [f64]> {
        let index = *self.index.get(&(component, quantity))?;
        self.recording.columns.get(index).map(Vec::as_slice)
    }

    /// Components of a group that have a quantity, in the order of the channels.
    pub fn components<'b>(
        &'b self,
        group: ChannelGroup,
        quantity: &'b str,
    ) -> impl Iterator<Item = &'a str> + 'b {
        let wanted =
            move |channel: &&Channel| channel.group == group && channel.quantity == quantity;
        self.recording.channels.iter().filter(wanted).map(|channel| channel.component.as_str())
    }

    /// Times of the shown rows, s.
    pub fn times(&self) -> &'a [f64] {
        &self.recording.time_s[..self.rows]
    }
}

/// Rows before the first time that is no number or goes backwards: what a plot can show.
fn drawable_rows(times: &[f64]) -> usize {
    let mut last = f64::NEG_INFINITY;
    let grows = |time: &&f64| {
        let grows = time.is_finite() && **time >= last;
        last = **time;
        grows
    };
    times.iter().take_while(grows).count()
}

/// A value of a column; no number where the column is too short.
pub fn value(column: &[f64], row: usize) -> f64 {
    column.get(row).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_end_where_time_stops_making_sense() {
        assert_eq!(drawable_rows(&[0.0, 1.0, 1.0, 2.0]), 4);
        assert_eq!(drawable_rows(&[0.0, 1.0, 0.5, 2.0]), 2);
        assert_eq!(drawable_rows(&[0.0, f64::NAN, 2.0]), 1);
        assert_eq!(drawable_rows(&[f64::INFINITY]), 0);
    }
}

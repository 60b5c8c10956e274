//! Fewer points that look the same: least and greatest value of each bucket of rows.

use crate::lookup::value;
use std::ops::Range;

/// How the rows of a recording become the points of the plots; the same for all series.
#[derive(Debug, Clone, PartialEq)]
pub struct Buckets {
    rows: usize,
    /// Two points each; empty when every row is a point.
    ranges: Vec<Range<usize>>,
}

impl Buckets {
    /// At most `max_points` points.
    pub fn new(rows: usize, max_points: usize) -> Self {
        let count = (max_points / 2).max(1);
        if rows <= 2 * count {
            return Self { rows, ranges: Vec::new() };
        }
        let start = |i: usize| i * rows / count;
        Self { rows, ranges: (0..count).map(|i| start(i)..start(i + 1)).collect() }
    }

    /// Whether points stand for several rows.
    pub fn is_decimated(&self) -> bool {
        !self.ranges.is_empty()
    }

    /// Times of the points: first and last row of each bucket.
    pub fn times(&self, times: &[f64]) -> Vec<f64> {
        if self.ranges.is_empty() {
            return times[..self.rows].to_vec();
        }
        self.ranges.iter().flat_map(|range| [times[range.start], times[range.end - 1]]).collect()
    }

    /// Values of the points: least and greatest value of each bucket in the order they occur.
    pub fn values(&self, column: &[f64]) -> Vec<f32> {
        if self.ranges.is_empty() {
            return (0..self.rows).map(|row| value(column, row) as f32).collect();
        }
        let mut out = Vec::with_capacity(2 * self.ranges.len());
        for range in &self.ranges {
            let finite = range
                .clone()
                .map(|row| (row, value(column, row)))
                .filter(|(_, value)| value.is_finite());
            let mut least: Option<(usize, f64)> = None;
            let mut greatest: Option<(usize, f64)> = None;
            for point in finite {
                if least.is_none_or(|(_, value)| point.1 < value) {
                    least = Some(point);
                }
                if greatest.is_none_or(|(_, value)| point.1 > value) {
                    greatest = Some(point);
                }
            }
            let (a, b) = match (least, greatest) {
                (Some(a), Some(b)) if a.0 <= b.0 => (a.1, b.1),
                (Some(a), Some(b)) => (b.1, a.1),
                _ => (f64::NAN, f64::NAN),
            };
            out.extend([a as f32, b as f32]);
        }
        out
    }
}

/// At most `max_frames` rows at equal distance, first and last included: whole rows, so that the
/// values of a frame belong together.
pub fn frames(rows: usize, max_frames: usize) -> Vec<usize> {
    let count = rows.min(max_frames.max(2));
    match count {
        0 => Vec::new(),
        1 => vec![0],
        _ => (0..count).map(|i| i * (rows - 1) / (count - 1)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_stay() {
        let mut column = vec![1.0; 100_000];
        column[12_345] = 7.0;
        column[77_777] = -3.0;
        let times: Vec<f64> = (0..column.len()).map(|i| i as f64).collect();
        let buckets = Buckets::new(column.len(), 2000);
        let (points, at) = (buckets.values(&column), buckets.times(&times));
        assert_eq!((points.len(), at.len()), (2000, 2000));
        assert!(points.contains(&7.0) && points.contains(&-3.0));
        assert!(at.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!((at[0], at[1999]), (0.0, 99_999.0));
        // A bucket has 100 rows: the peak is shown within 100 rows of its place.
        let shown = points.iter().position(|value| *value == 7.0).unwrap();
        assert!((at[shown] - 12_345.0).abs() < 100.0);
    }

    #[test]
    fn order_and_gaps() {
        let buckets = Buckets::new(8, 4);
        let nan = f64::NAN;
        assert_eq!(buckets.values(&[3.0, 2.0, 1.0, nan, 5.0, nan, nan, 6.0]), [3.0, 1.0, 5.0, 6.0]);
        assert!(buckets.values(&[nan; 8]).iter().all(|value| value.is_nan()));
        assert!(buckets.values(&[]).iter().all(|value| value.is_nan()));
    }

    #[test]
    fn few_rows_stay_as_they_are() {
        let buckets = Buckets::new(3, 2000);
        assert!(!buckets.is_decimated());
        assert_eq!(buckets.values(&[1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
        assert!(Buckets::new(0, 2000).values(&[]).is_empty());
    }

    #[test]
    fn frames_are_whole_rows() {
        assert_eq!(frames(5, 10), [0, 1, 2, 3, 4]);
        assert_eq!(frames(101, 3), [0, 50, 100]);
        assert_eq!(frames(1, 10), [0]);
        assert!(frames(0, 10).is_empty());
    }
}

//! Tests of the whole workspace: each folder beside this one is a program of them. Here is what several of
//! them need: where things are, random numbers that are the same every time, random elements.

pub mod pages;
pub mod prosnet;
pub mod running;
pub mod samples;

use std::path::{Path, PathBuf};

/// The root of the workspace.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A folder of the measured and published data, which are not part of the repository: below
/// `ANERGY_REFERENCE_DATA`, by default `../shared/data` from the root. `None`, with a line that says so,
/// where there are no reference data at all; a single missing case is an error.
///
/// # Panics
/// When the reference data are there but the case is not.
#[expect(clippy::print_stdout, reason = "a test that is skipped says so")]
pub fn reference_data(case: &str) -> Option<PathBuf> {
    let root = std::env::var_os("ANERGY_REFERENCE_DATA")
        .map_or_else(|| workspace().join("../shared/data"), PathBuf::from);
    if !root.is_dir() {
        println!(
            "SKIPPED {case}: no reference data at {}; set ANERGY_REFERENCE_DATA",
            root.display()
        );
        return None;
    }
    let folder = root.join(case);
    assert!(folder.is_dir(), "the reference data at {} lack the case {case}", root.display());
    Some(folder)
}

/// Pseudo-random numbers (splitmix64) from a fixed seed: the same on every platform.
#[derive(Debug, Clone)]
pub struct Random(pub u64);

impl Random {
    /// The next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A whole number below `n` (> 0).
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// A number in `low..high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// One of the items of a slice, which must not be empty.
    pub fn choose<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }

    /// Shuffles a slice.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }
}

//! A recording becomes one self-contained HTML report.
//!
//! [`html`] gives a page that opens from disk without a network: key numbers, a map of the network
//! with a time slider, linked plots, indicators, balances, events, and what is needed to repeat the run.
//! Recorded values stay in SI inside the page; l/min, bar, °C and kW are made where they are shown.
//!
//! What a model can name is text of strangers: everything goes through `escape` on its way into
//! the page, and the page's script writes text only.

mod collect;
mod decimate;
mod display;
mod drawing;
mod escape;
mod indicators;
mod layout;
mod lookup;
mod map;
mod page;
pub mod places;
mod series;
mod sites;
mod tables;

use anergy_core::recorder::Recording;

/// The report of a run as one HTML document; the same recording gives the same bytes.
///
/// A recording without rows, without map or without summary (an interrupted run) gives a report
/// that says so.
pub fn html(recording: &Recording) -> String {
    page::page(recording)
}

//! The model file, the state, and the invariants of the architecture.

mod continuation;
mod entries;
mod fuzz;
mod invalid;
mod tidy;

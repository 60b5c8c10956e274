//! Effects, and `explain`: what it names in data with a hidden effect, and what it does not.

mod ait;
mod effects;
mod hidden;
mod liege;
mod measurements;
mod rse;
mod small_cases;
mod tolerance;

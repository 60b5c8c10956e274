//! One file per command.

pub mod check;
pub mod demo;
pub mod explain;
pub mod export;
pub mod houses;
pub mod import;
pub mod measured;
pub mod report;
pub mod run;
pub mod schema;
pub mod solve;
pub mod stability;
pub mod sweep;

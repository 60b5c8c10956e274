//! Local controllers: measured signals in, set points of actuators out; sensors in between.

pub mod condition;
mod condition_words;
pub mod controller;
pub mod controllers;
pub mod modulation;
pub mod sensor;
pub mod swing;
pub mod user_controller;

//! Local controllers: measured signals in, set points of actuators out.

pub mod controller;
pub mod controllers;

//! Pumps and their controllers: blocking, hunting, stability and its remedies.

mod controllers;
mod feed_in_types;
mod hunting;
mod hunting_inertia;
mod hunting_random;
mod hunting_series;
mod pump_blocking;
mod stability_blocking;
mod user_controllers;
mod weighted_pi;

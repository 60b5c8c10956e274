//! Inputs of a building in their order.

pub(super) const ROOM_SET: usize = 0;
pub(super) const COOLING_SET: usize = 1;
pub(super) const PRESENCE: usize = 2;
pub(super) const APPLIANCES: usize = 3;
pub(super) const CELLAR: usize = 4;
pub(super) const HEATING_ENABLED: usize = 5;
pub(super) const COOLING_ENABLED: usize = 6;
pub(super) const OUTDOOR: usize = 7;
pub(super) const GROUND: usize = 8;
pub(super) const GLOBAL: usize = 9;
pub(super) const BEAM: usize = 10;
pub(super) const DIFFUSE: usize = 11;
pub(super) const ELEVATION: usize = 12;
pub(super) const AZIMUTH: usize = 13;
pub(super) const START: usize = 14;

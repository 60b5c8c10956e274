//! Networks of geographic information systems: GeoJSON (RFC 7946, WGS84 longitude and latitude) as models,
//! and models as GeoJSON.
//!
//! **Lengths** A pipe has the length that its property `length_m` (`length_km`, ...) says, whatever its line
//! looks like. Only without one it gets the length of its line: the sum of the geodesics between its points
//! on the ellipsoid WGS84 (Karney), heights left aside; that is said, with the number of such pipes.
//! Leaving out the nodes between two pipes in a row adds their lengths, so that the total is kept.
//!
//! **Joining** The ends of a line are the nodes it names (`from`, `to`), else the nearest point within the
//! tolerance, else the ends of other lines within the tolerance, which become one new node.
//!
//! **Positions** Metres east and north of the middle of the map by the radii of curvature of the ellipsoid there
//! (`anergy_core::local_plane`): good for drawing, 1e-3 of the distance within 10 km at middle latitudes. No lengths
//! are taken from them; whether ends are one node, within metres of each other, is.
//!
//! **Sources** rfc7946, karney2013.

mod export;
mod features;
mod join;
mod place;
mod properties;
mod simplify;
#[cfg(test)]
mod tests;
mod write;

pub use export::{Unplaced, export};

use crate::{Import, ImportError, text_of};

/// How a GeoJSON file is read.
#[derive(Debug, Clone, PartialEq)]
pub struct GeojsonOptions {
    /// Ends of lines and points closer than this are one node, m.
    pub snap_m: f64,
    /// Leaves out the nodes that only join two equal pipes.
    pub simplify: bool,
    /// Type of the pipes that say neither type nor diameter; `{NAME}` stands for a property of the pipe.
    pub pipe: Option<String>,
    /// Lines are trenches with supply and return, points are sites.
    pub trenches: bool,
}

impl Default for GeojsonOptions {
    fn default() -> Self {
        Self { snap_m: 0.5, simplify: false, pipe: None, trenches: false }
    }
}

/// The model file of a GeoJSON network.
///
/// # Errors
/// When the file is no GeoJSON in longitude and latitude, has no pipes, a pipe has neither geometry nor length,
/// or pipes say neither type nor diameter and no type is given for them.
pub fn import(bytes: &[u8], options: &GeojsonOptions) -> Result<Import, Vec<ImportError>> {
    let (mut network, mut notes) =
        features::read(&text_of(bytes), options.pipe.as_deref()).map_err(|error| vec![error])?;
    join::join(&mut network, options.snap_m, &mut notes)?;
    if options.simplify {
        simplify::simplify(&mut network, &mut notes);
    }
    write::write(&network, options, notes)
}

//! Plain nodes and edges of a model as GeoJSON.

use super::place::{LonLat, Plane};
use geojson::{Feature, Geometry, GeometryValue, JsonObject, feature::Id};
use serde_json::{Map, Value};
use std::collections::HashMap;
use thiserror::Error;

/// The model has positions in metres and does not say where on the earth they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error(
    "the positions of the model are in metres, and it does not say where they are on the earth: give `latitude_deg` \
     and `longitude_deg` of x_m = 0, y_m = 0 in [model], or --origin LATITUDE LONGITUDE"
)]
pub struct Unplaced;

/// The network as one feature per line: nodes as points, edges as straight lines between them, all fields as
/// properties. What has no position has no geometry.
///
/// `nodes` and `edges` are the entries of a plain model; `origin` is the longitude and latitude, deg, of
/// its x_m = 0, y_m = 0.
///
/// # Errors
/// [`Unplaced`] when there are positions but no origin.
pub fn export(
    name: &str,
    nodes: &[Map<String, Value>],
    edges: &[Map<String, Value>],
    origin: Option<LonLat>,
) -> Result<String, Unplaced> {
    let plane = origin.map(Plane::at);
    let mut places: HashMap<&str, LonLat> = HashMap::new();
    let mut features = Vec::with_capacity(nodes.len() + edges.len());
    for node in nodes {
        let metres = |axis: &str| node.get(axis).and_then(Value::as_f64);
        let at = match (metres("x_m"), metres("y_m")) {
            (Some(x_m), Some(y_m)) => Some(plane.ok_or(Unplaced)?.lon_lat([x_m, y_m])),
            _ => None,
        };
        if let (Some(at), Some(id)) = (at, text(node, "id")) {
            places.insert(id, at);
        }
        let mut properties = node.clone();
        properties.remove("x_m");
        properties.remove("y_m");
        features.push(feature(properties, at.map(GeometryValue::new_point)));
    }
    for edge in edges {
        let place = |end: &str| text(edge, end).and_then(|id| places.get(id)).copied();
        let line = match (place("from"), place("to")) {
            (Some(from), Some(to)) => Some(GeometryValue::new_line_string([from, to])),
            _ => None,
        };
        features.push(feature(edge.clone(), line));
    }
    let lines: Vec<String> = features.iter().map(Feature::to_string).collect();
    Ok(format!(
        "{{\"type\":\"FeatureCollection\",\"name\":{},\"features\":[\n{}\n]}}\n",
        Value::from(name),
        lines.join(",\n")
    ))
}

fn text<'a>(entry: &'a Map<String, Value>, name: &str) -> Option<&'a str> {
    entry.get(name).and_then(Value::as_str)
}

fn feature(properties: JsonObject, geometry: Option<GeometryValue>) -> Feature {
    Feature {
        id: text(&properties, "id").map(|id| Id::String(id.to_owned())),
        geometry: geometry.map(Geometry::new),
        properties: Some(properties),
        ..Feature::default()
    }
}

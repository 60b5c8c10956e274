//! The network as one message `foxglove.GeoJSON` for the Map panel of Foxglove.
//!
//! Positions in metres are about the setting `latitude_deg`, `longitude_deg` of the run, about 0, 0 without it.

use anergy_core::local_plane::{LocalPlane, LonLat};
use anergy_core::recorder::{NetworkMap, RunHeader};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Topic of the map.
pub(crate) const TOPIC: &str = "/network/map";
/// Name of its schema.
pub(crate) const SCHEMA: &str = "foxglove.GeoJSON";

/// Colours of hot, cold and other lines.
const COLOURS: [(&str, &str); 3] = [(".hot", "#be262c"), (".cold", "#215fa8"), ("", "#6b7480")];

/// JSON Schema of `foxglove.GeoJSON`.
pub(crate) fn schema() -> Value {
    json!({
        "title": SCHEMA,
        "description": "The network, with the names of sites and pipes",
        "type": "object",
        "properties": {"geojson": {"type": "string", "description": "GeoJSON (RFC 7946)"}},
    })
}

/// The message; `None` where no node has a position.
pub(crate) fn message(header: &RunHeader) -> Option<Value> {
    let setting = |name: &str| {
        let found = header.settings.iter().find(|(known, _)| known == name);
        found.and_then(|(_, value)| value.parse::<f64>().ok())
    };
    let origin = [setting("longitude_deg").unwrap_or(0.0), setting("latitude_deg").unwrap_or(0.0)];
    let features = features(&header.map, LocalPlane::at(origin));
    (!features.is_empty()).then(|| {
        let collection = json!({"type": "FeatureCollection", "features": features});
        json!({ "geojson": collection.to_string() })
    })
}

/// A point for each site or plain node, a line for each edge that goes from place to place.
fn features(map: &NetworkMap, plane: LocalPlane) -> Vec<Value> {
    let mut places: BTreeMap<&str, LonLat> = BTreeMap::new();
    let mut sites: BTreeMap<&str, LonLat> = BTreeMap::new();
    for node in &map.nodes {
        if let (Some(x_m), Some(y_m)) = (node.x_m, node.y_m) {
            let place = plane.lon_lat([x_m, y_m]);
            places.insert(&node.id, place);
            let name = if node.site.is_empty() { &node.id } else { &node.site };
            sites.entry(name).or_insert(place);
        }
    }
    let lines = map.edges.iter().filter_map(|edge| {
        let (from, to) = (places.get(edge.from.as_str())?, places.get(edge.to.as_str())?);
        let side = |end: &str| edge.from.ends_with(end) && edge.to.ends_with(end);
        let colour = COLOURS.iter().find(|(end, _)| side(end)).map_or("", |(_, colour)| colour);
        (from != to).then(|| {
            json!({
                "type": "Feature",
                "geometry": {"type": "LineString", "coordinates": [from, to]},
                "properties": {
                    "name": edge.id, "kind": edge.kind, "length_m": edge.length_m,
                    "style": {"color": colour, "weight": 3},
                },
            })
        })
    });
    let points = sites.iter().map(|(name, place)| {
        json!({
            "type": "Feature",
            "geometry": {"type": "Point", "coordinates": place},
            "properties": {"name": name, "style": {"color": "#18212c"}},
        })
    });
    lines.chain(points).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use anergy_core::recorder::{MapEdge, MapNode};

    fn node(id: &str, site: &str, x_m: Option<f64>) -> MapNode {
        MapNode { id: id.into(), site: site.into(), x_m, y_m: Some(0.0) }
    }

    #[test]
    fn lines_and_points_where_the_model_lies() {
        let mut header = RunHeader::default();
        let nodes = [
            ("a.hot", "a", Some(0.0)),
            ("a.cold", "a", Some(0.0)),
            ("b.hot", "b", Some(500.0)),
            ("c", "", None),
        ];
        header.map.nodes = nodes.map(|(id, site, x_m)| node(id, site, x_m)).into();
        header.map.edges = [("a.hot", "b.hot"), ("a.hot", "a.cold"), ("b.hot", "c")]
            .map(|(from, to)| MapEdge {
                id: format!("{from}-{to}"),
                kind: "pipe".into(),
                from: from.into(),
                to: to.into(),
                length_m: 510.0,
                inner_diameter_m: 0.05,
                station: String::new(),
            })
            .into();
        header.settings =
            vec![("latitude_deg".into(), "48".into()), ("longitude_deg".into(), "11".into())];
        let message = message(&header).unwrap();
        let map: Value = serde_json::from_str(message["geojson"].as_str().unwrap()).unwrap();
        let features = map["features"].as_array().unwrap();
        // One line from place to place, two sites.
        assert_eq!(features.len(), 3);
        assert_eq!(features[0]["geometry"]["coordinates"][0], json!([11.0, 48.0]));
        // 500 m / 74 625 m per deg.
        let longitude = features[0]["geometry"]["coordinates"][1][0].as_f64().unwrap();
        assert!((longitude - 11.0067).abs() < 1e-6, "{longitude}");
        assert_eq!(features[0]["properties"]["style"]["color"], "#be262c");
        header.map.nodes.iter_mut().for_each(|node| node.x_m = None);
        assert!(super::message(&header).is_none());
    }
}

//! Points and lines of a GeoJSON file with their names, ends, lengths and fields.

use super::place::LonLat;
use super::properties::{self, Fields, Unknown};
use crate::{ImportError, Note, NoteKind};
use geojson::{Feature, GeoJson, GeometryValue, Position, feature::Id};
use serde_json::{Map, Number, Value};
use std::collections::{BTreeMap, HashSet};

/// A node.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Point {
    pub id: String,
    pub at: Option<LonLat>,
    pub fields: Fields,
}

/// An edge.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Line {
    pub id: String,
    /// Word of the registry.
    pub kind: String,
    /// Nodes at ports a and b, as far as they are known.
    pub ends: [Option<String>; 2],
    /// Its points; empty without geometry.
    pub path: Vec<LonLat>,
    /// Length as it is given, m; pipes only.
    pub length_m: Option<f64>,
    pub fields: Fields,
}

impl Line {
    pub fn is_pipe(&self) -> bool {
        self.kind == "pipe"
    }
}

/// The content of a file.
#[derive(Debug, Default)]
pub(super) struct Network {
    pub name: Option<String>,
    pub points: Vec<Point>,
    pub lines: Vec<Line>,
}

/// Reads a file; what it has no use for is noted.
pub(super) fn read(text: &str, pipe: Option<&str>) -> Result<(Network, Vec<Note>), ImportError> {
    let file: GeoJson = text
        .parse()
        .map_err(|error| ImportError::new(None, format!("this is no GeoJSON: {error}")))?;
    let GeoJson::FeatureCollection(collection) = file else {
        return Err(ImportError::new(None, "the file has no `FeatureCollection`: export a layer"));
    };
    let mut reader = Reader { pipe, ..Reader::default() };
    if let Some(members) = &collection.foreign_members {
        reader.network.name = members.get("name").and_then(Value::as_str).map(str::to_owned);
        check_system(members)?;
    }
    for (number, feature) in collection.features.into_iter().enumerate() {
        reader.feature(number + 1, feature)?;
    }
    if reader.network.lines.is_empty() {
        return Err(ImportError::new(None, "the file has no lines: nothing that could be a pipe"));
    }
    let notes = reader.notes();
    Ok((reader.network, notes))
}

/// A coordinate reference system as files before RFC 7946 name it.
fn check_system(members: &Map<String, Value>) -> Result<(), ImportError> {
    let name = members.get("crs").and_then(|crs| crs.pointer("/properties/name")?.as_str());
    match name {
        Some(name) if !["CRS84", "4326"].iter().any(|known| name.contains(known)) => {
            let message = format!(
                "the coordinates are in {name}, not in longitude and latitude (RFC 7946): convert them, for \
                 example with ogr2ogr -t_srs EPSG:4326 out.geojson in.geojson"
            );
            Err(ImportError::new(None, message))
        }
        _ => Ok(()),
    }
}

#[derive(Default)]
struct Reader<'a> {
    /// Type of the pipes without type and diameter.
    pipe: Option<&'a str>,
    /// Number of such pipes.
    typed: usize,
    network: Network,
    node_ids: HashSet<String>,
    edge_ids: HashSet<String>,
    unknown: Unknown,
    /// Features of other shapes.
    shapes: BTreeMap<&'static str, usize>,
    renamed: Vec<String>,
    heights: usize,
    split: usize,
}

impl Reader<'_> {
    fn feature(&mut self, number: usize, feature: Feature) -> Result<(), ImportError> {
        let properties = feature.properties.unwrap_or_default();
        let id = name(&properties, feature.id.as_ref());
        let wrong = |what: String| {
            let named = id.as_ref().map_or(String::new(), |id| format!(" (\"{id}\")"));
            ImportError::new(None, format!("feature {number}{named}: {what}"))
        };
        match feature.geometry.map(|geometry| geometry.value) {
            Some(GeometryValue::Point { coordinates }) => {
                let at = lon_lat(&coordinates).map_err(&wrong)?;
                let height = coordinates.as_slice().get(2).copied();
                self.point(id, Some(at), height, &properties);
            }
            Some(GeometryValue::LineString { coordinates }) => {
                let path = path(&coordinates).map_err(&wrong)?;
                let length_m = length(&properties).map_err(&wrong)?;
                self.line(id.clone(), path, length_m, &properties).map_err(&wrong)?;
            }
            Some(GeometryValue::MultiLineString { coordinates }) => {
                let paths: Vec<Vec<LonLat>> = coordinates
                    .iter()
                    .map(|part| path(part))
                    .collect::<Result<_, _>>()
                    .map_err(&wrong)?;
                let length_m = length(&properties).map_err(&wrong)?;
                self.parts(id.clone(), &paths, length_m, &properties).map_err(&wrong)?;
            }
            None if properties.contains_key("from") && properties.contains_key("to") => {
                let length_m = length(&properties).map_err(&wrong)?;
                self.line(id.clone(), Vec::new(), length_m, &properties).map_err(&wrong)?;
            }
            None if id.is_some() => self.point(id, None, None, &properties),
            other => {
                let shape = other.as_ref().map_or("without geometry", GeometryValue::type_name);
                *self.shapes.entry(shape).or_insert(0) += 1;
            }
        }
        Ok(())
    }

    fn point(
        &mut self,
        id: Option<String>,
        at: Option<LonLat>,
        height: Option<f64>,
        properties: &Map<String, Value>,
    ) {
        let id = own(&mut self.node_ids, &mut self.renamed, id, "node");
        let mut fields =
            properties::fields(properties.iter(), &["id", "name"], true, &mut self.unknown);
        let elevated = fields.iter().any(|(name, _)| name.starts_with("elevation_"));
        if let Some(height) = height.filter(|height| height.is_finite() && !elevated) {
            self.heights += 1;
            fields.push(("elevation_m".to_owned(), height.into()));
        }
        self.network.points.push(Point { id, at, fields });
    }

    fn line(
        &mut self,
        id: Option<String>,
        path: Vec<LonLat>,
        length_m: Option<f64>,
        properties: &Map<String, Value>,
    ) -> Result<(), String> {
        let id = own(&mut self.edge_ids, &mut self.renamed, id, "pipe");
        let kind = properties.get("kind").and_then(Value::as_str).unwrap_or("pipe").to_owned();
        let taken = |name: &str, value: &Value| {
            kind == "pipe" && properties::length_m(name, value).is_some()
        };
        let others = properties.iter().filter(|(name, value)| !taken(name, value));
        let asked = self.pipe.map_or(Vec::new(), |pipe| placeholders(pipe));
        let taken = [&["id", "name", "from", "to"], &asked[..]].concat();
        let mut fields = properties::fields(others, &taken, false, &mut self.unknown);
        fields.retain(|(name, _)| name != "kind");
        if let Some(pipe) = self.pipe.filter(|_| kind == "pipe" && !is_typed(&fields)) {
            self.typed += 1;
            fields.push(("pipe".to_owned(), type_of(pipe, properties)?.into()));
        }
        let end = |name: &str| properties.get(name).and_then(text).filter(|name| !name.is_empty());
        let ends = [end("from"), end("to")];
        let length_m = length_m.filter(|_| kind == "pipe");
        self.network.lines.push(Line { id, kind, ends, path, length_m, fields });
        Ok(())
    }

    /// A line of several parts becomes several pipes, which share its length as they are drawn.
    fn parts(
        &mut self,
        id: Option<String>,
        paths: &[Vec<LonLat>],
        length_m: Option<f64>,
        properties: &Map<String, Value>,
    ) -> Result<(), String> {
        if let [path] = paths {
            return self.line(id, path.clone(), length_m, properties);
        }
        self.split += 1;
        let earth = super::place::Earth::new();
        let drawn: Vec<f64> = paths.iter().map(|path| earth.length_m(path)).collect();
        let total: f64 = drawn.iter().sum();
        let mut properties = properties.clone();
        properties.remove("from");
        properties.remove("to");
        for (i, (path, drawn)) in paths.iter().zip(drawn).enumerate() {
            let id = id.as_ref().map(|id| format!("{id}.{}", i + 1));
            self.line(id, path.clone(), length_m.map(|m| m * drawn / total), &properties)?;
        }
        Ok(())
    }

    fn notes(&self) -> Vec<Note> {
        let mut notes = Vec::new();
        let mut note = |kind, text| notes.push(Note { kind, line: None, text });
        for (name, count) in &self.unknown {
            let what = format!("property \"{name}\" of {count} features");
            note(NoteKind::NotTranslated, what);
        }
        for (shape, count) in &self.shapes {
            note(NoteKind::NotTranslated, format!("{count} features: {shape}"));
        }
        if let Some(pipe) = self.pipe.filter(|_| self.typed > 0) {
            let count = self.typed;
            let what = format!("{count} pipes without type and diameter are \"{pipe}\"");
            note(NoteKind::Changed, what);
        }
        for name in &self.renamed {
            note(NoteKind::Changed, format!("{name}: the name occurs twice"));
        }
        if self.heights > 0 {
            let what = format!("{} elevations are the third coordinates of points", self.heights);
            note(NoteKind::Changed, what);
        }
        if self.split > 0 {
            let what = format!(
                "{} lines of several parts are several pipes, which share the length given as they are drawn; \
                 their ends are where they are drawn",
                self.split
            );
            note(NoteKind::Changed, what);
        }
        notes
    }
}

/// Whether fields say the size of a pipe.
pub(super) fn is_typed(fields: &Fields) -> bool {
    let known = |name: &str| name == "pipe" || name.starts_with("inner_diameter_");
    fields.iter().any(|(name, value)| known(name) && !value.is_null())
}

/// Names of the properties that a type asks for: `DN` of `steel DN{DN}`.
fn placeholders(pipe: &str) -> Vec<&str> {
    pipe.split('{').skip(1).filter_map(|rest| Some(rest.split_once('}')?.0)).collect()
}

/// The type of a pipe with its properties put in.
fn type_of(pipe: &str, properties: &Map<String, Value>) -> Result<String, String> {
    let mut out = pipe.to_owned();
    for name in placeholders(pipe) {
        let value = properties.get(name).and_then(text).ok_or_else(|| {
            format!("its type \"{pipe}\" asks for a property \"{name}\", which it does not have")
        })?;
        out = out.replace(&format!("{{{name}}}"), &value);
    }
    Ok(out)
}

/// A name that nothing else has.
fn own(
    taken: &mut HashSet<String>,
    renamed: &mut Vec<String>,
    id: Option<String>,
    word: &str,
) -> String {
    let wanted = id.unwrap_or_else(|| format!("{word}{}", taken.len() + 1));
    let id = crate::model_text::unused(taken, &wanted);
    if id != wanted {
        renamed.push(format!("\"{wanted}\" is \"{id}\""));
    }
    taken.insert(id.clone());
    id
}

/// Name of a feature: its property `id`, its id, its property `name`.
fn name(properties: &Map<String, Value>, id: Option<&Id>) -> Option<String> {
    let of_feature = || match id? {
        Id::String(text) => Some(text.clone()),
        Id::Number(number) => Some(digits(number)),
    };
    let property = |name: &str| properties.get(name).and_then(text);
    let name = property("id").or_else(of_feature).or_else(|| property("name"));
    name.filter(|name| !name.trim().is_empty())
}

fn text(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => Some(digits(number)),
        _ => None,
    }
}

/// A number as a name: whole ones without decimals, since columns of floating point have 1.0 for 1.
fn digits(number: &Number) -> String {
    match number.as_f64() {
        Some(value) if number.is_f64() && value.fract() == 0.0 && value.abs() < 1e15 => {
            (value as i64).to_string()
        }
        _ => number.to_string(),
    }
}

fn length(properties: &Map<String, Value>) -> Result<Option<f64>, String> {
    let given = properties.iter().find_map(|(name, value)| properties::length_m(name, value));
    match given {
        Some(length_m) if !(length_m > 0.0 && length_m.is_finite()) => Err(format!(
            "a length of {length_m} m cannot be that of a pipe; without the property it follows from the line"
        )),
        given => Ok(given),
    }
}

fn path(positions: &[Position]) -> Result<Vec<LonLat>, String> {
    if positions.len() < 2 {
        return Err("a line needs two points".to_owned());
    }
    positions.iter().map(lon_lat).collect()
}

fn lon_lat(position: &Position) -> Result<LonLat, String> {
    let [longitude, latitude, ..] = position.as_slice() else {
        return Err("a position needs longitude and latitude".to_owned());
    };
    if longitude.abs() <= 180.0 && latitude.abs() <= 90.0 {
        return Ok([*longitude, *latitude]);
    }
    Err(format!(
        "[{longitude}, {latitude}] is not longitude and latitude in deg (RFC 7946): convert the coordinates, for \
         example with ogr2ogr -t_srs EPSG:4326 out.geojson in.geojson"
    ))
}

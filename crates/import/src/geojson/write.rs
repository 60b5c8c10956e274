//! The network as text of a model.

use super::GeojsonOptions;
use super::features::{Line, Network, Point, is_typed};
use super::place::Plane;
use super::properties::toml;
use crate::model_text::{Entry, ModelText};
use crate::{Import, ImportError, Note, NoteKind};

const TITLE: &str = "Imported from GeoJSON. What the file says otherwise or not at all:";

pub(super) fn write(
    network: &Network,
    options: &GeojsonOptions,
    notes: Vec<Note>,
) -> Result<Import, Vec<ImportError>> {
    let mut text = ModelText::default();
    for note in notes {
        text.note(note.kind, note.line, note.text);
    }
    let untyped: Vec<&Line> =
        network.lines.iter().filter(|line| line.is_pipe() && !is_typed(&line.fields)).collect();
    if let Some(first) = untyped.first() {
        let message = format!(
            "{} pipes have neither `pipe` nor `inner_diameter_m` (or another unit), the first is \"{}\": --pipe \
             \"steel DN50\" gives them a type of the catalogue, --pipe \"steel DN{{DN}}\" one by their property DN",
            untyped.len(),
            first.id
        );
        return Err(vec![ImportError::new(None, message)]);
    }
    let plane = Plane::around(network.points.iter().filter_map(|point| point.at));
    let name = network.name.as_deref().unwrap_or("GeoJSON network");
    let about = text.section("model").text("name", name);
    if let Some(plane) = plane {
        about.number("latitude_deg", plane.origin[1]).number("longitude_deg", plane.origin[0]);
    }
    for point in &network.points {
        node(&mut text, point, plane, options.trenches)?;
    }
    for line in &network.lines {
        edge(&mut text, line, options)?;
    }
    let holds = |point: &Point| {
        point.fields.iter().any(|(name, kind)| name == "kind" && kind == "pressure_boundary")
    };
    if !network.points.iter().any(holds) {
        let what = "no node gives a pressure: the model needs a `pressure_boundary`, a plant or a \
                    [pressure_reference], and somebody who takes water";
        text.note(NoteKind::NotTranslated, None, what.to_owned());
    }
    Ok(text.finish(TITLE))
}

fn node(
    text: &mut ModelText,
    point: &Point,
    plane: Option<Plane>,
    site: bool,
) -> Result<(), Vec<ImportError>> {
    let entry = if site { text.entry("site").text("id", &point.id) } else { text.node(&point.id) };
    let entry = match (plane, point.at) {
        (Some(plane), Some(at)) => {
            let [x_m, y_m] = plane.metres(at).map(|metres| (1e3 * metres).round() / 1e3);
            entry.number("x_m", x_m).number("y_m", y_m)
        }
        _ => entry,
    };
    let placed = point.at.is_some();
    let fields = point.fields.iter().filter(|(name, _)| {
        let written = placed && ["x_m", "y_m"].contains(&name.as_str());
        !(written || site && name == "kind")
    });
    fields_of(entry, fields, &point.id)
}

fn edge(
    text: &mut ModelText,
    line: &Line,
    options: &GeojsonOptions,
) -> Result<(), Vec<ImportError>> {
    let [Some(from), Some(to)] = &line.ends else { return Ok(()) };
    let entry = if options.trenches {
        if !line.is_pipe() {
            let message = format!("\"{}\" is a {}: only pipes can be trenches", line.id, line.kind);
            return Err(vec![ImportError::new(None, message)]);
        }
        text.entry("trench").text("id", &line.id).text("from", from).text("to", to)
    } else {
        text.edge(&line.id, &line.kind, from, to)
    };
    let entry = entry.maybe("length_m", line.length_m);
    fields_of(entry, line.fields.iter(), &line.id)
}

fn fields_of<'a>(
    mut entry: Entry<'_>,
    fields: impl Iterator<Item = &'a (String, serde_json::Value)>,
    id: &str,
) -> Result<(), Vec<ImportError>> {
    for (name, value) in fields {
        let is_key = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
        let Some(value) = toml(value).filter(|_| is_key && !name.is_empty()) else {
            let message = format!("\"{id}\": its property \"{name}\" cannot be a field");
            return Err(vec![ImportError::new(None, message)]);
        };
        entry = entry.raw(name, &value);
    }
    Ok(())
}

//! The same model with a finer grid of its storages: what the layers of a storage smear.
//!
//! **Equation** a storage of `n` layers gets `3 n`: layer `k` (from 1) becomes `3 k - 2 .. 3 k`, of which `3 k - 1` has its height. Ports,
//! coils and sensors stay where they are. Water that moves through well-mixed layers of height `dz` is smeared as by a conductivity of
//! `rho c u dz/2`, which falls to a third: the difference of both readings is two thirds of the error of the coarse grid.
//!
//! **Validity** models without controllers (they may name layers), storages of at most a third of the most layers there may be.

use crate::experiment::Experiment;
use anergy_simulation::model::UnitSpec;
use serde_json::Value;

/// Layers of the finer grid for one of the coarse one.
const FINER: usize = 3;
/// Error of the coarse grid over the difference to the finer one: `1/(1 - 1/3)`.
pub(crate) const WHOLE: f64 = 1.5;

/// The experiment with finer storages; none where there are none, or the model does not allow it.
pub(crate) fn finer(experiment: &Experiment) -> Option<Experiment> {
    if !experiment.model.controllers.is_empty() {
        return None;
    }
    let mut other = experiment.clone();
    let mut storages = Vec::new();
    for unit in other.model.units.iter_mut().filter(|unit| unit.params.kind() == "storage") {
        *unit = refined(unit)?;
        storages.push(unit.id.to_string());
    }
    for sensor in &mut other.sensors.sensor {
        if let Some((storage, layer)) = layer_of(&sensor.signal, &storages) {
            sensor.signal = format!("{storage}.t_{}_k", centre(layer));
        }
    }
    (!storages.is_empty()).then_some(other)
}

/// Share of what the layers mix that may be an error: all of it, unless the model says how well its mixing is known. Mixed layers mix as water
/// that eddies do, and who declares `storage_mixing` has chosen them so that they do by as much.
pub(crate) fn unknown_share(experiment: &Experiment) -> f64 {
    experiment.model.tolerance.storage_mixing.map_or(1.0, |half| half.min(1.0))
}

/// The layer of the finer grid at the height of one of the coarse grid, both from 1.
fn centre(layer: usize) -> usize {
    FINER * layer - FINER / 2
}

fn layer_of<'a>(signal: &str, storages: &'a [String]) -> Option<(&'a str, usize)> {
    let (of, quantity) = signal.rsplit_once('.')?;
    let storage = storages.iter().find(|storage| *storage == of)?;
    Some((storage, quantity.strip_prefix("t_")?.strip_suffix("_k")?.parse().ok()?))
}

fn refined(unit: &UnitSpec) -> Option<UnitSpec> {
    let mut value = unit.params.to_value();
    refine(&mut value);
    unit.with_params(value)
}

fn refine(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            for (name, field) in fields {
                match field.as_u64().map(|n| n as usize) {
                    Some(n) if name == "layers" => *field = Value::from(FINER * n),
                    Some(n) if name.ends_with("_layer") => *field = Value::from(centre(n)),
                    _ if name == "initial_layers_k" => {
                        let layers = field.as_array().into_iter().flatten();
                        let thrice = layers.flat_map(|t| vec![t.clone(); FINER]);
                        *field = thrice.collect();
                    }
                    _ => refine(field),
                }
            }
        }
        Value::Array(all) => all.iter_mut().for_each(refine),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn layers_stay_at_their_height() {
        // Of two layers the middles lie at 1/4 and 3/4; of six those of the second and the fifth.
        assert_eq!((centre(1), centre(2)), (2, 5));
        let mut storage = json!({
            "layers": 2, "ports": { "a": { "inlet_layer": 2, "outlet_layer": 1 } }, "initial_layers_k": [300.0, 310.0], "volume_m3": 0.5
        });
        refine(&mut storage);
        let finer = json!({
            "layers": 6, "ports": { "a": { "inlet_layer": 5, "outlet_layer": 2 } },
            "initial_layers_k": [300.0, 300.0, 300.0, 310.0, 310.0, 310.0], "volume_m3": 0.5
        });
        assert_eq!(storage, finer);
        let storages = ["tank".to_owned()];
        assert_eq!(layer_of("tank.t_7_k", &storages), Some(("tank", 7)));
        assert_eq!(layer_of("tank.charge.t_out_k", &storages), None);
        assert_eq!(layer_of("other.t_7_k", &storages), None);
    }
}

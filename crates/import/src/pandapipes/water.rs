//! Properties of the water of a net at one temperature.

use super::tables::{Tables, inside, number, numbers};
use crate::ImportError;

/// Properties of the water.
pub(super) struct Water {
    pub density: f64,
    pub heat_capacity: f64,
    pub viscosity: f64,
}

/// Properties at a temperature.
pub(super) fn water(net: &Tables, t_k: f64) -> Result<Water, ImportError> {
    let wrong = |what: &str| ImportError::new(None, format!("fluid: {what}"));
    let fluid = net.get("fluid").ok_or_else(|| wrong("the net has none"))?;
    if fluid.get("is_gas").and_then(serde_json::Value::as_bool) == Some(true) {
        return Err(wrong("a gas: anergy knows water only"));
    }
    let property = |name: &str| {
        let properties = fluid.get("all_properties")?;
        let property = inside(properties.get(name)?).into_owned();
        if let Some(value) = property.get("value") {
            return number(value);
        }
        let (x, y) = (numbers(property.get("x")?)?, numbers(property.get("y")?)?);
        if x.len() < 2 || x.len() != y.len() {
            return None;
        }
        // The last points continue the table on both sides, as in pandapipes.
        let i = x.partition_point(|x| *x <= t_k).clamp(1, x.len() - 1);
        Some(y[i - 1] + (y[i] - y[i - 1]) / (x[i] - x[i - 1]) * (t_k - x[i - 1]))
    };
    let get = |name: &str| {
        property(name)
            .filter(|value| *value > 0.0 && value.is_finite())
            .ok_or_else(|| wrong(&format!("{name} cannot be read")))
    };
    Ok(Water {
        density: get("density")?,
        heat_capacity: get("heat_capacity")?,
        viscosity: get("viscosity")?,
    })
}

//! From the parameters of a model file to a storage that runs; what cannot be is refused.

use super::coil::Coil;
use super::jet::Jet;
use super::layers::{Layers, MAX_LAYERS, side_and_section_m2};
use super::ports::{MAX_PORTS, Openings, refused};
use super::rod::Rod;
use super::tank::{Scheme, Tank};
use super::unit::{Initial, Storage};
use super::{StorageCoil, StorageParams, StorageRod};
use crate::equipment::liquid;
use crate::thermal_unit::UnitError;
use anergy_core::medium::Medium;

/// Loss of a storage of which nothing is said, W/(m2 K).
pub const U_W_M2_K: f64 = 0.35;

fn fields<T>(problem: String) -> Result<T, UnitError> {
    Err(UnitError::Fields { problem })
}

fn positive(field: &'static str, value: f64) -> Result<f64, UnitError> {
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(UnitError::OutOfRange { field, value, requirement: "must be positive" })
}

fn not_negative(field: &'static str, value: f64) -> Result<f64, UnitError> {
    if value.is_finite() && value >= 0.0 {
        return Ok(value);
    }
    Err(UnitError::OutOfRange { field, value, requirement: "must not be negative" })
}

fn within<T>(field: &'static str, problem: String) -> Result<T, UnitError> {
    Err(UnitError::Within { field, problem })
}

fn of_coils<T>(problem: String) -> Result<T, UnitError> {
    within("coils", problem)
}

fn of_rod<T>(problem: String) -> Result<T, UnitError> {
    within("rod", problem)
}

/// A number of a coil or of the rod.
fn part(
    of: &str,
    field: &str,
    value: f64,
    fits: bool,
    requirement: &str,
) -> Result<f64, UnitError> {
    if value.is_finite() && fits {
        return Ok(value);
    }
    within(
        if of == "rod" { "rod" } else { "coils" },
        format!("{of}: {field} = {value} {requirement}"),
    )
}

impl StorageParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range or does not fit the others.
    pub fn build(&self, medium: &Medium) -> Result<Storage, UnitError> {
        let layers = Layers {
            count: self.layers,
            height_m: positive("height_m", self.height_m)?,
            volume_m3: positive("volume_m3", self.volume_m3)?,
            density_kg_m3: medium.density_kg_m3,
            heat_capacity_j_kg_k: medium.heat_capacity_j_kg_k,
        };
        if !(1..=MAX_LAYERS).contains(&self.layers) {
            return within("layers", format!("layers = {} must be 1 to {MAX_LAYERS}", self.layers));
        }
        let streams = self.ports.len() + self.coils.len();
        if streams > MAX_PORTS {
            return fields(format!(
                "{streams} ports and coils are more than the {MAX_PORTS} that a storage can have"
            ));
        }
        not_negative("entrainment_m", self.entrainment_m)?;
        let mut openings = Openings::default();
        for (port, (name, written)) in self.ports.iter().enumerate() {
            if self.coils.contains_key(name) {
                return Err(refused(name, "has the name of a coil", "rename one of them"));
            }
            openings.add(&layers, port, name, written, self.entrainment_m)?;
        }
        let coils = self.coils.iter().map(|(name, coil)| coil.build(name, &layers));
        let coils = coils.collect::<Result<Vec<_>, _>>()?;
        let rod = self.rod.as_ref().map(|rod| rod.build(&layers)).transpose()?;
        if rod.as_ref().is_some_and(|rod| !medium.is_liquid(rod.t_max_k)) {
            let t_max_k = rod.as_ref().map_or(f64::NAN, |rod| rod.t_max_k);
            return of_rod(format!(
                "rod: t_max_k = {t_max_k} is no temperature of {}",
                medium.name()
            ));
        }
        for (field, t_k) in [("soc_empty_k", self.soc_empty_k), ("soc_full_k", self.soc_full_k)] {
            liquid(medium, field, t_k)?;
        }
        if self.soc_full_k <= self.soc_empty_k {
            let requirement = "must be above soc_empty_k (soc_empty_degc)";
            return Err(UnitError::OutOfRange {
                field: "soc_full_k",
                value: self.soc_full_k,
                requirement,
            });
        }
        let tank = Tank {
            ua_w_k: self.losses_w_k(&layers)?,
            scheme: self.scheme,
            openings,
            ports: self.ports.len(),
            coils,
            rod,
            conductivity_w_m_k: not_negative("conductivity_w_m_k", self.conductivity_w_m_k)?,
            jet: self.jet(&layers)?,
            buoyancy: self.buoyancy,
            buoyancy_w_k: not_negative("buoyancy_w_k", self.buoyancy_w_k)?,
            layers,
        };
        let initial = self.initial(&tank.layers, medium)?;
        positive("ambient_k", self.ambient_k)?;
        Ok(Storage::new(self, tank, initial))
    }

    /// The jets, where they mix.
    fn jet(&self, layers: &Layers) -> Result<Option<Jet>, UnitError> {
        not_negative("jet_share", self.jet_share)?;
        let jet = Jet {
            share: self.jet_share,
            richardson: positive("jet_richardson", self.jet_richardson)?,
            diameter_m: positive("port_diameter_m", self.port_diameter_m)?,
            density_kg_m3: layers.density_kg_m3,
            heat_capacity_j_kg_k: layers.heat_capacity_j_kg_k,
        };
        if self.jet_share > 0.0 && self.scheme != Scheme::MixedLayers {
            let problem = "jet_share: needs scheme = \"mixed_layers\"".to_owned();
            return within("jet_share", problem);
        }
        Ok((self.jet_share > 0.0).then_some(jet))
    }

    /// Conductance to the surroundings, of envelope and bridges together, W/K.
    pub fn loss_w_k(&self) -> f64 {
        let (side, section) = side_and_section_m2(self.volume_m3, self.height_m);
        let of_envelope = self.u_w_m2_k.unwrap_or(U_W_M2_K) * (side + 2.0 * section);
        self.ua_w_k.unwrap_or(of_envelope) + self.bridges_w_k.iter().sum::<f64>()
    }

    /// Conductance of each layer to the surroundings, W/K.
    fn losses_w_k(&self, layers: &Layers) -> Result<Vec<f64>, UnitError> {
        let areas = layers.envelope_m2();
        let envelope: f64 = areas.iter().sum();
        let u_w_m2_k = match (self.u_w_m2_k, self.ua_w_k) {
            (Some(_), Some(_)) => {
                return fields("give either u_w_m2_k or ua_w_k, not both".to_owned());
            }
            (None, Some(ua_w_k)) => not_negative("ua_w_k", ua_w_k)? / envelope,
            (u_w_m2_k, None) => not_negative("u_w_m2_k", u_w_m2_k.unwrap_or(U_W_M2_K))?,
        };
        let mut losses: Vec<f64> = areas.iter().map(|area| area * u_w_m2_k).collect();
        let bridges = self.bridges_w_k.len();
        if bridges > 0 && bridges != layers.count {
            let problem = format!(
                "bridges_w_k has {bridges} values for {} layers: one per layer, from the bottom",
                layers.count
            );
            return within("bridges_w_k", problem);
        }
        for (loss, bridge) in losses.iter_mut().zip(&self.bridges_w_k) {
            *loss += not_negative("bridges_w_k", *bridge)?;
        }
        Ok(losses)
    }

    fn initial(&self, layers: &Layers, medium: &Medium) -> Result<Initial, UnitError> {
        let given = [
            self.initial_k.is_some(),
            self.initial_bottom_k.is_some() || self.initial_top_k.is_some(),
            !self.initial_layers_k.is_empty(),
            !self.initial_sensors_k.is_empty(),
        ];
        if given.iter().filter(|given| **given).count() > 1 {
            return fields(
                "give one of initial_k, initial_bottom_k with initial_top_k, initial_layers_k, initial_sensors_k"
                    .to_owned(),
            );
        }
        let of_layers = |field, values_k: &[f64]| -> Result<Initial, UnitError> {
            for t_k in values_k {
                liquid(medium, field, *t_k)?;
            }
            Ok(Initial::Layers(layers.of_sensors(values_k)))
        };
        match (self.initial_k, self.initial_bottom_k, self.initial_top_k) {
            (Some(t_k), ..) => of_layers("initial_k", &[t_k]),
            (None, Some(bottom_k), Some(top_k)) => {
                liquid(medium, "initial_bottom_k", bottom_k)?;
                liquid(medium, "initial_top_k", top_k)?;
                let last = (layers.count - 1).max(1) as f64;
                let at = |l: usize| bottom_k + (top_k - bottom_k) * l as f64 / last;
                Ok(Initial::Layers((0..layers.count).map(at).collect()))
            }
            (None, Some(_), None) | (None, None, Some(_)) => {
                fields("give both initial_bottom_k and initial_top_k".to_owned())
            }
            (None, None, None) if !self.initial_layers_k.is_empty() => {
                let values = self.initial_layers_k.len();
                if values != layers.count {
                    let problem = format!(
                        "initial_layers_k has {values} values for {} layers: initial_sensors_k takes any number",
                        layers.count
                    );
                    return within("initial_layers_k", problem);
                }
                of_layers("initial_layers_k", &self.initial_layers_k)
            }
            _ if !self.initial_sensors_k.is_empty() => {
                of_layers("initial_sensors_k", &self.initial_sensors_k)
            }
            _ => Ok(Initial::OfRun),
        }
    }
}

impl StorageCoil {
    fn build(&self, name: &str, layers: &Layers) -> Result<Coil, UnitError> {
        let of = format!("coils.{name}");
        let positive =
            |field: &str, value: f64| part(&of, field, value, value > 0.0, "must be positive");
        let whole =
            |field: &str, value: f64| part(&of, field, value, value >= 0.0, "must not be negative");
        let (inlet_m, outlet_m) =
            match (self.inlet_m, self.outlet_m, self.inlet_layer, self.outlet_layer) {
                (Some(inlet_m), Some(outlet_m), None, None) => {
                    for (field, m) in [("inlet_m", inlet_m), ("outlet_m", outlet_m)] {
                        let inside = (0.0..=layers.height_m).contains(&m);
                        part(
                            &of,
                            field,
                            m,
                            inside,
                            &format!("must be 0 to height_m = {}", layers.height_m),
                        )?;
                    }
                    if inlet_m == outlet_m {
                        return of_coils(format!("{of}: inlet_m and outlet_m are the same height"));
                    }
                    (inlet_m, outlet_m)
                }
                (None, None, Some(inlet), Some(outlet)) => {
                    for (field, layer) in [("inlet_layer", inlet), ("outlet_layer", outlet)] {
                        let inside = (1..=layers.count).contains(&layer);
                        let allowed = format!("must be 1 (bottom) to {}", layers.count);
                        part(&of, field, layer as f64, inside, &allowed)?;
                    }
                    let layer_m = layers.height_m / layers.count as f64;
                    let (low, high) = ((inlet.min(outlet) - 1) as f64, inlet.max(outlet) as f64);
                    let (low_m, high_m) = (low * layer_m, high * layer_m);
                    if inlet <= outlet { (low_m, high_m) } else { (high_m, low_m) }
                }
                _ => {
                    return of_coils(format!(
                        "{of}: give either inlet_m and outlet_m or inlet_layer and outlet_layer"
                    ));
                }
            };
        let volume_m3 = whole("volume_m3", self.volume_m3)?;
        Ok(Coil {
            share: layers.shares_of_stretch(inlet_m.min(outlet_m), inlet_m.max(outlet_m)),
            rises: inlet_m < outlet_m,
            ua_nominal_w_k: positive("area_m2", self.area_m2)?
                * positive("u_w_m2_k", self.u_w_m2_k)?,
            content_kg: volume_m3 * layers.density_kg_m3,
            m_flow_nominal_kg_s: positive("m_flow_nominal_kg_s", self.m_flow_nominal_kg_s)?,
            flow_exponent: whole("flow_exponent", self.flow_exponent)?,
            nominal_difference_k: positive("nominal_difference_k", self.nominal_difference_k)?,
            difference_exponent: whole("difference_exponent", self.difference_exponent)?,
        })
    }
}

impl StorageRod {
    fn build(&self, layers: &Layers) -> Result<Rod, UnitError> {
        let share = match (self.bottom_m, self.top_m, self.layer) {
            (Some(bottom_m), Some(top_m), None)
                if 0.0 <= bottom_m && bottom_m < top_m && top_m <= layers.height_m =>
            {
                layers.shares_of_stretch(bottom_m, top_m)
            }
            (Some(bottom_m), Some(top_m), None) => {
                return of_rod(format!(
                    "rod: bottom_m = {bottom_m} and top_m = {top_m} must rise within 0 to height_m = {}",
                    layers.height_m
                ));
            }
            (None, None, Some(layer)) if (1..=layers.count).contains(&layer) => {
                let mut share = vec![0.0; layers.count];
                share[layer - 1] = 1.0;
                share
            }
            (None, None, Some(layer)) => {
                return of_rod(format!(
                    "rod: layer = {layer} must be 1 (bottom) to {}",
                    layers.count
                ));
            }
            _ => return of_rod("rod: give either bottom_m and top_m or layer".to_owned()),
        };
        if self.steps == Some(0) {
            return of_rod("rod: steps = 0: leave it out for a continuous power".to_owned());
        }
        Ok(Rod {
            share,
            power_w: part("rod", "power_w", self.power_w, self.power_w > 0.0, "must be positive")?,
            steps: self.steps,
            t_max_k: self.t_max_k,
            hysteresis_k: part(
                "rod",
                "hysteresis_k",
                self.hysteresis_k,
                self.hysteresis_k >= 0.0,
                "must not be negative",
            )?,
        })
    }
}

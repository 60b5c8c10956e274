//! From a model file to a running simulation.
//!
//! [`model::Model`] is the typed model, [`build::build`] turns it into a [`simulation::Simulation`],
//! [`run::run`] steps it to its end into a recorder, [`steady::solve`] finds its steady state.
//!
//! ```
//! use anergy_simulation::model::Model;
//! let text = r#"
//! format = 1
//! [[site]]
//! id = "plant"
//! lines = ["supply", "return"]
//! [[edge]]
//! id = "pump"
//! kind = "pump"
//! from = "plant.return"
//! to = "plant.supply"
//! head_max_hpa = 402.21
//! free_flow_l_min = 55.33
//! speed = 1.0
//! [[edge]]
//! id = "load"
//! kind = "resistance"
//! from = "plant.supply"
//! to = "plant.return"
//! dp_nominal_hpa = 100.0
//! m_flow_nominal_kg_min = 10.0
//! [pressure_reference]
//! node = "plant.return"
//! "#;
//! let model = Model::from_toml(text, std::path::Path::new(".")).unwrap();
//! let steady = anergy_simulation::steady::solve(&model).unwrap();
//! // sqrt(H0/(a + K)) with K = 1 hPa/(l/min)^2: 18.8548 l/min
//! assert!((steady.edge("pump").unwrap().m_flow_kg_s * 60.0 - 18.8548).abs() < 1e-3);
//!
//! // Stepped, with the pump at half its speed: flow is in proportion.
//! use anergy_core::clock::Time;
//! let plan = anergy_simulation::build::build(&model).unwrap();
//! let mut simulation = anergy_simulation::simulation::Simulation::new(plan).unwrap();
//! let (speed, flow) =
//!     (simulation.signal("pump.speed").unwrap(), simulation.channel("pump.m_flow_kg_s").unwrap());
//! simulation.set(speed, 0.5).unwrap();
//! simulation.advance_to(Time::from_s(10.0).unwrap(), Time::from_s(1.0).unwrap()).unwrap();
//! assert!((simulation.get(flow) * 60.0 - 0.5 * 18.8548).abs() < 1e-2);
//! ```

pub mod automatic_step;
pub mod balance;
pub mod build;
pub mod channels;
pub mod diagnostic;
pub mod document;
pub mod drivers;
pub mod effect;
pub mod effects;
pub mod error;
pub mod fields;
mod gains;
pub mod grammar;
pub mod isolate;
mod kpi;
pub mod model;
pub mod model_file;
pub mod nested;
pub mod overlay;
pub mod plain;
pub mod plan;
pub mod run;
pub mod simulation;
pub mod stability;
pub mod state;
pub mod steady;
pub mod table;
mod temperatures;
pub mod weather;
mod wording;

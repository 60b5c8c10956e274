//! REGISTRY of the thermal units: adding one is one file, its `mod` line and its line below.

pub mod air_source_heat_pump;
pub mod balancing_exchanger;
pub mod battery;
pub mod booster_heat_pump;
pub mod brine_heat_pump;
pub mod building;
pub mod combustion;
pub mod cooling_load;
pub mod direct_exchanger;
pub mod domestic_hot_water;
pub mod electric_load;
pub mod grid_connection;
pub mod heat_load;
pub mod heat_source;
pub mod household;
pub mod ideal_house;
pub mod mixing_station;
pub mod prescribed_source;
pub mod pv;
pub mod solar_collector;
pub mod storage;

use crate::thermal_unit::{ThermalUnit, UnitError};
use anergy_core::medium::Medium;

anergy_core::registry! {
    /// Every thermal unit a model file can name.
    pub enum Equipment: dyn ThermalUnit, params EquipmentParams, context Medium, error UnitError {
        PrescribedSource("prescribed_source", prescribed_source::PrescribedSource, prescribed_source::PrescribedSourceParams),
        HeatLoad("heat_load", heat_load::HeatLoad, heat_load::HeatLoadParams),
        HeatSource("heat_source", heat_source::HeatSource, heat_source::HeatSourceParams),
        AirSourceHeatPump("air_source_heat_pump", air_source_heat_pump::AirSourceHeatPump, air_source_heat_pump::AirSourceHeatPumpParams),
        BoosterHeatPump("booster_heat_pump", booster_heat_pump::BoosterHeatPump, booster_heat_pump::BoosterHeatPumpParams),
        BoosterTransferStation("booster_transfer_station", booster_heat_pump::BoosterHeatPump, booster_heat_pump::BoosterTransferStationParams),
        BrineHeatPump("brine_heat_pump", brine_heat_pump::BrineHeatPump, brine_heat_pump::BrineHeatPumpParams),
        DirectExchanger("direct_exchanger", direct_exchanger::DirectExchanger, direct_exchanger::DirectExchangerParams),
        BalancingExchanger("balancing_exchanger", balancing_exchanger::BalancingExchanger, balancing_exchanger::BalancingExchangerParams),
        CondensingBoiler("condensing_boiler", combustion::Combustion, combustion::boiler::CondensingBoilerParams),
        Chp("chp", combustion::Combustion, combustion::chp::ChpParams),
        StirlingChp("stirling_chp", combustion::Combustion, combustion::stirling::StirlingChpParams),
        DomesticHotWater("domestic_hot_water", domestic_hot_water::DomesticHotWater, domestic_hot_water::DomesticHotWaterParams),
        SolarCollector("solar_collector", solar_collector::SolarCollector, solar_collector::SolarCollectorParams),
        MixingStation("mixing_station", mixing_station::MixingStation, mixing_station::MixingStationParams),
        Pv("pv", pv::Pv, pv::PvParams),
        Battery("battery", battery::Battery, battery::BatteryParams),
        Household("household", household::Household, household::HouseholdParams),
        ElectricLoad("electric_load", electric_load::ElectricLoad, electric_load::ElectricLoadParams),
        ElectricVehicle("electric_vehicle", electric_load::ElectricLoad, electric_load::ElectricVehicleParams),
        GridConnection("grid_connection", grid_connection::GridConnection, grid_connection::GridConnectionParams),
        IdealHouse("ideal_house", ideal_house::IdealHouse, ideal_house::IdealHouseParams),
        CoolingLoad("cooling_load", cooling_load::CoolingLoad, cooling_load::CoolingLoadParams),
        Building("building", building::Building, building::BuildingParams),
        Storage("storage", storage::Storage, storage::StorageParams),
    }
}

/// The kinds that no water passes.
pub const WITHOUT_PORTS: &[&str] =
    &["pv", "battery", "household", "electric_load", "electric_vehicle", "grid_connection"];

impl EquipmentParams {
    /// The parameters of a unit of this name where it draws random numbers: with its name in its seed, so that houses of
    /// one type do not all do the same at the same time.
    pub fn named(&self, name: &str) -> Option<Self> {
        let mut own = match self {
            Self::Household(_) | Self::ElectricVehicle(_) | Self::DomesticHotWater(_) => {
                self.clone()
            }
            _ => return None,
        };
        match &mut own {
            Self::Household(params) => params.seed = of_name(params.seed, name),
            Self::ElectricVehicle(params) => params.seed = of_name(params.seed, name),
            Self::DomesticHotWater(params) => params.seed = of_name(params.seed, name),
            _ => {}
        }
        Some(own)
    }
}

/// A seed with a name in it (FNV-1a).
fn of_name(seed: u64, name: &str) -> u64 {
    name.bytes().fold(seed ^ 0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// A temperature at which the water of a unit is liquid, K.
///
/// # Errors
/// Names the field and its value.
pub(crate) fn liquid(medium: &Medium, field: &'static str, t_k: f64) -> Result<f64, UnitError> {
    if medium.is_liquid(t_k) {
        return Ok(t_k);
    }
    let (min_degc, max_degc) = medium.range_degc();
    Err(UnitError::NotLiquid { field, value: t_k, what: medium.name(), min_degc, max_degc })
}

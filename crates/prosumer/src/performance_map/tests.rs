use super::carnot::CarnotShare;
use super::params::PerformanceMapParams;
use super::reference::{ReferenceCooling, ReferenceHeating};
use super::*;

fn heating() -> ReferenceHeating {
    ReferenceHeating {
        nominal_w: 5750.0,
        cop: 4.65,
        cop_max: f64::INFINITY,
        return_counts_twice: true,
    }
}

fn operation(modulation: f64, source_degc: f64, return_degc: f64) -> Operation {
    Operation {
        modulation,
        source_in_k: source_degc + 273.15,
        source_out_k: source_degc + 273.15,
        return_k: return_degc + 273.15,
        supply_k: return_degc + 278.15,
        ambient_k: source_degc + 273.15,
    }
}

/// Air and return temperature, degC, and heat in kW and COP over modulation 0.2, 0.4, ... 1.
type CheckRow = (f64, f64, [(f64, f64); 5]);

/// Of the reference unit.
const CHECK: [CheckRow; 8] = [
    (-7.0, 30.0, [(3.54, 6.93), (4.39, 7.42), (5.88, 5.64), (7.34, 4.82), (8.05, 4.80)]),
    (-7.0, 45.0, [(2.62, 3.19), (3.36, 3.46), (4.67, 3.02), (5.94, 2.77), (6.57, 2.76)]),
    (2.0, 30.0, [(4.61, 8.35), (5.71, 8.95), (7.66, 6.79), (9.56, 5.81), (10.48, 5.78)]),
    (2.0, 35.0, [(4.24, 6.43), (5.32, 6.98), (7.21, 5.60), (9.05, 4.92), (9.96, 4.91)]),
    (2.0, 45.0, [(3.53, 3.92), (4.54, 4.25), (6.31, 3.71), (8.02, 3.40), (8.87, 3.39)]),
    (2.0, 55.0, [(2.86, 2.43), (3.79, 2.59), (5.40, 2.40), (6.96, 2.27), (7.74, 2.24)]),
    (7.0, 35.0, [(4.85, 6.98), (6.08, 7.58), (8.25, 6.08), (10.35, 5.33), (11.38, 5.32)]),
    (12.0, 45.0, [(4.65, 4.59), (5.98, 4.98), (8.31, 4.35), (10.57, 3.98), (11.69, 3.97)]),
];

#[test]
fn reference_unit_meets_its_check_table() {
    for (air, water, row) in CHECK {
        for (i, (heat_kw, cop)) in row.into_iter().enumerate() {
            let m = 0.2 * (i + 1) as f64;
            let at = heating().at(&operation(m, air, water));
            // The table has three digits: 0.2 % at worst.
            assert!(
                (at.useful_w / 1000.0 / heat_kw - 1.0).abs() < 3e-3,
                "{air} {water} {m}: {at:?}"
            );
            assert!((at.ratio() / cop - 1.0).abs() < 3e-3, "{air} {water} {m}: {at:?}");
        }
    }
}

#[test]
fn each_factor_is_clamped_to_its_own_range() {
    // Colder water than the tables know changes nothing below 15 degC, and the COP stays of this world.
    let at = |m, air, water| heating().at(&operation(m, air, water));
    assert_eq!(at(0.5, 2.0, 15.0), at(0.5, 2.0, 5.0));
    assert_eq!(at(0.5, 20.0, 35.0), at(0.5, 35.0, 35.0));
    assert_eq!(at(0.1, 2.0, 35.0), at(0.2, 2.0, 35.0));
    // Below 30 degC only the air factors go on.
    assert!(at(0.5, 2.0, 15.0).ratio() > at(0.5, 2.0, 30.0).ratio());
    // Least electricity: a quarter of 5750/4.65 = 1236.6 W.
    let cold = at(0.2, 20.0, 15.0);
    assert!(cold.electric_w >= 0.25 * 5750.0 / 4.65, "{cold:?}");
    let capped = ReferenceHeating { cop_max: 5.0, ..heating() }.at(&operation(0.2, 20.0, 15.0));
    assert!((capped.ratio() - 5.0).abs() < 1e-12 && capped.useful_w == cold.useful_w);
}

#[test]
fn return_temperature_can_count_once() {
    // At 35 degC both are the same; elsewhere only the modulation factors see the water.
    let once = ReferenceHeating { return_counts_twice: false, ..heating() };
    let (a, b) = (once.at(&operation(0.7, -3.0, 35.0)), heating().at(&operation(0.7, -3.0, 35.0)));
    assert_eq!(a, b);
    // A2/W55, m = 1: t = 2; f_Qm = 1.6967 - 0.1468 + 0.05 + 0.0044 - 0.0168 = 1.5875; f_Qa = 1.0204
    let at = once.at(&operation(1.0, 2.0, 55.0));
    assert!((at.useful_w / (5750.0 * 1.5875 * 1.0204) - 1.0).abs() < 1e-9, "{at:?}");
}

#[test]
fn reference_cooling_at_its_nominal_point() {
    // Full load at A35 and return 23 degC: 1.5 * 6.01 = 9.015 kW, EER 5.92 * 0.9 = 5.328
    let unit = ReferenceCooling { nominal_w: 6010.0, eer: 5.92 };
    let at = unit.at(&operation(1.0, 35.0, 23.0));
    assert!((at.useful_w - 9015.0).abs() < 1e-9 && (at.ratio() - 5.328).abs() < 1e-9, "{at:?}");
    // m = 0.8, A30, return 18: 1.2 * 1.06 * 0.9 * 6010; EER 5.92 * (1.15 - 0.1875) * 1.11 * 0.875
    let at = unit.at(&operation(0.8, 30.0, 18.0));
    assert!((at.useful_w - 6010.0 * 1.2 * 1.06 * 0.9).abs() < 1e-9, "{at:?}");
    assert!((at.ratio() - 5.92 * 0.9625 * 1.11 * 0.875).abs() < 1e-9, "{at:?}");
    assert_eq!(unit.at(&operation(1.0, 80.0, 23.0)).ratio(), 1.5);
}

fn booster(cooling: bool) -> CarnotShare {
    CarnotShare {
        cooling,
        rated_w: if cooling { 14_000.0 } else { 19_000.0 },
        share: 0.5,
        part_load_gain: 0.12,
        approach_k: 3.0,
        lift_min_k: 10.0,
        slope_per_k: if cooling { 0.0 } else { 0.025 },
        ratio_max: f64::INFINITY,
    }
}

#[test]
fn booster_has_a_cop_of_five_point_one() {
    // Grid 20 to 15 degC, supply 40: T_cond = 316.15, T_evap = 285.15: 0.5 * 316.15/31 = 5.099
    let at = booster(false).at(&Operation {
        source_out_k: 288.15,
        supply_k: 313.15,
        ..operation(1.0, 20.0, 35.0)
    });
    assert!((at.ratio() - 5.1).abs() < 0.002, "{at:?}");
    // 19 kW (1 + 0.025 * 10) = 23.75 kW, below 1.3 * 19
    assert!((at.useful_w - 23_750.0).abs() < 1e-6);
    // Half speed: half the heat, COP 1.06 times.
    let half = booster(false).at(&Operation {
        source_out_k: 288.15,
        supply_k: 313.15,
        ..operation(0.5, 20.0, 35.0)
    });
    assert!((half.ratio() / at.ratio() - 1.06).abs() < 1e-12);
    // Cold of 15 degC into a grid of 20: T_evap = 285.15, T_cond = 296.15: 0.5 * 285.15/11 = 12.96
    let cold = booster(true).at(&Operation {
        source_out_k: 293.15,
        supply_k: 288.15,
        ..operation(1.0, 15.0, 20.0)
    });
    assert!((cold.ratio() - 0.5 * 285.15 / 11.0).abs() < 1e-12 && cold.useful_w == 14_000.0);
}

#[test]
fn outlets_settle_to_what_the_flows_make_of_them() {
    let map = PerformanceMap::Carnot(booster(false));
    for (source, useful) in [(0.2 * 4180.0, 0.5 * 4180.0), (0.05 * 4180.0, 0.1 * 4180.0)] {
        let sides = Sides {
            cooling: false,
            source_in_k: 288.15,
            source: Stream::Flow(source),
            return_k: 308.15,
            useful: Stream::Flow(useful),
            ambient_k: 280.0,
            heat_share: 0.95,
        };
        let (got, at) = map.settled(&sides, 0.6);
        let evaporator_w = got.useful_w - 0.95 * got.electric_w;
        assert!((at.supply_k - 308.15 - got.useful_w / useful).abs() < 1e-7, "{at:?}");
        assert!((288.15 - at.source_out_k - evaporator_w / source).abs() < 1e-7, "{at:?}");
        assert_eq!(map.at(&at), got);
    }
}

#[test]
fn table_is_linear_between_its_points() {
    let params = PerformanceMapParams {
        modulation: vec![0.3, 1.0],
        source_k: vec![266.15, 275.15],
        supply_k: vec![308.15, 328.15],
        heat_w: vec![
            vec![3000.0, 2800.0],
            vec![3600.0, 3400.0],
            vec![8000.0, 7000.0],
            vec![9000.0, 8500.0],
        ],
        electric_w: vec![
            vec![900.0, 1300.0],
            vec![900.0, 1300.0],
            vec![2800.0, 3200.0],
            vec![2400.0, 3000.0],
        ],
        ..PerformanceMapParams::default()
    };
    let map = params.build().unwrap();
    let at = |m, source_k, supply_k| {
        map.at(&Operation { source_in_k: source_k, supply_k, ..operation(m, 0.0, 0.0) })
    };
    assert_eq!(at(0.3, 266.15, 308.15).useful_w, 3000.0);
    assert_eq!(at(1.0, 275.15, 328.15).electric_w, 3000.0);
    // Middle of everything: mean of the eight points, 5662.5 W.
    assert!((at(0.65, 270.65, 318.15).useful_w - 5662.5).abs() < 1e-9);
    // Beyond the axes the ends hold.
    assert_eq!(at(1.0, 250.0, 308.15), at(1.0, 266.15, 308.15));
    assert_eq!(map.modulation_min(), 0.3);
}

#[test]
fn tables_that_cannot_be_are_refused_with_the_place() {
    let good = PerformanceMapParams {
        source_k: vec![266.15, 275.15],
        return_k: vec![308.15, 328.15],
        heat_w: vec![vec![3000.0, 2800.0], vec![3600.0, 3400.0]],
        cop: vec![vec![3.0, 2.0], vec![4.0, 3.0]],
        ..PerformanceMapParams::default()
    };
    assert!(good.build().is_ok());
    let said = |change: fn(&mut PerformanceMapParams)| {
        let mut map = good.clone();
        change(&mut map);
        map.build().unwrap_err().to_string()
    };
    assert_eq!(
        said(|map| map.source_k = vec![275.15, 266.15]),
        "source_k must rise: its number 2 is 266.15, the one before 275.15"
    );
    assert!(said(|map| map.cop[1][0] = 0.9).contains("row 2, number 1"));
    assert!(said(|map| map.heat_w[0][1] = f64::NAN).contains("heat_w row 1, number 2: NaN"));
    assert!(said(|map| map.heat_w[1].truncate(1)).contains("the map has a hole"));
    assert!(said(|map| map.heat_w.truncate(1)).contains("heat_w has 1 rows"));
    assert!(said(|map| map.supply_k = vec![300.0, 310.0]).contains("either return_k"));
    assert!(said(|map| map.cop.clear()).contains("either electric_w"));
    assert!(said(|map| map.hplib_group = Some(1)).contains("give either"));
}

/// A row of the database with round numbers: group 2 (brine), COP 0.1 T_in - 0.1 T_out + 8 - 0.02 T_amb.
fn brine() -> PerformanceMapParams {
    PerformanceMapParams {
        hplib_group: Some(2),
        hplib_heat_w: Some(8000.0),
        hplib_electric_w: Some(2000.0),
        hplib_power_coefficients: Some([-0.015, 0.015, 0.08, -0.02]),
        hplib_ratio_coefficients: Some([0.1, -0.1, 8.0, -0.02]),
        ..PerformanceMapParams::default()
    }
}

#[test]
fn fit_of_the_database() {
    let map = brine().build().unwrap();
    let at = |m: f64, brine: f64, supply: f64, air: f64| {
        map.at(&Operation {
            supply_k: supply + 273.15,
            ambient_k: air + 273.15,
            ..operation(m, brine, supply - 5.0)
        })
    };
    // Brine 0, supply 40, air -7: COP = 8 - 4 + 0.14 = 4.14; P = 2000 (0.6 + 0.08 + 0.14) = 1640 W
    let cold = at(1.0, 0.0, 40.0, -7.0);
    assert!((cold.ratio() - 4.14).abs() < 1e-9 && (cold.electric_w - 1640.0).abs() < 1e-9);
    // Air 30: P = 2000 (0.6 + 0.08 - 0.6) = 160, less than a quarter of 1640
    assert!((at(1.0, 0.0, 40.0, 30.0).electric_w - 410.0).abs() < 1e-9);
    assert!((at(0.5, 0.0, 40.0, -7.0).electric_w - 820.0).abs() < 1e-9);
    // Supply 95: COP = 8 - 9.5 + 0.14 < 1: the rod of 8 kW
    assert_eq!(at(1.0, 0.0, 95.0, -7.0), Performance { useful_w: 8000.0, electric_w: 8000.0 });
    // On/off: no modulation, no least electricity.
    let on_off = PerformanceMapParams { hplib_group: Some(5), ..brine() }.build().unwrap();
    assert_eq!(on_off.modulation_min(), 1.0);
    let refused = |map: PerformanceMapParams| map.build().unwrap_err().to_string();
    assert!(refused(PerformanceMapParams { hplib_group: Some(7), ..brine() }).contains("1 to 6"));
    assert!(refused(PerformanceMapParams { cooling: true, ..brine() }).contains("cannot cool"));
    assert!(refused(PerformanceMapParams { hplib_heat_w: None, ..brine() }).contains("missing"));
}

#[test]
fn air_units_of_the_database_know_one_air() {
    // Large coefficients of source and outdoor air cancel: the sums -0.05 and 0.1 remain.
    let map = PerformanceMapParams {
        hplib_group: Some(1),
        hplib_power_coefficients: Some([-71.55, 0.01, 0.1, 71.5]),
        hplib_ratio_coefficients: Some([80.5, -0.06, 6.0, -80.4]),
        ..brine()
    };
    let at = |map: &PerformanceMapParams, source: f64, supply: f64| {
        map.build()
            .unwrap()
            .at(&Operation { supply_k: supply + 273.15, ..operation(1.0, source, supply - 5.0) })
    };
    // A2/W35: P = 2000 (-0.1 + 0.35 + 0.1) = 700 W, COP = 0.2 - 2.1 + 6 = 4.1
    let heat = at(&map, 2.0, 35.0);
    assert!((heat.electric_w - 700.0).abs() < 1e-6 && (heat.ratio() - 4.1).abs() < 1e-9);
    // Cooling A20/W10 takes the electricity of A25: P = 2000 (1.25 - 0.13 - 1.0) = 240; EER = 6 - 1 = 5
    let cold = PerformanceMapParams {
        cooling: true,
        hplib_power_coefficients: Some([70.05, -0.013, -1.0, -70.0]),
        hplib_ratio_coefficients: Some([100.0, 0.25, 7.5, -100.25]),
        ..map
    };
    let cold = at(&cold, 20.0, 10.0);
    assert!(
        (cold.electric_w - 240.0).abs() < 1e-6 && (cold.ratio() - 5.0).abs() < 1e-9,
        "{cold:?}"
    );
}

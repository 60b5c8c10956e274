#![allow(clippy::unwrap_used)]

use super::*;
use std::path::PathBuf;

/// A folder of its own for a test, with one file.
fn folder(name: &str, text: &str) -> PathBuf {
    let dir = std::env::temp_dir().join(format!("anergy-map-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    std::fs::write(dir.join("map.csv"), text).unwrap();
    dir
}

fn read(
    name: &str,
    text: &str,
    map: PerformanceMapParams,
) -> Result<PerformanceMapParams, Problem> {
    let dir = folder(name, text);
    let mut map = PerformanceMapParams { file: Some("map.csv".into()), ..map };
    let outcome = from_file(&mut map, &dir).map(|()| map);
    std::fs::remove_dir_all(dir).unwrap();
    outcome
}

const TABLE: &str = "source_degc,supply_degc,heat_kw,cop\n\
    7,35,8,4\n-7,35,6,3\n# a remark\n7,55,7,3\n-7,55,5,2\n";

#[test]
fn rows_of_a_table_in_any_order() {
    let map = read("table", TABLE, PerformanceMapParams::default()).unwrap();
    assert_eq!(map.source_k, [266.15, 280.15]);
    assert_eq!(map.supply_k, [308.15, 328.15]);
    assert_eq!(map.heat_w, [[6000.0, 5000.0], [8000.0, 7000.0]]);
    assert_eq!(map.cop, [[3.0, 2.0], [4.0, 3.0]]);
    assert!(map.build().is_ok() && map.file.is_none());
}

#[test]
fn tables_with_holes_are_refused_with_the_point() {
    let said = |name: &str, text: String| {
        read(name, &text, PerformanceMapParams::default()).err().unwrap().message
    };
    assert_eq!(
        said("hole", TABLE.replace("7,55,7,3\n", "")),
        "map.csv: the map has a hole: no row for modulation 1, source 7.00 degC, water 55.00 degC"
    );
    assert_eq!(
        said("twice", TABLE.replace("7,55,7,3", "7,35,7,3")),
        "map.csv line 5: the point of line 2 again"
    );
    assert_eq!(
        said("nan", TABLE.replace("7,55,7,3", "7,55,7,-")),
        "map.csv line 5, column cop: \"-\" is not a number"
    );
    assert!(
        said("column", TABLE.replace("cop", "efficiency"))
            .contains("unknown column \"efficiency\"")
    );
    assert!(
        said("none", "source_degc,heat_kw,cop\n1,2,3\n".into())
            .contains("return_degc and supply_degc")
    );
}

/// A made-up database with the columns of hplib.
fn database() -> String {
    let names = |what: &str, unit: &str| {
        let [a, b, c, d] =
            [1, 2, 3, 4].map(|i| format!("p{i}_{what} [{}]", if i == 3 { "-" } else { unit }));
        [a, b, c, d].join(",")
    };
    format!(
        "Manufacturer,Model,Titel,Group,P_th_h_ref [W],P_th_c_ref [W],P_el_h_ref [W],P_el_c_ref [W],{},{},{},{}\n\
         Made Up, Breeze 8,Breeze 8 outdoor,1.0,6000,5000,2500,1600,-70,0.01,0.1,69.9,50,-0.06,6,-49.9,70.05,-0.01,-1,-70,9,0.2,10,-9.3\n\
         Made Up,Deep 10,Deep 10,5.0,9000,,2600,,-0.015,0.015,0.3,0.002,0.1,-0.1,8,-0.01,,,,,,,,\n\
         Generic,Generic,Generic_top,1.0,,,,,-70,0.01,0.1,69.9,50,-0.06,6,-49.9,70.05,-0.01,-1,-70,9,0.2,10,-9.3\n\
         Generic,Generic,Generic_average,5.0,,,,,-0.015,0.015,0.3,0.002,0.1,-0.1,8,-0.01,,,,,,,,\n",
        names("P_el_h", "1/°C"),
        names("COP", "-"),
        names("P_el_c", "1/°C"),
        names("EER", "-"),
    )
}

fn unit(model: &str) -> PerformanceMapParams {
    PerformanceMapParams { hplib_model: Some(model.into()), ..PerformanceMapParams::default() }
}

#[test]
fn units_of_the_database() {
    let text = database();
    let map = read("unit", &text, unit("Breeze 8")).unwrap();
    assert_eq!((map.hplib_group, map.hplib_electric_w), (Some(1), Some(2500.0)));
    assert_eq!(map.hplib_power_coefficients, Some([-70.0, 0.01, 0.1, 69.9]));
    assert_eq!(map.hplib_ratio_coefficients, Some([50.0, -0.06, 6.0, -49.9]));
    assert!(map.build().is_ok());
    let cold = PerformanceMapParams { cooling: true, ..unit("Breeze 8") };
    let cold = read("cold", &text, cold).unwrap();
    assert_eq!(cold.hplib_electric_w, Some(1600.0));
    assert_eq!(cold.hplib_ratio_coefficients, Some([9.0, 0.2, 10.0, -9.3]));
    // Twice the size.
    let large = PerformanceMapParams { hplib_heat_w: Some(18_000.0), ..unit("Deep 10") };
    assert_eq!(read("large", &text, large).unwrap().hplib_electric_w, Some(5200.0));
    // Generic: COP at brine 0, supply 52, air -7: 8 - 5.2 + 0.07 = 2.87; 10 kW: 3484.3 W
    let generic = PerformanceMapParams {
        hplib_group: Some(5),
        hplib_heat_w: Some(10_000.0),
        ..unit("Generic")
    };
    let map = read("generic", &text, generic).unwrap();
    assert!((map.hplib_electric_w.unwrap() - 10_000.0 / 2.87).abs() < 1e-9);
}

#[test]
fn units_that_the_database_does_not_have() {
    let text = database();
    let refused = |name: &str, map: PerformanceMapParams| read(name, &text, map).err().unwrap();
    let unknown = refused("unknown", unit("Breze 8"));
    assert_eq!(unknown.message, "map.csv has no unit \"Breze 8\"");
    assert!(unknown.hint.unwrap().contains("Breeze 8"));
    let several = refused("several", unit("Generic"));
    assert!(several.hint.unwrap().contains("1 \"Generic_top\", 5 \"Generic_average\""));
    let sizeless = PerformanceMapParams { hplib_group: Some(5), ..unit("Generic") };
    assert!(refused("size", sizeless).message.contains("hplib_heat_w is missing"));
    let cold = PerformanceMapParams { cooling: true, ..unit("Deep 10") };
    assert!(refused("no_cold", cold).message.contains("has no cooling"));
    assert!(refused("which", PerformanceMapParams::default()).message.contains("which unit"));
    let mut alone = unit("Deep 10");
    assert!(
        from_file(&mut alone, Path::new(".")).err().unwrap().message.contains("needs the database")
    );
}

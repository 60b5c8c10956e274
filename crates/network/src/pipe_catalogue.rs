//! Pipes that can be bought: dimensions by name.
//!
//! **Sources** steel: outer diameters `en10220`; walls and casings of pre-insulated pipes as delivered
//! (`logstor2018`, `isoplus`) within `en253`, whose casings of 315 mm and more and their walls are used;
//! twin pipes `isoplus` within `en15698`; polyethylene `en12201`. The lengths are nominal: walls may be
//! thicker. **Assumptions** roughness of steel 0.05 mm, of polyethylene 0.007 mm.

use crate::elements::pipe::{Laying, POLYETHYLENE_W_M_K};

/// A pipe of the catalogue.
#[derive(Debug, Clone, PartialEq)]
pub struct CataloguePipe {
    /// Its name, for example `pre-insulated DN25 series 2`.
    pub name: String,
    /// Where its dimensions come from: keys of the references.
    pub source: &'static str,
    /// Inner diameter, m.
    pub inner_diameter_m: f64,
    /// Outer diameter of the wall, m.
    pub outer_diameter_m: f64,
    /// Roughness, m.
    pub roughness_m: f64,
    /// Conductivity of a wall that is not of steel, W/(m K).
    pub wall_conductivity_w_m_k: Option<f64>,
    /// Diameter and thickness of the casing, m.
    pub casing_m: Option<(f64, f64)>,
    /// Distance of the axes of twin pipes, m.
    pub spacing_m: Option<f64>,
    /// How it lies unless told otherwise.
    pub laying: Option<Laying>,
}

/// DN, outer diameter, wall and the casings of series 1 to 3, mm.
const STEEL_MM: &[(u16, f64, f64, [f64; 3])] = &[
    (20, 26.9, 2.6, [90.0, 110.0, 125.0]),
    (25, 33.7, 2.6, [90.0, 110.0, 125.0]),
    (32, 42.4, 2.6, [110.0, 125.0, 140.0]),
    (40, 48.3, 2.6, [110.0, 125.0, 140.0]),
    (50, 60.3, 2.9, [125.0, 140.0, 160.0]),
    (65, 76.1, 2.9, [140.0, 160.0, 180.0]),
    (80, 88.9, 3.2, [160.0, 180.0, 200.0]),
    (100, 114.3, 3.6, [200.0, 225.0, 250.0]),
    (125, 139.7, 3.6, [225.0, 250.0, 280.0]),
    (150, 168.3, 4.0, [250.0, 280.0, 315.0]),
    (200, 219.1, 4.5, [315.0, 355.0, 400.0]),
    (250, 273.0, 5.0, [400.0, 450.0, 500.0]),
    (300, 323.9, 5.6, [450.0, 500.0, 560.0]),
];

/// DN, outer diameter, wall, the casings of series 1 and 2 and the gap between the pipes, mm.
const TWIN_MM: &[(u16, f64, f64, [f64; 2], f64)] = &[
    (20, 26.9, 2.6, [125.0, 140.0], 19.0),
    (25, 33.7, 3.2, [140.0, 160.0], 19.0),
    (32, 42.4, 3.2, [160.0, 180.0], 19.0),
    (40, 48.3, 3.2, [160.0, 180.0], 19.0),
    (50, 60.3, 3.2, [200.0, 225.0], 20.0),
    (65, 76.1, 3.2, [225.0, 250.0], 20.0),
    (80, 88.9, 3.2, [250.0, 280.0], 25.0),
    (100, 114.3, 3.6, [315.0, 355.0], 25.0),
    (125, 139.7, 3.6, [400.0, 450.0], 30.0),
    (150, 168.3, 4.0, [450.0, 500.0], 40.0),
    (200, 219.1, 4.5, [560.0, 630.0], 45.0),
];

/// Largest casing with a wall of this thickness, mm.
const CASING_WALL_MM: &[(f64, f64)] = &[
    (180.0, 3.0),
    (200.0, 3.2),
    (225.0, 3.4),
    (250.0, 3.6),
    (280.0, 3.9),
    (315.0, 4.1),
    (355.0, 4.5),
    (400.0, 4.8),
    (450.0, 5.2),
    (500.0, 5.6),
    (560.0, 6.0),
    (630.0, 6.6),
];

/// Outer diameter and wall of SDR 11 and SDR 17, mm; walls of less than 2 mm are not made.
const POLYETHYLENE_MM: &[(u16, f64, Option<f64>)] = &[
    (20, 2.0, None),
    (25, 2.3, None),
    (32, 3.0, Some(2.0)),
    (40, 3.7, Some(2.4)),
    (50, 4.6, Some(3.0)),
    (63, 5.8, Some(3.8)),
    (75, 6.8, Some(4.5)),
    (90, 8.2, Some(5.4)),
    (110, 10.0, Some(6.6)),
    (125, 11.4, Some(7.4)),
    (140, 12.7, Some(8.3)),
    (160, 14.6, Some(9.5)),
    (180, 16.4, Some(10.7)),
    (200, 18.2, Some(11.9)),
    (225, 20.5, Some(13.4)),
    (250, 22.7, Some(14.8)),
    (280, 25.4, Some(16.6)),
    (315, 28.6, Some(18.7)),
    (355, 32.2, Some(21.1)),
    (400, 36.3, Some(23.7)),
];

const STEEL_ROUGHNESS_M: f64 = 5e-5;
const POLYETHYLENE_ROUGHNESS_M: f64 = 7e-6;

/// The catalogue, in the order of a list to read.
pub fn all() -> Vec<CataloguePipe> {
    let mut pipes = Vec::new();
    for (dn, outer_mm, wall_mm, _) in STEEL_MM {
        pipes.push(CataloguePipe {
            source: "en10220, logstor2018",
            laying: None,
            ..steel(format!("steel DN{dn}"), *outer_mm, *wall_mm)
        });
    }
    for (dn, outer_mm, wall_mm, casings_mm) in STEEL_MM {
        for (series, casing_mm) in (1..).zip(casings_mm) {
            pipes.push(CataloguePipe {
                source: "en253, logstor2018",
                casing_m: Some(casing(*casing_mm)),
                ..steel(format!("pre-insulated DN{dn} series {series}"), *outer_mm, *wall_mm)
            });
        }
    }
    for (dn, outer_mm, wall_mm, casings_mm, gap_mm) in TWIN_MM {
        for (series, casing_mm) in (1..).zip(casings_mm) {
            pipes.push(CataloguePipe {
                source: "en15698, isoplus",
                casing_m: Some(casing(*casing_mm)),
                spacing_m: Some((outer_mm + gap_mm) / 1000.0),
                laying: Some(Laying::Twin),
                ..steel(format!("twin DN{dn} series {series}"), *outer_mm, *wall_mm)
            });
        }
    }
    for (sdr, pick) in [(11, 0), (17, 1)] {
        for (outer_mm, wall_11_mm, wall_17_mm) in POLYETHYLENE_MM {
            let wall_mm = if pick == 0 { Some(*wall_11_mm) } else { *wall_17_mm };
            let Some(wall_mm) = wall_mm else { continue };
            let outer_mm = f64::from(*outer_mm);
            pipes.push(CataloguePipe {
                source: "en12201",
                roughness_m: POLYETHYLENE_ROUGHNESS_M,
                wall_conductivity_w_m_k: Some(POLYETHYLENE_W_M_K),
                ..steel(format!("PE100 SDR{sdr} {outer_mm}"), outer_mm, wall_mm)
            });
        }
    }
    pipes
}

/// The pipe of a name, however its letters are written.
pub fn find(name: &str) -> Option<CataloguePipe> {
    all().into_iter().find(|pipe| pipe.name.eq_ignore_ascii_case(name))
}

fn steel(name: String, outer_mm: f64, wall_mm: f64) -> CataloguePipe {
    CataloguePipe {
        name,
        source: "",
        inner_diameter_m: (outer_mm - 2.0 * wall_mm) / 1000.0,
        outer_diameter_m: outer_mm / 1000.0,
        roughness_m: STEEL_ROUGHNESS_M,
        wall_conductivity_w_m_k: None,
        casing_m: None,
        spacing_m: None,
        laying: Some(Laying::Buried),
    }
}

fn casing(diameter_mm: f64) -> (f64, f64) {
    let wall = CASING_WALL_MM.iter().find(|(largest_mm, _)| diameter_mm <= *largest_mm);
    (diameter_mm / 1000.0, wall.map_or(0.0, |(_, wall_mm)| wall_mm / 1000.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::pipe::PipeParams;
    use crate::ground::Ground;
    use anergy_core::medium::Medium;

    fn params(pipe: &CataloguePipe) -> PipeParams {
        PipeParams {
            inner_diameter_m: pipe.inner_diameter_m,
            roughness_m: pipe.roughness_m,
            outer_diameter_m: Some(pipe.outer_diameter_m),
            wall_conductivity_w_m_k: pipe.wall_conductivity_w_m_k.filter(|_| pipe.laying.is_some()),
            casing_diameter_m: pipe.casing_m.map(|(diameter_m, _)| diameter_m),
            casing_thickness_m: pipe.casing_m.map(|(_, thickness_m)| thickness_m),
            spacing_m: pipe.spacing_m,
            laying: pipe.laying,
            ..PipeParams::default()
        }
    }

    #[test]
    fn every_pipe_can_be_built_and_laid() {
        let all = all();
        for pipe in &all {
            let params = params(pipe);
            params
                .build(&Medium::default())
                .unwrap_or_else(|error| panic!("{}: {error}", pipe.name));
            if pipe.laying == Some(Laying::Twin) {
                params.pair(&params, &Ground::default()).unwrap();
            }
            assert!(pipe.casing_m.is_none_or(|(_, wall_m)| wall_m > 0.0), "{}", pipe.name);
            assert_eq!(find(&pipe.name.to_lowercase()).unwrap().name, pipe.name);
        }
        let mut names: Vec<&str> = all.iter().map(|pipe| pipe.name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), all.len());
        assert_eq!(find("pre-insulated DN21 series 2"), None);
    }

    #[test]
    fn better_series_lose_less() {
        let resistance = |name: &str| {
            let pipe = find(name).unwrap();
            params(&pipe).resistance(&Ground::default()).unwrap().unwrap().total_k_m_w()
        };
        for (dn, ..) in STEEL_MM {
            let of = |series: u8| resistance(&format!("pre-insulated DN{dn} series {series}"));
            assert!(of(1) < of(2) && of(2) < of(3), "DN{dn}");
        }
        // DN25 series 2: ln(104/33.7)/(2 pi 0.028) = 6.405 of 6.80 K m/W with soil at 1 m: 0.147 W/(m K)
        assert!((1.0 / resistance("pre-insulated DN25 series 2") - 0.147).abs() < 5e-4);
    }

    #[test]
    fn walls_of_polyethylene_follow_their_ratio() {
        // SDR = outer diameter over wall, the wall rounded.
        for (outer_mm, wall_11_mm, wall_17_mm) in POLYETHYLENE_MM {
            let outer_mm = f64::from(*outer_mm);
            for (wall_mm, sdr) in [(Some(*wall_11_mm), 11.0), (*wall_17_mm, 17.0)] {
                let Some(wall_mm) = wall_mm else { continue };
                let exact_mm = outer_mm / sdr;
                assert!((-0.08..=0.25).contains(&(wall_mm - exact_mm)), "{outer_mm} SDR {sdr}");
            }
        }
    }

    #[test]
    fn casings_of_the_steel_pipes_leave_room() {
        for (dn, outer_mm, _, casings_mm) in STEEL_MM {
            for casing_mm in casings_mm {
                let (_, wall_m) = casing(*casing_mm);
                let foam_mm = 0.5 * (casing_mm - outer_mm) - 1000.0 * wall_m;
                assert!((20.0..150.0).contains(&foam_mm), "DN{dn} in {casing_mm}: {foam_mm}");
            }
        }
    }
}

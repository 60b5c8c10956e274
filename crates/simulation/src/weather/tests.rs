use super::calendar::DAY_NS;
use super::irradiance::{Given, complete};
use super::*;
use anergy_core::solar::diffuse_share;
use std::sync::Arc;

const HOUR_NS: i64 = 3600 * NS_PER_S;
/// 2024-06-20 00:00 UTC.
const JUNE_NS: i64 = 1_718_841_600 * NS_PER_S;

fn munich() -> Location {
    Location { latitude_rad: 48.14_f64.to_radians(), longitude_rad: 11.58_f64.to_radians() }
}

/// Records of one time, with a global irradiance.
fn records(interval_ns: i64, t_outdoor_k: &[f64], global: &[f64]) -> Records {
    let mut records = Records {
        interval_ns,
        calendar: Calendar::Given { begin_ns: JUNE_NS },
        point_at: PointAt::End,
        location: Some(munich()),
        t_outdoor_k: t_outdoor_k.into(),
        relative_humidity: None,
        wind_m_s: None,
        irradiance: None,
    };
    let given = Given { global_w_m2: Some(global.to_vec()), ..Given::default() };
    let begins = (0..global.len()).map(|i| JUNE_NS + i as i64 * interval_ns);
    records.irradiance = Some(complete(&records, begins, given).unwrap());
    records
}

fn weather(records: Records) -> Weather {
    Weather { records: Arc::new(records), start_unix_ns: JUNE_NS, signals: [None; 8] }
}

fn day() -> Records {
    // 0.7 of what the hour has outside the atmosphere.
    let global: Vec<f64> = (0..24)
        .map(|hour| {
            let middle_s = JUNE_NS as f64 / 1e9 + 1800.0 + 3600.0 * f64::from(hour);
            953.0 * munich().path(middle_s).sine_s(-1800.0, 1800.0) / 3600.0
        })
        .collect();
    let t_k: Vec<f64> = (1..=24).map(|hour| 280.0 + f64::from(hour)).collect();
    records(HOUR_NS, &t_k, &global)
}

#[test]
fn whatever_the_steps_every_hour_has_its_mean() {
    let records = day();
    let irradiance = records.irradiance.clone().unwrap();
    let weather = weather(records);
    for step_ns in [NS_PER_S, 7 * NS_PER_S + 13, 60 * NS_PER_S, 900 * NS_PER_S, HOUR_NS] {
        let (mut near, mut now) = (None, 0);
        let (mut sums, mut hour) = ([0.0; 3], 0);
        while now < DAY_NS {
            // Steps that do not fit end at the hour.
            let end = (now + step_ns).min((now / HOUR_NS + 1) * HOUR_NS);
            let values = weather.values((Time(now), Time(end)), &mut near).unwrap();
            for (sum, value) in sums.iter_mut().zip(&values[GLOBAL..=BEAM]) {
                *sum += value * seconds(end - now) / 3600.0;
            }
            now = end;
            if now % HOUR_NS == 0 {
                for (sum, mean) in sums.iter().zip(irradiance.at(hour)) {
                    assert!((sum - mean).abs() < 1e-9 * mean.max(1.0), "{hour}: {sum} {mean}");
                }
                (sums, hour) = ([0.0; 3], hour + 1);
            }
        }
    }
}

#[test]
fn steps_across_hours_have_their_exact_means() {
    let records = day();
    let whole: f64 = records.irradiance.as_ref().unwrap().global_w_m2.iter().sum::<f64>() * 3600.0;
    let weather = weather(records);
    for step_ns in [7 * 60 * NS_PER_S + 1, 2 * HOUR_NS + 5, 7 * HOUR_NS, DAY_NS] {
        let (mut near, mut now, mut sum) = (None, 0, 0.0);
        while now < DAY_NS {
            let end = (now + step_ns).min(DAY_NS);
            let values = weather.values((Time(now), Time(end)), &mut near).unwrap();
            sum += values[GLOBAL] * seconds(end - now);
            now = end;
        }
        assert!((sum / whole - 1.0).abs() < 1e-12, "{step_ns}: {sum} {whole}");
    }
}

#[test]
fn temperatures_are_straight_lines_between_the_points() {
    let weather = weather(day());
    let at = |from_s: i64, to_s: i64| {
        let step = (Time(from_s * NS_PER_S), Time(to_s * NS_PER_S));
        weather.values(step, &mut None).unwrap()[0]
    };
    // The first record lies at 01:00 with 281 K, before it nothing is known.
    assert_eq!(at(0, 1800), 281.0);
    assert_eq!(at(3600, 3600), 281.0);
    assert_eq!(at(3600, 5400), 281.5);
    assert_eq!(at(0, 7200), 282.0);
    assert!((at(36_000, 36_900) - 290.25).abs() < 1e-12);
    // Points at the begin: the last one holds.
    let mut records = day();
    records.point_at = PointAt::Begin;
    let weather = super::Weather { records: Arc::new(records), ..weather };
    let at =
        |s: i64| weather.values((Time(s * NS_PER_S), Time(s * NS_PER_S)), &mut None).unwrap()[0];
    assert_eq!((at(0), at(1800), at(86_399)), (281.0, 281.5, 304.0));
}

#[test]
fn the_sun_is_up_where_it_shines_and_nothing_shines_at_night() {
    let weather = weather(day());
    let mut near = None;
    for minute in 0..1440_i64 {
        let step = (Time(minute * 60 * NS_PER_S), Time((minute + 1) * 60 * NS_PER_S));
        let values = weather.values(step, &mut near).unwrap();
        let middle_s = (JUNE_NS / NS_PER_S + minute * 60 + 30) as f64;
        let sun = munich().sun(middle_s);
        // A declination that is held for half an hour: 0.01 deg; a step that the sun leaves: half a minute.
        assert!((values[6] - sun.elevation_rad).abs() < 0.003, "{minute}");
        assert!((values[7] - sun.azimuth_rad).abs() < 0.005 || !(60..=1380).contains(&minute));
        if values[6] < -0.01 {
            assert!(values[GLOBAL] == 0.0 && values[BEAM] == 0.0, "{minute}: {values:?}");
        }
        // What falls down of the beam and the sky is all there is.
        let sum = values[4] + values[BEAM] * values[6].sin().max(0.0);
        if values[6] > 0.1 {
            assert!((sum - values[GLOBAL]).abs() < 0.2, "{minute}: {sum} {values:?}");
        }
    }
}

#[test]
fn an_hour_at_noon_runs_like_the_sine_of_the_elevation() {
    // By hand: mean 500 W/m2 from 11:00 to 12:00 UTC; sin h at its ends and its mean by Simpson's rule.
    let mut global = vec![0.0; 24];
    global[11] = 500.0;
    let weather = weather(records(HOUR_NS, &[280.0; 24], &global));
    let sine = |hour: f64| munich().sun(JUNE_NS as f64 / 1e9 + 3600.0 * hour).elevation_rad.sin();
    let mean = (sine(11.0) + 4.0 * sine(11.5) + sine(12.0)) / 6.0;
    for hour in [11.1, 11.5, 11.9] {
        let at = Time((hour * 3600e9) as i64);
        let value = weather.values((at, at), &mut None).unwrap()[GLOBAL];
        assert!((value - 500.0 * sine(hour) / mean).abs() < 0.02, "{hour}: {value}");
    }
}

#[test]
fn impossible_irradiance_is_spread_evenly() {
    // 20 W/m2 at night (a clock that is off): the energy stays.
    let mut global = vec![0.0; 24];
    global[0] = 20.0;
    let weather = weather(records(HOUR_NS, &[280.0; 24], &global));
    let step = (Time(600 * NS_PER_S), Time(700 * NS_PER_S));
    let values = weather.values(step, &mut None).unwrap();
    assert_eq!((values[GLOBAL], values[4], values[BEAM]), (20.0, 20.0, 0.0));
}

#[test]
fn what_is_not_given_follows_from_the_rest() {
    let noon = 12;
    let of = |given: Given| {
        let base = day();
        let begins = (0..24).map(|i| JUNE_NS + i as i64 * HOUR_NS);
        complete(&base, begins, given)
    };
    let only = |value: f64| {
        let mut values = vec![0.0; 24];
        values[noon] = value;
        Some(values)
    };
    let middle_s = JUNE_NS as f64 / 1e9 + 12.5 * 3600.0;
    let sine = munich().path(middle_s).sine_s(-1800.0, 1800.0) / 3600.0;
    // Global and diffuse: 600 = 200 + beam * sine.
    let found =
        of(Given { global_w_m2: only(600.0), diffuse_w_m2: only(200.0), ..Given::default() })
            .unwrap();
    assert!((found.beam_normal_w_m2[noon] - 400.0 / sine).abs() < 1e-9);
    // Diffuse and beam.
    let found =
        of(Given { diffuse_w_m2: only(200.0), beam_normal_w_m2: only(500.0), ..Given::default() })
            .unwrap();
    assert!((found.global_w_m2[noon] - (200.0 + 500.0 * sine)).abs() < 1e-9);
    // Global and beam.
    let found =
        of(Given { global_w_m2: only(700.0), beam_normal_w_m2: only(500.0), ..Given::default() })
            .unwrap();
    assert!((found.diffuse_w_m2[noon] - (700.0 - 500.0 * sine)).abs() < 1e-9);
    // Global alone: on 20 June it is 3.2 % less outside than in the mean.
    let found = of(Given { global_w_m2: only(700.0), ..Given::default() }).unwrap();
    let clearness = 700.0 / (1361.0 * 0.9677 * sine);
    assert!((found.diffuse_w_m2[noon] / 700.0 - diffuse_share(clearness)).abs() < 1e-3);
    assert!(of(Given { diffuse_w_m2: only(1.0), ..Given::default() }).is_err());
}

#[test]
fn beyond_the_records_there_is_nothing() {
    let weather = weather(day());
    let mut near = None;
    let hours = |from: i64, to: i64| (Time(from * HOUR_NS), Time(to * HOUR_NS));
    assert!(weather.values(hours(23, 24), &mut near).is_some());
    assert!(weather.values(hours(23, 25), &mut near).is_none());
    assert!(weather.values(hours(24, 25), &mut near).is_none());
    let records = &weather.records;
    assert_eq!(records.first_gap_ns(JUNE_NS, JUNE_NS + DAY_NS), None);
    assert_eq!(records.first_gap_ns(JUNE_NS, JUNE_NS + DAY_NS + 1), Some(JUNE_NS + DAY_NS));
    assert_eq!(records.first_gap_ns(JUNE_NS - HOUR_NS, JUNE_NS), Some(JUNE_NS - HOUR_NS));
}

use super::*;

fn munich(seed: u64) -> Synthetic {
    Synthetic {
        seed,
        mean_k: 282.65,
        amplitude_k: 10.0,
        coldest_day: 20.0,
        winter_day_amplitude_k: 4.0,
        summer_day_amplitude_k: 7.0,
        noise_difference_k: 3.5,
        noise_time_constant_s: 172_800.0,
        clearness_alpha: 1.5,
        clearness_beta: 1.0,
        wind_m_s: 2.5,
        location: Location {
            latitude_rad: 48.14_f64.to_radians(),
            longitude_rad: 11.58_f64.to_radians(),
        },
        ahead_ns: 3_600_000_000_000,
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

/// Amplitude of a cosine of a period, h, that is highest at an hour.
fn amplitude(t_k: &[f64], period: f64, highest: f64) -> f64 {
    let hours = t_k.iter().zip(1..);
    2.0 * mean(hours.map(|(t, hour)| t * (TAU * (f64::from(hour) - highest) / period).cos()))
}

#[test]
fn the_same_seed_is_the_same_year() {
    let (first, again) = (munich(7).records().unwrap(), munich(7).records().unwrap());
    assert!(first == again);
    assert!(first.t_outdoor_k != munich(8).records().unwrap().t_outdoor_k);
}

#[test]
fn mean_amplitudes_and_memory_of_many_years() {
    let years: Vec<Records> = (0..30).map(|seed| munich(seed).records().unwrap()).collect();
    let hours_of_year = (DAYS * HOURS) as f64;
    let of_years =
        |of: &dyn Fn(&[f64]) -> f64| mean(years.iter().map(|year| of(&year.t_outdoor_k)));
    // The mean of a year scatters by sigma sqrt(2 tau/year) = 3.5 sqrt(4/366) = 0.37 K, of 30 years by 0.067 K.
    let found_k = of_years(&|t_k| mean(t_k.iter().copied()));
    assert!((found_k - 282.65).abs() < 0.2, "{found_k}");
    // So does the amplitude, by sqrt(2) of it: 0.095 K.
    let highest = (20.0 + 183.0) * 24.0;
    let found_k = of_years(&|t_k| amplitude(t_k, hours_of_year, highest));
    assert!((found_k - 10.0).abs() < 0.28, "{found_k}");
    // The swing of the day: January 4 K, July 7 K (cosine between 4 and 7, 2 % inside over a month).
    for (first_day, expected_k) in [(5, 4.02), (188, 6.98)] {
        let days = first_day * 24..(first_day + 30) * 24;
        let found_k = of_years(&|t_k| amplitude(&t_k[days.clone()], 24.0, 15.0));
        assert!((found_k - expected_k).abs() < 0.15, "{first_day}: {found_k}");
    }
    // What remains of year and day: 3.5 K that are forgotten in two days: 1/e after 48 h, 1/e^2 after 96 h.
    let (mut variance, mut after_2_d, mut after_4_d) = (0.0, 0.0, 0.0);
    for seed in 0..30 {
        let noise = munich(seed).noise(&mut Pcg32::new(seed, STREAM), DAYS * HOURS);
        let lag = |hours: usize| {
            mean((0..noise.len()).map(|i| noise[i] * noise[(i + hours) % noise.len()])) / 30.0
        };
        variance += lag(0);
        after_2_d += lag(48);
        after_4_d += lag(96);
    }
    assert!((variance.sqrt() / 3.5 - 1.0).abs() < 0.03, "{}", variance.sqrt());
    assert!((after_2_d / variance - (-1.0_f64).exp()).abs() < 0.04, "{}", after_2_d / variance);
    assert!((after_4_d / variance - (-2.0_f64).exp()).abs() < 0.05, "{}", after_4_d / variance);
}

#[test]
fn the_year_repeats_without_a_jump() {
    let noise = munich(3).noise(&mut Pcg32::new(3, STREAM), DAYS * HOURS);
    // From one hour to the next: sigma sqrt(1 - r^2) = 0.71 K; a jump would have sqrt(2) 3.5 K.
    let steps = (0..noise.len()).map(|i| noise[(i + 1) % noise.len()] - noise[i]);
    let steps: Vec<f64> = steps.collect();
    assert!((mean(steps.iter().map(|step| step * step)).sqrt() - 0.71).abs() < 0.02);
    assert!(mean(steps.iter().copied()).abs() < 1e-12);
}

#[test]
fn sun_and_humidity_of_a_year() {
    let years: Vec<Records> = (0..10).map(|seed| munich(seed).records().unwrap()).collect();
    let irradiance = |year: &Records| year.irradiance.clone().unwrap();
    let kwh = |values: &[f64]| values.iter().sum::<f64>() / 1000.0;
    let global = mean(years.iter().map(|year| kwh(&irradiance(year).global_w_m2)));
    let diffuse = mean(years.iter().map(|year| kwh(&irradiance(year).diffuse_w_m2)));
    // Munich has some 1150 kWh/m2, half of it diffuse.
    assert!((1000.0..1250.0).contains(&global), "{global}");
    assert!((0.35..0.6).contains(&(diffuse / global)), "{}", diffuse / global);
    for year in &years {
        let irradiance = irradiance(year);
        for (hour, global) in irradiance.global_w_m2.iter().enumerate() {
            let [_, diffuse, beam] = irradiance.at(hour);
            assert!((0.0..1100.0).contains(global) && (0.0..=*global).contains(&diffuse));
            assert!((0.0..=1361.0).contains(&beam), "{hour}: {beam}");
        }
        let humidity = year.relative_humidity.as_ref().unwrap();
        assert!(humidity.iter().all(|humidity| (0.1..=1.0).contains(humidity)));
        let mean = mean(humidity.iter().copied());
        assert!((0.6..0.9).contains(&mean), "{mean}");
    }
    // Clearness of days, mean 1.5/2.5 = 0.6: what a June day has of the clear sky.
    let clear = mean((0..40_u64).map(|seed| {
        let year = munich(seed).records().unwrap();
        year.irradiance.unwrap().global_w_m2[24 * 172..24 * 173].iter().sum::<f64>()
    }));
    let path = munich(0).location.path(LEAP_YEAR_NS as f64 / 1e9 + 172.5 * 86_400.0);
    let minutes = (-720..720).map(|minute| path.position(60.0 * f64::from(minute)));
    let sky: f64 = minutes.map(|sun| clear_sky_w_m2(sun.elevation_rad.sin()) / 60.0).sum();
    // 40 days scatter by 0.262/sqrt(40) = 0.041.
    assert!((clear / sky - 0.6).abs() < 0.12, "{}", clear / sky);
}

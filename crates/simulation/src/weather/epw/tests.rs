use super::*;

/// A file with the hours of a year; what is done to a line, by its number from 1.
fn text(leap: bool, edit: impl Fn(usize, String) -> Option<String>) -> String {
    let mut text = String::from(
        "LOCATION,Somewhere,-,DEU,TMY,000000,48.25,11.55,1.0,520.0\nDESIGN CONDITIONS,0\n\
         TYPICAL/EXTREME PERIODS,0\nGROUND TEMPERATURES,0\nHOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0\n\
         COMMENTS 1,made for a test\nCOMMENTS 2,-\nDATA PERIODS,1,1,Data,Sunday, 1/ 1,12/31\n",
    );
    let mut line = 8;
    for day in 0..366 {
        if day == LEAP_DAY && !leap {
            continue;
        }
        let date = date_of(day);
        let (month, of_month) = (&date[..2], &date[3..]);
        for hour in 1..=24 {
            line += 1;
            // Months of a typical year come from different years.
            let year = 2000 + day / 40;
            let (t, sun) = (day as f64 / 10.0 - 5.0 + hour as f64 / 100.0, (hour * 10) as f64);
            let entry = format!(
                "{year},{month},{of_month},{hour},0,?9?9,{t},1.0,80,95000,0,0,300,{sun},{},{},0,0,0,0,180,{}.5,5,5",
                sun / 2.0,
                sun / 4.0,
                hour % 5
            );
            if let Some(entry) = edit(line, entry) {
                text += &entry;
                text.push('\n');
            }
        }
    }
    text
}

fn refused(text: &str) -> Problem {
    read("x.epw", text.as_bytes()).expect_err("is refused")
}

#[test]
fn years_of_365_and_366_days() {
    for (leap, count) in [(false, 8760), (true, 8784)] {
        let records = read("x.epw", text(leap, |_, line| Some(line)).as_bytes()).unwrap();
        assert_eq!(records.count(), count);
        let location = records.location.unwrap();
        assert!((location.latitude_rad.to_degrees() - 48.25).abs() < 1e-12);
        assert!((location.longitude_rad.to_degrees() - 11.55).abs() < 1e-12);
        // 2023-12-31 23:00 UTC is New Year there; hour 1 is the mean of the hour after, its point lies at its end.
        let new_year_ns = 1_704_063_600 * NS_PER_S;
        let number = records.number(new_year_ns);
        assert_eq!(records.begin_ns(number), new_year_ns);
        assert_eq!(records.record(number), Some(0));
        let [before, after] = records.points_around(number, 0);
        assert_eq!((before, after), (count - 1, 0));
        assert_eq!(records.irradiance.as_ref().unwrap().at(0), [10.0, 2.5, 5.0]);
        assert_eq!(records.t_outdoor_k[0], 273.15 - 5.0 + 0.01);
        assert_eq!(records.relative_humidity.as_ref().unwrap()[7], 0.8);
        assert_eq!(records.wind_m_s.as_ref().unwrap()[0], 1.5);
        // 29 February of 2024, 12:30 local.
        let leap_ns = 1_709_206_200 * NS_PER_S;
        let day = if leap { LEAP_DAY } else { LEAP_DAY - 1 };
        assert_eq!(records.record(records.number(leap_ns)), Some(24 * day + 12));
        assert_eq!(records.first_gap_ns(new_year_ns, new_year_ns + 3000 * DAY_NS), None);
    }
}

#[test]
fn what_is_wrong_is_said_with_line_and_column() {
    let with = |number: usize, from: &'static str, to: &'static str| {
        text(false, move |line, entry| {
            Some(if line == number { entry.replacen(from, to, 1) } else { entry })
        })
    };
    for (text, said) in [
        (
            text(false, |_, _| None).lines().take(3).map(|line| format!("{line}\n")).collect(),
            "line 3: the file ends in its header",
        ),
        ("temperature\n1\n2\n".to_owned(), "begins with LOCATION"),
        (text(false, |_, _| None), "no weather after the header"),
        (
            text(false, |line, entry| (line != 100).then_some(entry)),
            "line 100: 01-04 21:00 follows 01-04 19:00: 1 is missing",
        ),
        (with(100, ",20,0,?9", ",18,0,?9"), "line 100: 01-04 18:00 is not after 01-04 19:00"),
        (
            with(9, "-4.99", "99.9"),
            "line 9, column 7 (dry bulb temperature): 99.9 means that it is missing",
        ),
        (
            with(9, "-4.99", "NaN"),
            "line 9, column 7 (dry bulb temperature): \"NaN\" is not a finite number",
        ),
        (with(9, ",80,", ",999,"), "column 9 (relative humidity): 999 means that it is missing"),
        (with(9, "-4.99", "273.15"), "column 7 (dry bulb temperature): 273.15 means"),
        (with(9, ",80,", ",-3,"), "column 9 (relative humidity): -3 is outside 0 to 110"),
        (with(10, ",01,01,2,", ",13,01,2,"), "line 10, column 2 (month): 13 is outside 1 to 12"),
        (with(10, ",01,01,2,", ",02,30,2,"), "line 10, column 3 (day): month 2 has no day 30"),
        (with(10, ",01,01,2,", ",01,01,25,"), "line 10, column 4 (hour): 25 is outside 1 to 24"),
        (with(10, ",01,01,2,", ",01,01,2.5,"), "column 4 (hour): 2.5 is no whole number"),
        (
            with(8768, ",0,0,0,0,180,4.5,5,5", ",0"),
            "line 8768, column 22 (wind speed): the line has 17 columns",
        ),
    ] {
        let problem = refused(&text);
        assert!(problem.message.starts_with("x.epw line "), "{}", problem.message);
        assert!(problem.message.contains(said), "{said}:\n{}", problem.message);
    }
    let place = text(false, |_, line| Some(line)).replacen("48.25", "148.25", 1);
    assert!(
        refused(&place)
            .message
            .contains("line 1, column 7 (latitude): 148.25 is outside -90 to 90")
    );
}

#[test]
fn quarters_of_an_hour() {
    let header = text(false, |_, _| None).replacen("DATA PERIODS,1,1", "DATA PERIODS,1,4", 1);
    let row = |hour: u32, minute: u32| {
        format!("2001,7,1,{hour},{minute},-,20,1,80,9,0,0,0,100,0,100,0,0,0,0,0,2,0,0\n")
    };
    let rows: String =
        (1..=24).flat_map(|hour| [15, 30, 45, 60].map(|minute| row(hour, minute))).collect();
    let records = read("x.epw", format!("{header}{rows}").as_bytes()).unwrap();
    assert_eq!((records.count(), records.interval_ns()), (96, 900 * NS_PER_S));
    // A part of the year: 1 July 2024 from 00:00 to 24:00 in UTC+1.
    let begin_ns = 1_719_788_400 * NS_PER_S;
    assert_eq!(records.first_gap_ns(begin_ns, begin_ns + DAY_NS), None);
    assert_eq!(records.first_gap_ns(begin_ns, begin_ns + DAY_NS + 1), Some(begin_ns + DAY_NS));
    assert_eq!(records.first_gap_ns(begin_ns - 5, begin_ns), Some(begin_ns - 5));
    let wrong = refused(&format!("{header}{}", row(1, 20)));
    assert!(wrong.message.contains("20 is no end of one of 4 intervals"), "{}", wrong.message);
}

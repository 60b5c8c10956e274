use super::*;

/// A reservoir, a pump, two junctions, a tank, in US units.
const SMALL: &str = "\
[TITLE]
A small net
of the tests
[JUNCTIONS]
 J1  100  50  day
 J2  90   10
[RESERVOIRS]
 R   80
[TANKS]
 T   150  10  0  20  40  0
[PIPES]
 P1  J1 J2  1000 12  100  2.5  Open
 P2  J2 T   500  8   110  0    CV
[PUMPS]
 U   R J1  HEAD c  SPEED 0.9
[CURVES]
 c  500  100
[PATTERNS]
 day  1.0 2.0
 day  0.5
[TIMES]
 Duration 4:00
 Pattern Timestep 1:00
[COORDINATES]
 J1  1.5  -2
[QUALITY]
 J1  0.5
[END]
";

fn of(text: &str) -> Import {
    import(text.as_bytes(), EpanetOptions::default()).unwrap()
}

fn errors(text: &str) -> Vec<(Option<usize>, String)> {
    let errors = import(text.as_bytes(), EpanetOptions::default()).unwrap_err();
    errors.into_iter().map(|error| (error.line, error.message)).collect()
}

/// The lines of an entry of the model with this id.
fn entry<'a>(import: &'a Import, id: &str) -> Vec<&'a str> {
    let wanted = format!("id = \"{id}\"");
    let entry = import.model.split("\n\n").find(|entry| entry.lines().any(|l| l == wanted));
    entry.unwrap_or_else(|| panic!("no {id} in\n{}", import.model)).lines().collect()
}

#[track_caller]
fn has(import: &Import, id: &str, lines: &[&str]) {
    let entry = entry(import, id);
    for line in lines {
        assert!(entry.contains(line), "{line} is not in\n{}", entry.join("\n"));
    }
}

#[track_caller]
fn says(import: &Import, kind: NoteKind, line: Option<usize>, part: &str) {
    let found = import
        .notes
        .iter()
        .any(|note| note.kind == kind && note.line == line && note.text.contains(part));
    assert!(found, "no such note in {:#?}", import.notes);
}

#[test]
fn a_small_network() {
    let net = of(SMALL);
    assert!(net.model.contains("name = \"A small net\"\ndescription = \"of the tests\"\n"));
    assert!(net.model.contains("gravity = 9.81\n"));
    assert!(net.model.contains("until = \"14400s\"\n"));
    // 50 gpm are 3.1545 kg/s, 100 ft are 30.48 m.
    has(&net, "J1", &["kind = \"source\"", "elevation_m = 30.48", "x_m = 1.5", "y_m = -2.0"]);
    assert!(entry(&net, "J1").iter().any(|line| line.starts_with("m_flow_kg_s = -3.1545")));
    has(&net, "R", &["kind = \"pressure_boundary\"", "pressure_pa = 0.0", "elevation_m = 24.384"]);
    has(&net, "T", &["elevation_m = 48.768"]);
    has(&net, "P1", &["friction = \"hazen_williams\"", "hazen_williams_c = 100.0", "to = \"J2\""]);
    // 2.5 * 0.02517 * pi^2 * 9.81/(8 * 0.3048)
    assert!(entry(&net, "P1").iter().any(|line| line.starts_with("zeta = 2.498")));
    has(&net, "P2", &["from = \"J2\"", "to = \"P2.check\""]);
    has(&net, "P2.check_valve", &["from = \"P2.check\"", "to = \"T\""]);
    has(&net, "U", &["speed = 0.9", "initial_speed = 0.9", "from = \"R\"", "to = \"U.check\""]);
    // 1.33334 * 100 ft * 1000 * 9.81 Pa
    assert!(entry(&net, "U").iter().any(|line| line.starts_with("head_max_pa = 398680.")));
    // J2 has no pattern, and there is none named "1".
    assert_eq!(net.schedules, 1);
    let schedule = net.model.split("[[schedule]]").nth(1).unwrap();
    assert!(schedule.contains("signal = \"J1.m_flow_kg_s\""));
    let times: Vec<&str> =
        schedule.split('[').skip(2).map(|p| p.split(',').next().unwrap()).collect();
    assert_eq!(times, ["0.0", "3600.0", "7200.0", "10800.0"]);
    says(&net, NoteKind::Changed, Some(13), "the check valve is an edge of its own");
    says(&net, NoteKind::NotTranslated, Some(27), "[QUALITY], 1 line: water quality");
    assert!(net.model.starts_with("# Imported from an EPANET input file"));
    assert_eq!((net.nodes, net.edges), (6, 5));
}

#[test]
fn at_the_start_only() {
    let net = {
        let wanted = EpanetOptions { steady: true, ..EpanetOptions::default() };
        import(SMALL.as_bytes(), wanted).unwrap()
    };
    assert_eq!(net.schedules, 0);
    says(&net, NoteKind::NotTranslated, None, "patterns after t = 0");
}

#[test]
fn laws_and_units() {
    let head = "[JUNCTIONS]\nJ 1\n[RESERVOIRS]\nR 5\n[PIPES]\nP R J 10 100 0.2\n[OPTIONS]\n";
    let net = of(&format!("{head}Units LPS\nHeadloss D-W\nSpecific Gravity 0.9\n"));
    has(
        &net,
        "P",
        &["inner_diameter_m = 0.1", "roughness_m = 0.0002", "friction = \"swamee_jain\""],
    );
    has(&net, "P", &["transition = \"dunlop\"", "length_m = 10.0"]);
    assert!(net.model.contains("gravity = 9.81456"));
    assert!(net.model.contains("density_kg_m3 = 900.0"));
    let net = of(&format!("{head}Units CMH\nHeadloss C-M\n"));
    has(&net, "P", &["friction = \"chezy_manning\"", "manning_n = 0.2"]);
}

#[test]
fn demands_of_several_kinds_replace_the_one_of_the_junction() {
    let net = of("[JUNCTIONS]\nJ 0 100\n[RESERVOIRS]\nR 5\n[PIPES]\nP R J 10 100 100\n\
                  [DEMANDS]\nJ 10 a\nJ 5\nJ 1 b\n[PATTERNS]\na 2\nb 0\n1 3\n\
                  [OPTIONS]\nUnits LPS\nDemand Multiplier 2\n");
    // 2 * (10 * 2 + 5 * 3 + 1 * 0) l/s
    has(&net, "J", &["m_flow_kg_s = -70.0"]);
}

/// A reservoir, a valve line and a junction; `{}` is the rest of the line and of the file.
fn with_valve(line: &str, rest: &str) -> Import {
    of(&format!(
        "[JUNCTIONS]\nA 0\nB 10 1\n[RESERVOIRS]\nR 50\n[PIPES]\nP R A 10 100 100\nQ R B 1000 50 100\n\
         [VALVES]\nV A B 100 {line}\n[OPTIONS]\nUnits LPS\n{rest}"
    ))
}

#[test]
fn valves() {
    let net = with_valve("PRV 20", "");
    has(&net, "V", &["kind = \"valve\"", "characteristic = \"linear\"", "leakage = 0.0"]);
    let control = ["quantity = \"B.p_pa\"", "value = 196200.0", "free = \"V.opening\""];
    has(&net, "V.control", &control);
    has(&with_valve("PSV 20", ""), "V.control", &["quantity = \"A.p_pa\""]);
    let limited = with_valve("FCV 3", "");
    has(&limited, "V", &["kind = \"flow_limiter\"", "m_flow_set_kg_s = 3.0"]);
    // 4 * 0.99942 * 1000/2 Pa at 1 m/s, 7.854 kg/s.
    let throttle = entry(&with_valve("TCV 4", ""), "V").join("\n");
    assert!(throttle.contains("dp_nominal_pa = 1998.") && throttle.contains("7.853"), "{throttle}");
    has(&with_valve("PBV 2", ""), "V", &["kind = \"pressure_source\"", "head_pa = -19620.0"]);
    // A curve of one point begins at zero: 1 l/s at 1 m is 9.81 kPa.
    let general = with_valve("GPV c", "[CURVES]\nc 1 1\n");
    let curve = entry(&general, "V").join("\n");
    assert!(curve.contains("kind = \"resistance\"") && curve.contains("0.001]"), "{curve}");
    assert!(curve.contains("curve_dp_pa = [0.0, ") && curve.contains(", 9810.0]"), "{curve}");
    says(&general, NoteKind::Changed, Some(10), "begins at no flow and no loss");
    let falls = with_valve("GPV c", "[CURVES]\nc 1 2\nc 2 1\n");
    says(&falls, NoteKind::Problem, Some(10), "does not rise with the flow");
    // Half open without a curve: four times the loss coefficient of the open valve; with one, 25 % of the
    // flow coefficient: sixteen times.
    let dp_pa = |net: &Import| {
        let line =
            entry(net, "V").into_iter().find(|line| line.starts_with("dp_nominal_pa")).unwrap();
        line.rsplit_once(' ').unwrap().1.parse::<f64>().unwrap()
    };
    let (half, open) = (with_valve("PCV 50 2", ""), with_valve("PCV 100 2", ""));
    assert!((dp_pa(&half) / dp_pa(&open) - 4.0).abs() < 1e-12);
    let curved = with_valve("PCV 50 2 c", "[CURVES]\nc 40 20\nc 60 30\n");
    assert!((dp_pa(&curved) / dp_pa(&open) - 16.0).abs() < 1e-12);
    // Fixed open or closed valves do not control.
    has(&with_valve("PRV 20", "[STATUS]\nV OPEN\n"), "V", &["kind = \"resistance\""]);
    assert!(!with_valve("PRV 20", "[STATUS]\nV CLOSED\n").model.contains("id = \"V\""));
    let other = with_valve("PRV 20", "[STATUS]\nV 10\n");
    has(&other, "V.control", &["value = 98100.0"]);
}

#[test]
fn self_acting_valves() {
    let of = |line: &str| {
        let text = format!(
            "[JUNCTIONS]\nA 0\nB 10 1\n[RESERVOIRS]\nR 50\n[PIPES]\nP R A 10 100 100\nQ R B 1000 50 100\n\
             [VALVES]\nV A B 100 {line}\n[OPTIONS]\nUnits LPS\n"
        );
        let wanted = EpanetOptions { self_acting: true, ..EpanetOptions::default() };
        import(text.as_bytes(), wanted).unwrap()
    };
    // 20 m are 196.2 kPa, the middle of a band of 100 Pa.
    let net = of("PRV 20");
    let lines = ["kind = \"pressure_reducing_valve\"", "pressure_set_pa = 196150.0"];
    has(&net, "V", &lines);
    has(&net, "V", &["to = \"V.check\"", "sensed_node = \"B\"", "band_pressure_pa = 100.0"]);
    assert!(!net.model.contains("[[prescribed]]"));
    has(&of("PSV 20"), "V", &["kind = \"pressure_sustaining_valve\"", "sensed_node = \"A\""]);
}

#[test]
fn what_is_closed_is_left_out_and_said() {
    let net = of(
        "[JUNCTIONS]\nA 0 1\nB 0 1\nC 0\n[RESERVOIRS]\nR 5\nS 5\n[PIPES]\nP R A 10 100 100\n\
                  Q A B 10 100 100 0 Closed\nO A C 1 1 1\nN S A 1 1 1\n[STATUS]\nO Closed\nN Closed\n",
    );
    assert_eq!((net.nodes, net.edges), (2, 1));
    says(&net, NoteKind::Problem, Some(3), "junctions \"B\" take or give water");
    says(&net, NoteKind::NotTranslated, Some(4), "\"C\" are cut off");
    says(&net, NoteKind::NotTranslated, Some(7), "nothing open leads to \"S\"");
    says(&net, NoteKind::Changed, Some(10), "pipe \"Q\": left out");
}

#[test]
fn controls_that_act_at_the_start() {
    let controls = "[CONTROLS]\nLINK P1 CLOSED AT TIME 0\nLINK U 0.5 IF NODE T BELOW 12\n\
                    LINK U 1 IF NODE T ABOVE 15\nLINK P1 OPEN IF NODE J1 BELOW 3\n\
                    LINK P1 OPEN AT CLOCKTIME 5 PM\n";
    let net = of(&SMALL.replace("[END]\n", controls));
    assert!(!net.model.contains("id = \"P1\""));
    has(&net, "U", &["speed = 0.5"]);
    let taken = net.notes.iter().filter(|note| note.text.contains("is taken then")).count();
    let not_yet = net.notes.iter().filter(|note| note.text.contains("does not act at")).count();
    assert_eq!((taken, not_yet), (2, 2));
    says(&net, NoteKind::NotTranslated, Some(32), "it acts on the pressure of a junction");
}

#[test]
fn pumps_of_constant_power_and_with_patterns() {
    let net = of(&SMALL.replace("HEAD c  SPEED 0.9", "POWER 10"));
    let pump = entry(&net, "U").join("\n");
    assert!(pump.contains("curve_v_flow_m3_s = [0.0, ") && pump.contains("speed = 1.0"));
    says(&net, NoteKind::Changed, Some(15), "constant power");
    let net = of(&SMALL.replace("SPEED 0.9", "PATTERN day"));
    has(&net, "U", &["speed = 1.0", "speed_max = 2.0"]);
    assert!(net.model.contains("signal = \"U.speed\"\npoints = [[0.0, 1.0], [3600.0, 2.0], "));
}

#[test]
fn emitters_are_orifices() {
    let net =
        of("[JUNCTIONS]\nJ 1\n[RESERVOIRS]\nR 5\n[PIPES]\nP R J 10 100 100\n[EMITTERS]\nJ 2\n\
                  [OPTIONS]\nUnits LPS\n");
    // 2 l/s at 1 m.
    has(&net, "J.emitter", &["dp_nominal_pa = 9810.0", "m_flow_nominal_kg_s = 2.0"]);
    has(&net, "J.outside", &["elevation_m = 1.0", "pressure_pa = 0.0"]);
    assert!(!net.model.contains("exponent"));
    let net =
        of("[JUNCTIONS]\nJ 1\n[RESERVOIRS]\nR 5\n[PIPES]\nP R J 10 100 100\n[EMITTERS]\nJ 2\n\
                  [OPTIONS]\nUnits LPS\nEmitter Exponent 0.8\n");
    has(&net, "J.emitter", &["m_flow_nominal_kg_s = 2.0", "exponent = 1.25"]);
}

#[test]
fn full_and_empty_tanks_close_their_pipes() {
    let net = of(&SMALL.replace("150  10  0", "150  20  0"));
    // Out of the full tank only, and the check valve of the pipe towards it.
    has(&net, "P2.full_valve", &["from = \"P2.check\"", "to = \"P2.full\""]);
    says(&net, NoteKind::Changed, Some(13), "which is full");
    let net = of(&SMALL.replace("150  10  0", "150  0  0"));
    has(&net, "P2.empty_valve", &["from = \"P2.empty\"", "to = \"P2.check\""]);
}

#[test]
fn wrong_files_are_told_with_their_lines() {
    assert_eq!(errors(""), [(None, "the file has no nodes: is it an EPANET input file?".into())]);
    assert_eq!(
        errors("[JUNCTIONS]\nJ x\nJ2 1 2 p\nJ2\nJ2\n[PIPES]\nP J2 Q 1 1 1\nP J2 J2 1 1 1\n"),
        [
            (Some(2), "elevation: \"x\" is not a number".into()),
            (Some(3), "there is no pattern \"p\"".into()),
            (Some(5), "node \"J2\" exists twice".into()),
            (Some(7), "there is no node \"Q\"".into()),
            (Some(8), "link \"P\" begins and ends at one node".into()),
        ]
    );
    let pipe = |rest: &str| {
        errors(&format!("[JUNCTIONS]\nA 0\nB 0\n[PIPES]\nP A B {rest}\n"))[0].1.clone()
    };
    assert_eq!(pipe("0 1 1"), "length = 0 must be positive");
    assert_eq!(pipe("1 1"), "roughness is missing");
    assert_eq!(pipe("1 1 nan"), "roughness: \"nan\" is not a number");
    assert_eq!(pipe("1 1 1 half"), "minor loss: \"half\" is not a number");
    assert_eq!(
        errors(
            "[JUNCTIONS]\nA 0\n[OPTIONS]\nUnits XYZ\nHeadloss Q\nViscosity -1\n[TIMES]\nDuration\n"
        )
        .len(),
        4
    );
}

/// Whatever is cut away or put in, there is an answer.
#[test]
fn damaged_files_never_panic() {
    let text = format!(
        "{SMALL}[VALVES]\nV J1 J2 1 PRV 3\n[CONTROLS]\nLINK V CLOSED AT TIME 1\n[STATUS]\nV 1\n[EMITTERS]\nJ1 1\n[DEMANDS]\nJ1 1\n"
    );
    let text = text.replace("[END]\n", "");
    for end in 0..text.len() {
        let _ = import(&text.as_bytes()[..end], EpanetOptions::default());
    }
    let lines: Vec<&str> = text.lines().collect();
    for i in 0..lines.len() {
        let words: Vec<&str> = lines[i].split_whitespace().collect();
        for k in 0..words.len() {
            for new in ["", "-1", "x", "\"", "0", "1e308", "[", "A:B"] {
                let mut words = words.clone();
                words[k] = new;
                let line = words.join(" ");
                let mut lines = lines.clone();
                lines[i] = &line;
                let _ = import(lines.join("\n").as_bytes(), EpanetOptions::default());
            }
        }
    }
    let _ = import(&[0xff, 0xfe, b'[', b'P'], EpanetOptions::default());
}

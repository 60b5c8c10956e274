//! Made-up recordings of the size and shape of real ones.

use anergy_core::clock::Time;
use anergy_core::recorder::{Channel, ChannelGroup, Event, MapEdge, MapNode, Recording, Severity};
use serde_json::json;

/// Adds a column.
pub fn push(
    recording: &mut Recording,
    group: ChannelGroup,
    component: &str,
    quantity: &str,
    value: impl Fn(f64) -> f64,
) {
    let column = recording.time_s.iter().map(|t| value(*t)).collect();
    recording.channels.push(Channel {
        name: format!("{component}.{quantity}"),
        unit: "1".to_owned(),
        group,
        component: component.to_owned(),
        quantity: quantity.to_owned(),
    });
    recording.columns.push(column);
}

/// Adds a node of the map with pressure and temperature.
pub fn node(
    recording: &mut Recording,
    id: &str,
    site: &str,
    p_pa: impl Fn(f64) -> f64,
    t_k: impl Fn(f64) -> f64,
) {
    recording.header.map.nodes.push(MapNode {
        id: id.to_owned(),
        site: site.to_owned(),
        x_m: None,
        y_m: None,
    });
    push(recording, ChannelGroup::Nodes, id, "p_pa", p_pa);
    push(recording, ChannelGroup::Nodes, id, "t_k", t_k);
}

/// Adds an edge of the map with its flow.
pub fn edge(
    recording: &mut Recording,
    id: &str,
    kind: &str,
    ends: [&str; 2],
    length_m: f64,
    station: &str,
    flow: impl Fn(f64) -> f64,
) {
    recording.header.map.edges.push(MapEdge {
        id: id.to_owned(),
        kind: kind.to_owned(),
        from: ends[0].to_owned(),
        to: ends[1].to_owned(),
        length_m,
        inner_diameter_m: if length_m > 0.0 { 0.02 } else { 0.0 },
        station: station.to_owned(),
    });
    push(recording, ChannelGroup::Edges, id, "m_flow_kg_s", flow);
}

fn smooth(t: f64, at: f64, width: f64) -> f64 {
    1.0 / (1.0 + (-(t - at) / width).exp())
}

/// Flow of the three houses, l/min, feed-in positive.
fn house_flow(site: usize, t: f64) -> f64 {
    let after = smooth(t, 2240.0, 12.0);
    let start = 1.0 - (-t / 20.0).exp();
    let sf1 = start * (0.8 + 2.5 * after);
    let sf2 = start * (7.9 - 3.6 * after);
    [sf1, sf2, -(sf1 + sf2)][site]
}

/// Three houses in a chain, 200 m and 50 m apart: the first is blocked until the second slows down.
pub fn three_houses() -> Recording {
    let mut r = Recording {
        time_s: (0..=360).map(|i| f64::from(i) * 10.0).collect(),
        ..Recording::default()
    };
    r.header.model_name = "Three houses".to_owned();
    r.header.model_text =
        "[run]\nuntil_h = 1\nrecord_s = 10\n\n[site.sf1]\nstation = { kind = \"bidirectional\" }\n"
            .to_owned();
    r.header.settings = [
        ("step", "1 s"),
        ("record interval", "10 s"),
        ("hydraulic tolerance", "1e-6 Pa"),
        ("program", "anergy 0.1.0"),
    ]
    .map(|(name, value)| (name.to_owned(), value.to_owned()))
    .to_vec();
    let sites = ["sf1", "sf2", "sf4"];
    for (i, site) in sites.iter().enumerate() {
        let dp = move |t: f64| 21_000.0 - 6000.0 * i as f64 - 3000.0 * smooth(t, 2240.0, 12.0);
        let hot = move |t: f64| {
            273.15
                + [48.0, 60.0, 57.5][i]
                + [14.0, 0.0, 1.5][i] * smooth(t, 2300.0 + 120.0 * i as f64, 60.0)
        };
        node(&mut r, &format!("{site}.hot"), site, move |t| 2.5e5 + dp(t) / 2.0, hot);
        node(
            &mut r,
            &format!("{site}.cold"),
            site,
            move |t| 2.5e5 - dp(t) / 2.0,
            move |t| 273.15 + 32.0 + i as f64 + 2.0 * smooth(t, 1500.0, 300.0),
        );
        node(&mut r, &format!("{site}.station.inner"), site, |_| 2.5e5, |_| 320.0);
        let station = format!("{site}.station");
        let flow = move |t: f64| house_flow(i, t) / 60.0;
        push(&mut r, ChannelGroup::Interfaces, &station, "m_flow_kg_s", flow);
        push(&mut r, ChannelGroup::Interfaces, &station, "q_flow_w", move |t| {
            flow(t) * 4180.0 * 25.0
        });
        push(&mut r, ChannelGroup::Interfaces, &station, "requested_m_flow_kg_s", move |_| {
            [3.5, 8.0, -9.0][i] / 60.0
        });
        push(&mut r, ChannelGroup::Interfaces, &station, "blocked", move |t| {
            f64::from(i == 0 && (60.0..2245.0).contains(&t))
        });
        let (hot, cold, inner) =
            (format!("{site}.hot"), format!("{site}.cold"), format!("{site}.station.inner"));
        let pump = format!("{site}.feed_in_pump");
        edge(&mut r, &pump, "pump", [&cold, &inner], 0.0, &station, move |t| flow(t).max(0.0));
        push(&mut r, ChannelGroup::Edges, &pump, "speed", move |t| {
            [0.95, 1.0 - 0.15 * smooth(t, 2240.0, 4.0), 0.0][i]
        });
        let valve = format!("{site}.valve");
        edge(&mut r, &valve, "control_valve", [&inner, &hot], 0.0, &station, flow);
        push(&mut r, ChannelGroup::Edges, &valve, "opening", move |t| {
            [0.0, 0.0, 0.5 + 0.1 * smooth(t, 900.0, 60.0)][i]
        });
    }
    for (i, length) in [200.0, 50.0].into_iter().enumerate() {
        for (side, sign) in [("hot", 1.0), ("cold", -1.0)] {
            let [a, b] = [sites[i], sites[i + 1]].map(|site| format!("{site}.{side}"));
            let id = format!("{}_{}_{side}", sites[i], sites[i + 1]);
            let flow = move |t: f64| sign * (0..=i).map(|k| house_flow(k, t)).sum::<f64>() / 60.0;
            edge(&mut r, &id, "pipe", [&a, &b], length, "", flow);
            let warm = if side == "hot" { 55.0 } else { 33.0 };
            push(&mut r, ChannelGroup::Edges, &id, "t_a_k", move |t| {
                273.15 + warm + 5.0 * smooth(t, 2300.0, 60.0)
            });
            push(&mut r, ChannelGroup::Edges, &id, "t_b_k", move |t| {
                273.15 + warm + 5.0 * smooth(t, 2900.0, 90.0)
            });
            push(&mut r, ChannelGroup::Edges, &id, "q_loss_w", move |_| 4.0 * length);
        }
    }
    push(&mut r, ChannelGroup::Balances, "network", "energy_error_j", |_| 1e-6);
    for (time, severity, kind, message) in [
        (
            60.0,
            Severity::Warning,
            "blocked",
            "sf1.station delivers 0.80 of 3.50 l/min at full commanded speed: the pressure difference of 210 hPa leaves no head",
        ),
        (
            2230.0,
            Severity::Info,
            "setpoint",
            "sf2.feed_in_pump is ramped from 1.00 to 0.85 in 20 s",
        ),
        (2245.0, Severity::Info, "unblocked", "sf1.station delivers 3.20 l/min again"),
    ] {
        let component = if kind == "setpoint" { "sf2.feed_in_pump" } else { "sf1.station" };
        r.events.push(Event {
            time: Time::from_s(time).unwrap_or_default(),
            severity,
            component: component.to_owned(),
            kind: kind.to_owned(),
            message: message.to_owned(),
        });
    }
    r.summary = json!({
        "key_results": [
            {"label": "Feed-in before the reduction", "value": 0.7981, "unit": "l/min", "component": "sf1.station"},
            {"label": "Feed-in after the reduction", "value": 3.298, "unit": "l/min", "component": "sf1.station"},
            {"label": "Feed-in before the reduction", "value": 7.914, "unit": "l/min", "component": "sf2.station"},
            {"label": "Feed-in after the reduction", "value": 4.312, "unit": "l/min", "component": "sf2.station"},
            {"label": "Time blocked", "value": 36.42, "unit": "min", "component": "sf1.station"},
            {"label": "Heat delivered", "value": 14.62, "unit": "kWh", "component": "sf4.station"},
            {"label": "Pump energy", "value": 0.0312, "unit": "kWh", "component": "network"},
        ],
        "balances": [
            {"label": "Mass, largest error at a node", "value": 2.1e-13, "unit": "kg/s", "relative_error": 1.6e-12},
            {"label": "Energy fed in − extracted − lost − stored", "value": -3.4e-4, "unit": "J", "relative_error": 6.5e-12},
        ],
        "pipes": [
            {"component": "sf1-sf2.hot", "lost_kwh": 0.41, "mean_loss_w": 410.0, "brought_kwh": 0.39, "stored_kwh": -0.02, "relative_error": 3e-13},
        ],
        "statistics": {"steps": 3600, "newton iterations": 9214, "factorisations": 9214, "wall time": "0.21 s"}
    });
    r
}

/// A branching district: `count` sites, each with a station.
pub fn district(count: usize, rows: u32) -> Recording {
    let mut r = Recording {
        time_s: (0..rows).map(|i| f64::from(i) * 900.0).collect(),
        ..Recording::default()
    };
    r.header.model_name = format!("District of {count}");
    r.header.start_unix_ns = 1_767_225_600_000_000_000;
    for i in 0..count {
        let site = format!("h{i:04}");
        let phase = i as f64 * 0.37;
        let day = std::f64::consts::TAU / 86_400.0;
        let flow = move |t: f64| (0.02 + 0.001 * (i % 17) as f64) * (t * day + phase).sin();
        node(
            &mut r,
            &format!("{site}.hot"),
            &site,
            move |t| 3.2e5 + 1e4 * (t * day + phase).cos(),
            move |t| 330.0 + 6.0 * (t * day + phase).sin(),
        );
        node(
            &mut r,
            &format!("{site}.cold"),
            &site,
            |_| 3e5,
            move |t| 300.0 + 4.0 * (t * day - phase).sin(),
        );
        let station = format!("{site}.station");
        push(&mut r, ChannelGroup::Interfaces, &station, "m_flow_kg_s", flow);
        push(&mut r, ChannelGroup::Interfaces, &station, "blocked", move |t| {
            f64::from(i % 50 == 7 && t > 20_000.0 && t < 40_000.0)
        });
        if i > 0 {
            let parent = format!("h{:04}", if i < 40 { i - 1 } else { (i - 40) / 3 });
            for side in ["hot", "cold"] {
                let sign = if side == "hot" { 1.0 } else { -1.0 };
                let ends = [format!("{parent}.{side}"), format!("{site}.{side}")];
                let length = 15.0 + (i * 7 % 23) as f64;
                edge(
                    &mut r,
                    &format!("p{i:04}_{side}"),
                    "pipe",
                    [&ends[0], &ends[1]],
                    length,
                    "",
                    move |t| sign * flow(t) * (1.0 + 40.0 / (1.0 + i as f64)),
                );
            }
        }
    }
    r
}

/// A pump and a pipe around one node: no sites at all.
pub fn plain(nodes: usize) -> Recording {
    let mut r = Recording { time_s: vec![0.0, 60.0, 120.0], ..Recording::default() };
    r.header.model_name = "Plain".to_owned();
    for i in 0..nodes {
        node(&mut r, &format!("n{i}"), "", |_| 2e5, |_| 333.15);
    }
    if nodes > 1 {
        edge(&mut r, "pump", "pump", ["n0", "n1"], 0.0, "", |t| t / 600.0);
        push(&mut r, ChannelGroup::Edges, "pump", "speed", |_| 0.8);
        edge(&mut r, "return", "pipe", ["n1", "n0"], 30.0, "", |t| t / 600.0);
    }
    if nodes > 2 {
        edge(&mut r, "valve", "control_valve", ["n1", "n2"], 0.0, "", |t| -t / 900.0);
        edge(&mut r, "hx", "heat_exchanger", ["n2", "n0"], 0.0, "", |t| -t / 900.0);
    }
    r
}

/// Text that breaks out of careless pages.
pub const EVIL: &str = "</script><img src=x onerror=alert(1)>\" onfocus=\"alert(2) ' --><!--";

/// Three houses with hostile text everywhere.
pub fn hostile() -> Recording {
    let mut recording = three_houses();
    recording.header.model_name = EVIL.to_owned();
    recording.header.model_text = format!("<b>{EVIL}");
    recording.header.settings.push((EVIL.to_owned(), EVIL.to_owned()));
    recording.events.push(Event {
        time: Time(i64::MIN),
        severity: Severity::Warning,
        component: EVIL.to_owned(),
        kind: "blocked".to_owned(),
        message: EVIL.to_owned(),
    });
    recording.summary = json!({
        "key_results": [{"label": EVIL, "value": EVIL, "unit": EVIL, "component": EVIL}],
        "balances": [{"label": EVIL, "value": {"x": EVIL}, "unit": EVIL, "relative_error": EVIL}],
        "pipes": [{"component": EVIL, "lost_kwh": EVIL, "mean_loss_w": EVIL, "brought_kwh": EVIL, "stored_kwh": EVIL}],
        "statistics": {EVIL: EVIL},
    });
    let site = format!("{EVIL}site");
    node(&mut recording, &format!("{site}.hot"), &site, |_| 1e5, |_| 300.0);
    node(&mut recording, &format!("{site}.cold"), &site, |_| 1e5, |_| 300.0);
    node(&mut recording, EVIL, "", |_| 1e5, |_| 300.0);
    edge(&mut recording, EVIL, EVIL, [EVIL, "sf1.hot"], f64::NAN, "", |_| 1.0);
    push(
        &mut recording,
        ChannelGroup::Interfaces,
        &format!("{site}.station"),
        "m_flow_kg_s",
        |_| 0.1,
    );
    recording
}

/// A ring of junctions of hot and cold lines with sites on stubs and a boiler house between plain nodes.
pub fn ring() -> Recording {
    let mut r = Recording { time_s: vec![0.0, 600.0], ..Recording::default() };
    r.header.model_name = "Ring".to_owned();
    for j in 0..6 {
        for (side, t_k) in [("hot", 340.0 - f64::from(j)), ("cold", 303.0 + f64::from(j))] {
            node(&mut r, &format!("j{j}.{side}"), "", |_| 3e5, move |_| t_k);
            node(&mut r, &format!("s{j}.{side}"), &format!("s{j}"), |_| 3e5, move |_| t_k);
        }
        push(&mut r, ChannelGroup::Interfaces, &format!("s{j}.station"), "m_flow_kg_s", move |t| {
            (f64::from(j) - 2.0) * 0.04 * (1.0 + t / 600.0)
        });
    }
    for j in 0..6 {
        for side in ["hot", "cold"] {
            let (here, next) = (format!("j{j}.{side}"), format!("j{}.{side}", (j + 1) % 6));
            edge(
                &mut r,
                &format!("ring{j}_{side}"),
                "pipe",
                [&here, &next],
                60.0 + 10.0 * f64::from(j),
                "",
                move |_| 0.3 - 0.1 * f64::from(j),
            );
            edge(
                &mut r,
                &format!("stub{j}_{side}"),
                "pipe",
                [&here, &format!("s{j}.{side}")],
                12.0,
                "",
                move |_| 0.05 * f64::from(j),
            );
        }
    }
    node(&mut r, "boiler.in", "", |_| 2e5, |_| 303.0);
    edge(&mut r, "boiler_pump", "pump", ["j0.cold", "boiler.in"], 0.0, "", |_| 0.3);
    edge(&mut r, "boiler_hx", "heat_exchanger", ["boiler.in", "j0.hot"], 0.0, "", |_| 0.3);
    r
}

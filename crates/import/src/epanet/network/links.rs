//! Pipes, pumps and valves, and their status at the start.

use super::{Network, untranslated};
use crate::epanet::inp::{Row, Section, begins};
use crate::epanet::units::{HeadLoss, Options};
use crate::model_text::ModelText;
use crate::{ImportError, NoteKind};

/// What a link does at the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::epanet) enum Status {
    Open,
    Closed,
    /// A valve that controls.
    Active,
}

/// Kinds of valves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::epanet) enum ValveKind {
    /// Pressure reducing.
    Prv,
    /// Pressure sustaining.
    Psv,
    /// Pressure breaker.
    Pbv,
    /// Flow control.
    Fcv,
    /// Throttle control.
    Tcv,
    /// General purpose.
    Gpv,
    /// Position control.
    Pcv,
}

const VALVES: [(&str, ValveKind); 7] = [
    ("PRV", ValveKind::Prv),
    ("PSV", ValveKind::Psv),
    ("PBV", ValveKind::Pbv),
    ("FCV", ValveKind::Fcv),
    ("TCV", ValveKind::Tcv),
    ("GPV", ValveKind::Gpv),
    ("PCV", ValveKind::Pcv),
];

#[derive(Debug, Clone, PartialEq)]
pub(in crate::epanet) enum LinkKind {
    Pipe {
        length_m: f64,
        diameter_m: f64,
        /// m for Darcy-Weisbach, else the coefficient of the law.
        roughness: f64,
        minor_loss: f64,
        check_valve: bool,
    },
    Pump {
        /// Head times flow of a pump with constant power.
        head_times_flow_m4_s: Option<f64>,
        curve: Option<String>,
        pattern: Option<String>,
    },
    Valve {
        kind: ValveKind,
        diameter_m: f64,
        minor_loss: f64,
        /// Loss over the flow (GPV), or flow coefficient over the position in percent (PCV).
        curve: Option<String>,
    },
}

#[derive(Debug, Clone, PartialEq)]
pub(in crate::epanet) struct Link {
    pub id: String,
    pub line: usize,
    pub from: usize,
    pub to: usize,
    pub kind: LinkKind,
    pub status: Status,
    /// Speed of a pump, setting of a valve as written.
    pub setting: f64,
}

impl Network {
    pub(super) fn link(&mut self, row: &Row<'_>, options: &Options) -> Result<(), ImportError> {
        let id = row.words[0].to_owned();
        let (from, to) = (self.known_node(row, 1)?, self.known_node(row, 2)?);
        if from == to {
            return Err(row.error(format!("link \"{id}\" begins and ends at one node")));
        }
        let (kind, status, setting) = match row.section {
            Section::Pipes => pipe(row, options)?,
            Section::Pumps => self.pump(row, options)?,
            _ => self.valve(row, options)?,
        };
        if self.link_index.insert(id.clone(), self.links.len()).is_some() {
            return Err(row.error(format!("link \"{id}\" exists twice")));
        }
        self.links.push(Link { id, line: row.line, from, to, kind, status, setting });
        Ok(())
    }

    fn pump(
        &self,
        row: &Row<'_>,
        options: &Options,
    ) -> Result<(LinkKind, Status, f64), ImportError> {
        if row.words.get(3).is_some_and(|word| word.parse::<f64>().is_ok()) {
            return Err(row.error("a pump in the form of EPANET 1: use HEAD or POWER"));
        }
        let (mut head_times_flow_m4_s, mut curve, mut pattern) = (None, None, None);
        let mut speed = 1.0;
        for i in (3..row.words.len()).step_by(2) {
            let word = row.words[i];
            if begins(word, "POWE") {
                let power = row.positive(i + 1, "power")?;
                head_times_flow_m4_s = Some(options.head_times_flow_m4_s(power));
            } else if begins(word, "HEAD") {
                let id = row.word(i + 1, "curve")?;
                if !self.curves.contains_key(id) {
                    return Err(row.error(format!("there is no curve \"{id}\"")));
                }
                curve = Some(id.to_owned());
            } else if begins(word, "PATT") {
                row.word(i + 1, "pattern")?;
                pattern = self.pattern_id(row, i + 1)?;
            } else if begins(word, "SPEE") {
                speed = row.not_negative(i + 1, "speed")?;
            } else {
                return Err(row.error(format!("\"{word}\" says nothing of a pump")));
            }
        }
        if head_times_flow_m4_s.is_some() == curve.is_some() {
            return Err(row.error("a pump needs either HEAD or POWER"));
        }
        let status = if speed > 0.0 { Status::Open } else { Status::Closed };
        Ok((LinkKind::Pump { head_times_flow_m4_s, curve, pattern }, status, speed))
    }

    fn valve(
        &self,
        row: &Row<'_>,
        options: &Options,
    ) -> Result<(LinkKind, Status, f64), ImportError> {
        let word = row.word(4, "kind of valve")?;
        let Some((_, kind)) = VALVES.iter().find(|(name, _)| begins(word, name)) else {
            return Err(row.error(format!("unknown kind of valve \"{word}\"")));
        };
        // The setting of a general purpose valve is the name of its curve.
        let (setting, curve) = match kind {
            ValveKind::Gpv => (0.0, Some(row.word(5, "curve")?)),
            ValveKind::Pcv => (row.number(5, "setting")?, row.words.get(7).copied()),
            _ => (row.number(5, "setting")?, None),
        };
        if let Some(id) = curve.filter(|id| !self.curves.contains_key(*id)) {
            return Err(row.error(format!("there is no curve \"{id}\"")));
        }
        let kind = LinkKind::Valve {
            kind: *kind,
            diameter_m: row.positive(3, "diameter")? * options.diameter_m(),
            minor_loss: if row.words.len() > 6 { row.not_negative(6, "minor loss")? } else { 0.0 },
            curve: curve.map(str::to_owned),
        };
        Ok((kind, Status::Active, setting))
    }

    /// A line of `[STATUS]`: of one link, or of all whose ids are numbers between two.
    pub(super) fn status(
        &mut self,
        row: &Row<'_>,
        _options: &Options,
        text: &mut ModelText,
    ) -> Result<(), ImportError> {
        let last = row.words.len() - 1;
        if last == 0 {
            return Err(row.error("a status is missing"));
        }
        let wanted = setting(row, last)?;
        let range: Vec<usize> = match (last, self.link_at(row.words[0])) {
            (1, Some(link)) => vec![link],
            (1, None) => {
                return Err(row.error(format!("there is no link \"{}\"", row.words[0])));
            }
            _ => {
                let number = |i: usize| row.words[i].parse::<i64>().ok();
                let (Some(low), Some(high)) = (number(0), number(1)) else {
                    return Err(row.error("a range of links needs numbers as ids"));
                };
                let inside =
                    |link: &Link| link.id.parse::<i64>().is_ok_and(|id| (low..=high).contains(&id));
                (0..self.links.len()).filter(|i| inside(&self.links[*i])).collect()
            }
        };
        for link in range {
            if !self.set(link, wanted) {
                untranslated(text, row, "EPANET does not let it have this status");
            }
        }
        Ok(())
    }

    /// Gives a link a status or a setting. Pipes with a check valve have none.
    pub fn set(&mut self, link: usize, wanted: Setting) -> bool {
        let link = &mut self.links[link];
        match (&link.kind, wanted) {
            (LinkKind::Pipe { check_valve: true, .. }, _) => return false,
            (LinkKind::Pipe { .. } | LinkKind::Valve { kind: ValveKind::Gpv, .. }, wanted) => {
                match wanted {
                    Setting::Open => link.status = Status::Open,
                    Setting::Closed => link.status = Status::Closed,
                    Setting::Value(_) => return false,
                }
            }
            (LinkKind::Pump { .. }, Setting::Open) => {
                (link.status, link.setting) = (Status::Open, 1.0);
            }
            (LinkKind::Pump { .. }, Setting::Value(speed)) => {
                link.status = if speed > 0.0 { Status::Open } else { Status::Closed };
                link.setting = speed;
            }
            (LinkKind::Valve { .. }, Setting::Open) => link.status = Status::Open,
            (LinkKind::Valve { .. }, Setting::Value(value)) => {
                (link.status, link.setting) = (Status::Active, value);
            }
            (_, Setting::Closed) => link.status = Status::Closed,
        }
        true
    }
}

/// A word of `[STATUS]` or `[CONTROLS]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::epanet) enum Setting {
    Open,
    Closed,
    Value(f64),
}

/// Reads OPEN, CLOSED or a number.
pub(in crate::epanet) fn setting(row: &Row<'_>, i: usize) -> Result<Setting, ImportError> {
    let word = row.word(i, "status")?;
    if begins(word, "OPEN") {
        Ok(Setting::Open)
    } else if begins(word, "CLOS") {
        Ok(Setting::Closed)
    } else {
        Ok(Setting::Value(row.not_negative(i, "setting")?))
    }
}

fn pipe(row: &Row<'_>, options: &Options) -> Result<(LinkKind, Status, f64), ImportError> {
    let roughness_unit = match options.head_loss {
        HeadLoss::DarcyWeisbach => options.roughness_m(),
        _ => 1.0,
    };
    let (mut minor_loss, mut check_valve, mut status) = (0.0, false, Status::Open);
    for i in 6..row.words.len() {
        let word = row.words[i];
        if begins(word, "CV") {
            check_valve = true;
        } else if begins(word, "CLOS") {
            status = Status::Closed;
        } else if !begins(word, "OPEN") {
            minor_loss = row.not_negative(i, "minor loss")?;
        }
    }
    let kind = LinkKind::Pipe {
        length_m: row.positive(3, "length")? * options.length_m(),
        diameter_m: row.positive(4, "diameter")? * options.diameter_m(),
        roughness: row.positive(5, "roughness")? * roughness_unit,
        minor_loss,
        check_valve,
    };
    Ok((kind, status, 0.0))
}

impl Link {
    /// What stands for it in messages.
    pub fn name(&self) -> String {
        let kind = match &self.kind {
            LinkKind::Pipe { .. } => "pipe",
            LinkKind::Pump { .. } => "pump",
            LinkKind::Valve { kind, .. } => {
                VALVES.iter().find(|(_, known)| known == kind).map_or("valve", |(name, _)| name)
            }
        };
        format!("{kind} \"{}\"", self.id)
    }

    /// Whether it has a loss coefficient.
    pub fn has_loss(&self) -> bool {
        match self.kind {
            LinkKind::Pipe { minor_loss, .. } => minor_loss > 0.0,
            LinkKind::Valve { .. } => true,
            LinkKind::Pump { .. } => false,
        }
    }

    /// A note on the link.
    pub fn note(&self, text: &mut ModelText, kind: NoteKind, what: &str) {
        text.note(kind, self.line, format!("{}: {what}", self.name()));
    }
}

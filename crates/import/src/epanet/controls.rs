//! Controls: those that act at t = 0 change the status of their links, the others are listed.

use super::inp::{Row, Section, begins};
use super::network::{Network, untranslated};
use super::units::{Options, time_s};
use crate::ImportError;
use crate::epanet::network::setting;
use crate::model_text::ModelText;

/// Seconds of a day.
const DAY_S: f64 = 86_400.0;

/// Applies and lists the controls, in the order of the file; rules begin after the first step.
pub(super) fn apply(
    network: &mut Network,
    rows: &[Row<'_>],
    options: &Options,
    text: &mut ModelText,
    errors: &mut Vec<ImportError>,
) {
    for link in 0..network.links.len() {
        network.pump_pattern(link, options);
    }
    for row in rows.iter().filter(|row| row.section == Section::Controls) {
        errors.extend(control(network, row, options, text).err());
    }
    let mut rules = rows.iter().filter(|row| row.section == Section::Rules).peekable();
    if rules.peek().is_some() {
        let first = rules.peek().map(|row| row.line);
        let count = rules.filter(|row| begins(row.words[0], "RULE")).count();
        let what = format!("[RULES]: {count} rules, which act after t = 0");
        text.note(crate::NoteKind::NotTranslated, first, what);
    }
}

fn control(
    network: &mut Network,
    row: &Row<'_>,
    options: &Options,
    text: &mut ModelText,
) -> Result<(), ImportError> {
    let link = row.word(1, "link")?;
    let Some(link) = network.link_at(link) else {
        return Err(row.error(format!("there is no link \"{link}\"")));
    };
    let wanted = setting(row, 2)?;
    let condition = row.word(3, "condition")?;
    let now = if begins(condition, "AT") {
        let time = time_s(row.words.get(5..).unwrap_or_default())
            .ok_or_else(|| row.error("a control needs a time"))?;
        if begins(row.word(4, "TIME or CLOCKTIME")?, "CLOCK") {
            time % DAY_S == options.start_clock_s
        } else {
            time == 0.0
        }
    } else {
        let node = row.word(5, "node")?;
        let Some(node) = network.node_at(node) else {
            return Err(row.error(format!("there is no node \"{node}\"")));
        };
        let above = begins(row.word(6, "ABOVE or BELOW")?, "ABOVE");
        let level = row.number(7, "level")? * options.length_m();
        match network.nodes[node].level_m() {
            Some(now) => {
                if above {
                    now >= level
                } else {
                    now <= level
                }
            }
            None => {
                untranslated(text, row, "it acts on the pressure of a junction");
                return Ok(());
            }
        }
    };
    if now && !network.set(link, wanted) {
        untranslated(text, row, "EPANET does not let it have this status");
    } else if now {
        let what = "it acts at t = 0 and is taken then, later it does nothing";
        untranslated(text, row, what);
    } else {
        untranslated(text, row, "it does not act at t = 0");
    }
    Ok(())
}

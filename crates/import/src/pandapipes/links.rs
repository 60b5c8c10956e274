//! The edges of a net: which junctions they join, which of them the model keeps.

use super::tables::{Row, Table, Tables};
use crate::ImportError;
use std::collections::{HashMap, HashSet};

/// Tables of branches that the model has, with the columns of their junctions.
pub(super) const BRANCHES: [(&str, &str, &str); 7] = [
    ("pipe", "from_junction", "to_junction"),
    ("valve", "from_junction", "to_junction"),
    ("pump", "from_junction", "to_junction"),
    ("heat_exchanger", "from_junction", "to_junction"),
    ("heat_consumer", "from_junction", "to_junction"),
    ("flow_control", "from_junction", "to_junction"),
    ("press_control", "from_junction", "to_junction"),
];

/// A branch in service.
pub(super) struct Branch<'a> {
    pub table: &'a Table,
    pub row: &'a Row,
    pub from: i64,
    pub to: i64,
    /// A valve at the end of a pipe: the junction is that of the pipe.
    pub at_pipe: Option<i64>,
}

/// All branches in service, closed valves left out.
pub(super) fn branches<'a>(
    net: &Tables,
    tables: &'a [Table],
) -> Result<Vec<Branch<'a>>, ImportError> {
    let pipes = net.table("pipe")?;
    let mut branches = Vec::new();
    for (table, (_, from, to)) in tables.iter().zip(BRANCHES) {
        for row in table.in_service().filter(|row| table.flag(row, "opened")) {
            let old_form = table.name != "valve" || table.text(row, "et").is_none();
            let (from, to, at_pipe) = if old_form {
                (table.integer(row, from)?, table.integer(row, to)?, None)
            } else {
                let (junction, element) =
                    (table.integer(row, "junction")?, table.integer(row, "element")?);
                if table.text(row, "et") == Some("pi") {
                    if !pipes.rows.iter().any(|pipe| pipe.index == element) {
                        return Err(table.error(row, &format!("there is no pipe {element}")));
                    }
                    (junction, junction, Some(element))
                } else {
                    (junction, element, None)
                }
            };
            if from == to && at_pipe.is_none() {
                return Err(table.error(row, "it begins and ends at one junction"));
            }
            branches.push(Branch { table, row, from, to, at_pipe });
        }
    }
    Ok(branches)
}

/// Junctions with a way to a given pressure.
pub(super) fn reached(
    branches: &[Branch<'_>],
    fixed: impl Iterator<Item = i64>,
    usable: &HashSet<i64>,
) -> HashSet<i64> {
    let mut ways: HashMap<i64, Vec<i64>> = HashMap::new();
    for branch in branches {
        ways.entry(branch.from).or_default().push(branch.to);
        ways.entry(branch.to).or_default().push(branch.from);
    }
    let mut next: Vec<i64> = fixed.filter(|junction| usable.contains(junction)).collect();
    let mut reached: HashSet<i64> = next.iter().copied().collect();
    while let Some(junction) = next.pop() {
        for &other in ways.get(&junction).into_iter().flatten() {
            if usable.contains(&other) && reached.insert(other) {
                next.push(other);
            }
        }
    }
    reached
}

//! Pages of the documentation that slow tests write: tables of results.

use crate::workspace;

/// Whether this run writes pages (`make validate` does): `TABLE_DATE` is set.
pub fn writes_pages() -> bool {
    std::env::var_os("TABLE_DATE").is_some()
}

/// Writes `docs/src/validation/NAME.md` with the command that did it and, where `TABLE_DATE` says it, the
/// day.
///
/// # Panics
/// When the page cannot be written.
pub fn write_page(name: &str, command: &str, text: &str) {
    let day = std::env::var("TABLE_DATE").map_or_else(|_| String::new(), |day| format!(", {day}"));
    let path = workspace().join(format!("docs/src/validation/{name}.md"));
    let page = format!("{}\n\nWritten by `{command}`{day}.\n", text.trim_end());
    if let Err(error) = std::fs::write(&path, page) {
        panic!("cannot write {}: {error}", path.display());
    }
}

/// Prints a table and, where this run writes pages, puts it into `docs/src/validation/PAGE.md`: between the line
/// `<!-- NAME -->` and the next one that begins with `Written by`, which gets the command and the day.
///
/// # Panics
/// When the page has no such place, or cannot be written.
#[expect(clippy::print_stdout, reason = "with --nocapture the table is what one wants to see")]
pub fn write_table(page: &str, name: &str, command: &str, table: &str) {
    println!("{}", table.trim_end());
    let Ok(day) = std::env::var("TABLE_DATE") else { return };
    let path = workspace().join(format!("docs/src/validation/{page}.md"));
    let text = std::fs::read_to_string(&path)
        .unwrap_or_else(|error| panic!("cannot read {}: {error}", path.display()));
    let mark = format!("<!-- {name} -->\n");
    let place = text.split_once(&mark).and_then(|(before, rest)| {
        let (old, after) = rest.split_once("\nWritten by ")?;
        let stays = !old.contains("<!--");
        stays.then(|| (before, after.split_once('\n').map_or("", |(_, after)| after)))
    });
    let Some((before, after)) = place else {
        panic!("{} has no place for the table {name}", path.display());
    };
    let table = table.trim_end();
    let text = format!("{before}{mark}{table}\n\nWritten by `{command}`, {day}.\n{after}");
    if let Err(error) = std::fs::write(&path, text) {
        panic!("cannot write {}: {error}", path.display());
    }
}

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

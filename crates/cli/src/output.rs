//! Standard output that may be closed early (`anergy schema | head`).

use crate::failure::Failure;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Prints text; ends the program quietly when nobody reads any more.
pub fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    if let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        if error.kind() == ErrorKind::BrokenPipe {
            std::process::exit(0);
        }
        eprintln!("error: cannot write to standard output: {error}");
        std::process::exit(1);
    }
}

/// Opens a file to write; "-" is standard output. A folder that is not there is named.
pub fn create(path: &Path) -> Result<Box<dyn Write>, Failure> {
    if path == Path::new("-") {
        return Ok(Box::new(std::io::stdout().lock()));
    }
    match File::create(path) {
        Ok(file) => Ok(Box::new(file)),
        Err(error) => match path.parent() {
            Some(folder) if error.kind() == ErrorKind::NotFound && !folder.exists() => {
                let (path, folder) = (path.display(), folder.display());
                Err(Failure::File(format!("cannot write {path}: there is no folder {folder}")))
            }
            _ => Err(Failure::file("cannot write", path, &error)),
        },
    }
}

/// Prints a formatted line.
macro_rules! line {
    ($($argument:tt)*) => {
        $crate::output::print(&format!("{}\n", format_args!($($argument)*)))
    };
}
pub(crate) use line;

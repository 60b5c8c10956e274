//! Standard output that may be closed early (`anergy schema | head`).

use std::io::{ErrorKind, Write};

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

/// Prints a formatted line.
macro_rules! line {
    ($($argument:tt)*) => {
        $crate::output::print(&format!("{}\n", format_args!($($argument)*)))
    };
}
pub(crate) use line;

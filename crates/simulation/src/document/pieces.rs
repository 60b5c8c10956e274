//! A large text is parsed piece by piece: what the parser makes of a whole one takes many times its size.
//!
//! A piece ends before a line that begins with `[[`. That such a line is no part of a string or an array is
//! known when both pieces are sound: each then ends where it began, outside of everything. Whatever is not
//! plainly a list of entries that goes on in the next piece is left to the parser of the whole.

use super::{Tree, TreeKind, parse};

/// Size of a piece, bytes; smaller texts are parsed whole.
const PIECE: usize = 1 << 18;

/// The tree of a large text; `None` where it must be parsed whole: a small one, or one with problems.
pub(super) fn parse_large(text: &str) -> Option<Tree> {
    in_pieces(text, PIECE)
}

fn in_pieces(text: &str, size: usize) -> Option<Tree> {
    let mut end = piece(text, 0, size)?;
    let mut whole = parse(&text[..end], 0).ok()?;
    while end < text.len() {
        let next = piece(text, end, size).unwrap_or(text.len());
        let TreeKind::Table(more) = parse(&text[end..next], end).ok()?.kind else { return None };
        let TreeKind::Table(entries) = &mut whole.kind else { return None };
        for (key, tree) in more {
            let Some((first, known)) = entries.iter_mut().find(|(known, _)| known.name == key.name)
            else {
                entries.push((key, tree));
                continue;
            };
            // An array in one line cannot grow.
            let line = &text[..first.span.range()?.start];
            let (TreeKind::Array(known), TreeKind::Array(items)) = (&mut known.kind, tree.kind)
            else {
                return None;
            };
            if !line.trim_end_matches([' ', '\t']).ends_with("[[") {
                return None;
            }
            known.extend(items);
        }
        end = next;
    }
    Some(whole)
}

/// The end of the piece that begins at a byte; `None` where the text ends before.
fn piece(text: &str, first: usize, size: usize) -> Option<usize> {
    let from = (first + size..text.len()).find(|at| text.is_char_boundary(*at))?;
    text[from..].find("\n[[").map(|at| from + at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "format = 1\n[run]\nstep = \"1s\"\n[[edge]]\nid = \"a\"\n[edge.wall]\nx = [\n[1, 2],\n\
                        [3, 4]]\n[[node]]\nid = \"n\"\n[[edge]]\nid = \"b\"\n[ground]\nk = 3.5\n[[node]]\nid = \"m\"\n";

    #[test]
    fn pieces_make_the_whole() {
        let whole = parse(TEXT, 0).unwrap();
        for size in 0..TEXT.len() {
            if let Some(tree) = in_pieces(TEXT, size) {
                assert_eq!(tree.to_json(), whole.to_json(), "{size}");
                let span = |tree: &Tree| {
                    let TreeKind::Array(items) = &tree.get("edge").unwrap().kind else { panic!() };
                    items[1].get("id").unwrap().span
                };
                assert_eq!(span(&tree), span(&whole), "{size}");
            }
        }
        assert!(in_pieces(TEXT, 10).is_some());
    }

    #[test]
    fn what_goes_on_otherwise_is_left_to_the_whole() {
        let refused = [
            // A header in a string, and in an array.
            "a = 1\n[[edge]]\nid = '''\n[[edge]]\n'''\n[[edge]]\nid = 1\n",
            "a = 1\n[[edge]]\nid = [\n[[1]],\n[[2]]\n]\n",
            // A table and an array of one line that cannot be named again, a table of an entry before.
            "a = 1\n[run]\nx = 1\n[[edge]]\n[run]\ny = 1\n[[edge]]\nz = 1\n",
            "edge = [{ id = 1 }]\n[[edge]]\nid = 2\n",
            "a = 1\n[[edge]]\nid = 1\n[[node]]\nid = 2\n[edge.wall]\nx = 1\n",
        ];
        for text in refused {
            assert!(in_pieces(text, 0).is_none(), "{text}");
        }
    }
}

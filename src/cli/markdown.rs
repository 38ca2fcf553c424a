//! Tables in Markdown, for the pages of `docs/` that the program writes.

/// A table: its lines, each with a line feed.
pub(super) struct Table {
    text: String,
    columns: usize,
}

impl Table {
    pub(super) fn new(head: &[&str]) -> Self {
        let mut table = Self { text: String::new(), columns: head.len() };
        table.row(&head.iter().map(|cell| String::from(*cell)).collect::<Vec<_>>());
        table.text.push_str(&format!("|{}\n", "---|".repeat(head.len())));
        table
    }

    /// Appends a row, which has as many cells as the head; bars in cells are escaped, and line breaks become blanks.
    pub(super) fn row(&mut self, cells: &[String]) {
        assert_eq!(cells.len(), self.columns, "cells of a row, and of the head of its table: {cells:?}");
        let escaped = cells.iter().map(|cell| cell.replace('|', "\\|").replace('\n', " "));
        self.text.push_str(&format!("| {} |\n", escaped.collect::<Vec<_>>().join(" | ")));
    }

    /// The table's text with an empty line after it.
    pub(super) fn end(self) -> String {
        self.text + "\n"
    }
}

/// A word as code.
pub(super) fn code(text: &str) -> String {
    format!("`{text}`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_do_not_end_a_cell() {
        let mut table = Table::new(&["a", "b"]);
        table.row(&[code("x|y"), String::from("two\nlines")]);
        assert_eq!(table.end(), "| a | b |\n|---|---|\n| `x\\|y` | two lines |\n\n");
    }
}

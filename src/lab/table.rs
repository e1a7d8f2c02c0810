//! A table of results, and the forms it can be printed in.

use std::fmt::Write as _;

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number with the digits to show after the point; `None` where nothing was measured.
    Number(Option<f64>, usize),
}

impl Cell {
    /// Words.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// Milliseconds, or any other number with two digits after the point.
    pub fn millis(millis: Option<f64>) -> Self {
        Self::Number(millis, 2)
    }

    fn shown(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number(Some(number), digits) if number.is_finite() => format!("{number:.digits$}"),
            Self::Number(..) => "n/a".to_owned(),
        }
    }
}

/// Rows under headings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// What it shows.
    pub title: String,
    /// Headings.
    pub columns: Vec<&'static str>,
    /// Rows, each as long as [`Self::columns`].
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// An empty table.
    pub fn new(title: impl Into<String>, columns: &[&'static str]) -> Self {
        Self { title: title.into(), columns: columns.to_vec(), rows: Vec::new() }
    }

    /// All cells as they are shown.
    pub fn shown(&self) -> Vec<Vec<String>> {
        self.rows.iter().map(|row| row.iter().map(Cell::shown).collect()).collect()
    }

    /// Aligned columns for a terminal; numbers to the right.
    pub fn plain(&self) -> String {
        let shown = self.shown();
        let width = |column: usize| {
            let cells = shown.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count());
            cells.chain([self.columns[column].chars().count()]).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..self.columns.len()).map(width).collect();
        let is_number = |column: usize| {
            self.rows.first().and_then(|row| row.get(column)).is_some_and(|cell| matches!(cell, Cell::Number(..)))
        };
        let mut text = format!("{}\n", self.title);
        let mut line = |cells: &mut dyn Iterator<Item = &str>| {
            let mut joined = String::new();
            for (column, cell) in cells.enumerate() {
                let width = widths[column];
                let _ = if is_number(column) {
                    write!(joined, "{cell:>width$}  ")
                } else {
                    write!(joined, "{cell:width$}  ")
                };
            }
            text.push_str(joined.trim_end());
            text.push('\n');
        };
        line(&mut self.columns.iter().copied());
        for row in &shown {
            line(&mut row.iter().map(String::as_str));
        }
        text
    }

    /// A Markdown table with its title in bold.
    pub fn markdown(&self) -> String {
        let mut text = format!("**{}**\n\n| {} |\n|", self.title, self.columns.join(" | "));
        text.push_str(&"---|".repeat(self.columns.len()));
        text.push('\n');
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(|cell| cell.shown().replace('|', "\\|")).collect();
            let _ = writeln!(text, "| {} |", cells.join(" | "));
        }
        text
    }

    /// Comma-separated values (RFC 4180) with the title in a comment.
    pub fn csv(&self) -> String {
        let field = |text: &str| {
            if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
        };
        let mut text = format!("# {}\n{}\n", self.title, self.columns.join(","));
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(|cell| field(&cell.shown())).collect();
            let _ = writeln!(text, "{}", cells.join(","));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_holds_every_cell() {
        let mut table = Table::new("T", &["name", "ms"]);
        table.rows.push(vec![Cell::text("a, \"b\""), Cell::millis(Some(1.0 / 3.0))]);
        table.rows.push(vec![Cell::text("c"), Cell::millis(None)]);
        assert_eq!(table.plain(), "T\nname      ms\na, \"b\"  0.33\nc        n/a\n");
        assert_eq!(table.csv(), "# T\nname,ms\n\"a, \"\"b\"\"\",0.33\nc,n/a\n");
        assert!(table.markdown().ends_with("| a, \"b\" | 0.33 |\n| c | n/a |\n"), "{}", table.markdown());
    }
}

//! Tables in Markdown.

/// A Markdown table with a header row; the first column is text, the others are numbers.
pub struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Creates an empty table with these column headings.
    pub fn new<'h>(headings: impl IntoIterator<Item = &'h str>) -> Self {
        let headings: Vec<String> = headings.into_iter().map(str::to_owned).collect();
        let rule = (0..headings.len()).map(|column| if column == 0 { "---" } else { "--:" });
        let rule = rule.map(str::to_owned).collect();
        Self { rows: vec![headings, rule] }
    }

    /// Appends a row of cells to the table.
    pub fn row(&mut self, cells: impl Into<Vec<String>>) {
        let cells = cells.into();
        debug_assert_eq!(cells.len(), self.rows[0].len());
        self.rows.push(cells);
    }

    /// Formats the table as Markdown, followed by a blank line.
    pub fn markdown(&self) -> String {
        let rows = self.rows.iter().map(|cells| format!("| {} |\n", cells.join(" | ")));
        rows.collect::<String>() + "\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_then_a_rule_then_rows() {
        let mut table = Table::new(["mesh", "mean"]);
        table.row(["bunny".to_owned(), "0.1".to_owned()]);
        assert_eq!(table.markdown(), "| mesh | mean |\n| --- | --: |\n| bunny | 0.1 |\n\n");
    }
}

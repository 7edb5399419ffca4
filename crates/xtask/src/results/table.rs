//! Tables in Markdown.

/// A table with a heading row; the first column is text, the others are figures.
pub struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these headings.
    pub fn new<const N: usize>(headings: [&str; N]) -> Self {
        let rule = (0..N).map(|column| if column == 0 { "---" } else { "--:" }.to_owned());
        Self { rows: vec![headings.map(str::to_owned).to_vec(), rule.collect()] }
    }

    /// Adds a row.
    pub fn row<const N: usize>(&mut self, cells: [String; N]) {
        debug_assert_eq!(N, self.rows[0].len());
        self.rows.push(cells.to_vec());
    }

    /// The table as Markdown, with a blank line behind.
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

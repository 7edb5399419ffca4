//! Tables in plain text.

/// Formats rows as lines: the first column is left-aligned, the others are right-aligned, with two
/// spaces between them. Missing cells are empty.
pub fn aligned<R: AsRef<[String]>>(rows: &[R]) -> String {
    let mut widths = Vec::new();
    for row in rows.iter().map(AsRef::as_ref) {
        widths.resize(widths.len().max(row.len()), 0);
        let wider =
            |(width, cell): (&mut usize, &String)| *width = cell.chars().count().max(*width);
        widths.iter_mut().zip(row).for_each(wider);
    }
    let mut text = String::new();
    for row in rows.iter().map(AsRef::as_ref) {
        let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, width))| {
            if column == 0 { format!("{cell:<width$}") } else { format!("  {cell:>width$}") }
        });
        text.push_str(cells.collect::<String>().trim_end());
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_left_and_numbers_right() {
        let rows = [&["a", "10", "é"][..], &["long", "9"]];
        let rows = rows.map(|row| row.iter().map(|&cell| cell.into()).collect::<Vec<String>>());
        assert_eq!(aligned(&rows), "a     10  é\nlong   9\n");
    }
}

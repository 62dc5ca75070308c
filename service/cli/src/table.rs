//! Plain text tables: columns as wide as their widest cell, figures to the right.

/// Returns the rows under the header, columns two spaces apart; cells that start with a digit stand to the right.
pub fn table(header: &[&str], rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|r| r.get(column)).map(|c| c.chars().count());
        cells.chain([header[column].chars().count()]).max().unwrap_or(0)
    };
    let right = |column: usize| rows.iter().any(|r| r[column].starts_with(|c: char| c.is_ascii_digit()));
    let line = |cells: &mut dyn Iterator<Item = &str>| {
        let mut text = String::new();
        for (column, cell) in cells.enumerate() {
            let pad = " ".repeat(width(column).saturating_sub(cell.chars().count()));
            let gap = if column == 0 { "" } else { "  " };
            text += &if right(column) { format!("{gap}{pad}{cell}") } else { format!("{gap}{cell}{pad}") };
        }
        format!("{}\n", text.trim_end())
    };
    let mut text = line(&mut header.iter().copied());
    for row in rows {
        text += &line(&mut row.iter().map(String::as_str));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        let rows = vec![vec!["ward".into(), "8".into()], vec!["long_name".into(), "12".into()]];
        assert_eq!(table(&["world", "rooms"], &rows), "world      rooms\nward           8\nlong_name     12\n");
    }
}

//! Tables in Markdown.

/// A heading and rows, cells apart by ` | `.
pub(crate) struct Table(Vec<String>);

impl Table {
    pub(crate) fn new(heading: &str) -> Self {
        let columns = heading.split('|').count();
        Self(vec![format!("| {heading} |"), format!("|{}", "---|".repeat(columns))])
    }

    pub(crate) fn row(&mut self, cells: &str) {
        self.0.push(format!("| {cells} |"));
    }

    pub(crate) fn text(&self) -> String {
        self.0.join("\n")
    }
}

/// A number with the digits that its size is worth.
pub(crate) fn short(value: f64) -> String {
    match value.abs() {
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 1.0 => format!("{value:.1}"),
        _ => format!("{value:.4}"),
    }
}

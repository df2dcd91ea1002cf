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

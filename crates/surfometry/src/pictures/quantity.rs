//! What a picture shows.

use super::ticks::typeset_unit;

/// A quantity's name and unit, as they stand at colour bars and axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quantity<'a> {
    /// Name, such as `Mean curvature H`.
    pub name: &'a str,
    /// Unit, such as `1/mm` or `1/mm^2`, which is printed as mm⁻¹, mm⁻²; empty for a pure number.
    pub unit: &'a str,
}

impl Quantity<'_> {
    /// Name with the unit in brackets.
    pub(crate) fn label(&self) -> String {
        if self.unit.is_empty() { self.name.to_owned() } else { format!("{} ({})", self.name, self.unit()) }
    }

    /// The unit as printed.
    pub(crate) fn unit(&self) -> String {
        typeset_unit(self.unit)
    }
}

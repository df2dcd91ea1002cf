//! Derivatives where the image's axes are not perpendicular.

use super::{BandVoxels, Differentiation, FieldBlock, Jet};
use crate::tiling::IndexBox;
use crate::volume::{Grid, Shear};

/// A scheme whose derivatives are those along perpendicular axes, also where the image's are not: the chain rule, which has no
/// error of its own, once for all that is integrated, mapped or shown. Where they are, it is the scheme.
#[derive(Debug)]
pub(crate) struct Unsheared<D> {
    scheme: D,
    shear: Option<Shear>,
}

impl<D: Differentiation> Unsheared<D> {
    /// Of a scheme whose derivatives are along the axes of a grid.
    pub(crate) fn new(scheme: D, grid: &Grid) -> Self {
        Self { scheme, shear: grid.shear() }
    }

    fn unsheared(&self, jets: Vec<Jet>) -> Vec<Jet> {
        match &self.shear {
            None => jets,
            Some(shear) => jets.iter().map(|jet| jet.unsheared(shear)).collect(),
        }
    }
}

impl<D: Differentiation> Differentiation for Unsheared<D> {
    type Field = D::Field;

    fn embedding(&self) -> &Self::Field {
        self.scheme.embedding()
    }

    fn field_region(&self, tile: &IndexBox) -> IndexBox {
        self.scheme.field_region(tile)
    }

    fn visit_band(
        &self,
        field: &FieldBlock<Self>,
        tile: &IndexBox,
        half_width: f64,
        visit: &mut dyn FnMut(&BandVoxels),
    ) {
        match &self.shear {
            None => self.scheme.visit_band(field, tile, half_width, visit),
            Some(shear) => self.scheme.visit_band(field, tile, half_width, &mut |band| {
                visit(&band.with_jets(|jet| jet.unsheared(shear)));
            }),
        }
    }

    fn jets_at(&self, field: &FieldBlock<Self>, points: &[[f64; 3]]) -> Vec<Jet> {
        self.unsheared(self.scheme.jets_at(field, points))
    }

    fn jets(&self, points: &[[f64; 3]]) -> Vec<Jet> {
        self.unsheared(self.scheme.jets(points))
    }
}

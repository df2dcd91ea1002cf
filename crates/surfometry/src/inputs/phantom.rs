//! Built-in shapes.

use super::slabs::Reader;
use super::{HeaderFacts, InputError, OpenOptions, Slabs, Source};
use crate::accuracy::{Flag, FlagCode};
use crate::phantoms::{Phantom, Truth};
use crate::volume::Grid;

/// A built-in shape with its exact integrals.
pub(super) struct PhantomSource {
    phantom: Phantom,
    truth: Option<Truth>,
}

impl PhantomSource {
    pub(super) fn open(spec: &str, options: &OpenOptions) -> Result<Self, InputError> {
        let phantom = Phantom::from_spec_at(spec, options.spacing)?;
        let truth = phantom.truth();
        Ok(Self { phantom, truth })
    }
}

impl Source for PhantomSource {
    fn grid(&self) -> &Grid {
        self.phantom.grid()
    }

    fn slabs(&self) -> Result<Slabs<'_>, InputError> {
        Ok(Box::new(Reader(self.phantom.slabs())))
    }

    fn is_object(&self) -> bool {
        true
    }

    fn header(&self) -> HeaderFacts {
        HeaderFacts { format: "phantom", voxel_type: "uint8" }
    }

    fn truth(&self) -> Option<Truth> {
        self.truth
    }

    fn flags(&self) -> Vec<Flag> {
        let unknown =
            "the phantom's exact integrals did not converge: the shape is too fine for its period and size";
        let flag = self.truth.is_none().then(|| Flag::new(FlagCode::TruthNotConverged, unknown));
        flag.into_iter().collect()
    }
}

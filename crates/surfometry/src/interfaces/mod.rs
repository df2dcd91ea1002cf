//! Areas of contact between the labels of an image, from counts of pairs of voxels.
//!
//! Displacements d between two voxels cross a flat face of area A as often as |d . n| A has voxels; so a sum over
//! displacements with the right weights is its area (Crofton's formula, on a lattice). Of many displacements, up to five
//! voxels long, the weights can be such that faces of any direction count alike, that what a face loses or gains at its rim,
//! which grows with the square of the length, cancels, and that curvature, which goes with the cube, does as well
//! (`weights`). Nothing is blurred: faces keep their whole area up to the lines where three labels meet.

mod contrast;
mod counting;
mod weights;

pub(crate) use contrast::Contrast;
pub(crate) use counting::{Contact, Contacts};
pub(crate) use weights::PairWeights;

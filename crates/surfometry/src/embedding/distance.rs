//! The baseline that the paper rejects: the signed Euclidean distance.

use super::Embedding;
use crate::tiling::{Block, IndexBox};
use crate::volume::Mask;

/// Voxels that differences reach: two beyond a band voxel, three for the polynomial around a vertex.
const STENCIL_REACH: f64 = 3.0;

/// Signed Euclidean distance from each voxel centre to the nearest voxel *face* between object and
/// background, in mm, negative inside.
///
/// Distances to faces, not to voxel centres, place the surface where the mask's is (a difference of two
/// centre-to-centre transforms jumps from -h to +h and loses most of the area). The values are quantised, so
/// curvature from this field is noise and its Euler characteristic meaningless: that is the paper's point,
/// and the reason to use [`super::GaussianEmbedding`] instead.
///
/// [`DistanceEmbedding::to_boundary_voxels`] is the other form that is in use.
#[derive(Debug)]
pub struct DistanceEmbedding<'a> {
    mask: &'a Mask,
    spacing: [f64; 3],
    zero: Zero,
}

/// Where the distance is 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Zero {
    Faces,
    BoundaryVoxels,
}

impl<'a> DistanceEmbedding<'a> {
    /// The embedding of a mask.
    pub fn new(mask: &'a Mask) -> Self {
        Self { mask, spacing: mask.grid().spacing().mm(), zero: Zero::Faces }
    }

    /// The distance between voxel centres, 0 on the object's voxels that touch the background (26
    /// neighbours), as ITK's `SignedMaurerDistanceMapImageFilter` has it by default: its surface lies half a
    /// voxel inside the mask's.
    pub fn to_boundary_voxels(mask: &'a Mask) -> Self {
        Self { zero: Zero::BoundaryVoxels, ..Self::new(mask) }
    }

    /// Writes the distances of the voxels of `phi`'s region, which lies as far inside `padded` as they reach.
    fn fill(&self, phi: &mut Block<f64>, padded: &IndexBox, reach: f64) {
        let region = phi.region();
        let all = |of: &dyn Fn([i64; 3]) -> bool, gap: f64| distances(of, padded, self.spacing, gap);
        let inside = |index: [i64; 3]| self.mask.get(index);
        match self.zero {
            Zero::Faces => {
                let to_object = all(&inside, HALF_VOXEL);
                let to_background = all(&|index| !inside(index), HALF_VOXEL);
                for (y, z) in region.rows() {
                    let start = to_object.offset([region.lower[0], y, z]);
                    let pairs = to_object.values()[start..].iter().zip(&to_background.values()[start..]);
                    for (p, (&outside, &inside)) in phi.row_mut(y, z).iter_mut().zip(pairs) {
                        *p = libm::sqrt(outside).min(reach) - libm::sqrt(inside).min(reach);
                    }
                }
            }
            Zero::BoundaryVoxels => {
                let neighbours = |index: [i64; 3]| IndexBox::voxel(index).grown([1; 3]);
                let boundary = |index| inside(index) && self.mask.uniform_in(&neighbours(index)).is_none();
                let to_boundary = all(&boundary, 0.0);
                for (y, z) in region.rows() {
                    let values = &to_boundary.values()[to_boundary.offset([region.lower[0], y, z])..];
                    for ((p, &square), x) in phi.row_mut(y, z).iter_mut().zip(values).zip(region.lower[0]..) {
                        let distance = libm::sqrt(square).min(reach);
                        *p = if inside([x, y, z]) { -distance } else { distance };
                    }
                }
            }
        }
    }

    /// Distance up to which values must be exact so that every stencil at a band voxel is.
    fn reach(&self, half_width: f64) -> f64 {
        let [x, y, z] = self.spacing.map(|h| h * STENCIL_REACH);
        half_width + libm::sqrt(x * x + y * y + z * z)
    }
}

impl Embedding for DistanceEmbedding<'_> {
    type Value = f64;

    fn halo(&self, half_width: f64) -> [i64; 3] {
        self.spacing.map(|h| (self.reach(half_width) / h).ceil() as i64 + 1)
    }

    fn support(&self, half_width: f64) -> IndexBox {
        self.mask.bounds().grown(self.halo(half_width))
    }

    /// Distances beyond `half_width` and a stencil's reach are cut off there.
    fn evaluate_in(&self, storage: Vec<f64>, region: &IndexBox, half_width: f64) -> Block<f64> {
        let reach = self.reach(half_width);
        let padded = region.grown(self.halo(half_width));
        let mut phi = Block::reusing(storage, *region, 0.0);
        self.fill(&mut phi, &padded, reach);
        phi
    }

    fn constant_on(&self, region: &IndexBox, half_width: f64) -> Option<f64> {
        let inside = self.mask.uniform_in(&region.grown(self.halo(half_width)))?;
        let reach = self.reach(half_width);
        Some(if inside { -reach } else { reach })
    }
}

/// From a voxel's centre to its face, in voxels.
const HALF_VOXEL: f64 = 0.5;

/// Squared distance in mm^2 from every voxel centre of a box to the nearest voxel that is one `of` some
/// inside that box, as far as `gap` voxels from its centre along each axis (its cube with 1/2, its centre
/// with 0); 0 in those, infinite where the box holds none.
///
/// The squared distance to a cube is a sum over axes of max(|n| - gap, 0)^2 h^2, so one pass along each axis
/// does it.
fn distances(of: &dyn Fn([i64; 3]) -> bool, region: &IndexBox, spacing: [f64; 3], gap: f64) -> Block<f64> {
    let mut squares = Block::filled(*region, f64::INFINITY);
    for (y, z) in region.rows() {
        for (x, value) in (region.lower[0]..).zip(squares.row_mut(y, z)) {
            if of([x, y, z]) {
                *value = 0.0;
            }
        }
    }
    let [nx, ny, nz] = region.extent();
    let strides = [1, nx, nx * ny];
    for axis in 0..3 {
        let (stride, length) = (strides[axis], [nx, ny, nz][axis]);
        let starts = (0..nx * ny * nz).filter(|i| i / stride % length == 0);
        let mut line = vec![0.0; length];
        for start in starts {
            let values = squares.values_mut();
            (0..length).for_each(|i| line[i] = values[start + i * stride]);
            for (i, value) in lower_envelope(&line, spacing[axis], gap).into_iter().enumerate() {
                values[start + i * stride] = value;
            }
        }
    }
    squares
}

/// min over q of line\[q\] + max(|p - q| - gap, 0)^2 h^2 for every p.
///
/// The cost is convex in p - q, so the best q never decreases with p: divide and conquer finds all of them in
/// O(n log n) (the row minima of a Monge matrix).
fn lower_envelope(line: &[f64], spacing: f64, gap: f64) -> Vec<f64> {
    let sources: Vec<usize> = (0..line.len()).filter(|&q| line[q].is_finite()).collect();
    let mut best = vec![f64::INFINITY; line.len()];
    if sources.is_empty() {
        return best;
    }
    let cost = |p: usize, q: usize| {
        let apart = (p.abs_diff(q) as f64 - gap).max(0.0) * spacing;
        line[q] + apart * apart
    };
    let mut work = vec![(0, line.len(), 0, sources.len() - 1)];
    while let Some((from, to, first, last)) = work.pop() {
        if from >= to {
            continue;
        }
        let p = usize::midpoint(from, to);
        let mut argmin = first;
        for (s, &source) in sources.iter().enumerate().take(last + 1).skip(first) {
            let candidate = cost(p, source);
            if candidate < best[p] {
                (best[p], argmin) = (candidate, s);
            }
        }
        work.push((from, p, first, argmin));
        work.push((p + 1, to, argmin, last));
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::Grid;

    /// Distance from a point to a box, the definition.
    fn to_cube(p: [i64; 3], q: [i64; 3], h: [f64; 3]) -> f64 {
        (0..3).map(|a| (((p[a] - q[a]).abs() as f64 - 0.5).max(0.0) * h[a]).powi(2)).sum::<f64>().sqrt()
    }

    #[test]
    fn equals_brute_force_on_anisotropic_noise() {
        let spacing = [0.7, 1.0, 2.3];
        let grid = Grid::axis_aligned([9, 8, 7], spacing).unwrap();
        let inside = |[x, y, z]: [usize; 3]| (x * 7 + y * 13 + z * 29 + x * y * z) % 5 < 2;
        let mask = Mask::from_predicate(grid, inside);
        let embedding = DistanceEmbedding::new(&mask);
        let region = grid.index_box().grown([2; 3]);
        let phi = embedding.evaluate(&region, 3.0);
        let all: Vec<[i64; 3]> =
            region.grown([9; 3]).rows().flat_map(|(y, z)| (-11..20).map(move |x| [x, y, z])).collect();
        for (y, z) in region.rows() {
            for x in region.lower[0]..region.upper[0] {
                let p = [x, y, z];
                let phase = mask.get(p);
                let nearest = all.iter().filter(|q| mask.get(**q) != phase).map(|&q| to_cube(p, q, spacing));
                let distance = nearest.fold(embedding.reach(3.0), f64::min);
                let signed = if phase { -distance } else { distance };
                assert!((phi.get(p) - signed).abs() < 1e-12, "{p:?}: {} {signed}", phi.get(p));
            }
        }
    }
}

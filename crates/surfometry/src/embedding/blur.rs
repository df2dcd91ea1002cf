//! The blurred indicator on a box.

use super::kernel::GaussianKernel;
use super::{Indicator, Row};
use crate::tiling::{IndexBox, Pool};
use crate::vectors;
use fearless_simd::{dispatch, f32x16, prelude::*};

/// Voxels that are computed together.
const LANES: usize = 16;

/// G_sigma * I in three passes: along x from the ends of the rows' runs of ones, what is in a row beside
/// them, and along y and z, by pairs of voxels at equal distance.
///
/// A row whose neighbourhood is all outside or all inside is 0 or 1 without being convolved. It would come
/// out as exactly that, because the taps add up to 1 in the order in which they are added: so a voxel's value
/// does not depend on the box that was asked for, and 0 and 1 are exact far from the surface. Multiplications
/// are fused with additions, or come out as if they were: all machines give the same bits.
#[derive(Debug)]
pub(crate) struct Blur {
    x: RowKernel,
    /// Taps from the centre outward.
    y: Vec<f32>,
    z: Vec<f32>,
    work: Pool<Work>,
}

/// Slices that are convolved along z together.
const BATCH: usize = 8;

/// Rows of one slice convolved along x, and slices convolved along x and y.
#[derive(Debug, Default)]
struct Work {
    /// What a row is before it is convolved, and what its amounts become.
    row: Row,
    amounts: Vec<f32>,
    rows: Rows,
    /// Values by row, then slice; kinds by slice, then row.
    ring: Rows,
    /// What the rows of some slices that come out are.
    slice_kinds: Vec<Kind>,
    /// Where in `rows` and `ring` lies what a row comes from, in the order of the taps.
    row_starts: Vec<usize>,
    slice_starts: Vec<usize>,
}

/// Rows, of one slice or several, those that are all 0 or all 1 marked.
#[derive(Debug, Default)]
struct Rows {
    values: Vec<f32>,
    kinds: Vec<Kind>,
}

/// What a row is, as bits: those that several rows share say what all of them are.
type Kind = u8;
const MIXED: Kind = 0;
const ZERO: Kind = 1;
const ONE: Kind = 2;

/// The value of all of a row's voxels.
fn constant(kind: Kind) -> Option<f32> {
    match kind {
        ZERO => Some(0.0),
        ONE => Some(1.0),
        _ => None,
    }
}

impl Blur {
    /// A blur of sigma and spacing in the same unit, cut at `truncation` sigma.
    pub(crate) fn new(sigma: f64, spacing: [f64; 3], truncation: f64) -> Self {
        let kernel = |axis: usize| GaussianKernel::new(sigma, spacing[axis], 0, truncation);
        Self {
            x: RowKernel::new(&kernel(0)),
            y: half_taps(&kernel(1)),
            z: half_taps(&kernel(2)),
            work: Pool::default(),
        }
    }

    /// Voxels that a value depends on, on each side.
    pub(crate) fn halo(&self) -> [i64; 3] {
        [self.x.radius(), self.y.len() as i64 - 1, self.z.len() as i64 - 1]
    }

    /// Sets `phi`, the values on a box, to a level less the blurred indicator.
    pub(crate) fn subtract_from(
        &self,
        level: f32,
        indicator: &dyn Indicator,
        region: &IndexBox,
        phi: &mut [f32],
    ) {
        self.work.with(|work| {
            dispatch!(vectors::level(), simd => self.run(simd, (level, indicator), region, work, phi));
        });
    }

    #[inline(always)]
    fn run<S: Simd>(
        &self,
        simd: S,
        (level, indicator): (f32, &dyn Indicator),
        region: &IndexBox,
        work: &mut Work,
        phi: &mut [f32],
    ) {
        let [row_length, ny, nz] = region.extent();
        let (nx, plane) = (row_length.next_multiple_of(LANES), row_length * ny);
        let Work { row, amounts, rows, ring, slice_kinds, row_starts, slice_starts } = work;
        let halo = 2 * (self.z.len() - 1);
        let length = halo + BATCH;
        // One more than there are outputs for, where they are made in pairs.
        rows.resize(nx, ny + 2 * (self.y.len() - 1) + 1);
        ring.resize(nx, ny * length);
        slice_kinds.resize(BATCH * ny, ZERO);
        row_starts.clear();
        row_starts.extend((0..2 * self.y.len()).map(|offset| offset * nx));
        let mut made = 0;
        for first in (0..nz).step_by(BATCH) {
            let count = BATCH.min(nz - first);
            // Slice number n of the halo and the box lies in the ring at n modulo its length, beside those of
            // the same row.
            for number in made..first + count + halo {
                let radii = [0, self.y.len() as i64 - 1, self.z.len() as i64 - 1 - number as i64];
                let first = std::array::from_fn(|a| region.lower[a] - radii[a]);
                self.x.convolve_rows(simd, indicator, first, (&mut *row, &mut *amounts), rows);
                let slot = number % length;
                let kinds = &mut ring.kinds[slot * ny..][..ny];
                common_kinds(kinds, (0..self.y.len() * 2 - 1).map(|offset| &rows.kinds[offset..]));
                // Rows of neighbouring y lie a ring apart.
                for y in (0..ny).step_by(2) {
                    let (first, others) = ring.values[(y * length + slot) * nx..].split_at_mut(nx);
                    let second = others.get_mut((length - 1) * nx..).and_then(|rest| rest.get_mut(..nx));
                    let pair_kinds = [kinds[y], kinds.get(y + 1).copied().unwrap_or(ZERO)];
                    let values = &rows.values[y * nx..];
                    let terms = Terms { taps: &self.y, values, starts: row_starts, minuend: None };
                    convolve(simd, terms, pair_kinds, [first, second.unwrap_or(&mut [])]);
                }
            }
            made = first + count + halo;
            slice_starts.clear();
            slice_starts.extend((first..made).map(|number| number % length * nx));
            for (slice, kinds) in slice_kinds.chunks_exact_mut(ny).enumerate().take(count) {
                let from = |number: usize| &ring.kinds[number % length * ny..];
                common_kinds(kinds, (first + slice..=first + slice + halo).map(from));
            }
            let phi = &mut phi[first * plane..][..count * plane];
            for y in 0..ny {
                let values = &ring.values[y * length * nx..][..length * nx];
                for slice in (0..count).step_by(2) {
                    let (first, others) = phi[slice * plane + y * row_length..].split_at_mut(row_length);
                    let second =
                        others.get_mut(plane - row_length..).and_then(|rest| rest.get_mut(..row_length));
                    let kind_of =
                        |slice: usize| if slice < count { slice_kinds[slice * ny + y] } else { ZERO };
                    let starts = &slice_starts[slice..];
                    let terms = Terms { taps: &self.z, values, starts, minuend: Some(level) };
                    let pair_kinds = [kind_of(slice), kind_of(slice + 1)];
                    convolve(simd, terms, pair_kinds, [first, second.unwrap_or(&mut [])]);
                }
            }
        }
    }
}

impl Rows {
    fn resize(&mut self, nx: usize, ny: usize) {
        self.values.resize(nx * ny, 0.0);
        self.kinds.resize(ny, ZERO);
    }
}

/// Taps from the centre outward, in f32, that add up to exactly 1 as [`convolve`] adds them, the centre's
/// last: it is what the others leave of 1, which the last sum rounds to 1 whatever was rounded before.
pub(super) fn half_taps(kernel: &GaussianKernel) -> Vec<f32> {
    let mut taps: Vec<f32> = kernel.taps()[kernel.radius()..].iter().map(|&tap| tap as f32).collect();
    taps[0] = 1.0 - taps[1..].iter().rev().fold(0.0, |sum, tap| sum + tap * 2.0);
    taps
}

/// What each row is whose neighbours, as far as the kernel reaches, are these.
#[inline(always)]
fn common_kinds<'a>(out: &mut [Kind], neighbours: impl Iterator<Item = &'a [Kind]>) {
    out.fill(ZERO | ONE);
    for kinds in neighbours {
        for (common, kind) in out.iter_mut().zip(kinds) {
            *common &= kind;
        }
    }
}

/// What a row is the sum of: taps times the rows that begin at `starts`, from the farthest before to the
/// farthest behind.
#[derive(Clone, Copy)]
struct Terms<'a> {
    /// From the centre outward.
    taps: &'a [f32],
    values: &'a [f32],
    starts: &'a [usize],
    /// What the sum is taken from, if from anything.
    minuend: Option<f32>,
}

impl<'a> Terms<'a> {
    /// Those of the next row.
    #[inline(always)]
    fn next(self) -> Self {
        Self { starts: &self.starts[1..], ..self }
    }

    #[inline(always)]
    fn fill(self, kind: Kind, row: &mut [f32]) {
        if let Some(value) = constant(kind) {
            row.fill(self.minuend.map_or(value, |minuend| minuend - value));
        }
    }

    /// Stores a group of lanes of a row, or what of it lies in the row.
    #[inline(always)]
    fn store<S: Simd>(self, simd: S, sum: f32x16<S>, row: &mut [f32], at: usize) {
        let values = match self.minuend {
            Some(minuend) => f32x16::splat(simd, minuend) - sum,
            None => sum,
        };
        let row = &mut row[at..];
        if row.len() < LANES {
            row.copy_from_slice(&values.to_array()[..row.len()]);
        } else {
            values.store_slice(&mut row[..LANES]);
        }
    }

    /// `N` groups of lanes of a row, from `from` on.
    #[inline(always)]
    fn piece<const N: usize>(self, row: usize, from: usize) -> &'a [f32] {
        &self.values[self.starts[row] + from..][..N * LANES]
    }
}

/// Two neighbouring rows. Those that are known to be constant are filled.
#[inline(always)]
fn convolve<S: Simd>(simd: S, terms: Terms<'_>, kinds: [Kind; 2], [first, second]: [&mut [f32]; 2]) {
    let length = first.len();
    let both = kinds == [MIXED; 2];
    terms.fill(kinds[0], first);
    terms.fill(kinds[1], second);
    let mut from = 0;
    while from < length {
        // Several groups at once, because each waits for its own sum. (No closures here: they would not be
        // compiled for the vectors.)
        let left = (length - from).div_ceil(LANES);
        let groups = if both && <S::f32s as SimdBase<S>>::LEN < LANES {
            // Half as many registers of half the width: two rows of one group fill them.
            1
        } else if left == 4 {
            2
        } else {
            left.min(3)
        };
        match (both, groups) {
            (true, 1) => convolve_pair::<1, S>(simd, terms, from, first, second),
            (true, 2) => convolve_pair::<2, S>(simd, terms, from, first, second),
            (true, _) => convolve_pair::<3, S>(simd, terms, from, first, second),
            (false, _) => {
                if kinds[0] == MIXED {
                    convolve_some(simd, terms, from, groups, first);
                }
                if kinds[1] == MIXED {
                    convolve_some(simd, terms.next(), from, groups, second);
                }
            }
        }
        from += groups * LANES;
    }
}

#[inline(always)]
fn convolve_some<S: Simd>(simd: S, terms: Terms<'_>, from: usize, groups: usize, out: &mut [f32]) {
    match groups {
        1 => convolve_groups::<1, S>(simd, terms, from, out),
        2 => convolve_groups::<2, S>(simd, terms, from, out),
        _ => convolve_groups::<3, S>(simd, terms, from, out),
    }
}

/// `N` groups of lanes from `from` on.
#[inline(always)]
fn convolve_groups<const N: usize, S: Simd>(simd: S, terms: Terms<'_>, from: usize, out: &mut [f32]) {
    let radius = terms.taps.len() - 1;
    let mut sums = [f32x16::splat(simd, 0.0); N];
    for distance in (1..=radius).rev() {
        let before = terms.piece::<N>(radius - distance, from);
        let behind = terms.piece::<N>(radius + distance, from);
        let tap = f32x16::splat(simd, terms.taps[distance]);
        for group in 0..N {
            let both = lanes(simd, before, group) + lanes(simd, behind, group);
            sums[group] = both.mul_add_precise(tap, sums[group]);
        }
    }
    let centre = terms.piece::<N>(radius, from);
    for group in 0..N {
        let sum = lanes(simd, centre, group).mul_add_precise(terms.taps[0], sums[group]);
        terms.store(simd, sum, out, from + group * LANES);
    }
}

/// The same of two neighbouring rows at once: what is loaded for one serves the other a step later.
#[inline(always)]
fn convolve_pair<const N: usize, S: Simd>(
    simd: S,
    terms: Terms<'_>,
    from: usize,
    first: &mut [f32],
    second: &mut [f32],
) {
    let radius = terms.taps.len() - 1;
    let mut sums = [[f32x16::splat(simd, 0.0); N]; 2];
    // Before the first row at a distance, which is one nearer than before the second; behind the second, one
    // farther than behind the first.
    let (mut before, mut behind) = ([f32x16::splat(simd, 0.0); N], [f32x16::splat(simd, 0.0); N]);
    let (farthest, behind_all) = (terms.piece::<N>(0, from), terms.piece::<N>(2 * radius + 1, from));
    for group in 0..N {
        before[group] = lanes(simd, farthest, group);
        behind[group] = lanes(simd, behind_all, group);
    }
    for distance in (1..=radius).rev() {
        let nearer_before = terms.piece::<N>(radius + 1 - distance, from);
        let nearer_behind = terms.piece::<N>(radius + distance, from);
        let tap = f32x16::splat(simd, terms.taps[distance]);
        for group in 0..N {
            let (a, b) = (lanes(simd, nearer_before, group), lanes(simd, nearer_behind, group));
            sums[0][group] = (before[group] + b).mul_add_precise(tap, sums[0][group]);
            sums[1][group] = (a + behind[group]).mul_add_precise(tap, sums[1][group]);
            (before[group], behind[group]) = (a, b);
        }
    }
    for group in 0..N {
        let centre = before[group].mul_add_precise(terms.taps[0], sums[0][group]);
        let next = behind[group].mul_add_precise(terms.taps[0], sums[1][group]);
        terms.store(simd, centre, first, from + group * LANES);
        terms.store(simd, next, second, from + group * LANES);
    }
}

#[inline(always)]
fn lanes<S: Simd>(simd: S, values: &[f32], group: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &values[group * LANES..][..LANES])
}

/// A kernel along x.
#[derive(Debug)]
struct RowKernel {
    step: StepResponse,
    /// From the centre outward, for amounts that are no runs of ones; and where in a row of them a voxel's
    /// neighbours begin, from the farthest before on.
    taps: Vec<f32>,
    starts: Vec<usize>,
}

impl RowKernel {
    fn new(kernel: &GaussianKernel) -> Self {
        let starts = (0..=2 * kernel.radius()).collect();
        Self { step: StepResponse::new(kernel), taps: half_taps(kernel), starts }
    }

    fn radius(&self) -> i64 {
        self.step.radius
    }

    /// Rows of slice z convolved along x, from the one at y0 on, each from x0 on.
    #[inline(always)]
    fn convolve_rows<S: Simd>(
        &self,
        simd: S,
        indicator: &dyn Indicator,
        [x0, y0, z]: [i64; 3],
        (row, amounts): (&mut Row, &mut Vec<f32>),
        rows: &mut Rows,
    ) {
        let nx = rows.values.len() / rows.kinds.len();
        let span = (x0 - self.radius(), x0 + nx as i64 + self.radius());
        for ((y, out), kind) in (y0..).zip(rows.values.chunks_exact_mut(nx)).zip(&mut rows.kinds) {
            row.clear(span);
            indicator.read_row(y, z, row);
            *kind = match row.uniform() {
                Some(false) => ZERO,
                Some(true) => ONE,
                None => MIXED,
            };
            if let Some(value) = constant(*kind) {
                out.fill(value);
                continue;
            }
            self.step.convolve(simd, row.edges(), x0, out);
            if !row.amounts().is_empty() {
                amounts.resize(nx, 0.0);
                let terms =
                    Terms { taps: &self.taps, values: row.amounts(), starts: &self.starts, minuend: None };
                convolve(simd, terms, [MIXED, ZERO], [&mut *amounts, &mut []]);
                for (value, amount) in out.iter_mut().zip(amounts.iter()) {
                    *value += amount;
                }
            }
        }
    }
}

/// What a kernel makes of the start of a run of ones without end.
#[derive(Debug)]
struct StepResponse {
    radius: i64,
    /// Zeros, a group of lanes; then the values at the voxels from the radius before the run's first voxel
    /// on; then ones.
    rise: Vec<f32>,
}

impl StepResponse {
    fn new(kernel: &GaussianKernel) -> Self {
        let mut rise = vec![0.0; LANES];
        let mut sum = 0.0;
        for tap in &kernel.taps()[..2 * kernel.radius()] {
            sum += tap;
            rise.push(sum as f32);
        }
        rise.resize(rise.len() + LANES, 1.0);
        Self { radius: kernel.radius() as i64, rise }
    }

    /// A row as the convolution of the runs that start and end at `edges`, in turn; the row begins at `x0`.
    /// They ascend: then those that ended out of reach leave exactly 0, and a value does not depend on where
    /// the row starts.
    #[inline(always)]
    fn convolve<S: Simd>(&self, simd: S, edges: &[i64], x0: i64, row: &mut [f32]) {
        let last = (self.rise.len() - LANES) as i64;
        for (group, out) in row.chunks_exact_mut(LANES).enumerate() {
            let place = x0 + (group * LANES) as i64 + self.radius + LANES as i64;
            let mut sum = f32x16::splat(simd, 0.0);
            for run in edges.chunks_exact(2) {
                let rise = |edge: i64| (place - edge).clamp(0, last) as usize;
                sum += f32x16::from_slice(simd, &self.rise[rise(run[0])..][..LANES]);
                sum -= f32x16::from_slice(simd, &self.rise[rise(run[1])..][..LANES]);
            }
            sum.store_slice(out);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::{Grid, Mask};

    fn noise(dimensions: [usize; 3]) -> Mask {
        let grid = Grid::axis_aligned(dimensions, [1.0; 3]).unwrap();
        Mask::from_predicate(grid, |[x, y, z]| (x * x + 7 * y + z * z * y + x * z) % 11 < 5 && x > 3)
    }

    fn blurred(blur: &Blur, mask: &Mask, region: &IndexBox) -> Vec<f32> {
        let mut values = vec![f32::NAN; region.voxels()];
        blur.subtract_from(0.0, mask, region, &mut values);
        values.into_iter().map(|value| -value).collect()
    }

    /// The definition, in f64.
    #[test]
    fn is_the_sum_over_voxels_times_taps() {
        let mask = noise([40, 17, 13]);
        let spacing = [0.7, 1.0, 1.6];
        let blur = Blur::new(1.3, spacing, 5.0);
        let region = IndexBox::new([-9, -3, 2], [23, 6, 9]);
        let taps = spacing.map(|h| GaussianKernel::new(1.3, h, 0, 5.0));
        let radius = taps.each_ref().map(|t| t.radius() as i64);
        let values = blurred(&blur, &mask, &region);
        for (number, &value) in values.iter().enumerate() {
            let at = Grid::axis_aligned(region.extent(), [1.0; 3]).unwrap().index_of(number);
            let at: [i64; 3] = std::array::from_fn(|a| region.lower[a] + at[a] as i64);
            let mut sum = 0.0;
            for k in -radius[2]..=radius[2] {
                for j in -radius[1]..=radius[1] {
                    for i in -radius[0]..=radius[0] {
                        if mask.get([at[0] - i, at[1] - j, at[2] - k]) {
                            let tap = |a: usize, n: i64| taps[a].taps()[(n + radius[a]) as usize];
                            sum += tap(0, i) * tap(1, j) * tap(2, k);
                        }
                    }
                }
            }
            assert!((f64::from(value) - sum).abs() < 5e-7, "{at:?}: {value} {sum}");
        }
    }

    /// The same bits whatever box is asked for, and exactly 0 and 1 out of reach of the surface.
    #[test]
    fn a_value_does_not_depend_on_the_box() {
        let n = 70;
        let grid = Grid::axis_aligned([n; 3], [1.0; 3]).unwrap();
        let ball = |[x, y, z]: [usize; 3]| {
            let d = |v: usize| (v as f64 - 34.3).powi(2);
            d(x) + d(y) + d(z) < 900.0 && (x + y) % 17 != 0
        };
        let mask = Mask::from_predicate(grid, ball);
        let blur = Blur::new(1.0, [0.5; 3], 5.0);
        let whole = IndexBox::new([-13; 3], [83; 3]);
        let all = blurred(&blur, &mask, &whole);
        let [nx, ny, _] = whole.extent();
        for region in [IndexBox::new([-2, 5, 9], [30, 40, 31]), IndexBox::new([31, 30, 33], [47, 32, 70])] {
            let mut part = blurred(&blur, &mask, &region).into_iter();
            for (y, z) in region.rows() {
                for x in region.lower[0]..region.upper[0] {
                    let [i, j, k] = [x, y, z].map(|v| (v + 13) as usize);
                    assert_eq!(part.next().unwrap().to_bits(), all[(k * ny + j) * nx + i].to_bits());
                }
            }
        }
        assert_eq!(all[0], 0.0);
        let solid = Mask::from_predicate(grid, |_| true);
        let ones = blurred(&blur, &solid, &IndexBox::new([20, 20, 20], [36, 24, 24]));
        assert!(ones.iter().all(|&v| v == 1.0));
    }

    /// Taps add up to exactly 1 at any width.
    #[test]
    fn ones_stay_ones() {
        for sigma in [0.05, 0.2, 0.31, 0.4, 0.5, 0.77, 1.0, 1.3, 2.0, 3.7, 11.0] {
            let taps = half_taps(&GaussianKernel::new(sigma, 1.0, 0, 5.0));
            let (length, nx) = (2 * taps.len(), LANES);
            let starts: Vec<usize> = (0..length).map(|n| n * nx).collect();
            let (mut a, mut b) = (vec![0.0; nx], vec![0.0; nx]);
            let ones = vec![1.0; length * nx];
            dispatch!(vectors::level(), simd => convolve(simd, Terms { taps: &taps, values: &ones, starts: &starts, minuend: None }, [MIXED; 2], [&mut a, &mut b]));
            assert!(a.iter().chain(&b).all(|&v| v == 1.0), "sigma {sigma}");
        }
    }

    /// What the machine's widest vectors give and what its narrowest give are the same bits.
    #[test]
    fn vectors_change_no_bit() {
        let taps = half_taps(&GaussianKernel::new(1.0, 1.2, 0, 5.0));
        let (length, nx) = (2 * taps.len(), 9 * LANES);
        let values: Vec<f32> = (0..length * nx).map(|i| (i * 37 % 101) as f32 / 101.0).collect();
        let starts: Vec<usize> = (0..length).map(|n| n * nx).collect();
        let (mut wide, mut plain) = (vec![0.0; 2 * nx], vec![0.0; 2 * nx]);
        let on = |level: fearless_simd::Level, out: &mut [f32]| {
            let (first, second) = out.split_at_mut(nx);
            dispatch!(level, simd => convolve(simd, Terms { taps: &taps, values: &values, starts: &starts, minuend: None }, [MIXED; 2], [first, second]));
        };
        on(vectors::level(), &mut wide);
        on(fearless_simd::Level::baseline(), &mut plain);
        assert_eq!(wide, plain);
        // Nor does it make a difference whether a row's neighbour is convolved with it.
        let (mut alone, mut other) = (vec![0.0; nx], vec![0.0; nx]);
        dispatch!(vectors::level(), simd => {
            convolve(simd, Terms { taps: &taps, values: &values, starts: &starts, minuend: None }, [MIXED, ONE], [&mut alone, &mut other]);
        });
        assert_eq!(alone, wide[..nx]);
    }
}

//! The blurred indicator on a box, from bits.

use super::kernel::GaussianKernel;
use crate::tiling::{IndexBox, Pool};
use crate::volume::Mask;
use fearless_simd::{Level, dispatch};

/// Voxels that are computed together; rows are a multiple of it long.
pub(crate) const LANES: usize = 16;

/// G_sigma * I in three passes: along x from the ends of the rows' runs, along y and z by pairs of voxels at equal distance.
///
/// A row whose neighbourhood is all outside or all inside is 0 or 1 without being convolved. It would come out as exactly
/// that, because the taps add up to 1 in the order in which they are added: so a voxel's value does not depend on the box that was
/// asked for, and 0 and 1 are exact far from the surface. No fused multiplications: all machines give the same bits.
#[derive(Debug)]
pub(crate) struct Blur {
    x: StepResponse,
    /// Taps from the centre outward.
    y: Vec<f32>,
    z: Vec<f32>,
    work: Pool<Work>,
}

/// Rows convolved along x of one slice, and slices convolved along x and y.
#[derive(Debug, Default)]
struct Work {
    rows: Rows,
    ring: Vec<Rows>,
}

/// Rows of a slice, those that are all 0 or all 1 marked.
#[derive(Debug, Default)]
struct Rows {
    values: Vec<f32>,
    kinds: Vec<Kind>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Zero,
    One,
    Mixed,
}

impl Kind {
    fn value(self) -> Option<f32> {
        match self {
            Self::Zero => Some(0.0),
            Self::One => Some(1.0),
            Self::Mixed => None,
        }
    }
}

impl Blur {
    /// A blur of sigma and spacing in the same unit, cut at `truncation` sigma.
    pub(crate) fn new(sigma: f64, spacing: [f64; 3], truncation: f64) -> Self {
        let kernel = |axis: usize| GaussianKernel::new(sigma, spacing[axis], 0, truncation);
        Self {
            x: StepResponse::new(&kernel(0)),
            y: half_taps(&kernel(1)),
            z: half_taps(&kernel(2)),
            work: Pool::default(),
        }
    }

    /// Blurs a mask on a box whose rows are `LANES` voxels long or a multiple of that. `visit` gets the rows in their order: their values,
    /// or the one value that all of the row's voxels have.
    pub(crate) fn for_each_row(
        &self,
        mask: &Mask,
        region: &IndexBox,
        mut visit: impl FnMut(Result<&[f32], f32>),
    ) {
        let [nx, ny, nz] = region.extent();
        assert_eq!(nx % LANES, 0, "rows of {nx} voxels");
        let radius = self.z.len() - 1;
        let length = 2 * radius + 1;
        let mut out = Rows::default();
        out.resize(nx, ny);
        self.work.with(|Work { rows, ring }| {
            ring.resize_with(length.max(ring.len()), Rows::default);
            // Slice number n of the halo and the box lies in the ring at n modulo its length.
            for number in 0..nz + 2 * radius {
                let z = region.lower[2] - radius as i64 + number as i64;
                self.x_pass(mask, region, z, rows);
                self.y_pass(rows, nx, ny, &mut ring[number % length]);
                let Some(first) = number.checked_sub(2 * radius) else { continue };
                let slices: Vec<&Rows> = (0..length).map(|offset| &ring[(first + offset) % length]).collect();
                dispatch!(Level::new(), _simd => convolve_slice(&self.z, nx, &slices, &mut out));
                for (values, kind) in out.values.chunks(nx).zip(&out.kinds) {
                    visit(kind.value().map_or(Ok(values), Err));
                }
            }
        });
    }

    /// Slice z convolved along x, from the row that lies the radius below the box's to the one that lies it above.
    fn x_pass(&self, mask: &Mask, region: &IndexBox, z: i64, rows: &mut Rows) {
        let radius = (self.y.len() - 1) as i64;
        let nx = region.extent()[0];
        let (x0, x1) = (region.lower[0], region.upper[0]);
        let reach = self.x.radius;
        rows.resize(nx, region.extent()[1] + 2 * radius as usize);
        for (number, y) in (region.lower[1] - radius..region.upper[1] + radius).enumerate() {
            let mut runs = mask.runs_within(y, z, (x0 - reach, x1 + reach)).peekable();
            rows.kinds[number] = match runs.peek() {
                None => Kind::Zero,
                Some(&(a, b)) if a <= x0 - reach && b >= x1 + reach => Kind::One,
                Some(_) => Kind::Mixed,
            };
            let row = &mut rows.values[number * nx..][..nx];
            row.fill(rows.kinds[number].value().unwrap_or(0.0));
            if rows.kinds[number] == Kind::Mixed {
                runs.for_each(|run| self.x.add_run(row, x0, run));
            }
        }
    }

    fn y_pass(&self, rows: &Rows, nx: usize, ny: usize, out: &mut Rows) {
        out.resize(nx, ny);
        dispatch!(Level::new(), _simd => convolve_rows(&self.y, nx, rows, out));
    }
}

impl Rows {
    fn resize(&mut self, nx: usize, ny: usize) {
        self.values.resize(nx * ny, 0.0);
        self.kinds.resize(ny, Kind::Zero);
    }
}

/// What a row is whose neighbours, as far as the kernel reaches, are these.
fn common_kind(mut kinds: impl Iterator<Item = Kind>) -> Kind {
    let first = kinds.next().unwrap_or(Kind::Zero);
    if first != Kind::Mixed && kinds.all(|kind| kind == first) { first } else { Kind::Mixed }
}

/// Taps from the centre outward, in f32, that add up to exactly 1 as [`convolve_row`] adds them.
fn half_taps(kernel: &GaussianKernel) -> Vec<f32> {
    let mut taps: Vec<f32> = kernel.taps()[kernel.radius()..].iter().map(|&tap| tap as f32).collect();
    let sum = |taps: &[f32]| taps[1..].iter().fold(taps[0], |sum, tap| sum + tap * 2.0);
    // The centre's last place is finer than that of the sum, and the others are left as they are.
    while sum(&taps) != 1.0 {
        taps[0] = if sum(&taps) < 1.0 { taps[0].next_up() } else { taps[0].next_down() };
    }
    taps
}

/// Convolves along y: row number n of `out` is centred at row n + radius of `rows`.
#[inline(always)]
fn convolve_rows(taps: &[f32], nx: usize, rows: &Rows, out: &mut Rows) {
    let length = 2 * taps.len() - 1;
    for (y, (values, kind)) in out.values.chunks_exact_mut(nx).zip(&mut out.kinds).enumerate() {
        *kind = common_kind(rows.kinds[y..][..length].iter().copied());
        match kind.value() {
            Some(value) => values.fill(value),
            None => convolve(taps, values, |number| &rows.values[(y + number) * nx..][..nx]),
        }
    }
}

/// Convolves along z, from the slices from the farthest below to the farthest above.
#[inline(always)]
fn convolve_slice(taps: &[f32], nx: usize, slices: &[&Rows], out: &mut Rows) {
    for (y, (values, kind)) in out.values.chunks_exact_mut(nx).zip(&mut out.kinds).enumerate() {
        *kind = common_kind(slices.iter().map(|slice| slice.kinds[y]));
        if *kind == Kind::Mixed {
            convolve(taps, values, |number| &slices[number].values[y * nx..][..nx]);
        }
    }
}

/// out = the sum of taps times rows, `row(number)` being those from the farthest before to the farthest behind.
#[inline(always)]
fn convolve<'a>(taps: &[f32], out: &mut [f32], row: impl Fn(usize) -> &'a [f32]) {
    let radius = taps.len() - 1;
    for (number, chunk) in out.chunks_exact_mut(LANES).enumerate() {
        let lanes = |n: usize| -> &[f32; LANES] {
            row(n)[number * LANES..][..LANES].try_into().expect("rows are as long as `out`")
        };
        let mut sums = lanes(radius).map(|centre| taps[0] * centre);
        for (distance, tap) in taps.iter().enumerate().skip(1) {
            let (before, behind) = (lanes(radius - distance), lanes(radius + distance));
            for lane in 0..LANES {
                sums[lane] += tap * (before[lane] + behind[lane]);
            }
        }
        chunk.copy_from_slice(&sums);
    }
}

/// What a kernel makes of the start of a run of ones without end.
#[derive(Debug)]
struct StepResponse {
    radius: i64,
    /// At the voxels from the radius before the run's first voxel to one less than that behind it; 0 before, 1 behind.
    rise: Vec<f32>,
}

impl StepResponse {
    fn new(kernel: &GaussianKernel) -> Self {
        let taps = &kernel.taps()[..2 * kernel.radius()];
        let mut sum = 0.0;
        let running = |tap: &f64| {
            sum += tap;
            sum as f32
        };
        Self { radius: kernel.radius() as i64, rise: taps.iter().map(running).collect() }
    }

    /// Adds to `row`, whose first voxel is `x0`, the convolution of a run of ones [a, b). Runs come in ascending order: then those that
    /// ended out of reach have left exactly 0, and a value does not depend on where the row starts.
    fn add_run(&self, row: &mut [f32], x0: i64, (a, b): (i64, i64)) {
        let length = row.len() as i64;
        let place = |x: i64| (x - x0).clamp(0, length) as usize;
        self.add_edge(row, x0, a, 1.0);
        row[place(a + self.radius)..place(b + self.radius)].iter_mut().for_each(|value| *value += 1.0);
        self.add_edge(row, x0, b, -1.0);
    }

    fn add_edge(&self, row: &mut [f32], x0: i64, edge: i64, sign: f32) {
        let start = edge - self.radius - x0;
        let skipped = (-start).clamp(0, self.rise.len() as i64) as usize;
        let first = start.clamp(0, row.len() as i64) as usize;
        row[first..].iter_mut().zip(&self.rise[skipped..]).for_each(|(value, rise)| *value += sign * rise);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::Grid;

    fn noise(dimensions: [usize; 3]) -> Mask {
        let grid = Grid::axis_aligned(dimensions, [1.0; 3]).unwrap();
        Mask::from_predicate(grid, |[x, y, z]| (x * x + 7 * y + z * z * y + x * z) % 11 < 5 && x > 3)
    }

    fn blurred(blur: &Blur, mask: &Mask, region: &IndexBox) -> Vec<f32> {
        let mut values = Vec::new();
        blur.for_each_row(mask, region, |row| match row {
            Ok(row) => values.extend(row),
            Err(value) => values.extend(vec![value; region.extent()[0]]),
        });
        values
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

    /// What the machine's widest vectors give and what scalar code gives are the same bits.
    #[test]
    fn vectors_change_no_bit() {
        let rows: Vec<Vec<f32>> =
            (0..9).map(|n| (0..48).map(|i| ((i * 37 + n * 11) % 101) as f32 / 101.0).collect()).collect();
        let taps = half_taps(&GaussianKernel::new(1.0, 1.2, 0, 5.0));
        assert_eq!(2 * taps.len() - 1, rows.len());
        let (mut wide, mut plain) = (vec![0.0; 48], vec![0.0; 48]);
        dispatch!(Level::new(), _simd => convolve(&taps, &mut wide, |n| &rows[n]));
        convolve(&taps, &mut plain, |n| &rows[n]);
        assert_eq!(wide, plain);
    }
}

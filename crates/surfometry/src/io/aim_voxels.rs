//! Voxels of Scanco AIM files that are not stored one by one.

use super::ReadError;
use super::aim::{error, vax_float};
use super::assembled::{AssembleVoxels, Pieces};
use super::packed::PackedStretch;
use std::io::Read;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// How voxels are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coding {
    /// Floats of a VAX.
    VaxFloats,
    /// A byte for 2 x 2 x 2 voxels, bit 4 (z & 1) + 2 (y & 1) + (x & 1); the last byte is the value of those set.
    PackedBits,
    /// Two values, then lengths of runs that have one and the other in turn; 255 is a run of 254 that goes on.
    TwoValuedRuns,
    /// A value and the length of its run, again and again.
    ValuedRuns,
}

/// Where they are.
#[derive(Debug)]
pub(super) struct AimVoxels {
    pub(super) path: PathBuf,
    /// The first of their bytes, in the unpacked file.
    pub(super) at: u64,
    /// How many bytes they take.
    pub(super) size: u64,
    pub(super) coding: Coding,
    pub(super) dimensions: [usize; 3],
    /// Background on either side of an axis that runs leave out.
    pub(super) border: [usize; 3],
    /// Whether the runs' own size has 64 bits.
    pub(super) wide: bool,
}

/// Makes the next piece of the stored bytes; `None` where these end before the voxels do.
type Decode = Box<dyn FnMut(&mut PackedStretch) -> Result<Option<Vec<u8>>, ReadError> + Send>;

impl AimVoxels {
    /// Whether as many bytes as there are can hold the voxels.
    pub(super) fn check(&self) -> Result<(), ReadError> {
        let product =
            |sizes: [usize; 3]| sizes.iter().fold(1u64, |product, &n| product.saturating_mul(n as u64));
        let whole = self.dimensions;
        let fits = match self.coding {
            Coding::VaxFloats => self.size == product(whole).saturating_mul(4),
            Coding::PackedBits => self.size == product(whole.map(|n| n.div_ceil(2))).saturating_add(1),
            Coding::TwoValuedRuns | Coding::ValuedRuns => {
                product(self.inner()) <= self.size.saturating_mul(255)
            }
        };
        fits.then_some(()).ok_or_else(|| {
            error(format!(
                "{} bytes of voxels cannot be those of dim {whole:?}; copy or export the file again",
                self.size
            ))
        })
    }

    /// Dimensions without the border.
    fn inner(&self) -> [usize; 3] {
        std::array::from_fn(|a| self.dimensions[a] - 2 * self.border[a])
    }

    fn stored(&self) -> Result<PackedStretch, ReadError> {
        PackedStretch::open(&self.path, self.at, self.size)
    }

    fn floats(&self) -> Decode {
        let [nx, ny, nz] = self.dimensions;
        let mut left = nz;
        Box::new(move |stored| {
            if left == 0 {
                return Ok(None);
            }
            left -= 1;
            let Some(mut slice) = stored.bytes(nx * ny * 4)? else { return Ok(None) };
            for value in slice.chunks_exact_mut(4) {
                let ieee = vax_float([value[0], value[1], value[2], value[3]]);
                value.copy_from_slice(&ieee.to_le_bytes());
            }
            Ok(Some(slice))
        })
    }

    /// Two slices a piece; the value of the bits that are set stands behind them all.
    fn bits(&self) -> Result<Decode, ReadError> {
        let mut whole = self.stored()?;
        whole.skip(self.size - 1)?;
        let value = whole.array()?.map_or(0, |[value]| value);
        let [nx, ny, nz] = self.dimensions;
        let width = nx.div_ceil(2);
        let mut slices = 0..nz;
        Ok(Box::new(move |stored| {
            let pair = [slices.next(), slices.next()];
            if pair[0].is_none() {
                // The value.
                stored.skip(1)?;
                return Ok(None);
            }
            let Some(plane) = stored.bytes(width * ny.div_ceil(2))? else { return Ok(None) };
            let mut piece = Vec::with_capacity(2 * nx * ny);
            for z in pair.into_iter().flatten() {
                for y in 0..ny {
                    let row = &plane[y / 2 * width..][..width];
                    let first = (z % 2) * 4 + (y % 2) * 2;
                    let is_set = |x: usize| row[x / 2] >> (first + x % 2) & 1 == 1;
                    piece.extend((0..nx).map(|x| if is_set(x) { value } else { 0 }));
                }
            }
            Ok(Some(piece))
        }))
    }

    /// A slice a piece, with the border around it.
    fn runs(&self) -> Decode {
        let ([nx, ny, nz], [bx, by, bz]) = (self.dimensions, self.border);
        let mut runs = Runs::of(self.coding, self.wide);
        let mut slices = 0..nz;
        Box::new(move |stored| {
            let Some(z) = slices.next() else {
                runs.end()?;
                return Ok(None);
            };
            if z < bz || z >= nz - bz {
                return Ok(Some(vec![0; nx * ny]));
            }
            // Memory grows as runs arrive.
            let mut slice = vec![0; nx * by];
            for _ in by..ny - by {
                slice.resize(slice.len() + bx, 0);
                if !runs.extend(stored, &mut slice, nx - 2 * bx)? {
                    return Ok(None);
                }
                slice.resize(slice.len() + bx, 0);
            }
            slice.resize(nx * ny, 0);
            Ok(Some(slice))
        })
    }
}

impl AssembleVoxels for AimVoxels {
    fn files(&self) -> Vec<PathBuf> {
        vec![self.path.clone()]
    }

    fn open(&self, _: &Arc<AtomicU64>) -> Result<Box<dyn Read + Send>, ReadError> {
        let mut stored = self.stored()?;
        let mut decode = match self.coding {
            Coding::VaxFloats => self.floats(),
            Coding::PackedBits => self.bits()?,
            Coding::TwoValuedRuns | Coding::ValuedRuns => self.runs(),
        };
        Ok(Box::new(Pieces::new(move || {
            let piece = decode(&mut stored)?;
            if piece.is_none() {
                stored.end()?;
            }
            Ok(piece)
        })))
    }
}

/// Runs of voxels of one value.
struct Runs {
    coding: Coding,
    /// Bytes of the size in front of them, which are not read yet.
    size: Option<usize>,
    /// The values of which a run has one and the next the other.
    values: [u8; 2],
    /// Voxels left of the run.
    left: usize,
    /// Whether the next run has the other value.
    turns: bool,
}

impl Runs {
    fn of(coding: Coding, wide: bool) -> Self {
        Self { coding, size: Some(if wide { 8 } else { 4 }), values: [0; 2], left: 0, turns: false }
    }

    /// Puts voxels behind others; false where the stored bytes end before.
    fn extend(
        &mut self,
        stored: &mut PackedStretch,
        row: &mut Vec<u8>,
        voxels: usize,
    ) -> Result<bool, ReadError> {
        let end = row.len() + voxels;
        while row.len() < end {
            while self.left == 0 {
                if !self.next(stored)? {
                    return Ok(false);
                }
            }
            let some = self.left.min(end - row.len());
            row.resize(row.len() + some, self.values[0]);
            self.left -= some;
        }
        Ok(true)
    }

    /// Goes to the next run; false where there is none.
    fn next(&mut self, stored: &mut PackedStretch) -> Result<bool, ReadError> {
        let two = self.coding == Coding::TwoValuedRuns;
        if let Some(size) = self.size.take() {
            stored.skip(size as u64)?;
            if two {
                let Some(values) = stored.array()? else { return Ok(false) };
                self.values = values;
            }
        }
        if two {
            let Some([length]) = stored.array()? else { return Ok(false) };
            if self.turns {
                self.values.swap(0, 1);
            }
            self.turns = length != 255;
            self.left = usize::from(length.min(254));
        } else {
            let Some([value, length]) = stored.array()? else { return Ok(false) };
            self.values[0] = value;
            self.left = usize::from(length);
        }
        Ok(true)
    }

    /// Behind the last voxel no run is left.
    fn end(&self) -> Result<(), ReadError> {
        if self.left == 0 {
            Ok(())
        } else {
            Err(error("runs of more voxels than dim has; copy or export the file again"))
        }
    }
}

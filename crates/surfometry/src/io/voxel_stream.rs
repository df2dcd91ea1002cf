//! A file's voxels as slabs.

use super::claims::check_claim;
use super::encoding;
use super::header::{ByteOrder, Encoding, VoxelData, Voxels};
use super::{ImageHeader, ReadError, ReadOptions};
use crate::volume::{Grid, Samples, ScalarType, Slab, SlabReader, VolumeError, collected, slices_a_slab};
use std::collections::TryReserveError;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// How many bytes may follow the last voxel in compressed data, or as many as the voxels have: so far their
/// end is looked for.
const MOST_SURPLUS: u64 = 1 << 28;

/// An open image file, read slab by slab.
pub struct VoxelStream {
    header: ImageHeader,
    grid: Grid,
    voxels: Box<dyn Read + Send>,
    next_slice: usize,
    /// Most slices of a slab.
    most_slices: usize,
    buffer: Vec<u8>,
    file_nanoseconds: Arc<AtomicU64>,
    /// Bytes of compressed data behind the last voxel, once they were read.
    surplus: Arc<AtomicU64>,
}

impl VoxelStream {
    /// Opens a file of any supported format.
    ///
    /// # Errors
    /// [`ReadError`] for whatever the header alone shows to be wrong.
    pub fn open(path: &Path, options: ReadOptions) -> Result<Self, ReadError> {
        let header = super::read_header(path)?;
        let grid = header.grid(options.spacing)?;
        Self::of_header(header, grid, Arc::default())
    }

    /// Opens the data of a file whose header was read; how many bytes follow the voxels of compressed data is
    /// told in `surplus`, when all is read.
    pub(crate) fn of_header(
        header: ImageHeader,
        grid: Grid,
        surplus: Arc<AtomicU64>,
    ) -> Result<Self, ReadError> {
        check_claim(&header)?;
        let file_nanoseconds = Arc::default();
        let voxels = match &header.data {
            Voxels::Stored(data) => encoding::open(data, header.voxel_bytes(), &file_nanoseconds)?,
            Voxels::Assembled(assembled) => assembled.0.open(&file_nanoseconds)?,
        };
        let most_slices = usize::MAX;
        Ok(Self {
            header,
            grid,
            voxels,
            next_slice: 0,
            most_slices,
            buffer: Vec::new(),
            file_nanoseconds,
            surplus,
        })
    }

    /// The same in slabs of one slice each, for who reads many files at once.
    pub(super) fn slice_by_slice(mut self) -> Self {
        self.most_slices = 1;
        self
    }

    /// The file's header.
    pub fn header(&self) -> &ImageHeader {
        &self.header
    }

    fn fill(&mut self, bytes: usize) -> Result<(), ReadError> {
        // Memory grows as data arrive: a header may claim more than the file or the machine holds.
        self.buffer.clear();
        let too_large = |_| VolumeError::TooLarge { dimensions: self.header.dimensions };
        self.buffer.try_reserve_exact(bytes).map_err(too_large)?;
        let outcome = self.voxels.by_ref().take(bytes as u64).read_to_end(&mut self.buffer);
        let filled = self.buffer.len();
        let expected = self.header.voxel_bytes();
        let [nx, ny, _] = self.header.dimensions;
        let before = (self.next_slice * nx * ny * self.header.scalar.bytes()) as u64;
        let found = before + filled as u64;
        match outcome {
            // Decoders report a stream that stops in its middle as an unexpected end of file.
            Err(e) if e.kind() == io::ErrorKind::UnexpectedEof => {
                Err(ReadError::Truncated { found, expected })
            }
            Err(source) => Err(ReadError::of_read(source, found, expected)),
            Ok(_) if filled < bytes => Err(ReadError::Truncated { found, expected }),
            Ok(_) => Ok(()),
        }
    }

    /// What the buffer holds, as numbers.
    fn decode(&mut self) -> Result<Samples, TryReserveError> {
        let data = &self.header.data;
        let samples = decode(self.header.scalar, data.order(), &mut self.buffer)?;
        match data.scaling() {
            Some((slope, intercept)) => samples.scaled(slope, intercept),
            None => Ok(samples),
        }
    }

    /// Reads on to the end of compressed data, where decoders compare their checksums: damage may make a
    /// stream longer than it was.
    fn finish(&mut self) -> Result<(), ReadError> {
        let expected = self.header.voxel_bytes();
        if matches!(&self.header.data, Voxels::Stored(VoxelData { encoding: Encoding::Raw, .. })) {
            return Ok(());
        }
        let most = expected.max(MOST_SURPLUS);
        match io::copy(&mut self.voxels.by_ref().take(most), &mut io::sink()) {
            Ok(surplus) if surplus == most => Err(ReadError::Endless { expected, surplus }),
            Ok(surplus) => {
                self.surplus.store(self.header.beyond_trailer(surplus), Ordering::Relaxed);
                Ok(())
            }
            Err(source) => Err(ReadError::of_read(source, expected, expected)),
        }
    }
}

impl SlabReader for VoxelStream {
    type Error = ReadError;

    fn grid(&self) -> &Grid {
        &self.grid
    }

    fn file_time(&self) -> Duration {
        Duration::from_nanos(self.file_nanoseconds.load(Ordering::Relaxed))
    }

    fn next_slab(&mut self) -> Result<Option<Slab>, ReadError> {
        let [nx, ny, nz] = self.header.dimensions;
        let first = self.next_slice;
        if first == nz {
            return Ok(None);
        }
        let bytes = self.header.scalar.bytes();
        let slices = slices_a_slab(self.header.dimensions, bytes).min(self.most_slices);
        let last = (first + slices).min(nz);
        self.fill((last - first) * nx * ny * bytes)?;
        let samples =
            self.decode().map_err(|_| VolumeError::TooLarge { dimensions: self.header.dimensions })?;
        self.next_slice = last;
        if last == nz {
            self.finish()?;
        }
        Ok(Some(Slab { slices: first..last, samples }))
    }
}

macro_rules! numbers {
    ($type:ty, $order:expr, $bytes:expr) => {{
        let chunks =
            $bytes.chunks_exact(size_of::<$type>()).map(|c| c.try_into().expect("chunk of the type's size"));
        match $order {
            ByteOrder::Little => collected(chunks.map(<$type>::from_le_bytes))?,
            ByteOrder::Big => collected(chunks.map(<$type>::from_be_bytes))?,
        }
    }};
}

/// Bytes as numbers; those that are bytes themselves are taken as they are.
fn decode(scalar: ScalarType, order: ByteOrder, bytes: &mut Vec<u8>) -> Result<Samples, TryReserveError> {
    Ok(match scalar {
        ScalarType::U8 => Samples::U8(std::mem::take(bytes)),
        ScalarType::I8 => Samples::I8(numbers!(i8, order, bytes)),
        ScalarType::U16 => Samples::U16(numbers!(u16, order, bytes)),
        ScalarType::I16 => Samples::I16(numbers!(i16, order, bytes)),
        ScalarType::U32 => Samples::U32(numbers!(u32, order, bytes)),
        ScalarType::I32 => Samples::I32(numbers!(i32, order, bytes)),
        ScalarType::U64 => Samples::U64(numbers!(u64, order, bytes)),
        ScalarType::I64 => Samples::I64(numbers!(i64, order, bytes)),
        ScalarType::F32 => Samples::F32(numbers!(f32, order, bytes)),
        ScalarType::F64 => Samples::F64(numbers!(f64, order, bytes)),
    })
}

//! Images of one lattice laid over each other: layers of segments that may overlap, or a mask a file.

use super::assembled::{AssembleVoxels, Assembled, Pieces};
use super::combinations::Combinations;
use super::{ImageHeader, ReadError, VoxelStream};
use crate::volume::{Grid, Samples, Segments, SlabReader};
use rayon::prelude::*;
use std::io::Read;
use std::path::PathBuf;
use std::sync::atomic::AtomicU64;
use std::sync::{Arc, Mutex, PoisonError};

/// Images that are laid over each other.
#[derive(Debug)]
pub(super) struct Overlay {
    images: Vec<Layers>,
    dimensions: [usize; 3],
    /// Voxels of background in front of the lattice and behind it, along x, y, z.
    padding: [[usize; 2]; 3],
    /// Of whoever reads: the same whenever it is read.
    combinations: Arc<Mutex<Combinations>>,
}

/// An image of layers, which alternate voxel by voxel; one that is nothing else has one.
#[derive(Debug, Clone)]
pub(super) struct Layers {
    /// As it is stored: along x the layers alternate.
    pub(super) header: ImageHeader,
    pub(super) layers: Vec<Layer>,
}

/// What the values of a layer are.
#[derive(Debug, Clone)]
pub(super) enum Layer {
    /// Segments by their labels in it.
    Labels(Vec<(i64, i32)>),
    /// A segment, whatever the one label that occurs.
    Mask(i32),
    /// Labels that are called by themselves.
    Plain,
}

impl Overlay {
    /// Of images whose lattice is the same, with background around it.
    pub(super) fn assembled(
        images: Vec<Layers>,
        dimensions: [usize; 3],
        padding: [[usize; 2]; 3],
    ) -> Assembled {
        let numbers = images.iter().flat_map(|image| &image.layers).flat_map(|layer| match layer {
            Layer::Labels(labels) => labels.iter().map(|(_, number)| *number).collect(),
            Layer::Mask(number) => vec![*number],
            Layer::Plain => Vec::new(),
        });
        let combinations = Arc::new(Mutex::new(Combinations::new(numbers.collect())));
        Assembled(Arc::new(Self { images, dimensions, padding, combinations }))
    }
}

impl AssembleVoxels for Overlay {
    /// Of each image its header and its data; most are one file.
    fn files(&self) -> Vec<PathBuf> {
        let header_and_data = |Layers { header, .. }: &Layers| {
            let mut files = vec![header.path.clone()];
            files.extend(header.data.files());
            files.dedup();
            files
        };
        self.images.iter().flat_map(header_and_data).collect()
    }

    fn segments(&self) -> Option<Segments> {
        let plain =
            self.images.iter().flat_map(|image| &image.layers).any(|layer| matches!(layer, Layer::Plain));
        (!plain).then(|| self.combinations.lock().unwrap_or_else(PoisonError::into_inner).segments())
    }

    fn open(&self, _: &Arc<AtomicU64>) -> Result<Box<dyn Read + Send>, ReadError> {
        let readers = self.images.iter().map(LayerReader::open).collect::<Result<Vec<_>, _>>()?;
        let (padding, dimensions) = (self.padding, self.dimensions);
        let padded: [usize; 3] = std::array::from_fn(|a| dimensions[a] + padding[a][0] + padding[a][1]);
        let mut slices = Slices {
            readers,
            combinations: Arc::clone(&self.combinations),
            voxels: dimensions[0] * dimensions[1],
        };
        let mut next = 0;
        Ok(Box::new(Pieces::new(move || {
            let z = next;
            next += 1;
            let inner = padding[2][0]..padding[2][0] + dimensions[2];
            Ok(match z {
                z if inner.contains(&z) => Some(framed(&slices.next()?, dimensions, padding)),
                z if z < padded[2] => Some(vec![0; padded[0] * padded[1] * size_of::<i32>()]),
                _ => None,
            })
        })))
    }
}

/// A slice's numbers as bytes, with background around them.
fn framed(slice: &[i32], [nx, ny, _]: [usize; 3], [x, y, _]: [[usize; 2]; 3]) -> Vec<u8> {
    let background = |voxels: usize| std::iter::repeat_n(0u8, voxels * size_of::<i32>());
    let row = nx + x[0] + x[1];
    let mut bytes = Vec::with_capacity(row * (ny + y[0] + y[1]) * size_of::<i32>());
    bytes.extend(background(row * y[0]));
    for values in slice.chunks(nx) {
        bytes.extend(background(x[0]));
        bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend(background(x[1]));
    }
    bytes.extend(background(row * y[1]));
    bytes
}

/// The slices of all layers, one after the other.
struct Slices {
    readers: Vec<LayerReader>,
    combinations: Arc<Mutex<Combinations>>,
    voxels: usize,
}

impl Slices {
    fn next(&mut self) -> Result<Vec<i32>, ReadError> {
        let layers: Vec<Vec<Samples>> =
            self.readers.par_iter_mut().map(LayerReader::next).collect::<Result<_, _>>()?;
        let mut combinations = self.combinations.lock().unwrap_or_else(PoisonError::into_inner);
        let mut slice = vec![0; self.voxels];
        for (LayerReader { path, numbers, .. }, layers) in self.readers.iter_mut().zip(layers) {
            for (numbers, layer) in numbers.iter_mut().zip(layers) {
                let laid = combinations.lay(&mut slice, &layer, |label| numbers.of(label));
                laid.map_err(|error| ReadError::in_file(path, error))?;
            }
        }
        Ok(slice)
    }
}

struct LayerReader {
    path: PathBuf,
    stream: VoxelStream,
    numbers: Vec<Numbers>,
}

/// Which segment a label of a layer is, and where that is by the layer, what its label is.
struct Numbers {
    layer: Layer,
    place: usize,
    label: Option<i64>,
}

impl LayerReader {
    fn open(Layers { header, layers }: &Layers) -> Result<Self, ReadError> {
        let grid = Grid::axis_aligned(header.dimensions, [1.0; 3])?;
        let stream = VoxelStream::of_header(header.clone(), grid, Arc::default())?.slice_by_slice();
        let numbers = layers.iter().cloned().enumerate();
        let numbers = numbers.map(|(place, layer)| Numbers { layer, place, label: None }).collect();
        Ok(Self { path: header.path.clone(), stream, numbers })
    }

    /// The next slice of each layer.
    fn next(&mut self) -> Result<Vec<Samples>, ReadError> {
        let slab = self.stream.next_slab().map_err(|error| ReadError::in_file(&self.path, error))?;
        let samples = slab.map_or(Samples::U8(Vec::new()), |slab| slab.samples);
        let count = self.numbers.len();
        if count == 1 { Ok(vec![samples]) } else { Ok((0..count).map(|n| samples.every(count, n)).collect()) }
    }
}

impl Numbers {
    fn of(&mut self, label: i64) -> Result<i32, ReadError> {
        match &self.layer {
            Layer::Labels(labels) => {
                let number = labels.iter().find(|(of, _)| *of == label).map(|(_, number)| *number);
                number.ok_or(ReadError::NoSegment { label, layer: self.place })
            }
            Layer::Plain => {
                i32::try_from(label).map_err(|_| ReadError::NoSegment { label, layer: self.place })
            }
            Layer::Mask(number) => match self.label.replace(label) {
                Some(other) if other != label => Err(ReadError::SeveralLabels { labels: [other, label] }),
                _ => Ok(*number),
            },
        }
    }
}

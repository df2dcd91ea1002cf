//! Segmentations: a frame a slice and segment, in any order, empty ones left out; or a number of a segment a pixel.

use super::bits::BitLayout;
use super::code_extensions;
use super::colour::of_cielab;
use super::data_set::{DataSet, Elements};
use super::error;
use super::frame::{FrameGroups, groups};
use super::lattice::{Gaps, Stack, Stated};
use super::pixels::PixelLayout;
use crate::io::assembled::{AssembleVoxels, Assembled, Pieces};
use crate::io::combinations::Combinations;
use crate::io::header::{Voxels, three_dimensions};
use crate::io::{Format, ImageHeader, ReadError};
use crate::volume::{Affine, LabelEntry, LabelTable, Samples, ScalarType, Segments};
use dicom_dictionary_std::tags;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicU64;
use std::sync::{Arc, Mutex, PoisonError};

/// What pixels are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Binary,
    Fractional,
    LabelMap,
}

/// Reads the header of a segmentation, and its pixels: whose bits run on across frames.
pub(super) fn read_header(path: &Path) -> Result<ImageHeader, ReadError> {
    let data_set = DataSet::whole(path)?;
    let layout = PixelLayout::of(&data_set)?;
    let kind = kind(&data_set, layout)?;
    let labels = segments(&data_set)?;
    let groups = groups(&data_set);
    if groups.len() != layout.frames {
        return Err(error(format!(
            "{} frames, of which {} say where they lie; export the file again",
            layout.frames,
            groups.len()
        )));
    }
    let planes = groups.iter().map(FrameGroups::plane).collect::<Result<Vec<_>, _>>()?;
    let stack = Stack::of(&planes, Gaps::Empty(stated(&groups[0])), |n| format!("frame {}", n + 1))?;
    let frames = frames(&groups, &stack, kind, &labels)?;
    if kind == Kind::Fractional && labels.iter().count() > 1 {
        return Err(error(
            "several segments of fractions, which are no label image; export each as a file of its own",
        ));
    }
    let pixels = Pixels::of(&data_set, layout, kind)?;
    let around = usize::from(is_part(&data_set, stack.slices));
    let dimensions = three_dimensions(&[layout.columns, layout.rows, stack.slices + 2 * around])?;
    let origin = stack.affine.apply([0.0, 0.0, -(around as f64)]);
    let (scalar, scaling) = match kind {
        Kind::Binary => (ScalarType::I32, None),
        Kind::LabelMap => (layout.scalar(), None),
        Kind::Fractional => (layout.scalar(), Some((1.0 / most(&data_set)?, 0.0))),
    };
    let numbers = labels.iter().filter_map(|(label, _)| i32::try_from(label).ok()).collect();
    let combinations = (kind == Kind::Binary).then(|| Arc::new(Mutex::new(Combinations::new(numbers))));
    let slices = stack.slices;
    let voxels = Segmentation {
        path: path.to_owned(),
        pixels: Arc::new(pixels),
        frames,
        slices,
        around,
        scaling,
        combinations,
    };
    Ok(ImageHeader {
        path: path.to_owned(),
        format: Format::Dicom,
        dimensions,
        scalar,
        affine: Some(Affine { origin, ..stack.affine }),
        stated_spacing: None,
        unknown_unit: None,
        other_spacing: None,
        labels,
        data: Voxels::Assembled(Assembled(Arc::new(voxels))),
    })
}

fn kind(data_set: &DataSet, layout: PixelLayout) -> Result<Kind, ReadError> {
    let kind = data_set.text(tags::SEGMENTATION_TYPE).unwrap_or_default();
    match (kind.as_str(), layout.allocated) {
        ("BINARY", 1) => Ok(Kind::Binary),
        ("FRACTIONAL", 8 | 16) => Ok(Kind::Fractional),
        ("LABELMAP", 8 | 16) => Ok(Kind::LabelMap),
        (other, bits) => Err(error(format!(
            "a segmentation of type `{other}` with {bits} bits a pixel; read are BINARY, FRACTIONAL and LABELMAP: export it as one of these"
        ))),
    }
}

/// Names and colours of all segments, by number.
fn segments(data_set: &DataSet) -> Result<LabelTable, ReadError> {
    let sets = data_set.text(tags::SPECIFIC_CHARACTER_SET).unwrap_or_default();
    let segment = |item: &dicom_object::InMemDicomObject| {
        let number = item.whole_number(tags::SEGMENT_NUMBER);
        let number = number
            .ok_or_else(|| error("a segment without SegmentNumber (0062,0004); export the file again"))?;
        let colour = item.whole_numbers::<3>(tags::RECOMMENDED_DISPLAY_CIE_LAB_VALUE).map(of_cielab);
        let name = item.text(tags::SEGMENT_LABEL).map(|name| code_extensions::decoded(&name, &sets));
        Ok::<_, ReadError>((number, LabelEntry { name, colour }))
    };
    let all = data_set.items(tags::SEGMENT_SEQUENCE).iter().map(segment).collect::<Result<Vec<_>, _>>()?;
    let mut numbers: Vec<i64> = all.iter().map(|(number, _)| *number).collect();
    numbers.sort_unstable();
    match numbers.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(twice) => Err(error(format!(
            "two segments have SegmentNumber {} (0062,0004); export the file again",
            twice[0]
        ))),
        None => Ok(all.into_iter().collect()),
    }
}

/// What the header states of the distance of slices.
fn stated(group: &FrameGroups) -> Stated {
    let of = |tag| group.numbers::<1>(tags::PIXEL_MEASURES_SEQUENCE, tag).map(|[mm]| mm);
    Stated { spacing: of(tags::SPACING_BETWEEN_SLICES), thickness: of(tags::SLICE_THICKNESS) }
}

/// Whether the image that was segmented has more slices than have a frame: then an empty one lies around these.
fn is_part(data_set: &DataSet, slices: usize) -> bool {
    let series = data_set.items(tags::REFERENCED_SERIES_SEQUENCE);
    let images: usize =
        series.iter().map(|series| series.items(tags::REFERENCED_INSTANCE_SEQUENCE).len()).sum();
    images > slices
}

/// The value that stands for a whole pixel.
fn most(data_set: &DataSet) -> Result<f64, ReadError> {
    let most = data_set.whole_number(tags::MAXIMUM_FRACTIONAL_VALUE).filter(|most| *most > 0);
    most.map(|most| most as f64)
        .ok_or_else(|| error("no MaximumFractionalValue (0062,000E); export the file again"))
}

/// A frame, its slice, and its segment.
type Place = (usize, usize, i32);

/// The frames in order of slice.
fn frames(
    groups: &[FrameGroups],
    stack: &Stack,
    kind: Kind,
    labels: &LabelTable,
) -> Result<Vec<Place>, ReadError> {
    let segment = |group: &FrameGroups| {
        let number = group.holder(tags::SEGMENT_IDENTIFICATION_SEQUENCE, tags::REFERENCED_SEGMENT_NUMBER);
        let number = number.and_then(|holder| holder.whole_number(tags::REFERENCED_SEGMENT_NUMBER));
        let number = number.and_then(|number| i32::try_from(number).ok()).filter(|number| *number > 0);
        number.ok_or_else(|| error("a frame that names no segment (0062,000B); export the file again"))
    };
    let place = |(number, group): (usize, &FrameGroups)| {
        let segment = if kind == Kind::LabelMap { 0 } else { segment(group)? };
        if kind != Kind::LabelMap && labels.get(segment.into()).is_none() {
            return Err(error(format!(
                "frame {} is of segment {segment}, which SegmentSequence (0062,0002) does not describe; export the file again",
                number + 1
            )));
        }
        Ok((stack.slice_of[number], segment, number))
    };
    let mut places = groups.iter().enumerate().map(place).collect::<Result<Vec<_>, ReadError>>()?;
    places.sort_unstable();
    if let Some(twice) = places.windows(2).find(|pair| (pair[0].0, pair[0].1) == (pair[1].0, pair[1].1)) {
        return Err(error(format!(
            "frames {} and {} are of the same segment and slice; export the file again",
            twice[0].2 + 1,
            twice[1].2 + 1
        )));
    }
    Ok(places.into_iter().map(|(slice, segment, number)| (number, slice, segment)).collect())
}

/// The pixels of a file.
#[derive(Debug)]
struct Pixels {
    bytes: Vec<u8>,
    layout: PixelLayout,
    /// Of pixels of one bit.
    bits: Option<BitLayout>,
}

impl Pixels {
    fn of(data_set: &DataSet, layout: PixelLayout, kind: Kind) -> Result<Self, ReadError> {
        let bytes = data_set.pixels()?;
        let bits = match kind {
            Kind::Binary => Some(BitLayout::of(layout.pixels(), layout.frames, bytes.len())?),
            Kind::Fractional | Kind::LabelMap => None,
        };
        Ok(Self { bytes, layout, bits })
    }

    fn frame(&self, number: usize) -> Result<Vec<u8>, ReadError> {
        match self.bits {
            Some(bits) => Ok(bits.frame(&self.bytes, number)),
            None => self.layout.frame(&self.bytes, number),
        }
    }
}

/// The voxels of a segmentation, slice by slice.
#[derive(Debug)]
struct Segmentation {
    path: PathBuf,
    pixels: Arc<Pixels>,
    /// In order of slice.
    frames: Vec<Place>,
    slices: usize,
    /// Empty slices in front and behind.
    around: usize,
    scaling: Option<(f64, f64)>,
    /// Of segments that may overlap.
    combinations: Option<Arc<Mutex<Combinations>>>,
}

impl AssembleVoxels for Segmentation {
    fn files(&self) -> Vec<PathBuf> {
        vec![self.path.clone()]
    }

    fn scaling(&self) -> Option<(f64, f64)> {
        self.scaling
    }

    fn segments(&self) -> Option<Segments> {
        let combinations = self.combinations.as_ref()?;
        Some(combinations.lock().unwrap_or_else(PoisonError::into_inner).segments())
    }

    fn open(&self, _: &Arc<AtomicU64>) -> Result<Box<dyn Read + Send>, ReadError> {
        let (pixels, combinations) = (Arc::clone(&self.pixels), self.combinations.clone());
        let (mut frames, around) = (self.frames.clone().into_iter().peekable(), self.around);
        let mut slices = 0..self.slices + 2 * self.around;
        Ok(Box::new(Pieces::new(move || {
            let Some(slice) = slices.next() else { return Ok(None) };
            let mut of_slice = Vec::new();
            while let Some((number, _, segment)) = frames.next_if(|(_, of, _)| of + around == slice) {
                of_slice.push((pixels.frame(number)?, segment));
            }
            Ok(Some(match &combinations {
                Some(combinations) => combined(combinations, of_slice, pixels.layout.pixels())?,
                None => {
                    of_slice.pop().map_or_else(|| vec![0; pixels.layout.frame_bytes()], |(bytes, _)| bytes)
                }
            }))
        })))
    }
}

/// Numbers of the segments of a slice, and of combinations of them, as bytes.
fn combined(
    combinations: &Mutex<Combinations>,
    frames: Vec<(Vec<u8>, i32)>,
    pixels: usize,
) -> Result<Vec<u8>, ReadError> {
    let mut combinations = combinations.lock().unwrap_or_else(PoisonError::into_inner);
    let mut slice = vec![0i32; pixels];
    for (mask, segment) in frames {
        combinations.lay(&mut slice, &Samples::U8(mask), |_| Ok(segment))?;
    }
    Ok(slice.into_iter().flat_map(i32::to_le_bytes).collect())
}

//! Images of one or several frames a file.

use super::data_set::{DataSet, Elements, is_dicom};
use super::frame::{Plane, groups};
use super::lattice::{Gaps, Stack};
use super::pixels::PixelLayout;
use super::{error, segmentation};
use crate::io::assembled::{AssembleVoxels, Assembled, Pieces};
use crate::io::folder::{name_of, visible};
use crate::io::header::{Voxels, three_dimensions};
use crate::io::{Format, ImageHeader, ReadError};
use crate::volume::{LabelTable, ScalarType};
use dicom_dictionary_std::tags;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

/// A file of a series, as far as its header tells.
struct Member {
    path: PathBuf,
    series: String,
    description: String,
    layout: PixelLayout,
    frames: Vec<(Plane, Scaling)>,
}

/// How names of slices end, where they have an ending.
const ENDINGS: [&str; 3] = [".dcm", ".dicom", ".ima"];

/// value = slope * stored + intercept.
type Scaling = (f64, f64);

/// The one series that a folder holds.
pub(super) fn of_folder(folder: &Path) -> Result<ImageHeader, ReadError> {
    let (mut members, mut segmentations) = (Vec::new(), Vec::new());
    for path in files(folder)? {
        let data_set = DataSet::header(&path).map_err(|error| ReadError::in_file(&path, error))?;
        if data_set.is_segmentation() {
            segmentations.push(path);
        } else {
            members.push(member(&path, &data_set).map_err(|error| ReadError::in_file(&path, error))?);
        }
    }
    match &segmentations[..] {
        [] => {}
        [only] if members.is_empty() => return segmentation::read_header(only),
        [first, ..] => {
            return Err(error(format!(
                "the folder holds {} segmentations, as {}, and {} files of images: name the file that is meant",
                segmentations.len(),
                name_of(first),
                members.len()
            )));
        }
    }
    let mut series: BTreeMap<&str, Vec<&Member>> = BTreeMap::new();
    for member in &members {
        series.entry(&member.series).or_default().push(member);
    }
    if series.len() > 1 {
        let name = |(_, members): (_, &Vec<&Member>)| {
            format!("{} ({} files, as {})", members[0].description, members.len(), name_of(&members[0].path))
        };
        let names: Vec<String> = series.iter().take(10).map(name).collect();
        return Err(error(format!(
            "the folder holds {} series: {}; name a file of the one that is meant",
            series.len(),
            names.join(", ")
        )));
    }
    header(folder, &members)
}

/// The series that a file belongs to: itself and the files beside it of the same one.
pub(super) fn of_file(path: &Path, data_set: &DataSet) -> Result<ImageHeader, ReadError> {
    let own = member(path, data_set)?;
    let same = |other: &PathBuf| {
        // One that cannot be read may be a slice of it.
        let data_set = match DataSet::header(other) {
            Ok(data_set) => data_set,
            Err(error) => return Some(Err(ReadError::in_file(other, error))),
        };
        let belongs =
            !own.series.is_empty() && data_set.text(tags::SERIES_INSTANCE_UID).as_ref() == Some(&own.series);
        belongs.then(|| member(other, &data_set).map_err(|error| ReadError::in_file(other, error)))
    };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let others = files(folder)?.into_iter().filter(|other| other.file_name() != path.file_name());
    let others: Vec<Member> = others.filter_map(|other| same(&other)).collect::<Result<_, _>>()?;
    let all: Vec<Member> = [own].into_iter().chain(others).collect();
    header(path, &all)
}

/// DICOM files of a folder in order of their names, folders' directories and hidden files left out.
pub(in crate::io) fn files(folder: &Path) -> Result<Vec<PathBuf>, ReadError> {
    let name = |path: &PathBuf| name_of(path).to_lowercase();
    let files = visible(folder)?.into_iter().filter(|path| name(path) != "dicomdir");
    let (found, others): (Vec<_>, Vec<_>) = files.partition(|path| is_dicom(path));
    // What is called a slice, or is nothing at all, may have been one.
    let damaged = |path: &&PathBuf| {
        let is_empty = path.metadata().is_ok_and(|metadata| metadata.is_file() && metadata.len() == 0);
        ENDINGS.iter().any(|ending| name(path).ends_with(ending)) || is_empty
    };
    if let Some(path) = others.iter().find(damaged).filter(|_| !found.is_empty()) {
        let what = "no DICOM, though it lies among DICOM files and may have been a slice: fetch it again, or take it out of the folder";
        return Err(ReadError::in_file(path, error(what)));
    }
    Ok(found)
}

fn member(path: &Path, data_set: &DataSet) -> Result<Member, ReadError> {
    data_set.check_pixels_are_plain()?;
    let layout = PixelLayout::of(data_set)?;
    if layout.allocated == 1 {
        return Err(error("one bit a pixel outside a segmentation is not read; export it as a segmentation"));
    }
    let groups = groups(data_set);
    if groups.len() != layout.frames {
        return Err(error(format!(
            "{} frames, of which nothing says where they lie; export the series as files of one frame",
            layout.frames
        )));
    }
    let number = |group: &super::frame::FrameGroups, tag| {
        group.numbers::<1>(tags::PIXEL_VALUE_TRANSFORMATION_SEQUENCE, tag).map(|[value]| value)
    };
    let frame = |group: &super::frame::FrameGroups| {
        let scaling = (number(group, tags::RESCALE_SLOPE), number(group, tags::RESCALE_INTERCEPT));
        Ok((group.plane()?, (scaling.0.unwrap_or(1.0), scaling.1.unwrap_or(0.0))))
    };
    let frames = groups.iter().map(frame).collect::<Result<_, ReadError>>()?;
    let description = data_set.text(tags::SERIES_DESCRIPTION).unwrap_or_else(|| "no description".to_owned());
    let series = data_set.text(tags::SERIES_INSTANCE_UID).unwrap_or_default();
    Ok(Member { path: path.to_owned(), series, description, layout, frames })
}

fn header(path: &Path, members: &[Member]) -> Result<ImageHeader, ReadError> {
    let Some(first) = members.first() else {
        return Err(ReadError::UnknownFormat("the folder holds no DICOM image".to_owned()));
    };
    let layout = first.layout;
    if let Some(other) = members.iter().find(|member| !member.layout.is_like(&layout)) {
        return Err(error(format!(
            "{} and {} have other sizes or types of pixels: mixed series; name a file of the one that is meant, or take the others out",
            name_of(&first.path),
            name_of(&other.path)
        )));
    }
    let all: Vec<Frame> = members
        .iter()
        .enumerate()
        .flat_map(|(file, member)| {
            (0..).zip(&member.frames).map(move |(number, (plane, scaling))| Frame {
                file,
                number,
                plane: *plane,
                scaling: *scaling,
            })
        })
        .collect();
    let planes: Vec<Plane> = all.iter().map(|frame| frame.plane).collect();
    let name = |n: usize| {
        let frame = &all[n];
        let file = name_of(&members[frame.file].path);
        if members[frame.file].frames.len() > 1 {
            format!("frame {} of {file}", frame.number + 1)
        } else {
            file
        }
    };
    let stack = Stack::of(&planes, Gaps::None, name)?;
    let dimensions = three_dimensions(&[layout.columns, layout.rows, stack.slices])?;
    let mut in_order: Vec<(usize, Frame)> = stack.slice_of.iter().copied().zip(all).collect();
    in_order.sort_by_key(|(slice, _)| *slice);
    let frames: Vec<Frame> = in_order.into_iter().map(|(_, frame)| frame).collect();
    let scaling = frames[0].scaling;
    let uniform = frames.iter().all(|frame| frame.scaling == scaling);
    let paths = members.iter().map(|member| member.path.clone()).collect();
    let voxels = Series {
        paths,
        layout,
        frames,
        scaling: uniform.then_some(scaling).filter(|s| *s != (1.0, 0.0)),
        scaled: !uniform,
    };
    Ok(ImageHeader {
        path: path.to_owned(),
        format: Format::Dicom,
        dimensions,
        scalar: if uniform { layout.scalar() } else { ScalarType::F64 },
        affine: Some(stack.affine),
        stated_spacing: None,
        unknown_unit: None,
        other_spacing: None,
        labels: LabelTable::default(),
        data: Voxels::Assembled(Assembled(Arc::new(voxels))),
    })
}

/// A frame of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Frame {
    file: usize,
    number: usize,
    plane: Plane,
    scaling: Scaling,
}

/// The voxels of a series, frame by frame.
#[derive(Debug)]
struct Series {
    paths: Vec<PathBuf>,
    layout: PixelLayout,
    /// Front to back.
    frames: Vec<Frame>,
    scaling: Option<Scaling>,
    /// Whether each frame has a scaling of its own.
    scaled: bool,
}

impl AssembleVoxels for Series {
    fn files(&self) -> Vec<PathBuf> {
        self.paths.clone()
    }

    fn scaling(&self) -> Option<Scaling> {
        self.scaling
    }

    fn open(&self, _: &Arc<AtomicU64>) -> Result<Box<dyn Read + Send>, ReadError> {
        let (paths, layout, scaled) = (self.paths.clone(), self.layout, self.scaled);
        let mut frames = self.frames.clone().into_iter();
        // The file that was read last: one of several frames is wanted again.
        let mut last: Option<(usize, Vec<u8>)> = None;
        Ok(Box::new(Pieces::new(move || {
            let Some(frame) = frames.next() else { return Ok(None) };
            let path = &paths[frame.file];
            if last.as_ref().is_none_or(|(file, _)| *file != frame.file) {
                let pixels = DataSet::whole(path).and_then(|data_set| data_set.pixels());
                last = Some((frame.file, pixels.map_err(|error| ReadError::in_file(path, error))?));
            }
            let pixels = last.as_ref().map_or(&[][..], |(_, pixels)| pixels);
            let bytes =
                layout.frame(pixels, frame.number).map_err(|error| ReadError::in_file(path, error))?;
            Ok(Some(if scaled { scaled_bytes(&bytes, layout.scalar(), frame.scaling) } else { bytes }))
        })))
    }
}

/// The values of a frame as doubles.
fn scaled_bytes(bytes: &[u8], scalar: ScalarType, (slope, intercept): Scaling) -> Vec<u8> {
    let number = |pixel: &[u8]| {
        let mut wide = [0; 4];
        wide[..pixel.len()].copy_from_slice(pixel);
        let value = i32::from_le_bytes(wide);
        match scalar {
            ScalarType::I8 => f64::from(value as i8),
            ScalarType::I16 => f64::from(value as i16),
            ScalarType::I32 => f64::from(value),
            _ => f64::from(value as u32),
        }
    };
    bytes
        .chunks_exact(scalar.bytes())
        .flat_map(|pixel| (slope * number(pixel) + intercept).to_le_bytes())
        .collect()
}

//! Images that are measured box by box, anywhere and in any order.

use super::box_sums::{Labels, ObjectPart};
use super::scheme::Scheme;
use super::setup::Setup;
use super::{MeasureError, Measured, Measurement};
use crate::tiling::{Cover, IndexBox, TILE};
use crate::volume::{Found, Grid, LabelBlock, LabelGroup, LabelSelection, Mask, VolumeError};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Debug;
use thiserror::Error;

/// What the text in front of a value is, whatever form it is of.
const SCHEMA_NAME: &str = "surfometry-partial/";
/// The form that is written and read.
const SCHEMA: &str = "surfometry-partial/5";

type Results = Vec<(LabelGroup, Measured)>;

/// What some boxes of an image add to the measurement of its objects: a value that can be written, sent,
/// read, and merged with those of the other boxes in any order.
///
/// Sums are exact and hang on the image, not on the boxes, so the value of all boxes gives the bits of
/// [`Measurement::run_labels`], topology included, in whatever order they were merged. Two values of the same
/// boxes may differ all the same: in the times in them, and in how much of an object's finished parts they
/// still hold.
///
/// ```
/// # use surfometry::{Measurement, measurement::PartialMeasurement, tiling::IndexBox};
/// # use surfometry::volume::{Grid, LabelBlock, LabelImage, LabelSelection};
/// # let grid = Grid::axis_aligned([24, 24, 150], [1.0; 3])?;
/// # let ball = |v: [usize; 3]| (0..3).map(|a| v[a].abs_diff([12, 12, 124][a]).pow(2)).sum::<usize>() < 81;
/// # let voxels: Vec<u8> = (0..grid.voxel_count()).map(|n| u8::from(ball(grid.index_of(n)))).collect();
/// # let image = LabelImage::from_voxels(grid, &voxels)?;
/// let (measurement, all) = (Measurement::default(), LabelSelection::All);
/// let mut whole = PartialMeasurement::new(&measurement, grid, &all)?;
/// for region in [IndexBox::new([0, 0, 100], [24, 24, 150]), IndexBox::new([0, 0, 0], [24, 24, 100])] {
///     let IndexBox { lower, upper } = measurement.share(&grid, region)?.needed;
///     let rows = (lower[2]..upper[2]).flat_map(|z| (lower[1]..upper[1]).map(move |y| (y, z)));
///     let part: Vec<u8> = rows.flat_map(|(y, z)| (lower[0]..upper[0]).map(move |x| [x, y, z]))
///         .map(|index| u8::from(ball(index.map(|v| v as usize)))).collect();
///     let block = LabelBlock::from_voxels(grid, IndexBox { lower, upper }, &part)?;
///     let bytes = measurement.measure_box(&block, region, &all)?.to_bytes();
///     whole = whole.merged(PartialMeasurement::from_bytes(&bytes)?)?;
/// }
/// assert_eq!(whole.results()?[0].1.values, measurement.run_labels(&image, &all, |_, _| {})?[0].1.values);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Contents", into = "Contents")]
pub struct PartialMeasurement(Contents);

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Contents {
    schema: String,
    /// Version of this library: others may round differently.
    version: String,
    grid: Grid,
    measurement: Measurement,
    /// Labels of each group; `None` where all labels are selected.
    selection: Option<Vec<Vec<i64>>>,
    cover: Cover,
    /// The labels that occur in the boxes and around them, selected or not.
    labels: BTreeSet<i64>,
    /// By the labels of their group.
    #[serde(with = "crate::tiling::pairs")]
    objects: BTreeMap<Vec<i64>, Box<ObjectPart>>,
}

/// What a box of an image is measured over, and what must be known for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BoxShare {
    /// The voxels of the tiles that belong to the box: those whose first voxel lies in it. None where it
    /// holds no tile's first voxel.
    pub owned: IndexBox,
    /// The voxels on whose labels its sums depend: those that it owns and a halo around them, as far as the
    /// image reaches.
    pub needed: IndexBox,
}

/// Why two values cannot be merged.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MergeError {
    /// They were not made alike.
    #[error(
        "the values differ in {what}, {first} and {second}: merge those of one image, measured with the same choices by the same version"
    )]
    Differs {
        /// What they differ in.
        what: &'static str,
        /// That of the first.
        first: String,
        /// That of the second.
        second: String,
    },
    /// Some voxels are in both.
    #[error("the boxes {first} and {second} overlap: cut the image into disjoint boxes, and merge each once")]
    Overlap {
        /// Box of the first.
        first: IndexBox,
        /// Box of the second.
        second: IndexBox,
    },
}

/// Why bytes cannot be read as a value.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum DecodeError {
    /// They are something else.
    #[error("this is no partial measurement: it does not begin with `{SCHEMA_NAME}`")]
    NotOne,
    /// They were written in another form.
    #[error(
        "the partial measurement is of the form `{0}`, not `{SCHEMA}`: measure its box again with this version"
    )]
    OtherForm(String),
    /// They were cut off or changed.
    #[error("the partial measurement is damaged ({0}): copy it again, or measure its box again")]
    Damaged(String),
}

impl Measurement {
    /// What the measurement of a box of an image covers and needs. However an image is cut into boxes, each
    /// of its tiles belongs to one of them.
    ///
    /// # Errors
    /// [`MeasureError`] for parameters that make no sense, or that ask for whole objects.
    pub fn share(&self, grid: &Grid, region: IndexBox) -> Result<BoxShare, MeasureError> {
        let setup = self.setup_of_boxes(*grid)?;
        let owned = owned(grid, &region);
        Ok(BoxShare { owned, needed: needed(&setup, &owned) })
    }

    /// Measures the selected objects of an image as far as they lie in a box: see [`Measurement::share`] for
    /// what that covers, and which labels the block must hold.
    ///
    /// # Errors
    /// [`MeasureError`] for parameters that make no sense or ask for whole objects, or a block that lacks
    /// voxels around the box.
    pub fn measure_box(
        &self,
        block: &LabelBlock,
        region: IndexBox,
        selection: &LabelSelection,
    ) -> Result<PartialMeasurement, MeasureError> {
        let setup = self.setup_of_boxes(*block.grid())?;
        let owned = owned(block.grid(), &region);
        let needed = needed(&setup, &owned);
        if !block.region().holds(&needed) {
            return Err(MeasureError::BoxWithoutHalo { needed, given: *block.region() });
        }
        let (runs, labels) = block.runs();
        Ok(PartialMeasurement::of_box(&setup, owned, &Labels::new(runs, labels.collect()), selection))
    }

    fn setup_of_boxes(&self, grid: Grid) -> Result<Setup, MeasureError> {
        if self.needs_whole_objects() {
            return Err(MeasureError::Conflict(
                "objects that the image cuts are continued beyond it, and corrections found, as wholes: measure boxes with such objects closed, \
                 by another embedding than the recovering one",
            ));
        }
        let setup = Setup::of_masks(self, grid)?;
        Scheme::check_reach(&setup)?;
        Ok(setup)
    }
}

/// The voxels of the tiles whose first voxel lies in a box.
fn owned(grid: &Grid, region: &IndexBox) -> IndexBox {
    let (image, region) = (grid.index_box(), region.intersection(&grid.index_box()));
    let end =
        |index: i64, a: usize| (TILE[a] * (index + TILE[a] - 1).div_euclid(TILE[a])).min(image.upper[a]);
    IndexBox::new(
        std::array::from_fn(|a| end(region.lower[a], a)),
        std::array::from_fn(|a| end(region.upper[a], a)),
    )
}

/// The voxels that must be known for what is summed over a box.
fn needed(setup: &Setup, owned: &IndexBox) -> IndexBox {
    owned.grown(reach(setup)).intersection(&setup.grid.index_box())
}

/// Voxels around a box, on each side of each axis, that its sums depend on.
pub(super) fn reach(setup: &Setup) -> [i64; 3] {
    let nothing = Mask::empty(setup.grid);
    Scheme::of_part(setup, &nothing).reach(setup)
}

impl PartialMeasurement {
    /// The value of no box, to begin with.
    ///
    /// # Errors
    /// [`MeasureError`] for parameters that make no sense or ask for whole objects.
    pub fn new(
        measurement: &Measurement,
        grid: Grid,
        selection: &LabelSelection,
    ) -> Result<Self, MeasureError> {
        measurement.setup_of_boxes(grid).map(|setup| Self::empty(&setup, selection))
    }

    pub(super) fn empty(setup: &Setup, selection: &LabelSelection) -> Self {
        let selection = match selection {
            LabelSelection::All => None,
            LabelSelection::Groups(groups) => {
                Some(groups.iter().map(|group| group.labels().to_vec()).collect())
            }
        };
        Self(Contents {
            schema: SCHEMA.to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            grid: setup.grid,
            measurement: setup.measurement,
            selection,
            cover: Cover::of(setup.grid.index_box(), IndexBox::EMPTY),
            labels: BTreeSet::new(),
            objects: BTreeMap::new(),
        })
    }

    /// Of one box of an image, which may be empty, from the labels in and around it.
    pub(super) fn of_box(
        setup: &Setup,
        region: IndexBox,
        labels: &Labels,
        selection: &LabelSelection,
    ) -> Self {
        let Self(nothing) = Self::empty(setup, selection);
        if region.is_empty() {
            return Self(nothing);
        }
        Self(Contents {
            cover: Cover::of(setup.grid.index_box(), region),
            labels: labels.present().collect(),
            objects: labels.sums(setup, &region, reach(setup), selection),
            ..nothing
        })
    }

    /// The values of disjoint boxes as one, whether they touch or not.
    ///
    /// # Errors
    /// [`MergeError`] for values that were not made alike, or boxes that overlap.
    pub fn merged(mut self, other: Self) -> Result<Self, MergeError> {
        self.merge(other)?;
        Ok(self)
    }

    /// Adds the value of other boxes; where that is an error, nothing changes.
    ///
    /// # Errors
    /// As [`PartialMeasurement::merged`].
    pub fn merge(&mut self, Self(other): Self) -> Result<(), MergeError> {
        let Self(all) = self;
        all.check_alike(&other)?;
        let merged = all.cover.merged(&other.cover);
        let (cover, joint) = merged.map_err(|[first, second]| MergeError::Overlap { first, second })?;
        for (key, part) in &mut all.objects {
            if !other.objects.contains_key(key) {
                part.merge_nothing(cover.image(), &joint);
            }
        }
        for (key, mut part) in other.objects {
            match all.objects.entry(key) {
                Entry::Occupied(known) => known.into_mut().merge(*part, cover.image(), &joint),
                Entry::Vacant(free) => {
                    part.merge_nothing(cover.image(), &joint);
                    free.insert(part);
                }
            }
        }
        all.labels.extend(other.labels);
        all.cover = cover;
        Ok(())
    }

    /// The selected objects, in order of selection or of label: the bits of [`Measurement::run_labels`].
    ///
    /// # Errors
    /// [`MeasureError`] where boxes are missing, for a label that does not occur, or an image without
    /// foreground.
    pub fn results(&self) -> Result<Results, MeasureError> {
        let Self(all) = self;
        let (setup, found) = all.complete()?;
        let groups = found.all()?;
        let nothing = ObjectPart::default();
        let measured = |group: LabelGroup| {
            let part = all.objects.get(group.labels()).map_or(&nothing, |part| part);
            let measured = setup.measured(&part.totals(&all.cover));
            (group, measured)
        };
        Ok(groups.into_par_iter().map(measured).collect())
    }

    /// The same, and what does not occur; what was known of an object goes as its result comes, for there may be a hundred
    /// thousand.
    pub(super) fn into_results(mut self) -> Result<(Results, Vec<VolumeError>), MeasureError> {
        let (setup, Found { groups, missing }) = self.0.complete()?;
        if groups.iter().map(LabelGroup::labels).collect::<BTreeSet<_>>().len() < groups.len() {
            self.0.selection = Some(groups.iter().map(|group| group.labels().to_vec()).collect());
            return Ok((self.results()?, missing));
        }
        let Contents { cover, mut objects, .. } = self.0;
        let taken = groups.into_iter().map(|group| {
            let part = objects.remove(group.labels()).unwrap_or_default();
            (group, part)
        });
        let taken: Vec<(LabelGroup, Box<ObjectPart>)> = taken.collect();
        let measured =
            |(group, part): (LabelGroup, Box<ObjectPart>)| (group, setup.measured(&part.totals(&cover)));
        Ok((taken.into_par_iter().map(measured).collect(), missing))
    }

    /// The boxes of the image that are known.
    pub fn boxes(&self) -> &[IndexBox] {
        self.0.cover.boxes()
    }

    /// The value in a compact form, which begins with that form's name.
    ///
    /// # Panics
    /// Never: the value has a size, and memory is not a writer that fails.
    pub fn to_bytes(&self) -> Vec<u8> {
        postcard::to_stdvec(&self.0).expect("a value in memory can be written to memory")
    }

    /// The value that [`PartialMeasurement::to_bytes`] wrote.
    ///
    /// # Errors
    /// [`DecodeError`] for anything else.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, DecodeError> {
        let form = postcard::take_from_bytes::<&str>(bytes).map_or("", |(form, _)| form);
        check_form(form)?;
        let contents: Contents =
            postcard::from_bytes(bytes).map_err(|error| DecodeError::Damaged(error.to_string()))?;
        Self::try_from(contents)
    }
}

fn check_form(form: &str) -> Result<(), DecodeError> {
    match form {
        SCHEMA => Ok(()),
        _ if form.starts_with(SCHEMA_NAME) => Err(DecodeError::OtherForm(form.to_owned())),
        _ => Err(DecodeError::NotOne),
    }
}

impl From<PartialMeasurement> for Contents {
    fn from(PartialMeasurement(contents): PartialMeasurement) -> Self {
        contents
    }
}

impl TryFrom<Contents> for PartialMeasurement {
    type Error = DecodeError;

    fn try_from(contents: Contents) -> Result<Self, DecodeError> {
        check_form(&contents.schema)?;
        let Contents { grid, cover, objects, .. } = &contents;
        let damaged = |what: &str| Err(DecodeError::Damaged(what.to_owned()));
        if *cover.image() != grid.index_box() || !cover.is_valid() {
            return damaged("its boxes are no parts of its image");
        }
        if !objects.values().all(|part| part.is_valid(grid, cover)) {
            return damaged("an object is not one of its boxes");
        }
        Ok(Self(contents))
    }
}

impl Contents {
    /// How the whole image is measured, and the objects that are selected in it.
    fn complete(&self) -> Result<(Setup, Found), MeasureError> {
        let missing = self.cover.missing();
        if let Some(&first) = missing.first() {
            let voxels = missing.iter().map(IndexBox::voxels).sum();
            return Err(MeasureError::MissingBoxes { first, voxels });
        }
        let setup = self.measurement.setup_of_boxes(self.grid)?;
        let groups = |groups: &Vec<Vec<i64>>| groups.iter().cloned().map(LabelGroup::united).collect();
        let selection =
            self.selection.as_ref().map_or(LabelSelection::All, |g| LabelSelection::Groups(groups(g)));
        Ok((setup, selection.find_among(self.labels.iter().copied())?))
    }

    /// Whether two values may become one.
    fn check_alike(&self, other: &Self) -> Result<(), MergeError> {
        let same = |what, first: &dyn Debug, second: &dyn Debug| {
            let [first, second] = [first, second].map(|value| format!("{value:?}"));
            if first == second { Ok(()) } else { Err(MergeError::Differs { what, first, second }) }
        };
        same("version", &self.version, &other.version)?;
        same("dimensions", &self.grid.dimensions(), &other.grid.dimensions())?;
        same("affine", self.grid.affine(), other.grid.affine())?;
        same("parameters", &self.measurement, &other.measurement)?;
        same("selected labels", &self.selection, &other.selection)
    }
}

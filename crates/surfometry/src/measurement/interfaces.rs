//! What the labels of an image have in common: the area and the curvature of the contact of any two.

use super::scheme::{Scheme, with_scheme};
use super::setup::Setup;
use super::{EmbeddingKind, MeasureError, Measurement};
use crate::accuracy::of_average;
use crate::embedding::{Embedding, GaussianEmbedding};
use crate::integrals::{Integrals, Partial};
use crate::interfaces::{Contact, Contacts, Contrast, PairWeights};
use crate::local_geometry::Differentiation;
use crate::space::length;
use crate::text::{SHOWN_LABELS, listed};
use crate::tiling::IndexBox;
use crate::volume::{LabelGroup, LabelImage, VolumeError};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The contact of two labels, of which background, 0, may be one.
///
/// Areas are counted, not blurred (docs/quantities.md): each shared face counts once, so that the interfaces of a label add
/// up to its area. Where two surfaces touch at a tangent, all that is closer than a voxel counts as contact. Curvature is that of
/// the surface on which both labels' blurs are equal, where no third label is near; its normal points from the first label to
/// the second.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Interface {
    /// The two, the lower label first.
    pub labels: [LabelGroup; 2],
    /// Their names, where they have any.
    pub names: [Option<String>; 2],
    /// Area and curvature; null where they could not be had.
    #[serde(flatten)]
    pub values: InterfaceValues,
    /// Their standard errors.
    pub standard_error: InterfaceValues,
    /// Share of the area over which curvature was measured: where hardly any of a third label is within the blur.
    pub curvature_share: f64,
}

/// Area and curvature of an interface, or the errors of such.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct InterfaceValues {
    /// Area of contact.
    pub surface_area_mm2: Option<f64>,
    /// Integral of H, positive where the first label is convex.
    pub total_mean_curvature_mm: Option<f64>,
    /// Mean of H.
    pub average_mean_curvature_per_mm: Option<f64>,
}

/// Shares of third labels, after the blur, up to which a voxel tells the curvature of two: 2.6 sigma from an edge of one, and,
/// where there is too little of that, 2 sigma. They bend the surface on which the two are equal, the more of them there is.
const OTHERS: [f64; 2] = [0.004, 0.02];
/// Band voxels below which there is no curvature to speak of.
const FEWEST: u64 = 100;
/// Least share of what the looser limit leaves that the stricter one has to leave.
const ENOUGH: f64 = 0.2;
/// Standard errors of the area: a share of it, of directions that count for more than others; of smooth surfaces in units of
/// the root of the area times the spacing; of rims, which lie anywhere between voxels, in units of the root of their number of cells, and of
/// that number where a face that ends there lies along the grid: anywhere within a spacing, that is to 1/sqrt(12) of one, where
/// 4/pi cells are a spacing of length; as a share, of what is no wider than two voxels or so, rim all over, which may be a line; of
/// roughness, in units of what short displacements tell otherwise.
const OF_DIRECTIONS: f64 = 0.003;
const OF_SURFACE: f64 = 0.1;
const OF_RIM: f64 = 0.6;
const OF_GRIDDED_RIM: f64 = 0.227;
const OF_LINE: f64 = 0.6;
const OF_ROUGHNESS: f64 = 1.5;
/// Sigmas beyond which of a blur that two labels share nothing comes from where they touch.
const NEAR: f64 = 3.0;
/// Area of the voxels' faces, as a multiple of the interface's, up to which that lies along the grid, in part.
const GRIDDED: f64 = 1.1;

/// The objects of an image as numbers, background being 0.
struct Partition<'a> {
    image: &'a LabelImage,
    /// By number.
    objects: Vec<LabelGroup>,
    number_of: BTreeMap<i64, u32>,
    volumes: Vec<f64>,
}

impl Measurement {
    /// The interfaces of the objects of an image, and of whatever other labels it has, each by itself, with background, in
    /// order of their labels: all pairs of which voxels share a face.
    ///
    /// Blur and band are those of the choices; interfaces have an area at any embedding, and curvature where there is a blur
    /// at level 0.5.
    ///
    /// # Errors
    /// [`MeasureError`] for parameters that make no sense, labels that do not occur, or objects that share one.
    pub fn interfaces(
        &self,
        image: &LabelImage,
        objects: &[LabelGroup],
    ) -> Result<Vec<Interface>, MeasureError> {
        let setup = Setup::of_masks(&self.embedding(EmbeddingKind::Gaussian), *image.grid())?;
        Scheme::check_reach(&setup)?;
        let partition = Partition::of(image, objects)?;
        let weights = PairWeights::new(image.grid().spacing());
        let labels_of = |region: &IndexBox| image.dense(region, |label| partition.number(label));
        let contacts = Contacts::count(&image.grid().index_box(), &weights, &labels_of);
        let touching = |contact: &Contact| weights.faces(&contact.pairs).iter().any(|&area| area > 0.0);
        let found: Vec<_> = contacts.0.into_iter().filter(|(_, contact)| touching(contact)).collect();
        let rough = partition.roughness(&weights, &found);
        let areas: Vec<(f64, f64)> =
            found.iter().map(|(pair, contact)| partition.area(&weights, &rough, *pair, contact)).collect();
        let mut gridded = vec![0.0_f64; partition.objects.len()];
        for ((pair, contact), (area, _)) in found.iter().zip(&areas) {
            let share = gridded_share(&weights, contact, *area);
            for number in pair.map(|number| number as usize) {
                gridded[number] = gridded[number].max(share);
            }
        }
        let interface = |((pair, contact), &(area, error)): (&([u32; 2], Contact), &(f64, f64))| {
            let [here, there] = pair.map(|number| gridded[number as usize]);
            let rims = partition.rim_error(contact, here.max(there), area);
            partition.interface(&setup, *pair, contact, (area, libm::hypot(error, rims)))
        };
        Ok(found.par_iter().zip(&areas).map(interface).collect())
    }
}

impl<'a> Partition<'a> {
    fn of(image: &'a LabelImage, chosen: &[LabelGroup]) -> Result<Self, MeasureError> {
        let mut number_of = BTreeMap::new();
        let mut objects = Vec::new();
        for object in chosen {
            for &label in object.labels() {
                if image.summary(label).is_none() {
                    let present = listed(image.summaries().iter().map(|s| s.label), SHOWN_LABELS);
                    return Err(VolumeError::NoSuchLabel { missing: label, present }.into());
                }
                if number_of.insert(label, 0).is_some() {
                    return Err(MeasureError::Conflict(
                        "two of the objects share a label, so that their interface is no surface: name each label once",
                    ));
                }
            }
            objects.push(object.clone());
        }
        let others = image.summaries().iter().map(|s| s.label).filter(|label| !number_of.contains_key(label));
        objects.extend(others.map(LabelGroup::single).collect::<Vec<_>>());
        objects.push(LabelGroup::single(0));
        objects.sort_by(|a, b| a.labels().cmp(b.labels()));
        let background = objects.iter().position(|object| object.labels() == [0]).unwrap_or_default();
        // Background is number 0; the others keep their order.
        let background = objects.remove(background);
        objects.insert(0, background);
        for (number, object) in objects.iter().enumerate() {
            object.labels().iter().for_each(|&label| {
                number_of.insert(label, number as u32);
            });
        }
        let cell = image.grid().spacing().cell_volume();
        let voxels = |label: &i64| image.summary(*label).map_or(0, |summary| summary.voxels);
        let volume = |object: &LabelGroup| object.labels().iter().map(voxels).sum::<u64>() as f64 * cell;
        let volumes = objects.iter().map(volume).collect();
        Ok(Self { image, objects, number_of, volumes })
    }

    fn number(&self, label: i64) -> u32 {
        self.number_of.get(&label).copied().unwrap_or_default()
    }

    fn interface(
        &self,
        setup: &Setup,
        pair: [u32; 2],
        contact: &Contact,
        (area, error): (f64, f64),
    ) -> Interface {
        let mut numbers = pair;
        // A negative label is lower than background.
        numbers.sort_by(|a, b| self.object(*a).labels().cmp(self.object(*b).labels()));
        let core = self.core(setup, numbers, &contact.boxes);
        let curvature = core.and_then(|core| core.curvature(setup, area));
        let [average, average_error, share] = curvature.unwrap_or_default();
        let of = |area: f64, total: f64, average: f64| InterfaceValues {
            surface_area_mm2: Some(area),
            total_mean_curvature_mm: curvature.map(|_| total),
            average_mean_curvature_per_mm: curvature.map(|_| average),
        };
        let (total, total_error) = (area * average, libm::hypot(area * average_error, error * average));
        Interface {
            labels: numbers.map(|number| self.object(number).clone()),
            names: [None, None],
            values: of(area, total, average),
            standard_error: of(error, total_error, average_error),
            curvature_share: share,
        }
    }

    fn object(&self, number: u32) -> &LabelGroup {
        &self.objects[number as usize]
    }

    /// By number, the share by which short displacements tell another area of all of a label's surface than all do: of a smooth
    /// one they tell the same. (Of a part of it they do not: where it ends.)
    fn roughness(&self, weights: &PairWeights, found: &[([u32; 2], Contact)]) -> Vec<f64> {
        let mut sums = vec![[0.0; 2]; self.objects.len()];
        for (pair, contact) in found {
            let [area, short] = [weights.area(&contact.pairs), weights.area_of_short(&contact.pairs)];
            for number in pair {
                let [areas, shorts] = &mut sums[*number as usize];
                (*areas, *shorts) = (*areas + area, *shorts + short);
            }
        }
        let share = |[area, short]: [f64; 2]| {
            if area > 0.0 { OF_ROUGHNESS * (1.0 - short / area).abs() } else { 0.0 }
        };
        sums.into_iter().map(share).collect()
    }

    /// A contact's area, and its standard error but for that of rims.
    fn area(&self, weights: &PairWeights, rough: &[f64], pair: [u32; 2], contact: &Contact) -> (f64, f64) {
        let (pairs, faces) = (self.by_pairs(weights, rough, pair, contact), by_faces(weights, contact));
        if pairs.1 <= faces.1 { pairs } else { faces }
    }

    /// Standard error of an area by where it ends; `gridded` is the largest share of what meets there that lies along the grid.
    fn rim_error(&self, contact: &Contact, gridded: f64, area: f64) -> f64 {
        let spacing = self.image.grid().spacing();
        let (rim, cell) = (contact.rim as f64, spacing.largest() * spacing.geometric_mean());
        let line = if area < cell * rim { OF_LINE * area } else { 0.0 };
        [OF_RIM * cell * rim.sqrt(), OF_GRIDDED_RIM * gridded * cell * rim, line]
            .into_iter()
            .fold(0.0, libm::hypot)
    }

    /// The area that pairs of voxels tell, and its error.
    fn by_pairs(
        &self,
        weights: &PairWeights,
        rough: &[f64],
        pair: [u32; 2],
        contact: &Contact,
    ) -> (f64, f64) {
        let area = weights.area(&contact.pairs);
        if area <= 0.0 {
            return (area, f64::INFINITY);
        }
        let h = self.image.grid().spacing().geometric_mean();
        let thin = |number: u32| match number {
            0 => 0.0,
            _ => weights.loss_of_layer(2.0 * self.volumes[number as usize] / area),
        };
        let errors = [
            OF_DIRECTIONS * area,
            OF_SURFACE * h * area.sqrt(),
            area * pair.map(thin).into_iter().fold(0.0, f64::max),
            weights.change(&contact.by_way),
            area * pair.map(|number| rough[number as usize]).into_iter().fold(0.0, f64::max),
        ];
        (area, errors.into_iter().fold(0.0, libm::hypot))
    }

    /// What the band around the middle of two labels adds up to, away from all others, by either limit; `None` where
    /// there is no blur at level 0.5.
    fn core(&self, setup: &Setup, [from, to]: [u32; 2], boxes: &[[IndexBox; 2]]) -> Option<Core> {
        setup.parameters.compensable_sigma()?;
        let [from, to] = [from, to].map(|number| self.object(number).labels());
        let amounts = |labels: &[i64], amount: f32| labels.iter().map(|&l| (l, amount)).collect::<Vec<_>>();
        // phi = (u_to - u_from) / 2 and what the others have, 1 - u_from - u_to, each as a level less a blur. Background is what
        // is left of 1.
        let (level, middle, least, others) = match (from, to) {
            ([0], to) => (
                -0.5,
                Contrast::new(self.image, amounts(to, -1.0), -0.5),
                0.0,
                Contrast::new(self.image, amounts(to, 0.0), -1.0),
            ),
            (from, [0]) => (
                0.5,
                Contrast::new(self.image, amounts(from, 1.0), 0.5),
                0.0,
                Contrast::new(self.image, amounts(from, 0.0), -1.0),
            ),
            (from, to) => {
                let both = [amounts(from, 0.5), amounts(to, -0.5)].concat();
                let sum = [amounts(from, 1.0), amounts(to, 1.0)].concat();
                (0.0, Contrast::new(self.image, both, 0.0), 1.0, Contrast::new(self.image, sum, 0.0))
            }
        };
        let mut own = setup.clone();
        own.parameters.level = Some(level);
        let scheme = Scheme::of_blur(&own, &middle)?;
        let others =
            GaussianEmbedding::of_profile(&others, &setup.parameters.profile()?, least, setup.truncation());
        let half_width = setup.band.delta().half_width();
        let mut sums = [Partial::default(), Partial::default()];
        let near = near_faces(setup);
        for tile in boxes.iter().map(|[tile, faces]| tile.intersection(&faces.grown(near))) {
            let tile = &tile;
            let share = others.evaluate(tile, half_width);
            let part_of = |index: [i64; 3]| {
                let share = f64::from(share.get(index));
                OTHERS.iter().position(|limit| share < *limit).map(|number| number as u32)
            };
            let parts = with_scheme!(&scheme, s => {
                let field = s.tile_field(Vec::new(), tile, half_width);
                Partial::of_tile_by_part(s, &field, tile, &setup.band, &setup.quadrature, &part_of, &mut |_, _| {})
            });
            for (number, part) in &parts {
                let sum = &mut sums[*number as usize];
                *sum = std::mem::take(sum).merged(part);
            }
        }
        let [strict, between] = sums;
        let known = |sum: &Partial| {
            let integrals = Integrals::of(sum, setup.grid.spacing());
            (integrals.band_voxels >= FEWEST && integrals.has_surface()).then_some(integrals)
        };
        let loose = known(&between.merged(&strict))?;
        Some(Core { loose, strict: known(&strict).filter(|s| s.surface.area > ENOUGH * loose.surface.area) })
    }
}

/// The area that faces of voxels tell, for contacts of which pairs tell too little: a surface whose faces along the axes add
/// up to f has at least the length of the vector f, where it is flat, and at most the sum of its parts.
fn by_faces(weights: &PairWeights, contact: &Contact) -> (f64, f64) {
    let faces = weights.faces(&contact.pairs);
    let (least, most) = (length(faces), faces.iter().sum::<f64>());
    // Anywhere between them, and of boxes along the grid at the end.
    (0.5 * (least + most), 0.4 * (most - least))
}

/// How far, in voxels, from where two labels touch their blurs are equal and no third one is there: within the band, and the
/// blur's reach of both.
fn near_faces(setup: &Setup) -> [i64; 3] {
    let reach = 0.5 * setup.parameters.thickness_mm + NEAR * setup.parameters.sigma_mm.unwrap_or_default();
    setup.grid.spacing().mm().map(|h| libm::ceil(reach / h) as i64)
}

/// How much of a contact of some area lies along the grid, 0 to 1.
fn gridded_share(weights: &PairWeights, contact: &Contact, area: f64) -> f64 {
    let faces: f64 = weights.faces(&contact.pairs).iter().sum();
    ((GRIDDED - faces / area) / (GRIDDED - 1.0)).clamp(0.0, 1.0)
}

/// The part of an interface that no third label is near, by the looser and, where that leaves enough, the stricter limit.
struct Core {
    loose: Integrals,
    strict: Option<Integrals>,
}

impl Core {
    /// Mean of H, its standard error, and the share of an area that it is of; `None` where nothing is known of errors.
    fn curvature(&self, setup: &Setup, area: f64) -> Option<[f64; 3]> {
        let average = |integrals: &Integrals| {
            let own = setup.compensation(Some(*integrals), None)?.added_to(integrals);
            Some((own.total_mean_curvature / own.area, own))
        };
        let integrals = self.strict.as_ref().unwrap_or(&self.loose);
        let ((average, own), (looser, _)) = (average(integrals)?, average(&self.loose)?);
        let errors = setup.error_model(integrals)?.compensated(integrals, [0.0; 2]);
        let of_core =
            of_average([own.area, own.total_mean_curvature], [errors.area, errors.total_mean_curvature], 0.0);
        let share = (own.area / area).min(1.0);
        // What lies beside third labels may be curved as much as the rest varies.
        let surface = &integrals.surface;
        let mean = surface.total_mean_curvature / surface.area;
        let spread = (surface.total_squared_mean_curvature / surface.area - mean * mean).max(0.0).sqrt();
        // What third labels bend: of the stricter limit less than the looser one is off by.
        let bent = if self.strict.is_some() { (looser - average).abs() } else { spread };
        let errors = [of_core, (1.0 - share) * spread, bent];
        Some([average, errors.into_iter().fold(0.0, libm::hypot), share])
    }
}

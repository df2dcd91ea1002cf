//! How numbers are made of what was summed over an object.

use super::EmbeddingKind;
use super::clip::{BoundaryTerms, ClipSummary, MeasuredPart};
use super::pass::ObjectSums;
use super::recovery::{Recovered, SamplingNoise};
use super::result::{
    BlurredValues, DescribedSurface, GridSummary, Measured, MeshSummary, NO_ERRORS, StageSeconds,
    SurfaceValues, TopologySummary,
};
use super::setup::Setup;
use super::voxels::VoxelCounts;
use super::warnings::{Evidence, FLAT_SHARE_RECOVERED, NarrowPlace, flat_faces, raise_flags};
use crate::accuracy::{
    CompensationTerms, ErrorModel, Flag, FlagCode, band_variance, compensation_terms, mm_text, shear_errors,
    sheared,
};
use crate::integrals::{Integrals, SurfaceIntegrals};
use crate::surface::SurfaceSummary;
use crate::topology::VoxelTopology;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};
use std::time::Duration;

/// What was summed over an object.
#[derive(Clone, Default)]
pub(super) struct Totals {
    pub(super) sums: ObjectSums,
    pub(super) topology: VoxelTopology,
    pub(super) voxels: VoxelCounts,
    /// Where the object is measured, where the image cuts it and that is left out.
    pub(super) open: Option<OpenPart>,
    /// What corrections did, and the surface that came of it.
    pub(super) recovered: Option<Recovered>,
    /// Time that corrections and their surface took.
    pub(super) recover_time: Duration,
    /// Time until the integrals were known.
    pub(super) integrated: Duration,
    pub(super) topology_time: Duration,
}

/// A part of an object whose surface is open at its ends.
#[derive(Clone, Copy)]
pub(super) struct OpenPart {
    pub(super) part: MeasuredPart,
    pub(super) boundary: BoundaryTerms,
}

impl Totals {
    /// What a shift of the grid does to an object, of which so many copies of one part are off alike.
    fn sampling_noise(&self, model: &ErrorModel, blurred: &Integrals, copies: f64) -> SamplingNoise {
        let faces = self.recovered.map_or(blurred.faces, |recovered| recovered.faces());
        let [of_faces, faces_of_area] = model.of_faces(faces);
        let curved = model.volume_of_curved(blurred.surface.area);
        let of_blurred = || model.variance_of_volume(&self.sums.spectrum);
        let variance = self.recovered.map_or_else(of_blurred, |recovered| recovered.variance_of_volume);
        let known = libm::hypot(curved, of_faces);
        let beyond = (variance - known * known).max(0.0).sqrt();
        SamplingNoise { curved: curved * copies.sqrt(), beyond, of_faces, faces_of_area }
    }
}

impl Setup {
    /// Integrals over phi = 0, and V, A, M and M / A of the original object.
    pub(super) fn values(&self, sums: &ObjectSums, open: Option<&OpenPart>) -> [SurfaceValues; 2] {
        let surviving = self.surviving(sums);
        let terms = self.compensation(surviving, open);
        [blurred_values(surviving, open), compensated(surviving, terms)]
    }

    /// All numbers of an object.
    pub(super) fn measured(&self, totals: &Totals) -> Measured {
        let surviving = self.surviving(&totals.sums);
        let open = totals.open.as_ref();
        let terms = self.compensation(surviving, open);
        let clip = open.map(|open| open.part.summary(self.grid.spacing().cell_volume(), &open.boundary));
        let voxels = totals.voxels.summary(&self.grid);
        let counted_volume = self.soft.map_or(voxels.volume_mm3, |edges| edges.volume);
        let voxel_volume = clip.map_or(counted_volume, |clip| clip.voxel_volume_mm3);
        let evidence = self.evidence(totals, surviving, terms, voxel_volume);
        let topology = TopologySummary::of(&totals.topology, evidence.mesh.as_ref());
        let with_surface = surviving.filter(Integrals::has_surface);
        let errors = with_surface.and_then(|integrals| self.error_model(&integrals));
        let mut flags = self.flags(totals, &evidence, clip);
        if errors.is_none() && with_surface.is_some() {
            flags.push(Flag::new(FlagCode::NotComputed, NO_ERRORS));
        }
        let noise = errors.zip(with_surface).map(|(model, integrals)| model.grid_noise(&integrals));
        let terms = terms.filter(|_| !evidence.compensation_failed());
        let blurred = BlurredValues {
            values: blurred_values(surviving, open),
            grid_noise: noise.map_or_else(SurfaceValues::default, |e| SurfaceValues::of_noise(&e)),
        };
        let surface = self.described();
        let [values, standard_error] = match surface {
            DescribedSurface::Original => {
                let counted = self.soft.is_none().then_some(evidence.voxel_volume);
                self.original(totals, surviving, terms, counted, exact_euler(&topology, open))
            }
            DescribedSurface::Blurred | DescribedSurface::Given => [blurred.values, SurfaceValues::default()],
        };
        let standard_error = self.of_shear_and_rims(standard_error, &values, surviving, open.zip(errors));
        if surface == DescribedSurface::Original {
            flags.extend(large_error(&values, &standard_error, totals.recovered.is_some()));
        }
        Measured {
            surface,
            values,
            standard_error,
            blurred,
            mesh: evidence.mesh.map_or_else(MeshSummary::default, |mesh| MeshSummary::of(&mesh)),
            voxels,
            topology,
            clip,
            parameters: self.parameters,
            grid: GridSummary::of(&self.grid),
            flags,
            recovery: totals.recovered.map(|recovered| recovered.summary),
            compensation: terms,
            timings: totals.timings(),
        }
    }

    /// What the numbers are judged by.
    fn evidence(
        &self,
        totals: &Totals,
        plain: Option<Integrals>,
        terms: Option<CompensationTerms>,
        voxel_volume: f64,
    ) -> Evidence {
        Evidence {
            spacing: self.grid.spacing(),
            embedding: self.parameters.embedding,
            recovering: totals.recovered.is_some(),
            sigma: self.parameters.sigma_mm,
            thickness: self.parameters.thickness_mm,
            epsilon: self.parameters.epsilon,
            saturation: self.parameters.saturation(),
            voxel_volume,
            voxel_euler: totals.topology.euler_characteristic_26,
            narrow: plain.map(|plain| self.narrow_places(&plain)).unwrap_or_default(),
            boundary_curvature: totals.open.as_ref().map(|open| open.boundary.curvature),
            compensated_volume: plain.zip(terms).map(|(plain, terms)| terms.added_to(&plain).volume),
            plain,
            mesh: Some(SurfaceSummary::of_sums(&totals.sums.surface)).filter(|mesh| mesh.triangles > 0),
        }
    }

    /// What the numbers cannot say, but for how large their errors are.
    fn flags(&self, totals: &Totals, evidence: &Evidence, clip: Option<ClipSummary>) -> Vec<Flag> {
        let with_surface = evidence.plain.filter(Integrals::has_surface);
        let mut flags = self.parameter_flags(&totals.voxels, clip);
        flags.extend(raise_flags(evidence));
        flags.extend(with_surface.and_then(|integrals| self.soft?.flag(self.original_area(&integrals))));
        flags.extend(totals.recovered.and_then(|recovered| recovered.summary.flag()));
        flags.extend(totals.recovered.zip(with_surface).and_then(|(recovered, integrals)| {
            flat_faces(recovered.faces(), integrals.surface.area, FLAT_SHARE_RECOVERED)
        }));
        // What was taken for noise is told of as such.
        let noisy = totals.recovered.is_some_and(|recovered| recovered.summary.noisy);
        let original = self.described() == DescribedSurface::Original && !noisy;
        flags.extend(with_surface.filter(|_| original).and_then(|integrals| {
            totals.sums.detail.flag(integrals.surface.area, &self.grid, totals.recovered.is_some())
        }));
        flags
    }

    /// Errors with those of a sheared grid, where one is blurred, and of open rims.
    fn of_shear_and_rims(
        &self,
        errors: SurfaceValues,
        values: &SurfaceValues,
        blurred: Option<Integrals>,
        open: Option<(&OpenPart, ErrorModel)>,
    ) -> SurfaceValues {
        let strain = self.grid.strain();
        let sheared = blurred.zip(self.parameters.shift_sigma().filter(|_| strain > 0.0));
        let errors = sheared.map_or(errors, |(integrals, sigma)| {
            let [area, mean] = shear_errors(strain, sigma, &integrals.surface);
            errors.with(area, mean, values)
        });
        open.map_or(errors, |(open, model)| {
            errors.with(0.0, model.mean_of_open_rims(open.boundary.length), values)
        })
    }

    /// The surface that the unqualified numbers describe: the original object's wherever it can be had,
    /// unless the paper's choices are asked for.
    fn described(&self) -> DescribedSurface {
        let compensable = self.parameters.compensable_sigma().is_some() && !self.measurement.paper;
        match self.parameters.embedding {
            EmbeddingKind::Given => DescribedSurface::Given,
            _ if compensable => DescribedSurface::Original,
            _ => DescribedSurface::Blurred,
        }
    }

    /// Numbers of the original object and their standard errors, with its exact Euler characteristic.
    ///
    /// V is that of the voxels, whose count has no bias however thin the object is. The blurred surface's,
    /// compensated, has the same noise, which a blur only moves, and what compensation leaves besides.
    fn original(
        &self,
        totals: &Totals,
        blurred: Option<Integrals>,
        terms: Option<CompensationTerms>,
        counted: Option<f64>,
        euler: Option<i64>,
    ) -> [SurfaceValues; 2] {
        let modelled = blurred.and_then(|blurred| Some((self.error_model(&blurred)?, blurred)));
        let mut values = compensated(blurred, terms);
        // Copies of one part are all off in the same direction.
        let copies = f64::from(totals.voxels.symmetry(self.grid.spacing()));
        let (detail, spacing) = (&totals.sums.detail, self.grid.spacing());
        let lost = [detail.area(spacing), detail.total_mean_curvature(spacing)];
        let slopes = totals.sums.ripples.mean_square();
        let noise = modelled.map(|(model, blurred)| totals.sampling_noise(&model, &blurred, copies));
        let compensated_errors = modelled.filter(|_| terms.is_some()).map(|(model, blurred)| {
            let surface = &blurred.surface;
            let profile = self.parameters.profile();
            let ripples = profile.map_or([0.0; 2], |profile| model.of_ripples(surface, &profile, slopes));
            let errors = model.compensated(&blurred, ripples).with(lost[0], lost[1], surface);
            let [area, mean] = off_by_volume(surface, values.volume_mm3.zip(counted));
            let errors = model.of_copies(copies, errors, &blurred).with(area, mean, surface);
            errors.moved(noise.map_or(0.0, |noise| noise.beyond), surface)
        });
        let mut errors = compensated_errors.as_ref().map(SurfaceValues::of_errors).unwrap_or_default();
        if let Some([recovered, recovered_errors]) =
            totals.recovered.zip(counted).and_then(|(recovered, counted)| {
                recovered.results(counted, spacing, self.parameters.sigma_mm?, noise?, lost)
            })
        {
            (values, errors) = (recovered, recovered_errors);
        }
        // Straight thin parts lie in the lattice as a whole; of a blur, faces are seen as far as they are flat still.
        let [thin, faces, flipped] = totals.recovered.map_or([1.0, copies.sqrt(), 0.0], |recovered| {
            let area = values.surface_area_mm2.unwrap_or_default();
            [recovered.summary.thinness(), 1.0, recovered.summary.noise_of_volume(area, spacing)]
        });
        let counted_error = noise.map(|noise| {
            let curved = (noise.curved * thin).max(noise.moved());
            libm::hypot(libm::hypot(curved, noise.of_faces * faces), flipped)
        });
        let exact = euler.map(|_| 0.0);
        [
            SurfaceValues {
                volume_mm3: counted.or(values.volume_mm3),
                total_gaussian_curvature: euler.map(|chi| TAU * chi as f64),
                euler_characteristic: euler.map(|chi| chi as f64),
                ..values
            },
            SurfaceValues {
                volume_mm3: counted.map_or(errors.volume_mm3, |_| counted_error),
                total_gaussian_curvature: exact,
                euler_characteristic: exact,
                ..errors
            },
        ]
    }

    /// Where the object and the gaps in it are narrowest, of those whose share of the band counts.
    fn narrow_places(&self, plain: &Integrals) -> [Option<NarrowPlace>; 2] {
        plain.narrow.map(|narrow| {
            let (index, _) = narrow.narrowest?;
            let position_mm = self.grid.affine().apply(index.map(|v| v as f64));
            Some(NarrowPlace { share: narrow.voxels as f64 / plain.band_voxels as f64, position_mm })
        })
    }

    /// The integrals; `None` where nothing is inside the level set.
    pub(super) fn surviving(&self, sums: &ObjectSums) -> Option<Integrals> {
        let integrals = Integrals::of(&sums.integrals, self.grid.spacing());
        (integrals.inside_voxels > 0).then_some(integrals)
    }

    /// What compensation adds; `None` where it is not defined.
    pub(super) fn compensation(
        &self,
        integrals: Option<Integrals>,
        open: Option<&OpenPart>,
    ) -> Option<CompensationTerms> {
        let sigma = self.parameters.compensable_sigma()?;
        let integrals = integrals.filter(Integrals::has_surface)?;
        let own = self.own_sigma(&integrals);
        // Of two blurs whose shifts cancel, half of it is left.
        let sigma = libm::hypot(sigma, if sigma > 0.0 { own } else { own * FRAC_1_SQRT_2 });
        let profile = self.parameters.embedding.profile(libm::hypot(self.parameters.sigma_mm?, own));
        let variance = band_variance(&profile, self.band.delta());
        let mut terms = compensation_terms(&integrals, sigma, variance, self.terraces.as_ref());
        if let Some(OpenPart { boundary, .. }) = open {
            terms.shift.area += sigma * sigma * boundary.area;
            terms.shift.total_mean_curvature += sigma * sigma * boundary.total_mean_curvature;
        }
        Some(terms)
    }

    /// The blur that was in the image before it was blurred, mm; 0 of a mask.
    fn own_sigma(&self, integrals: &Integrals) -> f64 {
        self.soft.map_or(0.0, |edges| edges.own_variance(self.original_area(integrals)).sqrt())
    }

    /// Area before the blur, about.
    fn original_area(&self, integrals: &Integrals) -> f64 {
        let (sigma, surface) = (self.parameters.shift_sigma().unwrap_or(0.0), &integrals.surface);
        surface.area + 2.0 * sigma * sigma * surface.total_squared_mean_curvature
    }

    /// How far integrals are from exact; `None` where that was not studied.
    pub(super) fn error_model(&self, integrals: &Integrals) -> Option<ErrorModel> {
        let (Some(model), Some(edges)) = (self.errors, self.soft) else { return self.errors };
        let sampled = self.parameters.thickness_mm >= self.grid.spacing().largest();
        let occupancies = model.of_occupancies(&self.parameters.profile()?, self.band.delta());
        (sampled && edges.are_occupancies(self.original_area(integrals))).then_some(occupancies)
    }

    fn parameter_flags(&self, voxels: &VoxelCounts, clip: Option<ClipSummary>) -> Vec<Flag> {
        let mut flags = Vec::new();
        let cuts = voxels.cut_areas(&self.grid);
        let touches_border = cuts.as_flattened().iter().any(|&cut| cut > 0.0);
        let embedding = self.parameters.embedding;
        let ends = embedding == EmbeddingKind::Given && self.parameters.padding.is_none();
        if touches_border && ends {
            flags.push(Flag::new(FlagCode::SurfaceLeavesField, "the inside reaches the edge of the field, where its surface is left open: area and curvature miss that part and chi has no boundary term; with padding the field is closed there"));
        } else if touches_border {
            flags.push(touching(cuts, voxels.cut_share(&self.grid), clip));
        }
        flags.extend(sheared(&self.grid));
        if self.parameters.compensable_sigma().is_none() {
            flags.push(Flag::new(FlagCode::CompensationUndefined, without_compensation(embedding)));
        }
        flags
    }
}

/// What the numbers are where nothing is compensated.
fn without_compensation(embedding: EmbeddingKind) -> &'static str {
    match embedding {
        EmbeddingKind::Given => {
            "what made a field that is given, and whether that moved its surface, is not known, so nothing is compensated: the numbers \
             are those of the field's zero level"
        }
        kind if kind.is_distance() => {
            "compensation takes a blur off, and a distance has none: the numbers are those of its zero level"
        }
        _ => {
            "compensation is defined for the Gaussian and the corrected embedding at level 0.5 only, so the numbers are those of the \
             blurred surface"
        }
    }
}

/// Standard error of the area, as a share of it, from which on it is told of.
const LARGE_ERROR: f64 = 0.02;

fn large_error(values: &SurfaceValues, errors: &SurfaceValues, recovered: bool) -> Option<Flag> {
    let share = errors.surface_area_mm2? / values.surface_area_mm2?;
    let message = format!(
        "the standard error of the area is {:.1} % of it: edges, detail or gaps of the size of the {}",
        100.0 * share,
        // What gives detail back is given up with a sigma of one's own.
        if recovered {
            "voxels; only a finer scan tells more"
        } else {
            "blur; leave out a sigma that was chosen, give a map a scale for curvature, or scan finer"
        }
    );
    (share > LARGE_ERROR).then(|| Flag::new(FlagCode::LargeError, message))
}

/// Of an open surface, the Euler characteristic has a part from the boundary (Gauss-Bonnet).
fn blurred_values(integrals: Option<Integrals>, open: Option<&OpenPart>) -> SurfaceValues {
    let mut values = integrals.map_or_else(SurfaceValues::default, |i| SurfaceValues::of(&i));
    if let Some(open) = open {
        let total = |of_surface: f64| (of_surface + open.boundary.curvature) / TAU;
        values.euler_characteristic = values.total_gaussian_curvature.map(total);
    }
    values
}

/// Errors of A and M of a surface that lies off the object's, by as much as its volume tells: where walls are thin, each of
/// their sides lies too far in, which M sees though V and A are small or cancel (Steiner's formulas; H^2 stands for K, whose
/// signs cancel).
fn off_by_volume(surface: &SurfaceIntegrals, volumes: Option<(f64, f64)>) -> [f64; 2] {
    let off = volumes.map_or(0.0, |(own, counted)| (own - counted).abs() / surface.area);
    [2.0 * surface.total_mean_curvature.abs() * off, surface.total_squared_mean_curvature * off]
}

fn compensated(blurred: Option<Integrals>, terms: Option<CompensationTerms>) -> SurfaceValues {
    let known = blurred.zip(terms);
    known.map_or_else(SurfaceValues::default, |(blurred, terms)| {
        SurfaceValues::compensated(&terms.added_to(&blurred))
    })
}

/// The whole number of the original object's surface: its voxels', or, of the part between cuts, its mesh's.
fn exact_euler(topology: &TopologySummary, open: Option<&OpenPart>) -> Option<i64> {
    match open {
        None => Some(topology.euler_characteristic_voxels_26),
        Some(_) => topology.euler_characteristic_mesh,
    }
}

/// Where the image's edge cuts an object, and which share of its voxels' surface that is: both are counted alike.
fn touching(cuts: [[f64; 2]; 3], share: f64, clip: Option<ClipSummary>) -> Flag {
    let mut places = Vec::new();
    for (axis, cuts) in ["x", "y", "z"].iter().zip(cuts) {
        for (end, cut) in ["first", "last"].iter().zip(cuts).filter(|(_, cut)| *cut > 0.0) {
            places.push(format!("{end} {axis} ({} mm2)", mm_text(cut, 1)));
        }
    }
    if let Some(clip) = clip {
        let message = format!(
            "the object reaches the edge of the image in the slice {}: what lies within {} mm of it is left out, so the numbers are those of an \
             open surface between sections of {} mm2",
            places.join(", "),
            mm_text(clip.rim_mm, 4),
            mm_text(clip.section_area_mm2, 1)
        );
        return Flag::new(FlagCode::TouchesBorder, message);
    }
    let message = format!(
        "the object reaches the edge of the image in the slice {}, {:.1} % of its voxels' surface: it is closed there with a flat cap, which \
         counts in volume, area and curvature",
        places.join(", "),
        100.0 * share
    );
    Flag::new(FlagCode::TouchesBorder, message)
}

impl Totals {
    fn timings(&self) -> StageSeconds {
        let times = &self.sums.times;
        StageSeconds {
            recover: self.recover_time.as_secs_f64(),
            embed: times.embed.as_secs_f64(),
            derive: times.derive.as_secs_f64(),
            integrate: times.integrate.as_secs_f64(),
            surface: times.surface.as_secs_f64(),
            topology: self.topology_time.as_secs_f64(),
            integrals: self.integrated.as_secs_f64(),
            ..StageSeconds::default()
        }
    }
}

//! Why voxels, mesh and band disagree about an object's topology, and where.

use super::{Measured, Object, VoxelQuantity};
use crate::accuracy::{FlagCode, decimals_for, place_text};
use crate::tiling::Block;
use crate::topology::{ChangeKind, TopologyChange, topology_changes};
use crate::volume::{Grid, Mask};
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// Between which two objects topology changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChangeStage {
    /// From the voxels to what is inside the surface phi = 0.
    Blur,
    /// From what is inside phi = 0 to what is inside another level of the band.
    Band,
}

/// A change of topology with its place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LocatedChange {
    /// Between what.
    pub stage: ChangeStage,
    /// What; the first of components, cavities and handles that changes decides.
    pub kind: ChangeKind,
    /// By how much the number of 26-connected components grows.
    pub components: i64,
    /// By how much the number of 6-connected cavities grows.
    pub cavities: i64,
    /// By how much the number of handles grows.
    pub handles: i64,
    /// Where, in the world (RAS), mm.
    pub position_mm: [f64; 3],
    /// The voxel there (x, y, z).
    pub voxel: [i64; 3],
    /// Width there, mm: of the strut, hole, piece or cavity, of the wall that was broken or the gap that was filled.
    pub width_mm: f64,
    /// For the band, the share of its levels at which the change has happened; 1 for the blur.
    pub share: f64,
}

impl LocatedChange {
    fn new(stage: ChangeStage, change: &TopologyChange, grid: &Grid, share: f64) -> Self {
        Self {
            stage,
            kind: change.kind,
            components: change.components,
            cavities: change.cavities,
            handles: change.handles,
            position_mm: grid.affine().apply(change.voxel.map(|v| v as f64)),
            voxel: change.voxel,
            width_mm: change.width_mm,
            share,
        }
    }

    /// What it adds to the Euler characteristic of the surface, as far as it has happened.
    pub fn euler_characteristic(&self) -> f64 {
        self.share * (2 * (self.components + self.cavities - self.handles)) as f64
    }

    /// How many of its kind happened at once.
    fn count(&self) -> u64 {
        let growth = [self.components, self.cavities, self.handles];
        growth.into_iter().find(|&n| n != 0).map_or(0, i64::unsigned_abs)
    }
}

/// What was found out about an object's topology.
#[derive(Debug, Clone, PartialEq)]
pub struct TopologyExplanation {
    /// The changes: the blur's, then the band's.
    pub changes: Vec<LocatedChange>,
    /// What the band must see beyond the Euler characteristic of phi = 0: by the coarea formula it sees the mean of those of its levels,
    /// weighted by the delta.
    pub expected_in_band: f64,
    /// The band voxel with the least gradient, where the integral of K is least certain.
    pub weakest: Option<WeakestGradient>,
}

/// Where the field of a band is flattest: near a place at which the topology of its levels changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeakestGradient {
    /// Where, in the world (RAS), mm.
    pub position_mm: [f64; 3],
    /// The gradient there as a share of the steepest of a flat surface.
    pub share: f64,
}

/// Share of the band's levels below which a change inside it is not told.
const LEAST_SHARE: f64 = 0.005;

impl Object {
    /// Where the blur and the band change the object's topology; `None` where there is no blur, or it leaves nothing.
    ///
    /// The voxels are compared with the solids inside three levels of phi: 0, and both ends of the band. The sum of the blur's changes is
    /// exactly the difference of the Euler numbers of the voxels and of those inside phi = 0 (26-connected).
    pub fn explain_topology(&self) -> Option<TopologyExplanation> {
        let scheme = self.scheme().filter(|_| self.setup.parameters.embedding.is_blur())?;
        let half_width = self.delta().half_width();
        let phi = self.voxel_map(VoxelQuantity::Phi, &scheme.limits(half_width))?;
        let below = |level: f64| Mask::of_values(*self.grid(), &phi, |phi| f64::from(phi) < level);
        let at =
            |voxel: [i64; 3]| if phi.region().contains(voxel) { f64::from(phi.get(voxel)) } else { f64::MAX };
        let located =
            |stage, change: &TopologyChange, share| LocatedChange::new(stage, change, self.grid(), share);
        let surface = below(0.0);
        // From far levels to 0: what is deepest on its new side first.
        let mut changes: Vec<LocatedChange> =
            topology_changes(self.mask(), &surface, |voxel| -at(voxel).abs())
                .iter()
                .map(|change| located(ChangeStage::Blur, change, 1.0))
                .collect();
        for (level, outwards) in [(-half_width, false), (half_width, true)] {
            // From 0 to the band's end.
            for change in topology_changes(&surface, &below(level), |voxel| at(voxel).abs()) {
                let passed = self.delta().heaviside(at(change.voxel));
                let share = if outwards { 1.0 - passed } else { passed };
                changes.push(located(ChangeStage::Band, &change, share));
            }
        }
        changes.retain(|change| change.share >= LEAST_SHARE);
        let of_band = changes.iter().filter(|change| change.stage == ChangeStage::Band);
        let expected_in_band = of_band.map(LocatedChange::euler_characteristic).sum();
        let steepest = self.setup.parameters.profile()?.slope(0.0).abs();
        let weakest = weakest_gradient(&phi, half_width, self.grid())
            .map(|(position_mm, gradient)| WeakestGradient { position_mm, share: gradient / steepest });
        Some(TopologyExplanation { changes, expected_in_band, weakest })
    }
}

/// Where in the band the field's gradient, by central differences, is least, and what it is there.
fn weakest_gradient(phi: &Block<f32>, half_width: f64, grid: &Grid) -> Option<([f64; 3], f64)> {
    let (region, spacing) = (phi.region(), grid.spacing().mm());
    let strides = [1, region.extent()[0], region.extent()[0] * region.extent()[1]];
    let values = phi.values();
    let squared = |place: usize| -> f64 {
        let slope = |a: usize| {
            f64::from(values[place + strides[a]] - values[place - strides[a]]) / (2.0 * spacing[a])
        };
        (0..3).map(|a| slope(a).powi(2)).sum()
    };
    let inner = region.grown([-1; 3]);
    let rows = inner.rows().flat_map(|(y, z)| (inner.lower[0]..inner.upper[0]).map(move |x| [x, y, z]));
    let in_band = rows.filter(|&voxel| f64::from(phi.get(voxel)).abs() < half_width);
    let slopes = in_band.map(|voxel| (voxel, squared(phi.offset(voxel))));
    let (voxel, least) = slopes.min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((grid.affine().apply(voxel.map(|v| v as f64)), least.sqrt()))
}

impl Measured {
    /// Whether voxels, mesh and band disagree about the topology.
    pub fn topology_disagrees(&self) -> bool {
        let codes = [FlagCode::EulerNotInteger, FlagCode::EulerDiffersFromVoxels];
        self.flags.iter().any(|flag| codes.contains(&flag.code))
    }

    /// Takes up where topology changed, also in the words of the flags that tell of it.
    pub fn explain(&mut self, explanation: TopologyExplanation) {
        let mesh = self.topology.euler_characteristic_mesh.map(|chi| chi as f64);
        let TopologyExplanation { changes, expected_in_band, weakest } = explanation;
        let expected = mesh.map(|mesh| mesh + expected_in_band);
        let finest = self.grid.spacing_mm.into_iter().fold(f64::INFINITY, f64::min);
        let found = |stage| {
            let of_stage: Vec<_> = changes.iter().filter(|change| change.stage == stage).collect();
            if of_stage.is_empty() { "nothing that counts".to_owned() } else { counted(&of_stage, finest) }
        };
        for flag in &mut self.flags {
            match flag.code {
                FlagCode::EulerDiffersFromVoxels => {
                    let _ = write!(flag.message, ". Blur: {}", found(ChangeStage::Blur));
                }
                FlagCode::EulerNotInteger => {
                    let _ = write!(flag.message, ". Between the band's levels: {}", found(ChangeStage::Band));
                    if let Some((measured, expected)) = self.blurred.euler_characteristic.zip(expected) {
                        let rest = measured - expected;
                        let _ = write!(
                            flag.message,
                            "; that makes {expected:.3}, the rest, {rest:+.3}, is noise of the grid, most of it where gradients are weak"
                        );
                    }
                    if let Some(WeakestGradient { position_mm, share }) = weakest {
                        let _ = write!(
                            flag.message,
                            ": weakest at {}, {:.0} % of a flat surface's",
                            place_text(position_mm, finest),
                            100.0 * share
                        );
                    }
                }
                _ => {}
            }
        }
        self.topology.euler_characteristic_expected = expected;
        self.topology.changes = Some(changes);
    }
}

/// Changes by kind, each with the place of the widest.
fn counted(changes: &[&LocatedChange], finest: f64) -> String {
    let decimals = decimals_for(finest);
    let mut kinds: Vec<ChangeKind> = changes.iter().map(|change| change.kind).collect();
    kinds.sort_unstable_by_key(|kind| *kind as usize);
    kinds.dedup();
    let part = |kind: ChangeKind| {
        let alike = || changes.iter().filter(|change| change.kind == kind);
        let count: u64 = alike().map(|change| change.count()).sum();
        let widest = alike().max_by(|a, b| a.width_mm.total_cmp(&b.width_mm)).expect("there is one");
        let at = place_text(widest.position_mm, finest);
        let plural = if count > 1 { "s" } else { "" };
        let (what, done) = kind.words();
        let the = if count > 1 { "the widest " } else { "" };
        format!("{count} {what}{plural} {done} ({the}{:.decimals$} mm wide, at {at})", widest.width_mm)
    };
    kinds.into_iter().map(part).collect::<Vec<_>>().join(", ")
}

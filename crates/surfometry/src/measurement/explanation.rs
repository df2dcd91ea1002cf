//! Why voxels, mesh and band disagree about an object's topology, and where.

use super::level_sets::LevelSets;
use super::{Measured, Object};
use crate::accuracy::{FlagCode, decimals_for, place_text};
use crate::tiling::WorkTime;
use crate::topology::{ChangeKind, TopologyChange, timed_changes};
use crate::volume::Grid;
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
    ///
    /// Memory follows the surface: some 16 bytes for each voxel of the band and each that the blur puts on the other side, and a few bits
    /// for each of the object's box.
    pub fn explain_topology(&self) -> Option<TopologyExplanation> {
        self.explain_topology_of(usize::MAX, &WorkTime::default())
    }

    /// The same, with the time that it takes; `None` also where more than so many voxels of the band, or that the blur puts on the other
    /// side, would have to be looked at.
    pub(crate) fn explain_topology_of(&self, most: usize, time: &WorkTime) -> Option<TopologyExplanation> {
        let steepest = self.setup.parameters.profile()?.slope(0.0).abs();
        let LevelSets { inner, surface, outer, phi, weakest } = LevelSets::of(self, most, time)?;
        let from_surface = |voxel: [i64; 3]| phi.get(voxel).abs();
        let (outwards, (inwards, blur)) = rayon::join(
            || timed_changes(&surface, &outer, from_surface, time),
            || {
                rayon::join(
                    || timed_changes(&surface, &inner, from_surface, time),
                    // From far levels to 0: what is deepest on its new side first.
                    || timed_changes(&self.mask, &surface, |voxel| -from_surface(voxel), time),
                )
            },
        );
        let located =
            |stage, change: &TopologyChange, share| LocatedChange::new(stage, change, self.grid(), share);
        let mut changes: Vec<LocatedChange> =
            blur.iter().map(|change| located(ChangeStage::Blur, change, 1.0)).collect();
        let passed = |change: &TopologyChange| self.delta().heaviside(f64::from(phi.get(change.voxel)));
        changes.extend(inwards.iter().map(|change| located(ChangeStage::Band, change, passed(change))));
        changes
            .extend(outwards.iter().map(|change| located(ChangeStage::Band, change, 1.0 - passed(change))));
        changes.retain(|change| change.share >= LEAST_SHARE);
        let of_band = changes.iter().filter(|change| change.stage == ChangeStage::Band);
        let expected_in_band = of_band.map(LocatedChange::euler_characteristic).sum();
        let weakest = weakest.map(|(voxel, gradient)| WeakestGradient {
            position_mm: self.grid().affine().apply(voxel.map(|v| v as f64)),
            share: gradient / steepest,
        });
        Some(TopologyExplanation { changes, expected_in_band, weakest })
    }
}

/// What a flag that tells of a disagreement about the topology ends with where its reasons were not looked for.
pub const UNEXPLAINED: &str = ". Where was not looked into, for the object is large: ask for an explanation";

/// Flags that tell of a disagreement about the topology.
const DISAGREEMENTS: [FlagCode; 2] = [FlagCode::EulerNotInteger, FlagCode::EulerDiffersFromVoxels];

impl Measured {
    /// Whether voxels, mesh and band disagree about the topology.
    pub fn topology_disagrees(&self) -> bool {
        self.flags.iter().any(|flag| DISAGREEMENTS.contains(&flag.code))
    }

    /// About how many voxels the band has: its area times its thickness.
    pub fn band_voxels(&self) -> usize {
        let area = self.blurred.surface_area_mm2.unwrap_or_default();
        (area * self.parameters.thickness_mm / self.grid.spacing_mm.iter().product::<f64>()) as usize
    }

    /// Says, in the flags that tell of a disagreement about the topology, that it was not looked for where it changed.
    pub fn leave_unexplained(&mut self) {
        for flag in &mut self.flags {
            if DISAGREEMENTS.contains(&flag.code) {
                flag.message +=
                    ". Where was not looked into, for the object is large: ask for an explanation";
            }
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Measurement;
    use crate::phantoms::Phantom;

    /// A hole that the blur closes, where that may be looked into and where it may not.
    #[test]
    fn what_is_too_large_is_left_and_said_so() {
        let mask =
            Phantom::from_spec("phantom:genus?genus=1&major=3&minor=6").unwrap().labels().unwrap().mask(1);
        let object = Measurement::default().sigma_mm(5.0).prepare(&mask).unwrap();
        let mut measured = object.measure();
        assert!(measured.topology_disagrees());
        let time = WorkTime::default();
        let all = object.explain_topology().unwrap();
        // The band has about as many voxels as is said, and few others differ.
        let band = measured.band_voxels();
        assert!(object.explain_topology_of(band / 2, &time).is_none());
        assert_eq!(object.explain_topology_of(band * 4, &time).unwrap(), all);
        assert!(time.total().as_nanos() > 0);
        measured.leave_unexplained();
        assert!(measured.topology.changes.is_none());
        assert!(
            measured
                .flags
                .iter()
                .all(|f| f.message.ends_with(UNEXPLAINED) == DISAGREEMENTS.contains(&f.code))
        );
    }
}

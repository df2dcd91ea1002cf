//! Why voxels, mesh and band disagree about an object's topology, and where.

use super::level_sets::{BandEnds, LevelSets};
use super::{Measured, Object};
use crate::accuracy::{FlagCode, decimals_for, place_text};
use crate::tiling::{SparseField, WorkTime};
use crate::topology::{ChangeKind, TopologyChange, timed_changes};
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
    /// Width there, mm: of the strut, hole, piece or cavity, of the wall that was broken or the gap that was
    /// filled.
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
    /// What the band must see beyond the Euler characteristic of phi = 0: by the coarea formula it sees the
    /// mean of those of its levels, weighted by the delta. `None` where only the blur was looked at.
    pub expected_in_band: Option<f64>,
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

/// What of an object is compared: only its voxels with phi = 0, which takes no longer than measuring it, or
/// also the levels of the band, whose voxels have their turn one after the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Looked {
    /// What runs over files ask for.
    #[cfg_attr(not(feature = "io"), allow(dead_code))]
    Blur,
    BlurAndBand,
}

/// Share of the band's levels below which a change inside it is not told.
const LEAST_SHARE: f64 = 0.005;

impl Object {
    /// Where the blur and the band change the object's topology; `None` where there is no blur, or it leaves
    /// nothing.
    ///
    /// The voxels are compared with the solids inside three levels of phi: 0, and both ends of the band. The
    /// sum of the blur's changes is exactly the difference of the Euler numbers of the voxels and of those
    /// inside phi = 0 (26-connected).
    ///
    /// Memory follows the surface: some 16 bytes for each voxel of the band and each that the blur puts on
    /// the other side, and a few bits for each of the object's box.
    pub fn explain_topology(&self) -> Option<TopologyExplanation> {
        self.explain_topology_of(Looked::BlurAndBand, usize::MAX, &WorkTime::default())
    }

    /// The same, or only what the blur changed, with the time that it takes; `None` also where more than so
    /// many values of the field would have to be kept: those of voxels that the blur puts on the other side,
    /// and those of the band.
    pub(crate) fn explain_topology_of(
        &self,
        looked: Looked,
        most: usize,
        time: &WorkTime,
    ) -> Option<TopologyExplanation> {
        let LevelSets { surface, band, phi } =
            LevelSets::of(self, looked == Looked::BlurAndBand, most, time)?;
        let from_surface = |voxel: [i64; 3]| phi.get(voxel).abs();
        let (of_band, of_blur) = rayon::join(
            || band.map(|ends| self.changes_in_band(&ends, &surface, &phi, time)),
            // From far levels to 0: what is deepest on its new side first.
            || timed_changes(&self.mask, &surface, |voxel| -from_surface(voxel), time),
        );
        let of_blur = of_blur.iter().map(|change| self.located(ChangeStage::Blur, change, 1.0));
        let mut changes: Vec<LocatedChange> = of_blur.collect();
        let Some((of_band, weakest)) = of_band else {
            return Some(TopologyExplanation { changes, expected_in_band: None, weakest: None });
        };
        let expected_in_band = Some(of_band.iter().map(LocatedChange::euler_characteristic).sum());
        changes.extend(of_band);
        Some(TopologyExplanation { changes, expected_in_band, weakest })
    }

    fn located(&self, stage: ChangeStage, change: &TopologyChange, share: f64) -> LocatedChange {
        LocatedChange::new(stage, change, self.grid(), share)
    }

    /// What changes between the levels of the band, and where its field is flattest.
    fn changes_in_band(
        &self,
        BandEnds { inner, outer, weakest }: &BandEnds,
        surface: &Mask,
        phi: &SparseField,
        time: &WorkTime,
    ) -> (Vec<LocatedChange>, Option<WeakestGradient>) {
        let from_surface = |voxel: [i64; 3]| phi.get(voxel).abs();
        let (outwards, inwards) = rayon::join(
            || timed_changes(surface, outer, from_surface, time),
            || timed_changes(surface, inner, from_surface, time),
        );
        let passed = |change: &TopologyChange| self.delta().heaviside(f64::from(phi.get(change.voxel)));
        let located = |change, share| self.located(ChangeStage::Band, change, share);
        let mut changes: Vec<LocatedChange> =
            inwards.iter().map(|change| located(change, passed(change))).collect();
        changes.extend(outwards.iter().map(|change| located(change, 1.0 - passed(change))));
        changes.retain(|change| change.share >= LEAST_SHARE);
        let steepest = self.setup.parameters.profile().map_or(f64::NAN, |profile| profile.slope(0.0).abs());
        let weakest = weakest.map(|(voxel, gradient)| WeakestGradient {
            position_mm: self.grid().affine().apply(voxel.map(|v| v as f64)),
            share: gradient / steepest,
        });
        (changes, weakest)
    }
}

/// What a flag that tells of a disagreement about the topology ends with where its reasons were not looked
/// for.
pub const UNEXPLAINED: &str = ". Where was not looked into: ask for an explanation";

impl Measured {
    /// Whether phi = 0 and the voxels disagree about the topology: the blur changed it.
    pub fn blur_changed_topology(&self) -> bool {
        self.flags.iter().any(|flag| flag.code == FlagCode::EulerDiffersFromVoxels)
    }

    /// Says, in the flags that tell of a disagreement about the topology, that it was not looked for where it
    /// changed.
    pub fn leave_unexplained(&mut self) {
        for flag in &mut self.flags {
            if matches!(flag.code, FlagCode::EulerDiffersFromVoxels | FlagCode::EulerNotInteger) {
                flag.message += UNEXPLAINED;
            }
        }
    }

    /// Takes up where topology changed, also in the words of the flags that tell of it.
    pub fn explain(&mut self, explanation: TopologyExplanation) {
        let mesh = self.topology.euler_characteristic_mesh.map(|chi| chi as f64);
        let TopologyExplanation { changes, expected_in_band, weakest } = explanation;
        let expected = mesh.zip(expected_in_band).map(|(mesh, in_band)| mesh + in_band);
        let finest = self.grid.spacing_mm.into_iter().fold(f64::INFINITY, f64::min);
        let found = |stage| {
            let of_stage: Vec<_> = changes.iter().filter(|change| change.stage == stage).collect();
            if of_stage.is_empty() {
                "nothing that shows at voxel centres".to_owned()
            } else {
                counted(&of_stage, finest)
            }
        };
        for flag in &mut self.flags {
            match flag.code {
                FlagCode::EulerDiffersFromVoxels => {
                    let _ = write!(flag.message, ". Blur: {}", found(ChangeStage::Blur));
                }
                FlagCode::EulerNotInteger if expected_in_band.is_none() => flag.message += UNEXPLAINED,
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
        assert!(measured.blur_changed_topology());
        let time = WorkTime::default();
        let all = object.explain_topology().unwrap();
        let of_blur = object.explain_topology_of(Looked::Blur, usize::MAX, &time).unwrap();
        assert!(time.total().as_nanos() > 0);
        // The hole is the blur's; what the band adds is left out, and said so.
        assert_eq!(of_blur.changes, all.changes[..of_blur.changes.len()]);
        assert!(all.changes[of_blur.changes.len()..].iter().all(|change| change.stage == ChangeStage::Band));
        assert_eq!((of_blur.expected_in_band, of_blur.weakest), (None, None));
        // Few voxels are on the other side of the blur, and many in the band.
        assert!(object.explain_topology_of(Looked::Blur, 10, &time).is_none());
        assert!(object.explain_topology_of(Looked::BlurAndBand, 8_000, &time).is_none());
        assert!(object.explain_topology_of(Looked::Blur, 8_000, &time).is_some());
        let unexplained = |measured: &Measured, code| {
            measured.flags.iter().find(|f| f.code == code).is_none_or(|f| f.message.ends_with(UNEXPLAINED))
        };
        let mut of_blur_only = measured.clone();
        of_blur_only.explain(of_blur);
        assert!(unexplained(&of_blur_only, FlagCode::EulerNotInteger));
        assert!(!unexplained(&of_blur_only, FlagCode::EulerDiffersFromVoxels));
        measured.leave_unexplained();
        assert!(measured.topology.changes.is_none());
        assert!(unexplained(&measured, FlagCode::EulerDiffersFromVoxels));
    }
}

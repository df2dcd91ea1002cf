//! Bones as smooth unions of simple parts: every individual's are a little different, and their integrals are
//! known.

use super::bone_part::Part;
use super::chance::Chance;
use super::curved_triangles::integrate_until_steady;
use super::jet_arithmetic::{Smooth, smooth_maximum, smooth_minimum};
use super::{Shape, Truth, value_and_jet};

/// A bone of an individual, made of parts that blend.
///
/// Not an atlas: sizes and proportions are those of adults, so that curvature, thickness and topology are
/// what a clinical scan holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Bone {
    parts: Vec<Part>,
    /// What stays open however close the parts are: the vertebral canal.
    canal: Option<Part>,
    /// Width over which parts blend, mm.
    blend: f64,
    /// Where the bone is cut flat, along z, mm.
    cut: Option<f64>,
}

/// Rounds the rims of a flat cut and of the canal, mm.
const RIM: f64 = 3.0;
/// Spacing of the first lattice for integrals, mm.
const STEP: f64 = 2.9;
/// By how much V, A and M may change from one lattice to the next; they are then some thirty times better
/// than that.
const TOLERANCE: f64 = 1e-4;

impl Bone {
    /// A right proximal femur, cut below the lesser trochanter as the paper's are: one component without
    /// handles.
    pub fn proximal_femur(individual: u32) -> Self {
        let mut vary = Individual::new(individual, 0);
        let size = vary.size();
        let neck = 50.0 + vary.by(6.0);
        let parts = vec![
            Part::ellipsoid([34.0, 2.0, 37.0], vary.radii([23.0, 23.0, 22.5], 0.03)),
            Part::ellipsoid([17.0, 1.0, 22.0], vary.radii([31.0, 13.5, 16.0], 0.05)).turned_about_y(-neck),
            Part::ellipsoid([-13.0, -2.0, 17.0], vary.radii([16.0, 19.0, 24.0], 0.06)),
            Part::ellipsoid([5.0, -13.0, -22.0], vary.radii([9.0, 8.0, 13.0], 0.08)),
            Part::drum([-5.0, 0.0, -30.0], vary.radii([16.5, 15.0, 60.0], 0.05)),
        ];
        Self { parts, canal: None, blend: 7.0, cut: Some(-44.0 + vary.by(4.0)) }.scaled(size)
    }

    /// A fourth lumbar vertebra: one handle, the vertebral canal; `second_hole`: another one, in a transverse
    /// process, as two of the paper's have by contouring or by anatomy.
    pub fn lumbar_vertebra(individual: u32, second_hole: bool) -> Self {
        let mut vary = Individual::new(individual, 1);
        let size = vary.size();
        let width = 1.0 + vary.by(0.05);
        let process = 1.0 + vary.by(0.08);
        let mut parts = vec![
            Part::drum([0.0, 24.0, 0.0], vary.radii([24.5, 17.5, 14.5], 0.05)),
            Part::ring([0.0, -4.0, 3.0], 17.5 * width, 4.0).stretched(2.0),
            Part::ellipsoid([0.0, -39.0, -2.0], vary.radii([4.5, 17.0, 11.0], 0.06)),
        ];
        for side in [-1.0, 1.0] {
            let at = |x: f64, y: f64, z: f64| [side * x * width, y, z];
            parts.push(Part::ellipsoid(at(16.5, 6.0, 5.0), vary.radii([5.0, 12.0, 7.5], 0.05)));
            parts.push(Part::ellipsoid(at(33.0 * process, -4.0, 4.0), vary.radii([20.0, 5.5, 6.5], 0.06)));
            parts.push(Part::ellipsoid(at(20.0, -13.0, 12.0), vary.radii([5.5, 6.5, 13.0], 0.06)));
            parts.push(Part::ellipsoid(at(17.0, -20.0, -10.0), vary.radii([5.5, 6.0, 13.0], 0.06)));
        }
        if second_hole {
            parts.push(Part::ring([61.0 * process, -4.0, 4.0], 8.5, 3.2));
        }
        // As long as any bone is high.
        let canal = Part::ellipsoid([0.0, -4.0, 3.0], [12.0 * width, 9.5, 100.0]);
        Self { parts, canal: Some(canal), blend: 5.0, cut: None }.scaled(0.88 * size)
    }

    fn scaled(self, size: f64) -> Self {
        let parts = self.parts.into_iter().map(|part| part.scaled(size)).collect();
        let canal = self.canal.map(|canal| canal.scaled(size));
        Self { parts, canal, blend: self.blend * size, cut: self.cut.map(|z| z * size) }
    }

    fn implicit<T: Smooth>(&self, p: [T; 3]) -> T {
        let mut parts = self.parts.iter().map(|part| part.implicit(p));
        let first = parts.next().expect("a bone has parts");
        let mut whole = parts.fold(first, |whole, part| smooth_minimum(whole, part, self.blend));
        if let Some(canal) = &self.canal {
            whole = smooth_maximum(whole, canal.implicit(p) * -1.0, RIM);
        }
        match self.cut {
            Some(z) => smooth_maximum(whole, p[2] * -1.0 + z, RIM),
            None => whole,
        }
    }
}

impl Shape for Bone {
    value_and_jet!();

    fn truth(&self) -> Option<Truth> {
        integrate_until_steady(self, STEP, TOLERANCE)
    }

    fn half_extent(&self) -> [f64; 3] {
        let reach =
            |axis: usize| self.parts.iter().map(|part| part.reach(axis)).fold(0.0, f64::max) + self.blend;
        std::array::from_fn(reach)
    }
}

/// What makes an individual.
struct Individual(Chance);

impl Individual {
    fn new(number: u32, kind: u64) -> Self {
        Self(Chance::new((u64::from(number) << 8) | kind))
    }

    fn by(&mut self, size: f64) -> f64 {
        self.0.about_zero(size)
    }

    /// Of the whole bone.
    fn size(&mut self) -> f64 {
        1.0 + self.by(0.16)
    }

    fn radii(&mut self, radii: [f64; 3], share: f64) -> [f64; 3] {
        radii.map(|r| r * (1.0 + self.by(share)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::phantoms::{Phantom, Pose};
    use crate::topology::VoxelTopology;

    fn topology(bone: Bone) -> i64 {
        let phantom = Phantom::new(bone, Pose::new([0.0; 3], [0.0; 3]), [1.2; 3]).unwrap();
        VoxelTopology::of(&phantom.labels().unwrap().mask(1)).euler_characteristic_26
    }

    /// Sizes of adults, and the topology that is promised, of a cohort.
    #[test]
    fn individuals_are_bones() {
        let (mut femurs, mut vertebrae) = (Vec::new(), Vec::new());
        for individual in 1..=50 {
            let bones = [Bone::proximal_femur(individual), Bone::lumbar_vertebra(individual, false)];
            for (bone, volumes) in bones.into_iter().zip([&mut femurs, &mut vertebrae]) {
                let phantom = Phantom::new(bone, Pose::new([0.0; 3], [0.0; 3]), [2.5; 3]).unwrap();
                volumes.push(phantom.labels().unwrap().mask(1).voxels() as f64 * 2.5f64.powi(3));
            }
        }
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        let deviation = |v: &[f64]| (v.iter().map(|x| (x - mean(v)).powi(2)).sum::<f64>() / 49.0).sqrt();
        println!("{} {} {} {}", mean(&femurs), deviation(&femurs), mean(&vertebrae), deviation(&vertebrae));
        assert!((150e3..180e3).contains(&mean(&femurs)) && (60e3..75e3).contains(&mean(&vertebrae)));
        // The paper's 50: 160 000 +- 46 000 and 67 000 +- 13 000 mm^3.
        assert!((0.15..0.4).contains(&(deviation(&femurs) / mean(&femurs))));
        assert!((0.12..0.4).contains(&(deviation(&vertebrae) / mean(&vertebrae))));
        for individual in [1, 50] {
            assert_eq!(topology(Bone::proximal_femur(individual)), 2);
            assert_eq!(topology(Bone::lumbar_vertebra(individual, false)), 0);
            assert_eq!(topology(Bone::lumbar_vertebra(individual, true)), -2);
        }
        assert_eq!(Bone::proximal_femur(3), Bone::proximal_femur(3));
        assert_ne!(Bone::proximal_femur(3), Bone::proximal_femur(4));
    }
}

//! A closed mesh as voxels, against another tool's voxels.

use surfometry::io::{read_labels, read_mesh};
use surfometry::surface::Mesh;
use surfometry::volume::Spacing;
use surfometry::voxelisation::VoxelisedMesh;
use surfometry_real_data::real;

fn voxels(mesh: &Mesh, spacing: [f64; 3]) -> u64 {
    VoxelisedMesh::new(mesh, Spacing::new(spacing).unwrap()).unwrap().labels().unwrap().mask(1).voxels()
}

/// The femur's mesh on the lattice of the voxels that trimesh made of it: as many voxels within the noise of
/// where the lattice lies.
#[test]
#[cfg_attr(not(shared_data), ignore = "../shared/data is absent")]
fn a_real_femur() {
    let mesh = read_mesh(&real("mesh/libhip_m3_left_proximal_femur.stl")).unwrap();
    assert!((mesh.volume() - 184_805.0).abs() < 1.0 && (mesh.area() - 24_385.0).abs() < 1.0);
    for (name, spacing) in [("1mm", [1.0; 3]), ("2mm", [2.0; 3]), ("0.8x0.8x2.5mm", [0.8, 0.8, 2.5])] {
        let file = format!("bone/libhip_m3_left_proximal_femur_{name}.nii.gz");
        let theirs = read_labels(real(&file)).unwrap().mask(1).voxels();
        let ours = voxels(&mesh, spacing);
        let apart = ours as f64 / theirs as f64 - 1.0;
        println!("{name}: {ours} voxels, trimesh {theirs}");
        // A flat cut of 1100 mm2 lies along the slices: half a slice of it is 0.3 % at 1 mm.
        assert!(apart.abs() < 0.004 * spacing[2], "{name} {apart}");
    }
}

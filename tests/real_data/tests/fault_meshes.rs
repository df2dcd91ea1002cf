//! Small meshes that earlier versions got wrong; tests beside the code make others of each kind.

use surfometry::inputs::{InputError, OpenOptions, open};
use surfometry::volume::LabelImage;
use surfometry_real_data::fault;

/// Volume and centroid of the voxels of 0.5 mm, or why there are none.
fn voxels(name: &str) -> Result<(f64, [f64; 3]), InputError> {
    let options = OpenOptions { spacing: Some([0.5; 3]), ..OpenOptions::default() };
    let source = open(fault(&format!("io/{name}")).to_str().unwrap(), &options)?;
    let image = LabelImage::from_slabs(&mut source.slabs()?)?;
    let measured = surfometry::Measurement::default().run(image.mask(1)).unwrap();
    Ok((measured.voxels.count as f64 / 8.0, measured.voxels.centroid_mm))
}

/// Balls of 790 mm3 at (20, 30, 40), one of them said in LPS; two where there are two.
#[test]
#[cfg_attr(not(shared_data), ignore = "../shared/data is absent")]
fn meshes_that_are_read() {
    for (name, volume, centre) in [
        ("A1_two_solids.stl", 1581.0, [35.0, 30.0, 40.0]),
        ("A3_faces_and_tristrips.ply", 1581.0, [35.0, 30.0, 40.0]),
        ("C4_slicer_lps.stl", 790.0, [-20.0, -30.0, 40.0]),
        ("D1_binary_solid_newline.stl", 790.0, [20.0, 30.0, 40.0]),
        ("D2_nameless_solid.stl", 790.0, [20.0, 30.0, 40.0]),
        ("D5_latin1_comment.ply", 790.0, [20.0, 30.0, 40.0]),
        ("D14_unused_vertex_far_away.ply", 790.0, [20.0, 30.0, 40.0]),
        ("E3_vertices_one_ulp_apart.stl", 790.0, [20.0, 30.0, 40.0]),
    ] {
        let (found, place) = voxels(name).unwrap();
        assert!((found / volume - 1.0).abs() < 0.01, "{name}: {found} mm3");
        assert!((0..3).all(|axis| (place[axis] - centre[axis]).abs() < 0.01), "{name}: {place:?}");
    }
}

#[test]
#[cfg_attr(not(shared_data), ignore = "../shared/data is absent")]
fn meshes_that_are_told_what_is_wrong() {
    for (name, words) in [
        ("E1_one_face_flipped.stl", ["turned opposite ways", "orient them alike"]),
        ("E4_metres.stl", ["0.012", "in metres, scale them by 1000"]),
        ("E7_nan.ply", ["vertex 3", "not finite"]),
        ("E11_empty.stl", ["the file is empty", "export the mesh again"]),
    ] {
        let error = voxels(name).unwrap_err().to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{name}: {error}");
    }
}

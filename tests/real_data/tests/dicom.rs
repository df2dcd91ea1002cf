//! A liver that dcmqi wrote as a DICOM segmentation and as NRRD, with the scan that it was made on, and the layers of a
//! segmentation of 3D Slicer's.

use surfometry::io::{read_header, read_labels};
use surfometry::runs::{Plan, records_of};
use surfometry_real_data::{fault, real};

#[test]
#[cfg_attr(not(shared_data), ignore = "../shared/data is absent")]
fn a_segmentation_is_what_its_writer_says() {
    let folder = real("formats/original");
    let [ours, theirs] = ["liver.dcm", "liver_seg.nrrd"].map(|name| read_labels(folder.join(name)).unwrap());
    let [a, b] = [&ours, &theirs].map(|image| image.mask(1));
    assert_eq!((a.voxels(), b.voxels()), (107_098, 107_098));
    assert_eq!(ours.summary(1).unwrap().bounds, theirs.summary(1).unwrap().bounds);
    let [p, q] = [&ours, &theirs].map(|image| image.grid().affine().apply([511.0, 3.0, 2.0]));
    assert!((0..3).all(|w| (p[w] - q[w]).abs() < 1e-3), "{p:?} {q:?}");
    assert_eq!(read_header(folder.join("liver.dcm")).unwrap().labels.names()[&1], "Liver");
    // Three slices of the scan, of which any stands for all.
    let scan = read_header(folder.join("02.dcm")).unwrap();
    let at = scan.affine.unwrap().apply([511.0, 3.0, 2.0]);
    assert!((0..3).all(|w| (at[w] - q[w]).abs() < 1e-3), "{at:?} {q:?}");
}

#[test]
#[cfg_attr(not(shared_data), ignore = "../shared/data is absent")]
fn both_layers_of_a_segmentation_are_measured() {
    let path = fault("io/E5_seg_two_layers.seg.nrrd");
    let records = records_of(path.to_str().unwrap(), &Plan::default()).unwrap();
    let names: Vec<&str> = records.iter().map(|record| record.name.as_deref().unwrap()).collect();
    assert_eq!(names, ["Femur", "Canal"]);
    assert!(records.iter().all(|record| record.measured.voxels.count == 3885));
}

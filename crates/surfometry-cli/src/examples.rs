//! Examples below the help of each command, of the files that its users have.

pub(crate) const PROGRAM: &str = "\
Examples:
  surfometry bone.nii.gz                              numbers of each label
  surfometry measure scans/*.nii.gz -o results.csv    a table of many
  surfometry map bone.nii.gz --png bone.png           a picture
  surfometry report bone.nii.gz -o bone.html          a page to keep
  surfometry phantom:torus                            without a file at hand
`surfometry COMMAND -h` shows the options that most need, `--help` all.";

pub(crate) const MEASURE: &str = "\
Examples:
  surfometry measure scan1.nii.gz scan2.mha -o results.csv
  surfometry measure vertebrae.nii.gz --label 20-22 --details
  surfometry measure ct.nii.gz --threshold 226.. --largest-component
  surfometry measure scan.nii.gz --sigma 1.5 --png scan.png
  surfometry measure array.npy --spacing 0.5,0.5,1.0";

pub(crate) const MAP: &str = "\
Examples:
  surfometry map bone.nii.gz --png bone.png
  surfometry map bone.nii.gz -o bone.vtp    for ParaView, 3D Slicer
  surfometry map vertebrae.nii.gz -o spine.pdf --together --title \"L1 to L3\"
  surfometry map scan.nii.gz -o map.nii.gz --voxels mean-curvature,phi
  surfometry map scan.nii.gz --against later.nii.gz -o change.vtp";

pub(crate) const REPORT: &str = "\
Examples:
  surfometry report scan.nii.gz -o scan.html
  surfometry report scans/*.nii.gz -o cohort.html --title \"Cohort A\"";

pub(crate) const INFO: &str = "\
Examples:
  surfometry info scan.nii.gz
  surfometry info scans/*.nii.gz --json";

pub(crate) const EMBED: &str = "\
Examples:
  surfometry embed scan.nii.gz -o blurred.nii.gz";

pub(crate) const PHANTOM: &str = "\
Examples:
  surfometry phantom 'ellipsoid?radii=30,20,15&rotate=10,20,30' -o e.nii.gz
  surfometry phantom 'torus?major=20&minor=8&spacing=0.8,0.8,1.2' -o t.nii.gz";

pub(crate) const SWEEP: &str = "\
Examples:
  surfometry sweep scan.nii.gz --range 1:4:7 --chart sweep.png
  surfometry sweep scan.nii.gz --range 1:4:7 -o sweep.csv";

pub(crate) const REFERENCE: &str = "\
Examples:
  surfometry reference scan.nii.gz
  surfometry reference scan.nii.gz --method crofton-13 -o crofton.csv";

pub(crate) const COMPARE: &str = "\
Examples:
  surfometry compare ours.csv theirs.csv
  surfometry compare ours.csv theirs.csv --column volume_mm3 -o page.html";

pub(crate) const VALIDATE: &str = "\
Examples:
  surfometry validate --shape torus --poses 1 --resolutions 10 --ratios 1";

pub(crate) const COHORT: &str = "\
Examples:
  surfometry cohort -o cohort --femurs 0 --vertebrae 1";

pub(crate) const MERGE: &str = "\
Examples:
  surfometry merge shard-*.jsonl -o results.csv";

pub(crate) const RERUN: &str = "\
Examples:
  surfometry rerun results.json";

pub(crate) const GENERATE: &str = "\
Examples:
  surfometry generate man -o man
  surfometry generate bash > surfometry.bash";

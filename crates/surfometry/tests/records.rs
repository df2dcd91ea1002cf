//! Records as documents: they come back as they were, and tables have a column for everything that they hold.

use surfometry::Measurement;
use surfometry::inputs::{OpenOptions, Preparation};
use surfometry::io::write_labels;
use surfometry::measurement::Clip;
use surfometry::reference_methods::METHODS;
use surfometry::runs::{
    Batch, Collected, Plan, Record, ReferenceRecord, ReferenceTask, Row, flatten, records_of,
};
use surfometry::volume::{Grid, LabelImage};
use surfometry::{Choice, Control};

fn records() -> Vec<Record> {
    let measurement = Measurement::default();
    let preparation = Preparation { threshold: Some("1..".parse().unwrap()), ..Preparation::default() };
    let open = OpenOptions { preparation, ..OpenOptions::default() };
    let clipped = Plan { measurement: measurement.clip(Clip::Exclude), open, ..Plan::default() };
    // A rod that ends at the edge of its image.
    let grid = Grid::axis_aligned([40, 30, 30], [1.0; 3]).unwrap();
    let inside = |[_, y, z]: [usize; 3]| (y as f64 - 14.3).hypot(z as f64 - 14.6) < 8.0;
    let voxels: Vec<u8> = (0..grid.voxel_count()).map(|n| u8::from(inside(grid.index_of(n)))).collect();
    let folder = tempfile::tempdir().unwrap();
    let rod = folder.path().join("rod.nii");
    write_labels(&rod, &LabelImage::from_voxels(grid, &voxels).unwrap()).unwrap();
    let thin = "phantom:capsule?radius=2&length=20&rotate=20,30,40";
    let inputs = [("phantom:torus?major=12&minor=5", Plan::default()), (thin, Plan::default())];
    let mut records: Vec<Record> = [inputs[0].clone(), inputs[1].clone(), (rod.to_str().unwrap(), clipped)]
        .into_iter()
        .flat_map(|(name, plan)| records_of(name, &plan).unwrap())
        .collect();
    // As of a map.
    records[0].curvature_sigma_mm = Some(3.0);
    records
}

#[test]
fn they_come_back_as_they_were() {
    for record in records() {
        let text = serde_json::to_string(&record).unwrap();
        let back: Record = serde_json::from_str(&text).unwrap();
        assert_eq!(serde_json::to_string(&back).unwrap(), text);
        assert_eq!(
            (back.measured.values, back.measured.flags),
            (record.measured.values, record.measured.flags)
        );
    }
}

#[test]
fn tables_have_all_columns() {
    let columns = Record::columns();
    let mut seen = Vec::new();
    for record in records() {
        let row = flatten(&serde_json::to_value(&record).unwrap());
        // Regions and interfaces have tables of their own.
        let apart = ["clip", "preparation", "recovery", "truth", "regions", "interfaces"];
        for key in row.keys().filter(|key| !apart.contains(&key.as_str())) {
            assert!(columns.contains(key), "{key}");
            seen.push(key.clone());
        }
    }
    let missing: Vec<&String> = columns.iter().filter(|column| !seen.contains(column)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn reference_tables_have_all_columns() {
    let (control, mut found) = (Control::default(), Collected::default());
    let inputs = ["phantom:ball?radius=5".to_owned()];
    let batch = Batch { inputs: &inputs, open: OpenOptions::default(), control: &control, cure: |_| None };
    let task = ReferenceTask { plan: Plan::default(), methods: METHODS.to_vec() };
    batch.run(&task, &mut found).unwrap();
    let columns = ReferenceRecord::columns();
    for record in &found.results {
        let row = flatten(&serde_json::to_value(record).unwrap());
        assert!(row.keys().eq(&columns), "{:?} {columns:?}", row.keys().collect::<Vec<_>>());
        let text = serde_json::to_string(record).unwrap();
        assert_eq!(&serde_json::from_str::<ReferenceRecord>(&text).unwrap(), record);
    }
    assert_eq!(found.results.len(), METHODS.len());
}

/// Words of choices are the words of records, and each is found by its own.
#[test]
fn choices_have_one_name() {
    use surfometry::measurement::{Derivatives, EmbeddingKind};
    fn check<T: Choice + serde::Serialize + std::fmt::Debug>() {
        for &choice in T::ALL {
            assert_eq!(serde_json::to_value(choice).unwrap(), choice.word());
            assert_eq!(T::of_word(choice.word()), Ok(choice));
        }
        let error = T::of_word("nothing").unwrap_err().to_string();
        assert!(error.contains(T::ALL[0].word()) && error.contains(T::WHAT), "{error}");
    }
    check::<EmbeddingKind>();
    check::<Derivatives>();
    check::<surfometry::integrals::Smearing>();
    check::<surfometry::integrals::QuadratureRule>();
    check::<Clip>();
    check::<surfometry::measurement::DescribedSurface>();
}

/// A run that was told to stop ends, without a result that is not whole.
#[test]
fn a_stop_ends_a_batch() {
    let control = Control::default();
    let inputs: Vec<String> = (5..30).map(|r| format!("phantom:ball?radius={r}")).collect();
    let batch = Batch { inputs: &inputs, open: OpenOptions::default(), control: &control, cure: |_| None };
    control.stop();
    let mut found = Collected::default();
    let outcome = batch.run(&surfometry::runs::MeasureTask::default(), &mut found).unwrap();
    assert!(outcome.stopped && found.results.is_empty() && found.failures.is_empty());
}

//! Every bone by every method.

use crate::bones::{Bone, paper_distance, progress, rebinarised};
use crate::desk::Desk;
use anyhow::{Context, Result};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::Path;
use surfometry::Measurement;
use surfometry::measurement::{EmbeddingKind, Measured};
use surfometry::reference_methods::{
    Crofton, OdgaardGundersen, ReferenceMethod, ReferenceValues, Triangulation, VoxelCounting,
};
use surfometry::volume::Mask;

/// A bone by a method; what the method does not give is not a number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Row {
    /// The bone.
    pub(crate) bone: String,
    /// Femur or L4.
    pub(crate) kind: String,
    /// The method, and on what.
    pub(crate) method: String,
    /// V, mm^3.
    pub(crate) volume: f64,
    /// A, mm^2.
    pub(crate) area: f64,
    /// M / A, 1/mm.
    pub(crate) average_mean_curvature: f64,
    /// Of the surface.
    pub(crate) euler_characteristic: f64,
}

const FILE: &str = "measurements.csv";

/// What the validation measured.
pub(crate) fn read_rows(desk: &Desk) -> Result<Vec<Row>> {
    read(&desk.of_other("validation", FILE)).context("run the experiment `validation` first")
}

fn read(path: &Path) -> Result<Vec<Row>> {
    let mut reader = csv::Reader::from_path(path)?;
    Ok(reader.deserialize().collect::<Result<_, _>>()?)
}

/// Measures the cohort, bones in parallel, and keeps the table; reads it where it is there.
pub(super) fn measure_cohort(desk: &Desk) -> Result<Vec<Row>> {
    let table = desk.folder().join(FILE);
    if table.exists() {
        return read(&table);
    }
    let cohort = desk.cohort()?;
    let bar = progress("bones measured", cohort.len());
    let measured: Result<Vec<Vec<Row>>> = cohort
        .par_iter()
        .map(|bone| {
            let rows = measure(bone).with_context(|| bone.name.clone());
            bar.inc(1);
            rows
        })
        .collect();
    bar.finish_and_clear();
    let rows: Vec<Row> = measured?.into_iter().flatten().collect();
    let mut writer = csv::Writer::from_path(&table)?;
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    writer.flush()?;
    Ok(rows)
}

fn measure(bone: &Bone) -> Result<Vec<Row>> {
    let mask = bone.mask()?;
    let embedded = Measurement::paper().prepare(&mask)?;
    let again = rebinarised(&embedded)?;
    let at_papers_sigma = Measurement::default().sigma_mm(2.0).prepare(&mask)?.measure();
    let mut rows = Vec::new();
    let mut add = |method: &str, [volume, area, average, chi]: [f64; 4]| {
        rows.push(Row {
            bone: bone.name.clone(),
            kind: bone.kind().to_owned(),
            method: method.to_owned(),
            volume,
            area,
            average_mean_curvature: average,
            euler_characteristic: chi,
        });
    };
    let truth = &bone.truth;
    add(
        "exact",
        [truth.volume, truth.surface_area, truth.average_mean_curvature, truth.euler_characteristic as f64],
    );
    add("paper", plain(&embedded.measure()));
    add("defaults at the paper's sigma", plain(&at_papers_sigma));
    add("defaults at the paper's sigma, original", original(&at_papers_sigma));
    add("defaults", original(&Measurement::default().run(&mask)?));
    add("defaults on the re-binarised mask", original(&Measurement::default().run(&again)?));
    add("distance", plain(&paper_distance().run(&mask)?));
    add("distance on the re-binarised mask", plain(&paper_distance().run(&again)?));
    let itk = paper_distance().embedding(EmbeddingKind::DistanceToVoxels);
    add("distance to boundary voxels on the re-binarised mask", plain(&itk.run(&again)?));
    for method in REFERENCES {
        add(method.name(), reference(method, &mask));
    }
    for method in [
        &Triangulation::Smoothed as &dyn ReferenceMethod,
        &Triangulation::SmoothedOneSided,
        &OdgaardGundersen::Foreground26,
    ] {
        add(&format!("{} on the re-binarised mask", method.name()), reference(method, &again));
    }
    Ok(rows)
}

const REFERENCES: [&dyn ReferenceMethod; 5] = [
    &Triangulation::Smoothed,
    &Triangulation::Mask,
    &Crofton::Directions13,
    &VoxelCounting,
    &OdgaardGundersen::Foreground26,
];

/// The blurred object.
fn plain(m: &Measured) -> [f64; 4] {
    [
        m.blurred.volume_mm3,
        m.blurred.surface_area_mm2,
        m.blurred.average_mean_curvature_per_mm,
        m.blurred.euler_characteristic,
    ]
    .map(|value| value.unwrap_or(f64::NAN))
}

/// The original one; its characteristic is that of the surface as a mesh.
fn original(m: &Measured) -> [f64; 4] {
    let c = &m.values;
    let chi = m.topology.euler_characteristic_mesh.map(|chi| chi as f64);
    [c.volume_mm3, c.surface_area_mm2, c.average_mean_curvature_per_mm, chi]
        .map(|value| value.unwrap_or(f64::NAN))
}

fn reference(method: &dyn ReferenceMethod, mask: &Mask) -> [f64; 4] {
    let ReferenceValues {
        volume_mm3,
        surface_area_mm2,
        average_mean_curvature_per_mm,
        euler_characteristic,
        ..
    } = method.measure(mask);
    [volume_mm3, surface_area_mm2, average_mean_curvature_per_mm, euler_characteristic]
        .map(|value| value.unwrap_or(f64::NAN))
}

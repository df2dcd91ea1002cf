//! Parts of objects by regions, and interfaces, as tables for people.

use super::layout::Layout;
use super::numbers::with_error;
use std::collections::BTreeSet;
use surfometry::runs::Record;

/// What stands below the objects of an input; empty where neither was asked for.
pub(crate) fn parts_text(records: &[Record]) -> String {
    regions_text(records) + &interfaces_text(records)
}

fn regions_text(records: &[Record]) -> String {
    let mut layout = Layout::new(&["label", "region", "V mm3", "A mm2", "M mm", "int K"]);
    for record in records {
        for part in record.regions.iter().flatten() {
            let label = record.label.as_ref().map(ToString::to_string).unwrap_or_default();
            let region = part.name.clone().unwrap_or_else(|| part.region.to_string());
            let (v, e) = (&part.values, &part.standard_error);
            layout.row(vec![
                label,
                region,
                with_error(v.volume_mm3, e.volume_mm3),
                with_error(v.surface_area_mm2, e.surface_area_mm2),
                with_error(v.total_mean_curvature_mm, e.total_mean_curvature_mm),
                with_error(v.total_gaussian_curvature, e.total_gaussian_curvature),
            ]);
        }
    }
    let any = records.iter().any(|record| record.regions.is_some());
    if any { format!("\n{}", layout.text()) } else { String::new() }
}

fn interfaces_text(records: &[Record]) -> String {
    let mut layout = Layout::new(&["label", "touches", "A mm2", "M mm", "mean H 1/mm"]);
    let mut known = BTreeSet::new();
    for interface in records.iter().flat_map(|record| record.interfaces.iter().flatten()) {
        let [first, second] =
            [0, 1].map(|n| interface.names[n].clone().unwrap_or_else(|| interface.labels[n].to_string()));
        if !known.insert(interface.labels.each_ref().map(ToString::to_string)) {
            continue;
        }
        let (v, e) = (&interface.values, &interface.standard_error);
        layout.row(vec![
            first,
            second,
            with_error(v.surface_area_mm2, e.surface_area_mm2),
            with_error(v.total_mean_curvature_mm, e.total_mean_curvature_mm),
            with_error(v.average_mean_curvature_per_mm, e.average_mean_curvature_per_mm),
        ]);
    }
    let any = records.iter().any(|record| record.interfaces.is_some());
    if any { format!("\n{}", layout.text()) } else { String::new() }
}

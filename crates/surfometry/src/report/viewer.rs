//! The page's program, from its files.

/// In the order in which they need each other.
const FILES: [&str; 20] = [
    include_str!("viewer/elements.js"),
    include_str!("viewer/numbers.js"),
    include_str!("viewer/packed.js"),
    include_str!("viewer/colors.js"),
    include_str!("viewer/attributes.js"),
    include_str!("viewer/camera.js"),
    include_str!("viewer/surface_drawing.js"),
    include_str!("viewer/surface_view.js"),
    include_str!("viewer/histogram.js"),
    include_str!("viewer/selection.js"),
    include_str!("viewer/places.js"),
    include_str!("viewer/slices.js"),
    include_str!("viewer/sweep.js"),
    include_str!("viewer/object_numbers.js"),
    include_str!("viewer/method.js"),
    include_str!("viewer/object_page.js"),
    include_str!("viewer/table.js"),
    include_str!("viewer/downloads.js"),
    include_str!("viewer/overview.js"),
    include_str!("viewer/main.js"),
];

/// One script in which nothing is global.
pub(super) fn program() -> String {
    format!("\"use strict\";\n(() => {{\n{}\n}})();\n", FILES.concat())
}

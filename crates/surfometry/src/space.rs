//! Vectors of space, and directions that are spread evenly over the sphere.

use std::f64::consts::PI;

/// Half of the 26 neighbours of a point of a lattice, one of each two that lie opposite.
pub(crate) const HALF_OF_NEIGHBOURS: [[i64; 3]; 13] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 1, 0],
    [1, -1, 0],
    [1, 0, 1],
    [1, 0, -1],
    [0, 1, 1],
    [0, 1, -1],
    [1, 1, 1],
    [1, 1, -1],
    [1, -1, 1],
    [-1, 1, 1],
];

pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(a: [f64; 3]) -> f64 {
    libm::sqrt(dot(a, a))
}

/// The direction of a vector that is not zero.
pub(crate) fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = length(a);
    a.map(|v| v / length)
}

/// A Fibonacci sphere.
#[cfg(feature = "pictures")]
pub(crate) fn sphere(count: usize) -> impl Iterator<Item = [f64; 3]> {
    (0..count).map(move |n| on_spiral(n, 1.0 - (2 * n + 1) as f64 / count as f64))
}

/// Directions of lines, which have no sense: half of a Fibonacci sphere.
pub(crate) fn half_sphere(count: usize) -> impl Iterator<Item = [f64; 3]> {
    (0..count).map(move |n| on_spiral(n, (n as f64 + 0.5) / count as f64))
}

/// Each point is turned by the golden angle against the one before.
fn on_spiral(number: usize, z: f64) -> [f64; 3] {
    let golden = PI * (3.0 - libm::sqrt(5.0));
    let (sin, cos) = libm::sincos(golden * number as f64);
    let across = libm::sqrt(1.0 - z * z);
    [across * cos, across * sin, z]
}

//! From the world to a picture's pixels.

use super::view::Basis;
use super::viewpoint::Viewpoint;
use crate::space::{dot, minus};

/// A parallel projection: lengths across the line of sight are true everywhere in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// The picture's axes.
    pub basis: Basis,
    /// World position at the middle of the picture, mm.
    pub center: [f64; 3],
    /// Size of a pixel.
    pub mm_per_pixel: f64,
    /// Width and height in pixels.
    pub size: [usize; 2],
}

impl Camera {
    /// Pixel coordinates, x to the right and y down from the upper left corner, and the depth in mm toward
    /// the viewer.
    pub fn project(&self, point: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.basis.coordinates(minus(point, self.center));
        let [width, height] = self.size.map(|n| n as f64);
        [0.5 * width + x / self.mm_per_pixel, 0.5 * height - y / self.mm_per_pixel, z]
    }

    /// World position at pixel coordinates, in the plane through the camera's centre.
    pub fn unproject(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        let [width, height] = self.size.map(|n| n as f64);
        let (along, above) = ((x - 0.5 * width) * self.mm_per_pixel, (0.5 * height - y) * self.mm_per_pixel);
        std::array::from_fn(|i| self.center[i] + along * self.basis.right[i] + above * self.basis.up[i])
    }
}

impl Basis {
    /// Components of a vector along right, up and toward.
    pub fn coordinates(&self, vector: [f64; 3]) -> [f64; 3] {
        [dot(vector, self.right), dot(vector, self.up), dot(vector, self.toward)]
    }

    /// The vector with these components.
    pub(crate) fn vector(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| x * self.right[i] + y * self.up[i] + z * self.toward[i])
    }
}

/// What a view shows of an object: the rectangle that its points fall into.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Prospect {
    pub(crate) view: Viewpoint,
    /// World position of the middle.
    pub(crate) center: [f64; 3],
    /// Width and height, mm.
    pub(crate) extent: [f64; 2],
}

impl Prospect {
    /// Around points; those that are not finite are passed over.
    pub(crate) fn of(view: Viewpoint, points: impl IntoIterator<Item = [f64; 3]>) -> Self {
        let basis = view.basis();
        let empty = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let (low, high) =
            points.into_iter().filter(|p| p.iter().all(|v| v.is_finite())).fold(empty, |(low, high), p| {
                let c = basis.coordinates(p);
                (std::array::from_fn(|i| low[i].min(c[i])), std::array::from_fn(|i| high[i].max(c[i])))
            });
        if low[0] > high[0] {
            return Self { view, center: [0.0; 3], extent: [0.0; 2] };
        }
        let middle: [f64; 3] = std::array::from_fn(|i| 0.5 * (low[i] + high[i]));
        Self { view, center: basis.vector(middle), extent: [high[0] - low[0], high[1] - low[1]] }
    }
}

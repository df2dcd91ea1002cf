//! Rotation and shift of a phantom.

/// How a shape lies in the world: rotated about x, then y, then z, then shifted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Rotation matrix, shape to world.
    rotation: [[f64; 3]; 3],
    /// Shift in mm.
    shift: [f64; 3],
}

impl Pose {
    /// Angles in degrees about x, y, z; shift in mm.
    pub fn new(degrees: [f64; 3], shift: [f64; 3]) -> Self {
        let [x, y, z] = degrees.map(|d| libm::sincos(d.to_radians()));
        let rotation_x = [[1.0, 0.0, 0.0], [0.0, x.1, -x.0], [0.0, x.0, x.1]];
        let rotation_y = [[y.1, 0.0, y.0], [0.0, 1.0, 0.0], [-y.0, 0.0, y.1]];
        let rotation_z = [[z.1, -z.0, 0.0], [z.0, z.1, 0.0], [0.0, 0.0, 1.0]];
        Self { rotation: product(rotation_z, product(rotation_y, rotation_x)), shift }
    }

    /// A world point in the shape's frame.
    pub fn to_shape(&self, world: [f64; 3]) -> [f64; 3] {
        let moved: [f64; 3] = std::array::from_fn(|a| world[a] - self.shift[a]);
        std::array::from_fn(|a| (0..3).map(|b| self.rotation[b][a] * moved[b]).sum())
    }

    /// Half the edges of a world box, centred on the shift, that holds a box of the shape's frame.
    pub fn half_extent(&self, half: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|a| (0..3).map(|b| self.rotation[a][b].abs() * half[b]).sum())
    }

    /// Shift in mm.
    pub fn shift(&self) -> [f64; 3] {
        self.shift
    }
}

fn product(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotates_about_x_then_y_then_z() {
        let pose = Pose::new([90.0, 90.0, 0.0], [1.0, 0.0, 0.0]);
        // The shape's y axis goes to z (about x), then to x (about y).
        let back = pose.to_shape([3.0, 0.0, 0.0]);
        assert!((back[1] - 2.0).abs() < 1e-12 && back[0].abs() < 1e-12 && back[2].abs() < 1e-12, "{back:?}");
    }
}

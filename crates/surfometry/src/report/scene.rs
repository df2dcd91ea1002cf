//! A surface as plotly.js takes it.

use crate::Choice;
use crate::pictures::color_scale;
use crate::surface::{LocalQuantity, Surface};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::Serialize;

/// Triangles of a page beyond which a browser turns no surface smoothly, and the file grows past 50 MB.
pub const MOST_TRIANGLES: usize = 1_000_000;

/// A surface and its quantities, as typed arrays in base64.
#[derive(Debug, Clone, Serialize)]
pub struct Scene {
    x: TypedArray,
    y: TypedArray,
    z: TypedArray,
    i: TypedArray,
    j: TypedArray,
    k: TypedArray,
    quantities: Vec<Layer>,
}

/// One quantity's values and colours.
#[derive(Debug, Clone, Serialize)]
struct Layer {
    name: &'static str,
    title: &'static str,
    unit: &'static str,
    values: TypedArray,
    limits: [f64; 2],
    colors: Vec<(f64, String)>,
}

/// The form that plotly.js knows for typed arrays.
#[derive(Debug, Clone, Serialize)]
struct TypedArray {
    dtype: &'static str,
    bdata: String,
}

impl TypedArray {
    fn floats(values: impl Iterator<Item = f64>) -> Self {
        let bytes: Vec<u8> = values.flat_map(|v| (v as f32).to_le_bytes()).collect();
        Self { dtype: "f4", bdata: BASE64_STANDARD.encode(bytes) }
    }

    fn integers(values: impl Iterator<Item = u32>) -> Self {
        let bytes: Vec<u8> = values.flat_map(u32::to_le_bytes).collect();
        Self { dtype: "u4", bdata: BASE64_STANDARD.encode(bytes) }
    }
}

/// Stops of a colour scale.
const STOPS: usize = 33;

impl Scene {
    /// `None` where there is no surface, or one of more triangles than the page has room for.
    pub fn of(surface: &Surface, room: usize) -> Option<Self> {
        let mesh = &surface.mesh;
        if surface.is_empty() || mesh.triangles.len() > room {
            return None;
        }
        let coordinate = |a: usize| TypedArray::floats(mesh.vertices.iter().map(move |v| v[a]));
        let corner = |n: usize| TypedArray::integers(mesh.triangles.iter().map(move |t| t[n]));
        let layer = |quantity: LocalQuantity| {
            let values = surface.values(quantity)?;
            let scale = color_scale(surface, quantity, None);
            let stops = scale.stops(STOPS).into_iter();
            Some(Layer {
                name: quantity.name(),
                title: quantity.meaning(),
                unit: quantity.unit(),
                values: TypedArray::floats(values.into_iter()),
                limits: scale.limits(),
                colors: stops.map(|(place, [r, g, b])| (place, format!("rgb({r},{g},{b})"))).collect(),
            })
        };
        let shown = LocalQuantity::ALL.iter().copied().filter(|quantity| !quantity.is_standard_error());
        Some(Self {
            x: coordinate(0),
            y: coordinate(1),
            z: coordinate(2),
            i: corner(0),
            j: corner(1),
            k: corner(2),
            quantities: shown.filter_map(layer).collect(),
        })
    }
}

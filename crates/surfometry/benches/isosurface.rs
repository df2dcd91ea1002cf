//! Time to extract phi = 0 from a field in memory, attributes excluded: `isosurface FIELD.npy [SPACING]`.
//!
//! Prints seconds, triangles, vertices. `benches/peers/isosurface.py` runs it in turn with scikit-image.

use std::time::Instant;
use surfometry::io::{ReadOptions, read_field};
use surfometry::surface::extract;

fn main() {
    // `cargo bench` adds an option of its own.
    let Some(path) = std::env::args().skip(1).find(|argument| !argument.starts_with("--")) else {
        println!("usage: isosurface FIELD.npy; benches/peers/isosurface.py makes one");
        return;
    };
    let field = read_field(&path, ReadOptions { spacing: Some([1.0; 3]) }).expect("a readable field");
    let start = Instant::now();
    let mesh = extract(&&field, field.grid());
    println!("{} {} {}", start.elapsed().as_secs_f64(), mesh.triangles.len(), mesh.vertices.len());
}

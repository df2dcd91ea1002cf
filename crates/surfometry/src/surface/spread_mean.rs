//! Local means over a surface.

use std::collections::HashMap;

/// Means of vertices' values around each vertex, weighted by area: values are shared out to the nodes of a
/// lattice and taken from there again, both trilinearly, so that the mean varies smoothly and its width, a
/// standard deviation of 0.58 lattice edges, does not depend on the mesh.
///
/// The lattice's node 0 is the world's origin; surfaces that pass within an edge of each other are averaged
/// together.
#[derive(Debug)]
pub(super) struct SpreadMean {
    /// By vertex: the nodes around, and their weights.
    nodes: Vec<[u32; 8]>,
    weights: Vec<[f32; 8]>,
    count: usize,
}

impl SpreadMean {
    /// Of vertices in mm, with a lattice of an edge in mm.
    pub(super) fn new(vertices: &[[f64; 3]], edge: f64) -> Self {
        let mut numbers: HashMap<[i64; 3], u32> = HashMap::new();
        let (mut nodes, mut weights) =
            (Vec::with_capacity(vertices.len()), Vec::with_capacity(vertices.len()));
        for vertex in vertices {
            let place = vertex.map(|v| v / edge);
            let lower = place.map(f64::floor);
            nodes.push(std::array::from_fn(|corner| {
                let node = std::array::from_fn(|a| lower[a] as i64 + (corner >> a & 1) as i64);
                let next = numbers.len() as u32;
                *numbers.entry(node).or_insert(next)
            }));
            weights.push(std::array::from_fn(|corner| {
                let along = |a: usize| {
                    let upper = place[a] - lower[a];
                    if corner >> a & 1 == 1 { upper } else { 1.0 - upper }
                };
                (along(0) * along(1) * along(2)) as f32
            }));
        }
        Self { nodes, weights, count: numbers.len() }
    }

    /// Means of several values at once; a vertex without area counts nowhere.
    pub(super) fn of<const N: usize>(&self, values: &[[f64; N]], areas: &[f64]) -> Vec<[f64; N]> {
        let mut sums = vec![([0.0; N], 0.0); self.count];
        let around = || self.nodes.iter().zip(&self.weights);
        for (((nodes, weights), value), &area) in around().zip(values).zip(areas) {
            for (&node, &weight) in nodes.iter().zip(weights) {
                let (sum, total) = &mut sums[node as usize];
                let weight = f64::from(weight) * area;
                sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += weight * value);
                *total += weight;
            }
        }
        let mean = |(nodes, weights): (&[u32; 8], &[f32; 8])| {
            let (mut mean, mut total) = ([0.0; N], 0.0);
            for (&node, &weight) in nodes.iter().zip(weights) {
                let (sum, area) = &sums[node as usize];
                mean.iter_mut().zip(sum).for_each(|(mean, sum)| *mean += f64::from(weight) * sum);
                total += f64::from(weight) * area;
            }
            mean.map(|sum| if total > 0.0 { sum / total } else { 0.0 })
        };
        around().map(mean).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A constant stays; of a step along a line, half is seen at the step, nothing two edges away.
    #[test]
    fn means_are_local() {
        let line: Vec<[f64; 3]> = (0..400).map(|n| [0.1 * f64::from(n), 0.3, -7.2]).collect();
        let areas = vec![0.7; line.len()];
        let mean = SpreadMean::new(&line, 4.0);
        assert!(mean.of(&vec![[3.0]; line.len()], &areas).iter().all(|m| (m[0] - 3.0).abs() < 1e-12));
        let step: Vec<[f64; 1]> = line.iter().map(|p| [f64::from(u8::from(p[0] >= 20.0))]).collect();
        let smooth = mean.of(&step, &areas);
        assert!((smooth[200][0] - 0.5).abs() < 0.02, "{}", smooth[200][0]);
        assert!(smooth[119][0] == 0.0 && (smooth[281][0] - 1.0).abs() < 1e-12);
        assert!(
            smooth.windows(2).all(|pair| pair[1][0] > pair[0][0] - 1e-9 && pair[1][0] - pair[0][0] < 0.03)
        );
    }
}

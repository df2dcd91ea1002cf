//! Voxels of a band with their derivatives, a column a number.

use super::Jet;

/// A voxel of the band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandVoxel {
    /// Image index.
    pub index: [i64; 3],
    /// The field and its derivatives there.
    pub jet: Jet,
}

/// Most voxels that are handed on together: their columns stay in the processor's nearest caches.
pub(crate) const CAPACITY: usize = 256;
/// Most voxels that are added together.
pub(crate) const GROUP: usize = u8::BITS as usize;

/// Some voxels of a band. Kept by columns, so that curvature is computed for many at once.
#[derive(Debug, Clone)]
pub struct BandVoxels {
    count: usize,
    /// Neighbours along x: the index of the first, and a bit for each that belongs to the band.
    groups: Vec<([i64; 3], u8)>,
    /// A jet's ten numbers; the unused end of each is of no meaning.
    columns: Vec<[f64; CAPACITY]>,
}

impl BandVoxels {
    /// None.
    pub(crate) fn new() -> Self {
        Self { count: 0, groups: Vec::with_capacity(CAPACITY), columns: vec![[0.0; CAPACITY]; 10] }
    }

    /// Hands on voxels that come one by one, in parts: what is left to do where
    /// [`visit_band`](super::Differentiation::visit_band) is implemented for derivatives of one's own.
    pub fn hand_on(voxels: impl IntoIterator<Item = BandVoxel>, visit: &mut dyn FnMut(&Self)) {
        let mut band = Self::new();
        for BandVoxel { index, jet } in voxels {
            band.push_jet(index, &jet, visit);
        }
        band.flush(visit);
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// One of a jet's ten numbers, of all voxels and some that are of no meaning.
    pub(crate) fn column(&self, number: usize) -> &[f64; CAPACITY] {
        &self.columns[number]
    }

    /// Image indices.
    pub(crate) fn indices(&self) -> impl Iterator<Item = [i64; 3]> + '_ {
        let of_group = |&([x, y, z], bits): &([i64; 3], u8)| {
            (0..GROUP as i64).filter(move |n| bits >> n & 1 == 1).map(move |n| [x + n, y, z])
        };
        self.groups.iter().flat_map(of_group)
    }

    /// One by one.
    pub fn iter(&self) -> impl Iterator<Item = BandVoxel> + '_ {
        self.indices().enumerate().map(|(number, index)| BandVoxel { index, jet: self.jet(number) })
    }

    /// The field and its derivatives at one of them, by number.
    pub(crate) fn jet(&self, number: usize) -> Jet {
        let of = |column: usize| self.columns[column][number];
        Jet {
            value: of(0),
            gradient: std::array::from_fn(|a| of(1 + a)),
            hessian: std::array::from_fn(|a| of(4 + a)),
        }
    }

    /// Adds those of 8 neighbours along x whose bits are set; their numbers lie in `columns` from `from` on,
    /// and 8 more may be read. Hands all on and starts again where another group might not fit.
    #[inline(always)]
    pub(crate) fn push_window<const N: usize>(
        &mut self,
        first: [i64; 3],
        bits: u8,
        columns: &[[f32; N]; 10],
        from: usize,
        visit: &mut dyn FnMut(&Self),
    ) {
        let mut rest = u32::from(bits);
        let mut count = self.count;
        while rest != 0 {
            // Neighbours that belong to the band lie together: they move together, and what lies behind is
            // written over.
            let lane = rest.trailing_zeros() as usize;
            let neighbours = (rest >> lane).trailing_ones() as usize;
            for (column, numbers) in self.columns.iter_mut().zip(columns) {
                let numbers: &[f32; GROUP] =
                    numbers[from + lane..][..GROUP].try_into().expect("of this length");
                column[count..][..GROUP].copy_from_slice(&numbers.map(f64::from));
            }
            count += neighbours;
            rest &= !0 << (lane + neighbours);
        }
        self.finish_group(first, bits, count - self.count, visit);
    }

    /// Adds one by its jet.
    pub(crate) fn push_jet(&mut self, index: [i64; 3], jet: &Jet, visit: &mut dyn FnMut(&Self)) {
        self.put(self.count, jet);
        self.finish_group(index, 1, 1, visit);
    }

    fn put(&mut self, place: usize, jet: &Jet) {
        let numbers = [jet.value].into_iter().chain(jet.gradient).chain(jet.hessian);
        for (column, number) in self.columns.iter_mut().zip(numbers) {
            column[place] = number;
        }
    }

    /// The same voxels with other derivatives.
    pub(super) fn with_jets(&self, jet: impl Fn(&Jet) -> Jet) -> Self {
        let mut band = self.clone();
        for number in 0..self.count {
            band.put(number, &jet(&self.jet(number)));
        }
        band
    }

    #[inline(always)]
    fn finish_group(&mut self, first: [i64; 3], bits: u8, count: usize, visit: &mut dyn FnMut(&Self)) {
        self.groups.push((first, bits));
        self.count += count;
        if self.count > CAPACITY - 2 * GROUP {
            self.flush(visit);
        }
    }

    /// Hands on what is left.
    pub(crate) fn flush(&mut self, visit: &mut dyn FnMut(&Self)) {
        if !self.is_empty() {
            visit(self);
            self.groups.clear();
            self.count = 0;
        }
    }
}

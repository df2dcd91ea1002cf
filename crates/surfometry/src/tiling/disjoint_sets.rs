//! What is connected with what.

/// Union-find with path halving.
#[derive(Debug, Clone, Default)]
pub(crate) struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// Adds sets of one member each; the first one's number.
    pub(crate) fn add(&mut self, count: usize) -> usize {
        let first = self.parent.len();
        let end = u32::try_from(first + count).expect("fewer than 2^32 members");
        self.parent.extend(first as u32..end);
        first
    }

    /// Number of members.
    pub(crate) fn members(&self) -> usize {
        self.parent.len()
    }

    /// The member that stands for another's set.
    pub(crate) fn root(&mut self, i: usize) -> usize {
        let mut i = i as u32;
        loop {
            let parent = self.parent[i as usize];
            if parent == i {
                return i as usize;
            }
            let next = self.parent[parent as usize];
            self.parent[i as usize] = next;
            i = next;
        }
    }

    /// Makes one of two members' sets.
    pub(crate) fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b) as u32;
    }

    /// Number of sets.
    pub(crate) fn count(&self) -> u64 {
        (0..).zip(&self.parent).filter(|&(i, &parent): &(u32, &u32)| i == parent).count() as u64
    }
}

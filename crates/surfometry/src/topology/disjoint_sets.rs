//! What is connected with what.

/// Union-find with path halving.
#[derive(Debug, Clone, Default)]
pub(crate) struct DisjointSets {
    parent: Vec<usize>,
}

impl DisjointSets {
    /// Adds sets of one member each; the first one's number.
    pub(crate) fn add(&mut self, count: usize) -> usize {
        let first = self.parent.len();
        self.parent.extend(first..first + count);
        first
    }

    /// The member that stands for another's set.
    pub(crate) fn root(&mut self, mut i: usize) -> usize {
        while self.parent[i] != i {
            self.parent[i] = self.parent[self.parent[i]];
            i = self.parent[i];
        }
        i
    }

    /// Makes one of two members' sets.
    pub(crate) fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
    }

    /// Keeps the sets of some members only, each member numbered by its place in the list; how many other sets there were.
    pub(crate) fn keep(&mut self, members: &[usize]) -> u64 {
        let roots: Vec<usize> = members.iter().map(|&member| self.root(member)).collect();
        let all = self.count();
        let mut first = std::collections::HashMap::new();
        let parent: Vec<usize> =
            roots.iter().enumerate().map(|(place, root)| *first.entry(*root).or_insert(place)).collect();
        self.parent = parent;
        all - first.len() as u64
    }

    /// Number of sets.
    pub(crate) fn count(&self) -> u64 {
        self.parent.iter().enumerate().filter(|(i, parent)| i == *parent).count() as u64
    }
}

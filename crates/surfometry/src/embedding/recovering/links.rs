//! What each of many does to others.

/// Others, ascending, and how much is done to each, of one after the other: 8 bytes a pair, in one piece of memory, for there
/// are millions.
#[derive(Debug, Default)]
pub(super) struct Links {
    pairs: Vec<(u32, f32)>,
    /// Where each begins.
    firsts: Vec<usize>,
}

impl Links {
    /// The next one, without links so far.
    pub(super) fn begin(&mut self) {
        self.firsts.push(self.pairs.len());
    }

    /// To the last one.
    pub(super) fn push(&mut self, other: u32, value: f32) {
        self.pairs.push((other, value));
    }

    pub(super) fn of(&self, number: usize) -> &[(u32, f32)] {
        let end = self.firsts.get(number + 1).copied().unwrap_or(self.pairs.len());
        &self.pairs[self.firsts[number]..end]
    }

    /// Of parts, one after the other.
    pub(super) fn joined(parts: Vec<Self>) -> Self {
        let mut all = Self::default();
        all.pairs.reserve_exact(parts.iter().map(|part| part.pairs.len()).sum());
        for part in parts {
            all.firsts.extend(part.firsts.iter().map(|first| first + all.pairs.len()));
            all.pairs.extend_from_slice(&part.pairs);
        }
        all
    }

    /// Of some, which have no links but among each other, by their places.
    pub(super) fn of_members(&self, members: &[u32], place: &[u32]) -> Self {
        let mut own = Self::default();
        own.pairs.reserve_exact(members.iter().map(|&member| self.of(member as usize).len()).sum());
        for &member in members {
            own.begin();
            own.pairs.extend(
                self.of(member as usize).iter().map(|&(other, value)| (place[other as usize], value)),
            );
        }
        own
    }
}

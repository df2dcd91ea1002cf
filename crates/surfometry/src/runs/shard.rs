//! A part of a run's inputs, for one of several machines.

use super::words::WordError;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Every so manieth input of a run, beginning with one of the first: neighbours in a list are often alike in size, so
/// that all shards have about as much to do. Which inputs these are follows from their order alone.
///
/// ```
/// use surfometry::runs::Shard;
/// let shard: Shard = "2/3".parse()?;
/// assert_eq!(shard.inputs(&["a", "b", "c", "d", "e"]), ["b", "e"]);
/// assert!("4/3".parse::<Shard>().is_err());
/// # Ok::<(), surfometry::runs::WordError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Shard {
    number: usize,
    of: usize,
}

impl Shard {
    /// The shard that has all inputs.
    pub const ALL: Self = Self { number: 1, of: 1 };

    /// Which it is, from 1 on.
    pub fn number(self) -> usize {
        self.number
    }

    /// Of how many.
    pub fn of(self) -> usize {
        self.of
    }

    /// Its own among all inputs, in their order.
    pub fn inputs<T: Clone>(self, all: &[T]) -> Vec<T> {
        all.iter().skip(self.number - 1).step_by(self.of).cloned().collect()
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Shard {
    type Err = WordError;

    fn from_str(text: &str) -> Result<Self, WordError> {
        let parts =
            text.split_once('/').and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match parts {
            Some((number, of)) if (1..=of).contains(&number) => Ok(Self { number, of }),
            _ => Err(WordError(format!("`{text}`: write which shard, and of how many: 1/8 to 8/8"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_input_is_in_one_shard() {
        for (count, of) in [(0, 1), (5, 7), (100, 1), (100, 7), (99, 9)] {
            let all: Vec<usize> = (0..count).collect();
            let mut seen = vec![0; count];
            for number in 1..=of {
                let shard: Shard = format!("{number}/{of}").parse().unwrap();
                let own = shard.inputs(&all);
                for input in own {
                    seen[input] += 1;
                }
            }
            assert!(seen.iter().all(|&times| times == 1));
        }
    }
}

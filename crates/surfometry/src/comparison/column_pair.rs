//! Columns as a user names them.

/// A column of the method's table, and one of the standard's.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnPair {
    /// In the method's table.
    pub method: String,
    /// In the standard's.
    pub standard: String,
}

/// `NAME`, or `METHOD:STANDARD` of columns that are called differently; which it is, where a name has a colon
/// itself, only the tables tell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColumnChoice(String);

impl ColumnChoice {
    /// The columns that are meant: the one reading of which both tables have the columns. Without any the first
    /// of which one table has its column, or what is split at the first colon.
    ///
    /// # Errors
    /// The readings, where there are several.
    pub fn resolve(
        &self,
        of_method: impl Fn(&str) -> bool,
        of_standard: impl Fn(&str) -> bool,
    ) -> Result<ColumnPair, Vec<ColumnPair>> {
        let readings = self.readings();
        let both = |pair: &&ColumnPair| of_method(&pair.method) && of_standard(&pair.standard);
        let found: Vec<&ColumnPair> = readings.iter().filter(both).collect();
        match found.as_slice() {
            [] => {
                let one = |pair: &&ColumnPair| of_method(&pair.method) || of_standard(&pair.standard);
                Ok(readings.iter().find(one).unwrap_or(&readings[0]).clone())
            }
            [pair] => Ok((*pair).clone()),
            several => Err(several.iter().map(|pair| (*pair).clone()).collect()),
        }
    }

    /// Split at each of its colons, and whole.
    fn readings(&self) -> Vec<ColumnPair> {
        let pair = |method: &str, standard: &str| ColumnPair {
            method: method.to_owned(),
            standard: standard.to_owned(),
        };
        let split = |(at, _): (usize, &str)| pair(&self.0[..at], &self.0[at + 1..]);
        self.0.match_indices(':').map(split).chain([pair(&self.0, &self.0)]).collect()
    }
}

impl std::fmt::Display for ColumnChoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::str::FromStr for ColumnChoice {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(Self(text.to_owned()))
    }
}

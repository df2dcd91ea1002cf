//! What two tables are called for people.

use std::path::Path;

/// Names of two tables, by their files' without folders and endings, with folders where these are the same.
///
/// ```
/// use surfometry::comparison::names_of;
/// assert_eq!(names_of(["a/ours.csv", "a/theirs.csv"]), ["ours", "theirs"]);
/// assert_eq!(names_of(["a/x.csv", "b/x.csv"]), ["a/x.csv", "b/x.csv"]);
/// ```
pub fn names_of(tables: [&str; 2]) -> [String; 2] {
    let stem = |path: &str| {
        Path::new(path)
            .file_stem()
            .map_or_else(|| path.to_owned(), |stem| stem.to_string_lossy().into_owned())
    };
    let [method, standard] = tables.map(stem);
    if method != standard {
        [method, standard]
    } else if tables[0] != tables[1] {
        tables.map(str::to_owned)
    } else {
        ["method".to_owned(), "standard".to_owned()]
    }
}

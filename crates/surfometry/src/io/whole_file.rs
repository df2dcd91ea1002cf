//! Files that appear whole or not at all.

use super::ResultOutput;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes a file under a name of its own beside it, `NAME.partial`, which takes its place only when
/// everything is written. A link is followed; a device or pipe (`/dev/stdout`) is written to directly.
///
/// # Errors
/// Whatever the file system or `write` says; the file is then as it was.
pub fn write_whole(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut out = ResultOutput::create(path.as_ref())?;
    let mut buffered = BufWriter::new(&mut out);
    let written = write(&mut buffered).and_then(|()| buffered.flush());
    // What could not be written is not to be written either when the buffer goes.
    drop(buffered.into_parts());
    match written {
        Ok(()) => out.finish(),
        Err(error) => out.discard().and(Err(error)),
    }
}

/// Whether a file of that name could be written, before what is to be in it has been made: an existing one is opened,
/// for a new one an empty file is made beside it and taken away.
///
/// # Errors
/// Whatever the file system says.
pub fn try_writing(path: impl AsRef<Path>) -> io::Result<()> {
    let path = path.as_ref();
    check_name(path)?;
    // Who reads a pipe would see it end.
    if path.exists() && !path.is_file() {
        return Ok(());
    }
    if path.exists() {
        File::options().append(true).open(path)?;
    }
    // A new one takes its place.
    let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let mut name = target.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.trial", std::process::id()));
    let trial = target.with_file_name(name);
    File::create_new(&trial)?;
    fs::remove_file(&trial)
}

/// Refuses a file whose name is written as a folder's, and one in a Zarr, which would be taken for a chunk or for metadata.
///
/// # Errors
/// What to name instead.
pub(super) fn check_name(path: &Path) -> io::Result<()> {
    if is_written_as_folder(path) {
        let error =
            "its name ends as a folder's does: leave out what follows the name, or name a file in the folder";
        return Err(io::Error::new(io::ErrorKind::IsADirectory, error));
    }
    let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    zarr_around(&target).map_or(Ok(()), |zarr| {
        let error = format!(
            "it would lie in the Zarr {}, all files of which are its own: name one elsewhere",
            zarr.display()
        );
        Err(io::Error::new(io::ErrorKind::InvalidInput, error))
    })
}

/// Whether a name ends in a separator, or in a dot behind one: neither is part of the path's last name, yet no file can be
/// renamed to it.
fn is_written_as_folder(path: &Path) -> bool {
    let name = path.as_os_str().as_encoded_bytes();
    let name = name.strip_suffix(b".").unwrap_or(name);
    name.last().is_some_and(|&byte| std::path::is_separator(char::from(byte)))
}

/// The Zarr that a file lies in, or would.
#[cfg(feature = "zarr")]
fn zarr_around(file: &Path) -> Option<PathBuf> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let folder = folder.canonicalize().ok()?;
    folder.ancestors().find(|folder| super::zarr::is_zarr(folder)).map(Path::to_owned)
}

#[cfg(not(feature = "zarr"))]
fn zarr_around(_: &Path) -> Option<PathBuf> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replaces_on_success_only() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        write_whole(&path, |out| out.write_all(b"first")).unwrap();
        let failed = write_whole(&path, |out| {
            out.write_all(b"second")?;
            Err(io::Error::other("half-way"))
        });
        assert!(failed.is_err());
        assert_eq!(fs::read(&path).unwrap(), b"first");
        write_whole(&path, |out| out.write_all(b"third")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"third");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(write_whole(folder.path(), |_| Ok(())).is_err());
    }

    #[test]
    fn what_can_be_written_is_known_before() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        try_writing(&path).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        fs::write(&path, b"kept").unwrap();
        try_writing(&path).unwrap();
        assert_eq!(
            (fs::read(&path).unwrap(), fs::read_dir(folder.path()).unwrap().count()),
            (b"kept".to_vec(), 1)
        );
        assert!(try_writing(folder.path().join("none").join("file")).is_err());
        assert!(try_writing("/proc/file").is_err());
    }

    #[test]
    fn names_that_end_as_folders_do() {
        for name in ["a/", "a/.", "/a//", "b/a/./"] {
            assert!(is_written_as_folder(Path::new(name)), "{name}");
        }
        for name in ["a", "a.", "b/a", "b/.a", "b/a.."] {
            assert!(!is_written_as_folder(Path::new(name)), "{name}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn follows_links_spares_devices_and_minds_the_umask() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        fs::write(&real, b"old").unwrap();
        symlink(&real, &link).unwrap();
        write_whole(&link, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"new");
        assert!(link.is_symlink());
        // Readable by the group wherever an ordinary new file is.
        let mode = |p: &Path| fs::metadata(p).unwrap().permissions().mode() & 0o777;
        let plain = folder.path().join("plain");
        fs::write(&plain, b"").unwrap();
        assert_eq!(mode(&real), mode(&plain));
        // A replaced file keeps who may read it.
        for bits in [0o640, 0o600, 0o664] {
            fs::set_permissions(&real, fs::Permissions::from_mode(bits)).unwrap();
            write_whole(&link, |out| out.write_all(b"newer")).unwrap();
            assert_eq!(mode(&real), bits);
        }
        write_whole("/dev/null", |out| out.write_all(b"gone")).unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }
}

//! Files that appear whole or not at all.

use super::ResultOutput;
use std::io::{self, BufWriter, Write};
use std::path::Path;

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

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

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

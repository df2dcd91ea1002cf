//! Files that grow while a run goes on, and take their name when it has ended.

use super::whole_file::check_name;
use std::fs::{self, File, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A file under a name of its own, `NAME.partial`, until it is finished. Where a run is killed, what it has
/// written so far is there.
#[derive(Debug)]
pub struct GrowingFile {
    file: File,
    /// An end that the next bytes will replace.
    end: Vec<u8>,
    partial: PathBuf,
    target: PathBuf,
}

/// The name that a file has until it is finished.
pub fn unfinished(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".partial");
    name.into()
}

impl GrowingFile {
    /// Begins a file, in the place of an earlier unfinished one. A link is followed; the file of that name
    /// stays as it is until this one is finished.
    ///
    /// # Errors
    /// Whatever the file system says; a target that is a folder or written as one, lies in a Zarr, or cannot be written.
    pub fn create(path: &Path) -> io::Result<Self> {
        let growing = Self::open(path)?;
        growing.file.set_len(0)?;
        Ok(growing)
    }

    /// Goes on with the lines that an earlier unfinished one has, which are given; half a line at its end is taken away.
    ///
    /// # Errors
    /// As of [`GrowingFile::create`]; bytes that are no text.
    pub fn reopen_lines(path: &Path) -> io::Result<(Self, String)> {
        let mut growing = Self::open(path)?;
        let mut bytes = Vec::new();
        growing.file.read_to_end(&mut bytes)?;
        bytes.truncate(bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1));
        growing.cut_back(bytes.len() as u64)?;
        let lines =
            String::from_utf8(bytes).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
        Ok((growing, lines))
    }

    /// Where it is until it is finished.
    pub fn partial(&self) -> &Path {
        &self.partial
    }

    /// The unfinished file, as it is; nobody else may be at it.
    fn open(path: &Path) -> io::Result<Self> {
        check_name(path)?;
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if target.is_dir() {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
        }
        if target.exists() && !target.is_file() {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "it is a pipe or a device, which cannot go on later",
            ));
        }
        if target.is_file() {
            // Whoever took the right to write it away meant it.
            File::options().append(true).open(&target)?;
        }
        let partial = unfinished(&target);
        // Nobody but such a run makes a file of that name, and none a link or a pipe.
        if fs::symlink_metadata(&partial).is_ok_and(|there| !there.is_file()) {
            let error = format!("{} is no file: remove it", partial.display());
            return Err(io::Error::new(io::ErrorKind::AlreadyExists, error));
        }
        let file = Self::locked(&partial)?;
        Ok(Self { file, end: Vec::new(), partial, target })
    }

    /// An unfinished one of a run that was killed is written over, but not one that another run is at.
    fn locked(partial: &Path) -> io::Result<File> {
        loop {
            let file = File::options().read(true).write(true).create(true).truncate(false).open(partial)?;
            if let Err(TryLockError::WouldBlock) = file.try_lock() {
                let error = format!("another run is writing it ({})", partial.display());
                return Err(io::Error::new(io::ErrorKind::ResourceBusy, error));
            }
            // A run that ended meanwhile has given this very file its name: those are its results.
            let opened = same_file::Handle::from_file(file.try_clone()?)?;
            if same_file::Handle::from_path(partial).is_ok_and(|there| there == opened) {
                return Ok(file);
            }
        }
    }

    /// Gives the file its name.
    ///
    /// # Errors
    /// Whatever the file system says; what was written is under the partial name then.
    pub fn finish(mut self) -> io::Result<()> {
        self.drop_end()?;
        if let Ok(earlier) = fs::metadata(&self.target) {
            self.file.set_permissions(earlier.permissions())?;
        }
        self.file.sync_all()?;
        fs::rename(&self.partial, &self.target)
    }

    /// Takes it away.
    ///
    /// # Errors
    /// Whatever the file system says.
    pub(crate) fn discard(self) -> io::Result<()> {
        fs::remove_file(&self.partial)
    }

    /// Writes bytes, and behind them an end that the next ones will replace: by one call to the system, so
    /// that a run that is killed leaves either both or neither. Where that fails, as on a full disk, the earlier end is
    /// put back, for which there was room.
    fn write_secured(&mut self, bytes: &[u8], end: &[u8]) -> io::Result<()> {
        let earlier = self.end.clone();
        let start = self.file.stream_position()? - earlier.len() as u64;
        if (bytes.len() + end.len()) < earlier.len() {
            self.drop_end()?;
        }
        self.return_to_end()?;
        self.end = end.to_vec();
        self.file.write_all(&[bytes, end].concat()).inspect_err(|_| {
            if self.cut_back(start).and_then(|()| self.file.write_all(&earlier)).is_ok() {
                self.end = earlier;
            }
        })
    }

    /// Takes away what is written from a place on.
    fn cut_back(&mut self, start: u64) -> io::Result<()> {
        self.file.set_len(start)?;
        self.file.seek(SeekFrom::Start(start)).map(drop)
    }

    /// Goes back to where the replaceable end begins.
    fn return_to_end(&mut self) -> io::Result<()> {
        let length = std::mem::take(&mut self.end).len() as i64;
        if length > 0 { self.file.seek_relative(-length) } else { Ok(()) }
    }

    /// Takes the replaceable end away.
    fn drop_end(&mut self) -> io::Result<()> {
        self.return_to_end()?;
        let written = self.file.stream_position()?;
        self.file.set_len(written)
    }
}

/// Where the results of a run go while it goes on: a file that grows, or a stream.
pub enum ResultOutput {
    /// A file.
    File(GrowingFile),
    /// A pipe, a terminal, a device.
    Stream(Box<dyn Write + Send>),
}

/// Opens a device, or a pipe that somebody reads: to open one that nobody reads would wait for a reader.
fn open_stream(path: &Path, kind: fs::FileType) -> io::Result<File> {
    let mut options = File::options();
    options.write(true);
    #[cfg(unix)]
    let _tried = {
        use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
        let at_once = || options.clone().custom_flags(libc::O_NONBLOCK).open(path);
        let nobody = "it is a pipe that nobody reads: start its reader first, or name a file";
        kind.is_fifo().then(at_once).transpose().map_err(|e| match e.raw_os_error() {
            Some(libc::ENXIO) => io::Error::new(io::ErrorKind::BrokenPipe, nobody),
            _ => e,
        })?
    };
    options.open(path)
}

impl ResultOutput {
    /// Standard output.
    pub fn stdout() -> Self {
        Self::Stream(Box::new(io::stdout()))
    }

    /// A file of a name, or what else has that name, as `/dev/stdout`.
    ///
    /// # Errors
    /// As of [`GrowingFile::create`].
    pub fn create(path: &Path) -> io::Result<Self> {
        match fs::metadata(path) {
            Ok(found) if !found.is_file() && !found.is_dir() => {
                Ok(Self::Stream(Box::new(open_stream(path, found.file_type())?)))
            }
            _ => GrowingFile::create(path).map(Self::File),
        }
    }

    /// Writes bytes, and behind them, where they can be replaced, an end that makes whole what was written so
    /// far.
    ///
    /// # Errors
    /// Whatever keeps them from being written.
    pub fn write_secured(&mut self, bytes: &[u8], end: &[u8]) -> io::Result<()> {
        match self {
            Self::File(file) => file.write_secured(bytes, end),
            Self::Stream(stream) => stream.write_all(bytes),
        }
    }

    /// Ends what was written: a file takes its name.
    ///
    /// # Errors
    /// Whatever keeps it from being written.
    pub fn finish(self) -> io::Result<()> {
        match self {
            Self::File(file) => file.finish(),
            Self::Stream(mut stream) => stream.flush(),
        }
    }

    /// The same of a run that may have been stopped: a file keeps the name of an unfinished one then, which is
    /// given.
    ///
    /// # Errors
    /// As of [`ResultOutput::finish`].
    pub fn end(self, stopped: bool) -> io::Result<Option<PathBuf>> {
        match self.partial().filter(|_| stopped).map(Path::to_owned) {
            None => self.finish().map(|()| None),
            unfinished => Ok(unfinished),
        }
    }

    /// Takes away what was written to a file so far; what a stream was given is gone.
    ///
    /// # Errors
    /// Whatever keeps it from being taken away.
    pub(super) fn discard(self) -> io::Result<()> {
        match self {
            Self::File(file) => file.discard(),
            Self::Stream(_) => Ok(()),
        }
    }

    /// Where a file's results are until it is finished.
    pub fn partial(&self) -> Option<&Path> {
        match self {
            Self::File(file) => Some(&file.partial),
            Self::Stream(_) => None,
        }
    }
}

impl Write for ResultOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.write(bytes),
            Self::Stream(stream) => stream.write(bytes),
        }
    }

    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self {
            Self::File(file) => file.write_all(bytes),
            Self::Stream(stream) => stream.write_all(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::File(file) => file.flush(),
            Self::Stream(stream) => stream.flush(),
        }
    }
}

impl Write for GrowingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if !self.end.is_empty() {
            self.drop_end()?;
        }
        self.file.write(bytes)
    }

    /// All or nothing: a row that a full disk has no room for is not begun.
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        if !self.end.is_empty() {
            self.drop_end()?;
        }
        let start = self.file.stream_position()?;
        self.file.write_all(bytes).inspect_err(|_| {
            // The failure that is told of is the first one.
            let _cut = self.cut_back(start);
        })
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a link of the unfinished name leads to is not this run's.
    #[test]
    fn an_unfinished_name_is_no_link() {
        let folder = tempfile::tempdir().unwrap();
        let victim = folder.path().join("victim");
        fs::write(&victim, "kept").unwrap();
        std::os::unix::fs::symlink(&victim, folder.path().join("results.json.partial")).unwrap();
        let refused = GrowingFile::create(&folder.path().join("results.json")).unwrap_err();
        assert_eq!(refused.kind(), io::ErrorKind::AlreadyExists);
        assert_eq!(fs::read(&victim).unwrap(), b"kept");
    }

    /// A run that begins while another one ends does not write over what that one has finished.
    #[test]
    fn results_of_runs_at_once_stay_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.json");
        let run = || {
            for _ in 0..2000 {
                // Busy where the other one is at it.
                if let Ok(mut file) = GrowingFile::create(&path) {
                    file.write_all(b"whole").unwrap();
                    fs::rename(&file.partial, &file.target).unwrap();
                    assert_eq!(fs::read(&path).unwrap(), b"whole");
                }
            }
        };
        std::thread::scope(|scope| [(); 4].map(|()| drop(scope.spawn(run))));
        assert_eq!(fs::read(&path).unwrap(), b"whole");
    }

    #[test]
    fn it_takes_its_name_at_the_end_and_keeps_rights() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.json");
        fs::write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        let mut file = GrowingFile::create(&path).unwrap();
        file.write_secured(b"one", b" and the end").unwrap();
        let partial = folder.path().join("results.json.partial");
        assert_eq!(fs::read(&partial).unwrap(), b"one and the end");
        assert_eq!(GrowingFile::create(&path).unwrap_err().kind(), io::ErrorKind::ResourceBusy);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        file.write_secured(b"!", b"").unwrap();
        assert_eq!(fs::read(&partial).unwrap(), b"one!");
        file.write_secured(b"", b" and a long end").unwrap();
        assert_eq!(fs::read(&partial).unwrap(), b"one! and a long end");
        file.write_all(b", two").unwrap();
        file.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"one!, two");
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        assert!(!partial.exists());
    }
}

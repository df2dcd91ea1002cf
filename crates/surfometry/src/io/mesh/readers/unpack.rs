//! The bytes of a mesh's file, unpacked.

use super::super::super::ReadError;
use super::super::super::packed::{Packed, read_start};
use std::io::Read;
use std::path::Path;

/// Bytes that so many packed ones may become: no mesh is packed better, and whoever packed zeros to fill the memory does
/// not.
pub(super) fn most_unpacked(packed: usize) -> usize {
    (64 << 20) + packed.saturating_mul(100)
}

/// All bytes of a file, which may be packed by gzip or bzip2, whatever its name says.
pub(super) fn contents(path: &Path, format: &'static str) -> Result<Vec<u8>, ReadError> {
    let file = Packed::open(path)?;
    let packed = file.is_packed();
    let most = if packed { most_unpacked(file.stored_bytes()? as usize) as u64 } else { u64::MAX };
    let refused = |reason| ReadError::Mesh { format, reason };
    let mut bytes = Vec::new();
    file.into_reader()?.take(most).read_to_end(&mut bytes).map_err(|error| {
        if packed {
            refused(format!("the compressed data are damaged ({error})"))
        } else {
            ReadError::io(path, error)
        }
    })?;
    if bytes.len() as u64 == most {
        return Err(refused(format!("more than {most} bytes are packed in the file: unpack it first")));
    }
    Ok(bytes)
}

/// The first bytes of a file that [`contents`] would read, as many as there are.
pub(super) fn beginning(path: &Path, limit: u64) -> Vec<u8> {
    read_start(path, limit).unwrap_or_default()
}

//! Files as one zip archive, sent in pieces.

use std::io::{self, Write};

use tonic::Status;

use crate::status;

/// Bytes of a piece.
const PIECE: usize = 256 << 10;

/// Hands what is written to `send` in pieces of one size.
struct Pieces<F: FnMut(Vec<u8>) -> bool> {
    buffer: Vec<u8>,
    send: F,
}

impl<F: FnMut(Vec<u8>) -> bool> Pieces<F> {
    fn hand_over(&mut self) -> io::Result<()> {
        let piece = std::mem::replace(&mut self.buffer, Vec::with_capacity(PIECE));
        if piece.is_empty() || (self.send)(piece) { Ok(()) } else { Err(io::ErrorKind::BrokenPipe.into()) }
    }
}

impl<F: FnMut(Vec<u8>) -> bool> Write for Pieces<F> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let room = PIECE - self.buffer.len();
        let taken = bytes.len().min(room);
        self.buffer.extend_from_slice(&bytes[..taken]);
        if self.buffer.len() == PIECE {
            self.hand_over()?;
        }
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Writes files into an archive and hands its pieces to `send`, which returns false when nobody takes them any more.
///
/// The same files give the same bytes: entries carry no date.
///
/// # Errors
/// `CANCELLED` when nobody takes the pieces; `INTERNAL`.
pub(super) fn write(
    files: impl IntoIterator<Item = (String, Vec<u8>)>,
    send: impl FnMut(Vec<u8>) -> bool,
) -> Result<(), Status> {
    let failed = |e: zip::result::ZipError| match e {
        zip::result::ZipError::Io(e) if e.kind() == io::ErrorKind::BrokenPipe => {
            Status::cancelled("nobody takes the archive any more")
        }
        other => status::internal(&other),
    };
    let mut archive = zip::ZipWriter::new_stream(Pieces { buffer: Vec::with_capacity(PIECE), send });
    let options = zip::write::SimpleFileOptions::default()
        .compression_method(zip::CompressionMethod::Deflated)
        .last_modified_time(zip::DateTime::default());
    for (path, bytes) in files {
        archive.start_file(path, options).map_err(failed)?;
        archive.write_all(&bytes).map_err(|e| failed(e.into()))?;
    }
    let mut pieces = archive.finish().map_err(failed)?.into_inner();
    pieces.hand_over().map_err(|e| failed(e.into()))
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    #[test]
    fn an_archive_is_read_as_it_was_written() {
        let files = [("a/b.txt".to_owned(), vec![7; 3 * PIECE + 1]), ("c".to_owned(), b"x".to_vec())];
        let pack = || {
            let mut whole = Vec::new();
            write(files.clone(), |piece| {
                whole.extend(piece);
                true
            })
            .unwrap();
            whole
        };
        let bytes = pack();
        assert_eq!(bytes, pack());
        let mut archive = zip::ZipArchive::new(io::Cursor::new(bytes)).unwrap();
        for (name, content) in &files {
            let mut read = Vec::new();
            archive.by_name(name).unwrap().read_to_end(&mut read).unwrap();
            assert_eq!(&read, content);
        }
        let refused = write(files.clone(), |_| false).unwrap_err();
        assert_eq!(refused.code(), tonic::Code::Cancelled);
    }
}

//! The pass over the text of an OBJ file.

use std::io;
use std::path::Path;

use meshlod_io::ParseError;
use meshlod_io::obj::{ObjPart, ObjStream};

use crate::source::file::{PlacedFile, named};
use crate::source::spool::Spool;

/// Bytes of text that are in memory at a time, unless a line is longer.
pub(super) const WINDOW: usize = 1 << 22;

/// Greatest number of bytes of a line.
const LONGEST: usize = 1 << 26;

/// Files that a text is read into.
pub(super) struct Spools {
    pub positions: Spool,
    pub faces: Spool,
    pub uvs: Lazy,
    pub normals: Lazy,
    pub colors: Lazy,
    pub paint: Lazy,
}

/// File that is made when something is added to it.
#[derive(Default)]
pub(super) struct Lazy {
    pub spool: Option<Spool>,
}

impl Lazy {
    fn add(&mut self, values: &[f32], folder: &Path) -> io::Result<()> {
        if values.is_empty() {
            return Ok(());
        }
        if self.spool.is_none() {
            self.spool = Some(Spool::new(folder)?);
        }
        self.spool.as_mut().map_or(Ok(()), |spool| spool.add_floats(values))
    }

    fn words(&self) -> u64 {
        self.spool.as_ref().map_or(0, |spool| spool.words)
    }
}

impl Spools {
    /// Reads a file into files in a folder.
    pub fn read(path: &Path, scratch: &Path, size: usize) -> io::Result<(Self, ObjStream)> {
        let file = PlacedFile::open(path)?;
        let mut stream = ObjStream::default();
        let mut spools = Self {
            positions: Spool::new(scratch)?,
            faces: Spool::new(scratch)?,
            uvs: Lazy::default(),
            normals: Lazy::default(),
            colors: Lazy::default(),
            paint: Lazy::default(),
        };
        let mut at = 0;
        while at < file.length || at == 0 {
            let bytes = window(&file, at, size)?;
            let part = stream.read(&bytes).map_err(|error| file.invalid(error))?;
            at += bytes.len() as u64;
            let added = spools.add(&part, scratch);
            added.map_err(|error| spools.refused(error, (path, scratch), (at, file.length)))?;
        }
        Ok((spools, stream))
    }

    fn add(&mut self, part: &ObjPart, scratch: &Path) -> io::Result<()> {
        let halves = |x: f64| [x.to_bits() as u32, (x.to_bits() >> 32) as u32];
        self.positions.add(part.positions.as_flattened().iter().flat_map(|&x| halves(x)))?;
        self.faces.add(part.outlines.iter().copied())?;
        self.uvs.add(part.uvs.as_flattened(), scratch)?;
        self.normals.add(part.normals.as_flattened(), scratch)?;
        self.paint.add(part.paint.as_flattened(), scratch)?;
        if part.colors.is_empty() {
            return Ok(());
        }
        // Vertices before that have no colour are white.
        let mut missing = 3 * part.first as u64 - self.colors.words();
        while missing > 0 {
            let some = missing.min(1 << 16);
            self.colors.add(&vec![1.0; some as usize], scratch)?;
            missing -= some;
        }
        self.colors.add(part.colors.as_flattened(), scratch)
    }

    /// Says of a disk that is full how much was needed.
    fn refused(
        &self,
        error: io::Error,
        (path, scratch): (&Path, &Path),
        (at, length): (u64, u64),
    ) -> io::Error {
        if error.kind() != io::ErrorKind::StorageFull {
            return error;
        }
        let lazy = [&self.uvs, &self.normals, &self.colors, &self.paint];
        let words = self.positions.words + self.faces.words;
        let words = words + lazy.iter().map(|lazy| lazy.words()).sum::<u64>();
        let needed = (words as f64 * 4.0 * length as f64 / at.max(1) as f64 / 1e6).ceil();
        let reason =
            format!("the disk is full; reading {} takes about {needed} MB", path.display());
        named(scratch, io::Error::new(io::ErrorKind::StorageFull, reason))
    }
}

/// Returns the bytes from a place on that end with a statement or with the file.
fn window(file: &PlacedFile, at: u64, mut size: usize) -> io::Result<Vec<u8>> {
    loop {
        let mut bytes = file.part(at, size)?;
        if at + bytes.len() as u64 >= file.length {
            return Ok(bytes);
        }
        match ObjStream::whole_statements(&bytes) {
            0 if size >= LONGEST => {
                let byte = usize::try_from(at).unwrap_or(usize::MAX);
                let reason = "a line of more than 64 MiB cannot be read in passing";
                return Err(file.invalid(ParseError::byte(byte, reason)));
            }
            0 => size *= 4,
            end => {
                bytes.truncate(end);
                return Ok(bytes);
            }
        }
    }
}

//! Archives of tilesets in one file, `.3tz` [MAX22]: zip files whose entries are stored as they are.
//!
//! The last entry is an index of the others by the MD5 of their names, so that a reader finds one
//! without the directory of the zip file.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use crate::source::PlacedFile;

/// Suffix of archives.
const SUFFIX: &str = "3tz";

/// Name of the index in an archive.
const INDEX: &str = "@3dtilesIndex1@";

/// First bytes of a local header, an entry of the directory, its end, and the end in 64 bits with
/// what says where that is.
const LOCAL: u32 = 0x0403_4b50;
const ENTRY: u32 = 0x0201_4b50;
const END: u32 = 0x0605_4b50;
const WIDE_END: u32 = 0x0606_4b50;
const WIDE_PLACE: u32 = 0x0706_4b50;

/// Bytes of these, without names and what is added.
const LOCAL_SIZE: usize = 30;
const ENTRY_SIZE: usize = 46;
const END_SIZE: usize = 22;
const WIDE_END_SIZE: usize = 56;
const WIDE_PLACE_SIZE: usize = 20;

/// Day of all entries, 1 January 1980: the same tiles are the same bytes.
const DAY: u16 = 0x21;

/// Returns true for the path of an archive, by its suffix.
pub fn is_archive(path: &Path) -> bool {
    path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case(SUFFIX))
}

/// Entry of an archive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Entry {
    /// Byte of the file that its header begins at.
    offset: u64,
    size: u32,
    checksum: u32,
}

/// Writes an archive from its beginning to its end.
pub struct ArchiveWriter<'w> {
    out: &'w mut dyn Write,
    length: u64,
    entries: Vec<(String, Entry)>,
}

impl<'w> ArchiveWriter<'w> {
    /// Begins an archive.
    pub fn new(out: &'w mut dyn Write) -> Self {
        Self { out, length: 0, entries: Vec::new() }
    }

    /// Adds a file by its name, which has slashes between its parts.
    ///
    /// # Errors
    /// Errors of the system, and a file of 4 GiB or more.
    pub fn add(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let size = u32::try_from(bytes.len()).ok().filter(|&size| size < u32::MAX);
        let size = size.ok_or_else(|| io::Error::other(format!("{name}: is larger than 4 GB")))?;
        let entry = Entry { offset: self.length, size, checksum: crc32fast::hash(bytes) };
        let mut head = Fields::default();
        head.word(LOCAL).half(10).common(&entry).half(name.len() as u16).half(0);
        self.write(&head.0)?;
        self.write(name.as_bytes())?;
        self.write(bytes)?;
        self.entries.push((name.to_owned(), entry));
        Ok(())
    }

    /// Adds the index and the directory.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn finish(mut self) -> io::Result<()> {
        let index = index(self.entries.iter().map(|(name, entry)| (&**name, entry.offset)));
        self.add(INDEX, &index)?;
        let start = self.length;
        for (name, entry) in std::mem::take(&mut self.entries) {
            let wide = u32::try_from(entry.offset).ok().filter(|&at| at < u32::MAX);
            let mut head = Fields::default();
            let needs = if wide.is_some() { 10 } else { 45 };
            head.word(ENTRY).half(45).half(needs).common(&entry).half(name.len() as u16);
            head.half(if wide.is_some() { 0 } else { 12 }).half(0).half(0).half(0).word(0);
            head.word(wide.unwrap_or(u32::MAX)).0.extend(name.as_bytes());
            if wide.is_none() {
                head.half(1).half(8).long(entry.offset);
            }
            self.write(&head.0)?;
            self.entries.push((name, entry));
        }
        let (count, size) = (self.entries.len() as u64, self.length - start);
        let mut end = Fields::default();
        if count >= u64::from(u16::MAX) || self.length >= u64::from(u32::MAX) {
            end.word(WIDE_END).long(WIDE_END_SIZE as u64 - 12).half(45).half(45).word(0).word(0);
            end.long(count).long(count).long(size).long(start);
            end.word(WIDE_PLACE).word(0).long(self.length).word(1);
        }
        let count = count.min(u64::from(u16::MAX)) as u16;
        let narrow = |x: u64| x.min(u64::from(u32::MAX)) as u32;
        end.word(END).half(0).half(0).half(count).half(count).word(narrow(size));
        end.word(narrow(start)).half(0);
        self.write(&end.0)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.length += bytes.len() as u64;
        self.out.write_all(bytes)
    }
}

/// Little-endian numbers.
#[derive(Default)]
struct Fields(Vec<u8>);

impl Fields {
    fn half(&mut self, x: u16) -> &mut Self {
        self.0.extend(x.to_le_bytes());
        self
    }

    fn word(&mut self, x: u32) -> &mut Self {
        self.0.extend(x.to_le_bytes());
        self
    }

    fn long(&mut self, x: u64) -> &mut Self {
        self.0.extend(x.to_le_bytes());
        self
    }

    /// Adds what local headers and entries of the directory have alike: flags, method, time, day,
    /// checksum and the size twice, since nothing is compressed.
    fn common(&mut self, entry: &Entry) -> &mut Self {
        self.half(0)
            .half(0)
            .half(0)
            .half(DAY)
            .word(entry.checksum)
            .word(entry.size)
            .word(entry.size)
    }
}

/// Returns the index of files by their names and offsets.
fn index<'n>(files: impl Iterator<Item = (&'n str, u64)>) -> Vec<u8> {
    let mut rows: Vec<([u64; 2], u64)> = files.map(|(name, at)| (hash(name), at)).collect();
    rows.sort_unstable();
    let bytes = rows.iter().flat_map(|([a, b], at)| [a, b, at].map(|x| x.to_le_bytes()));
    bytes.flatten().collect()
}

/// Returns the MD5 of a name as two numbers, by which the index is sorted.
fn hash(name: &str) -> [u64; 2] {
    let bytes = md5::compute(name).0;
    let (halves, _) = bytes.as_chunks::<8>();
    [u64::from_le_bytes(halves[0]), u64::from_le_bytes(halves[1])]
}

/// Archive that is open for reading.
#[derive(Debug)]
pub struct Archive {
    file: PlacedFile,
    entries: BTreeMap<String, Entry>,
}

impl Archive {
    /// Opens an archive, and checks that its index has all of its files.
    ///
    /// # Errors
    /// Errors of the system, and a file that is not an archive of stored entries.
    pub fn open(path: &Path) -> io::Result<Self> {
        let file = PlacedFile::open(path)?;
        let (at, size, count) = directory(&file)?;
        let size = usize::try_from(size).map_err(|_| invalid("its directory is too large"))?;
        let bytes = part(&file, at, size)?;
        let (mut entries, mut last) = (BTreeMap::new(), String::new());
        let mut rest = &bytes[..];
        for _ in 0..count {
            let found = entry(rest).ok_or_else(|| invalid("its directory is damaged"))?;
            let (name, entry, after) = found;
            (last, rest) = (name.clone(), after);
            entries.insert(name, entry);
        }
        let this = Self { file, entries };
        if last != INDEX {
            return Err(invalid("its last entry is not the index of a 3tz archive"));
        }
        let named = this.entries.iter().filter(|(name, _)| *name != INDEX);
        let expected = index(named.map(|(name, entry)| (&**name, entry.offset)));
        match this.read(INDEX)? == expected {
            true => Ok(this),
            false => Err(invalid("its index does not fit its entries")),
        }
    }

    /// Reads a file by its name.
    ///
    /// # Errors
    /// Errors of the system, a file that there is not, and one that is not as it was written.
    pub fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        let none = || io::Error::new(io::ErrorKind::NotFound, format!("it has no {name}"));
        let entry = self.entries.get(name).ok_or_else(none)?;
        let head = part(&self.file, entry.offset, LOCAL_SIZE)?;
        let damaged = || invalid(&format!("its entry {name} is damaged"));
        let names = usize::from(half(&head, 26)) + usize::from(half(&head, 28));
        let at = entry.offset + (LOCAL_SIZE + names) as u64;
        let named = part(&self.file, entry.offset + LOCAL_SIZE as u64, name.len())?;
        if word(&head, 0) != LOCAL || named != name.as_bytes() {
            return Err(damaged());
        }
        let bytes = part(&self.file, at, entry.size as usize)?;
        match crc32fast::hash(&bytes) == entry.checksum {
            true => Ok(bytes),
            false => Err(damaged()),
        }
    }
}

/// Returns where the directory is, its bytes and the number of its entries.
fn directory(file: &PlacedFile) -> io::Result<(u64, u64, u64)> {
    let none = || invalid("is not a 3tz archive");
    let at = file.length.checked_sub(END_SIZE as u64).ok_or_else(none)?;
    let end = part(file, at, END_SIZE)?;
    if word(&end, 0) != END {
        return Err(none());
    }
    let narrow = (u64::from(word(&end, 16)), u64::from(word(&end, 12)), u64::from(half(&end, 10)));
    let Some(at) = at.checked_sub(WIDE_PLACE_SIZE as u64) else { return Ok(narrow) };
    let place = part(file, at, WIDE_PLACE_SIZE)?;
    if word(&place, 0) != WIDE_PLACE {
        return Ok(narrow);
    }
    let wide = part(file, long(&place, 8), WIDE_END_SIZE)?;
    match word(&wide, 0) == WIDE_END {
        true => Ok((long(&wide, 48), long(&wide, 40), long(&wide, 32))),
        false => Err(none()),
    }
}

/// Reads an entry of the directory; returns its name, and what comes after it.
fn entry(bytes: &[u8]) -> Option<(String, Entry, &[u8])> {
    let (head, rest) = bytes.split_at_checked(ENTRY_SIZE)?;
    let (name, rest) = rest.split_at_checked(half(head, 28).into())?;
    let (extra, rest) = rest.split_at_checked(half(head, 30).into())?;
    let (_, rest) = rest.split_at_checked(half(head, 32).into())?;
    let [size, stored] = [24, 20].map(|at| word(head, at));
    let offset = match word(head, 42) {
        u32::MAX => (extra.len() == 12 && half(extra, 0) == 1).then(|| long(extra, 4))?,
        offset => u64::from(offset),
    };
    let is_stored = word(head, 0) == ENTRY && half(head, 10) == 0 && size == stored;
    let entry = Entry { offset, size, checksum: word(head, 16) };
    let name = String::from_utf8(name.to_vec()).ok()?;
    is_stored.then_some((name, entry, rest))
}

/// Returns so many bytes of a file.
fn part(file: &PlacedFile, at: u64, size: usize) -> io::Result<Vec<u8>> {
    let bytes = if at <= file.length { file.part(at, size)? } else { Vec::new() };
    if bytes.len() == size { Ok(bytes) } else { Err(invalid("it is cut off or changed")) }
}

fn half(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes([bytes[at], bytes[at + 1]])
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from(half(bytes, at)) | u32::from(half(bytes, at + 2)) << 16
}

fn long(bytes: &[u8], at: usize) -> u64 {
    u64::from(word(bytes, at)) | u64::from(word(bytes, at + 4)) << 32
}

fn invalid(reason: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, reason.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(files: &[(&str, &[u8])]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut writer = ArchiveWriter::new(&mut bytes);
        files.iter().for_each(|(name, bytes)| writer.add(name, bytes).unwrap());
        writer.finish().unwrap();
        bytes
    }

    fn open(bytes: &[u8]) -> (tempfile::TempDir, io::Result<Archive>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.3tz");
        std::fs::write(&path, bytes).unwrap();
        let archive = Archive::open(&path);
        (folder, archive)
    }

    const FILES: [(&str, &[u8]); 3] =
        [("tileset.json", b"{}"), ("tiles/0-0-0-0.glb", b"glTF and more"), ("empty", b"")];

    #[test]
    fn files_come_back_by_their_names() {
        let (_folder, archive) = open(&written(&FILES));
        let archive = archive.unwrap();
        for (name, bytes) in FILES {
            assert_eq!(archive.read(name).unwrap(), bytes, "{name}");
        }
        assert_eq!(archive.read("none").unwrap_err().kind(), io::ErrorKind::NotFound);
        assert_eq!(archive.read(INDEX).unwrap().len(), 24 * FILES.len());
    }

    #[test]
    fn entries_beyond_four_gigabytes_are_found() {
        let mut bytes = Vec::new();
        let mut writer = ArchiveWriter::new(&mut bytes);
        // As if so much had been written before.
        let far = 5 << 32;
        writer.length = far;
        writer.add("far", b"away").unwrap();
        writer.finish().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.3tz");
        let mut file = std::fs::File::create(&path).unwrap();
        io::Seek::seek(&mut file, io::SeekFrom::Start(far)).unwrap();
        file.write_all(&bytes).unwrap();
        assert_eq!(Archive::open(&path).unwrap().read("far").unwrap(), b"away");
    }

    #[test]
    fn damage_is_told() {
        let bytes = written(&FILES);
        for end in 0..bytes.len() {
            assert!(open(&bytes[..end]).1.is_err(), "{end}");
        }
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 0x41;
            // Times, versions and attributes tell nothing about the files.
            let (_folder, archive) = open(&changed);
            let Ok(archive) = archive else { continue };
            for (name, bytes) in FILES {
                assert!(archive.read(name).map_or(true, |read| read == bytes), "{at}: {name}");
            }
        }
    }
}

//! Resources between the chunks of a file.

use meshlod_samples as samples;
use meshlod_simplify::Method;

use super::bytes;
use crate::file::Resource;
use crate::tests::walks::forest;
use crate::{Archive, FileError, Query};

/// Offset of the flags, and the flags of resources in the earlier form and in this one.
const FLAGS: usize = 19;
const OLD: u8 = 4;
const NEW: u8 = 8;
/// Offset of the index of chunks, and the length of an entry.
const INDEX: usize = 88;
const ENTRY_LEN: usize = 44;

fn resources(chunks: usize) -> Vec<Resource> {
    let resource =
        |(after_chunks, bytes): (usize, &[u8])| Resource { after_chunks, bytes: bytes.to_vec() };
    let all: [(usize, &[u8]); 6] = [
        (0, b"first"),
        (2, &[3; 5000]),
        (0, b""),
        (chunks + 9, b"last"),
        (1, b"second"),
        (2, b"after the other"),
    ];
    all.map(resource).to_vec()
}

fn archive() -> Archive<Vec<u8>> {
    let forest = forest(&samples::torus(800), Method::Qem);
    let archive = Archive::open(bytes(&forest)).unwrap();
    let chunks = archive.chunk_count();
    archive.with_resources(&resources(chunks)).unwrap()
}

/// The order in which the resources lie in the file.
const ORDER: [usize; 6] = [0, 2, 4, 1, 5, 3];

#[test]
fn resources_come_back_in_the_order_of_the_file() {
    let archive = archive();
    let given = resources(archive.chunk_count());
    assert_eq!(archive.resource_count(), given.len());
    for (place, &index) in ORDER.iter().enumerate() {
        assert_eq!(archive.resource(place).unwrap().as_ref(), Some(&given[index].bytes));
    }
    assert_eq!(archive.resource(given.len()).unwrap(), None);
    archive.read().unwrap();
    let none = archive.with_resources(&[]).unwrap();
    assert_eq!(none.resource_count(), 0);
    let forest = forest(&samples::torus(800), Method::Qem);
    assert!(none.into_source() == bytes(&forest), "nothing else has changed");
}

#[test]
fn every_start_has_the_resources_before_its_end() {
    let archive = archive();
    let all = archive.chunk_count();
    let base = archive.chunk_ends().next().unwrap() as usize;
    let bytes = archive.into_source();
    let (mut chunks, mut found) = (0, 0);
    for end in base..=bytes.len() {
        let part = Archive::open(bytes[..end].to_vec()).unwrap();
        let there = (0..6).filter(|&i| part.resource(i).unwrap().is_some()).count();
        let has = |i| part.has_resource(i).unwrap();
        assert!((0..there).all(has) && !(there..6).any(has));
        assert!(there >= found && part.complete_chunks() >= chunks);
        // Nothing is there before what it comes after.
        let after = [0, 0, 1, 2, 2, all];
        assert!(there == 0 || part.complete_chunks() >= after[there - 1], "{end}");
        (chunks, found) = (part.complete_chunks(), there);
        if end % 50 == 0 {
            part.extract(&Query::uniform(0.0)).unwrap();
        }
    }
    assert_eq!((chunks, found), (all, 6));
}

#[test]
fn an_index_that_lies_is_refused() {
    let archive = archive();
    let at = INDEX + ENTRY_LEN * archive.chunk_count();
    let bytes = archive.into_source();
    let opened = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut wrong = bytes.clone();
        change(&mut wrong);
        Archive::rewrite_checksums(&mut wrong);
        Archive::open(wrong)
    };
    assert!(opened(&|_| {}).is_ok());
    let put = |bytes: &mut Vec<u8>, at: usize, number: u32| {
        bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
    };
    // Number of resources, place of the last, place of the first.
    for (offset, number) in [(0, 7), (0, u32::MAX), (72, 1 << 20), (12, 3)] {
        assert!(opened(&|bytes| put(bytes, at + offset, number)).is_err(), "{offset} {number}");
    }
    // A length that no file has: all that follows is missing, and no memory is taken for it.
    let long = opened(&|bytes| put(bytes, at + 4, u32::MAX)).unwrap();
    assert!(long.complete_chunks() == 0 && long.resource(0).unwrap().is_none());
    // The last one stored in no known form.
    let last = bytes.len() - 5;
    let wrong = opened(&|bytes| bytes[last] = 7).unwrap();
    assert!(matches!(wrong.resource(5), Err(FileError::Section { .. })));
    let mut wrong = bytes.clone();
    wrong[last] = 7;
    let error = Archive::open(wrong).unwrap().resource(5).unwrap_err().to_string();
    assert!(error.contains("resource 5"), "{error}");
}

/// A file of an earlier version: materials before the first chunk and images after the last.
#[test]
fn the_earlier_form_opens_without_its_materials() {
    let forest = forest(&samples::torus(800), Method::Qem);
    let plain = bytes(&forest);
    let archive = Archive::open(plain.clone()).unwrap();
    let index = INDEX + ENTRY_LEN * archive.chunk_count();
    let base = archive.chunk_ends().next().unwrap() as usize;
    let words = [5u32, 0, 6, 0].iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
    let (head, rest) = plain.split_at(index);
    let (mesh, chunks) = rest.split_at(base - index);
    let mut old = [head, &words, mesh, b"early", chunks, b"images"].concat();
    old[FLAGS] |= OLD;
    Archive::rewrite_checksums(&mut old);
    let opened = Archive::open(old.clone()).unwrap();
    assert!(opened.has_old_resources() && opened.resource_count() == 0);
    assert_eq!(opened.resource(0).unwrap(), None);
    let [is, was] = [&opened, &archive].map(|file| file.read().unwrap().0);
    assert_eq!(is.bytes(), was.bytes());
    assert_eq!(opened.complete_chunks(), archive.chunk_count());
    assert!(Archive::open([&old[..], b"!"].concat()).is_err());
    let new = opened.with_resources(&resources(2)).unwrap();
    assert!(!new.has_old_resources() && new.resource_count() == 6);
    assert_eq!(new.into_source()[FLAGS] & (OLD | NEW), NEW);
}

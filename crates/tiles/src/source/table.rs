//! Rows of a spool that are read in any order, through a cache of pages that each thread has.

use std::io;

use super::file::PlacedFile;
use super::spool::Spool;

/// Words of a page, about: 4 KiB, as of vertices of PLY files.
const PAGE: usize = 1 << 10;

/// Bytes of the pages of a table in the caches of all threads together.
const ALL: usize = 1 << 25;

/// Least number of bytes of the pages in one cache.
const LEAST: usize = 1 << 20;

/// Marks a slot without a page.
const NONE: u64 = u64::MAX;

/// Rows of as many words each.
#[derive(Debug)]
pub(super) struct Table {
    file: PlacedFile,
    width: usize,
    /// Number of rows.
    count: u64,
    /// A page has two to the power of this many rows.
    shift: u32,
    /// Number of slots of a cache, a power of two.
    slots: usize,
}

/// Cache of one thread: each page has one slot that it can be in.
#[derive(Debug)]
pub(super) struct Pages {
    /// Page in each slot.
    pages: Vec<u64>,
    words: Vec<Vec<u32>>,
    bytes: Vec<u8>,
}

impl Table {
    pub fn new(spool: Spool, width: usize, threads: usize) -> io::Result<Self> {
        let count = spool.words / width as u64;
        let shift = (PAGE / width).max(1).ilog2();
        let page = (size_of::<u32>() * width) << shift;
        let most = ((ALL / threads.max(1)).max(LEAST) / page).max(1);
        let pages = usize::try_from(count >> shift).unwrap_or(most) + 1;
        let slots = 1 << most.min(pages.next_power_of_two()).ilog2();
        Ok(Self { file: spool.finish()?, width, count, shift, slots })
    }

    /// Makes an empty cache.
    pub fn pages(&self) -> Pages {
        let words = vec![Vec::new(); self.slots];
        Pages { pages: vec![NONE; self.slots], words, bytes: Vec::new() }
    }

    /// Returns a row; `None` if there are not as many.
    #[inline]
    pub fn row<'c>(&self, pages: &'c mut Pages, row: u64) -> io::Result<Option<&'c [u32]>> {
        if row >= self.count {
            return Ok(None);
        }
        let page = row >> self.shift;
        let slot = page as usize & (self.slots - 1);
        if pages.pages[slot] != page {
            self.load(pages, page, slot)?;
        }
        let at = (row & ((1 << self.shift) - 1)) as usize * self.width;
        Ok(Some(&pages.words[slot][at..at + self.width]))
    }

    #[cold]
    fn load(&self, pages: &mut Pages, page: u64, slot: usize) -> io::Result<()> {
        pages.pages[slot] = NONE;
        let first = page << self.shift;
        let count = (1 << self.shift).min(self.count - first) as usize;
        let size = 4 * self.width;
        pages.bytes.resize(count * size, 0);
        self.file.read(first * size as u64, &mut pages.bytes)?;
        let words = &mut pages.words[slot];
        words.clear();
        words.extend(pages.bytes.as_chunks().0.iter().map(|&word| u32::from_le_bytes(word)));
        pages.pages[slot] = page;
        Ok(())
    }
}

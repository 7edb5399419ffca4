//! Cache of the vertices of a file, by pages of consecutive ones.
//!
//! Faces name vertices in any order, but mostly close to each other. Every thread has a cache of
//! its own, so that none waits for another.

use std::io;
use std::sync::Mutex;

/// Bytes of a page, about. On a terrain of 20 million faces pages of 16 and 64 KiB took as long;
/// 200,000 faces of vertices in no order took 4.8 s, and with those pages 11 s and 37 s.
const PAGE: usize = 1 << 12;

/// Bytes of the decoded vertices in all caches together.
const ALL: usize = 1 << 27;

/// Least number of bytes of the decoded vertices in one cache.
const LEAST: usize = 1 << 22;

/// Marks a slot without a page.
const NONE: u64 = u64::MAX;

/// Caches of all threads.
#[derive(Debug)]
pub(super) struct Caches {
    /// Number of vertices.
    pub count: u64,
    /// Values of a vertex.
    width: usize,
    /// A page has two to the power of this many vertices.
    shift: u32,
    /// Number of slots of a cache, a power of two.
    slots: usize,
    idle: Mutex<Vec<Cache>>,
}

/// Cache of one thread: each page has one slot that it can be in.
#[derive(Debug)]
pub(super) struct Cache {
    /// Page in each slot.
    pages: Vec<u64>,
    places: Vec<Vec<[f64; 3]>>,
    values: Vec<Vec<f32>>,
    bytes: Vec<u8>,
}

/// Page that is to be filled.
pub(super) struct Page<'c> {
    /// First vertex, and the number of vertices.
    pub first: u64,
    pub count: usize,
    pub places: &'c mut Vec<[f64; 3]>,
    pub values: &'c mut Vec<f32>,
    /// Room for what is read.
    pub bytes: &'c mut Vec<u8>,
}

/// Returns the binary logarithm of the number of vertices in a page, by their bytes in the file.
pub(super) fn page_shift(size: usize) -> u32 {
    (PAGE / size.max(1)).max(1).ilog2()
}

impl Caches {
    /// Makes caches of a number of vertices, each of so many bytes in the file and values.
    pub fn new(count: u64, size: usize, width: usize, threads: usize) -> Self {
        let shift = page_shift(size);
        let page = (size_of::<[f64; 3]>() + size_of::<f32>() * width) << shift;
        let most = ((ALL / threads.max(1)).max(LEAST) / page).max(1);
        let pages = usize::try_from(count >> shift).unwrap_or(most) + 1;
        let slots = 1 << most.min(pages.next_power_of_two()).ilog2();
        Self { count, width, shift, slots, idle: Mutex::default() }
    }

    /// Lends a cache that no other thread has.
    pub fn take(&self) -> Cache {
        let idle = self.idle.lock().expect("no thread panics here").pop();
        idle.unwrap_or_else(|| Cache {
            pages: vec![NONE; self.slots],
            places: vec![Vec::new(); self.slots],
            values: vec![Vec::new(); self.slots],
            bytes: Vec::new(),
        })
    }

    /// Takes a cache back.
    pub fn give(&self, cache: Cache) {
        self.idle.lock().expect("no thread panics here").push(cache);
    }

    /// Returns the place of a vertex, which there must be, and its values; `fill` reads its page.
    #[inline]
    pub fn vertex<'c>(
        &self,
        cache: &'c mut Cache,
        vertex: u64,
        fill: impl FnOnce(Page<'_>) -> io::Result<()>,
    ) -> io::Result<([f64; 3], &'c [f32])> {
        let page = vertex >> self.shift;
        let slot = page as usize & (self.slots - 1);
        if cache.pages[slot] != page {
            self.load(cache, page, slot, fill)?;
        }
        let row = (vertex & ((1 << self.shift) - 1)) as usize;
        Ok((cache.places[slot][row], &cache.values[slot][row * self.width..][..self.width]))
    }

    #[cold]
    fn load(
        &self,
        cache: &mut Cache,
        page: u64,
        slot: usize,
        fill: impl FnOnce(Page<'_>) -> io::Result<()>,
    ) -> io::Result<()> {
        cache.pages[slot] = NONE;
        let first = page << self.shift;
        let count = (1 << self.shift).min(self.count - first) as usize;
        let (places, values) = (&mut cache.places[slot], &mut cache.values[slot]);
        places.clear();
        values.clear();
        fill(Page { first, count, places, values, bytes: &mut cache.bytes })?;
        cache.pages[slot] = page;
        Ok(())
    }
}

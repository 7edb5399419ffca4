//! Cache of the vertices of a file, by pages of consecutive ones.
//!
//! Faces name vertices in any order, but mostly close to each other. Every thread has a cache of
//! its own, so that none waits for another.

use std::io;
use std::sync::Mutex;

use meshlod_io::ply::VertexRows;

use super::file::PlacedFile;

/// Bytes of a page, about. On a terrain of 20 million faces pages of 16 and 64 KiB took as long;
/// 200,000 faces of vertices in no order took 4.8 s, and with those pages 11 s and 37 s.
const PAGE: usize = 1 << 12;

/// Bytes of the decoded vertices in all caches together.
const ALL: usize = 1 << 27;

/// Least number of bytes of the decoded vertices in one cache.
const LEAST: usize = 1 << 22;

/// Marks a slot without a page.
const NONE: u64 = u64::MAX;

/// Caches of all threads, and what they are caches of.
#[derive(Debug)]
pub(super) struct Caches {
    rows: VertexRows,
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

impl Caches {
    pub fn new(rows: VertexRows, threads: usize) -> Self {
        let width: usize = rows.layers().iter().map(|layer| layer.width).sum();
        let shift = (PAGE / rows.size).max(1).ilog2();
        let page = (size_of::<[f64; 3]>() + size_of::<f32>() * width) << shift;
        let most = ((ALL / threads.max(1)).max(LEAST) / page).max(1);
        let pages = usize::try_from(rows.count >> shift).unwrap_or(most) + 1;
        let slots = 1 << most.min(pages.next_power_of_two()).ilog2();
        Self { rows, width, shift, slots, idle: Mutex::default() }
    }

    /// Returns the number of vertices.
    pub fn count(&self) -> u64 {
        self.rows.count
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

    /// Returns the place of a vertex, which there must be, and its values.
    #[inline]
    pub fn vertex<'c>(
        &self,
        file: &PlacedFile,
        cache: &'c mut Cache,
        vertex: u64,
    ) -> io::Result<([f64; 3], &'c [f32])> {
        let page = vertex >> self.shift;
        let slot = page as usize & (self.slots - 1);
        if cache.pages[slot] != page {
            self.load(file, cache, page, slot)?;
        }
        let row = (vertex & ((1 << self.shift) - 1)) as usize;
        Ok((cache.places[slot][row], &cache.values[slot][row * self.width..][..self.width]))
    }

    #[cold]
    fn load(&self, file: &PlacedFile, cache: &mut Cache, page: u64, slot: usize) -> io::Result<()> {
        cache.pages[slot] = NONE;
        let first = page << self.shift;
        let count = (1 << self.shift).min(self.rows.count - first) as usize;
        cache.bytes.resize(count * self.rows.size, 0);
        file.read(self.rows.start + first * self.rows.size as u64, &mut cache.bytes)?;
        let (places, values) = (&mut cache.places[slot], &mut cache.values[slot]);
        places.clear();
        values.clear();
        let read = self.rows.read(first, &cache.bytes, places, values);
        read.map_err(|error| file.invalid(error))?;
        cache.pages[slot] = page;
        Ok(())
    }
}

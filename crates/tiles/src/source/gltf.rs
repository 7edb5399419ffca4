//! Triangles of a glTF or GLB file, whose geometry is read in passing.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use meshlod_io::Scene;
use meshlod_io::gltf::{GltfStream, ScratchFile, Store, StoreFiles};
use rayon::prelude::*;

use super::file::PlacedFile;
use super::pages::{Cache, Caches, Page, page_shift};
use super::spool::Spool;
use super::{MOST_TRIANGLES, Source, Triangles};
use crate::layout::Layout;

/// Number of triangles that a thread decodes at a time.
const GROUP: usize = 1 << 12;

/// glTF or GLB file of any size, with little memory but for its JSON and images.
///
/// The triangles are those that a scene of the file shows, in the same order, with normals, texture
/// coordinates and colours. Rows of accessors are read where they are in the file and its buffers;
/// what is compressed or sparse is expanded into files without a name. Faces that lack normals, where
/// others have them, get their own.
#[derive(Debug)]
pub struct GltfSource {
    path: PathBuf,
    stream: GltfStream,
    /// First vertex of each pool among all, at the beginning of a page.
    firsts: Vec<u64>,
    caches: Caches,
    layout: Layout,
}

impl GltfSource {
    /// Opens a file; `None` if it has fewer than `least` bytes with its buffers and when nothing is
    /// compressed, or must be read as a whole. Returns a scene, too, whose meshes have no faces: materials, images and notes.
    ///
    /// # Errors
    /// Errors of the system, and those of [`meshlod_io::open_gltf_stream`].
    pub fn open(path: &Path, least: u64, scratch: &Path) -> io::Result<Option<(Self, Scene)>> {
        let files: Arc<dyn StoreFiles> = Arc::new(PassingFiles { scratch: scratch.to_owned() });
        let opened = meshlod_io::open_gltf_stream(path, least, files, Layout::keeps);
        let opened = opened.map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
        let Some((stream, scene)) = opened else { return Ok(None) };
        let layout = Layout::of(stream.layers());
        let width = layout.width();
        let size = size_of::<f32>() * (3 + width);
        let mut count = 0u64;
        let mut firsts = Vec::new();
        for pool in 0..stream.pools() {
            firsts.push(count);
            count =
                (count + stream.vertices_of(pool) as u64).next_multiple_of(1 << page_shift(size));
        }
        let caches = Caches::new(count, size, width, rayon::current_num_threads());
        Ok(Some((Self { path: path.to_owned(), stream, firsts, caches, layout }, scene)))
    }
}

impl Source for GltfSource {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn triangles(&self, take: &mut dyn FnMut(&Triangles) -> io::Result<()>) -> io::Result<()> {
        let mut batch = Batch::default();
        let mut some = Triangles::default();
        for (number, run) in self.stream.runs().iter().enumerate() {
            let mut first = 0;
            while first < run.steps {
                let count = GROUP.min(run.steps - first).min(MOST_TRIANGLES - batch.faces.len());
                batch.add(self, number, (first, count))?;
                first += count;
                if batch.faces.len() == MOST_TRIANGLES {
                    batch.decode(self, &mut some)?;
                    take(&some)?;
                }
            }
        }
        if batch.faces.is_empty() {
            return Ok(());
        }
        batch.decode(self, &mut some)?;
        take(&some)
    }
}

/// Triangles that are decoded together.
#[derive(Default)]
struct Batch {
    /// Vertices of the pools of their runs.
    faces: Vec<[u32; 3]>,
    parts: Vec<BatchPart>,
}

/// Some triangles of a run.
struct BatchPart {
    run: usize,
    count: usize,
}

impl Batch {
    /// Reads the vertices of some steps of a run.
    fn add(&mut self, source: &GltfSource, run: usize, steps: (usize, usize)) -> io::Result<()> {
        let before = self.faces.len();
        let read = source.stream.faces(run, steps, &mut self.faces);
        read.map_err(|error| source.invalid(error))?;
        self.parts.push(BatchPart { run, count: self.faces.len() - before });
        Ok(())
    }

    /// Makes triangles of all faces, and forgets these.
    fn decode(&mut self, source: &GltfSource, some: &mut Triangles) -> io::Result<()> {
        let width = source.layout.width();
        some.resize(self.faces.len(), width);
        let mut rest =
            (&self.faces[..], &mut some.places[..], &mut some.values[..], &mut some.materials[..]);
        let mut work = Vec::with_capacity(self.parts.len());
        for &BatchPart { run, count } in &self.parts {
            let (faces, faces_left) = rest.0.split_at(count);
            let (places, places_left) = rest.1.split_at_mut(count);
            let (values, values_left) = rest.2.split_at_mut(3 * width * count);
            let (materials, materials_left) = rest.3.split_at_mut(count);
            rest = (faces_left, places_left, values_left, materials_left);
            materials.fill(source.stream.runs()[run].material as u16);
            work.push((run, faces, places, values));
        }
        // The first error in the order of the file, whichever thread found one first.
        let decoded: Vec<io::Result<()>> = work
            .into_par_iter()
            .map(|(run, faces, places, values)| {
                let mut cache = source.caches.take();
                let decoded = source.decode(run, faces, (places, values), &mut cache);
                source.caches.give(cache);
                decoded
            })
            .collect();
        self.faces.clear();
        self.parts.clear();
        decoded.into_iter().collect()
    }
}

impl GltfSource {
    /// Fills the corners of some faces of a run.
    fn decode(
        &self,
        run: usize,
        faces: &[[u32; 3]],
        (places, values): (&mut [[[f64; 3]; 3]], &mut [f32]),
        cache: &mut Cache,
    ) -> io::Result<()> {
        let width = self.layout.width();
        let pool = self.stream.runs()[run].pool;
        let corners = places.as_flattened_mut().iter_mut().enumerate();
        for ((corner, place), &vertex) in corners.zip(faces.as_flattened()) {
            let (own, own_values) = self.vertex(pool, vertex, cache)?;
            let values = &mut values[width * corner..][..width];
            values.copy_from_slice(own_values);
            *place = self.stream.place(run, own, values);
        }
        self.layout.fill_normals(places, values);
        Ok(())
    }

    /// Returns the place of a vertex in its mesh, and its values.
    #[inline]
    fn vertex<'c>(
        &self,
        pool: usize,
        vertex: u32,
        cache: &'c mut Cache,
    ) -> io::Result<([f64; 3], &'c [f32])> {
        let first = self.firsts[pool];
        self.caches.vertex(cache, first + u64::from(vertex), |page: Page<'_>| {
            let own = (page.first - first) as usize;
            let there = self.stream.vertices_of(pool);
            let some = (own, page.count.min(there.saturating_sub(own)));
            let read = self.stream.vertices(pool, some, page.places, page.values);
            read.map_err(|error| self.invalid(error))
        })
    }

    fn invalid(&self, error: meshlod_io::ParseError) -> io::Error {
        io::Error::new(io::ErrorKind::InvalidData, meshlod_io::IoError::parse(&self.path, error))
    }
}

/// Files that a document is read from.
#[derive(Debug)]
struct PassingFiles {
    /// Folder of files without a name.
    scratch: PathBuf,
}

impl StoreFiles for PassingFiles {
    fn open(&self, path: &Path) -> io::Result<Arc<dyn Store>> {
        Ok(Arc::new(PlacedFile::open(path)?))
    }

    fn scratch(&self) -> io::Result<Box<dyn ScratchFile>> {
        Ok(Box::new(Spool::new(&self.scratch)?))
    }
}

impl Store for PlacedFile {
    fn length(&self) -> u64 {
        self.length
    }

    fn read(&self, at: u64, bytes: &mut [u8]) -> io::Result<()> {
        Self::read(self, at, bytes)
    }
}

impl ScratchFile for Spool {
    fn add(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.add_bytes(bytes)
    }

    fn finish(self: Box<Self>) -> io::Result<Arc<dyn Store>> {
        Ok(Arc::new(Spool::finish(*self)?))
    }
}

#[cfg(test)]
mod tests;

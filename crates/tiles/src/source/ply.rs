//! Triangles of a binary PLY file, which is read in passing.

use std::io;
use std::path::Path;

use meshlod_io::ply::{FaceRows, RowFault, StreamLayout, VertexRows, stream_layout};
use rayon::prelude::*;

use super::file::PlacedFile;
use super::pages::{Cache, Caches, Page};
use super::polygon::{Polygon, Slots};
use super::{MOST_TRIANGLES, Source, Triangles};
use crate::layout::Layout;

/// Bytes at the beginning of a file that its header must be in.
const HEAD: usize = 1 << 20;

/// Bytes of faces that are in memory at a time; no row may be longer.
const WINDOW: usize = 1 << 22;

/// Number of triangles from which rows are decoded by another thread.
const GROUP: usize = 1 << 12;

/// Binary PLY file that is read in passing, with little memory however large it is.
///
/// The triangles are those that [`meshlod_io::ply::read`] makes, in the same order, with the normals,
/// texture coordinates and colours of the vertices. Other properties are passed over.
#[derive(Debug)]
pub struct PlySource {
    file: PlacedFile,
    faces: FaceRows,
    vertices: VertexRows,
    caches: Caches,
    layout: Layout,
    left_out: Vec<String>,
}

impl PlySource {
    /// Opens a file; `None` if it can only be read as a whole, see [`stream_layout`].
    ///
    /// # Errors
    /// Errors of the system, and a header that is not one of a mesh.
    pub fn open(path: &Path) -> io::Result<Option<Self>> {
        let file = PlacedFile::open(path)?;
        let head = file.part(0, HEAD)?;
        let found = stream_layout(&head, file.length).map_err(|error| file.invalid(error))?;
        let Some(StreamLayout { mut vertices, faces, left_out }) = found else { return Ok(None) };
        vertices.keep_layers(Layout::keeps);
        let layout = Layout::of(&vertices.layers());
        let width = vertices.layers().iter().map(|layer| layer.width).sum();
        let threads = rayon::current_num_threads();
        let caches = Caches::new(vertices.count, vertices.size, width, threads);
        Ok(Some(Self { file, faces, vertices, caches, layout, left_out }))
    }

    /// Returns the properties of faces that are passed over, although scenes keep them.
    pub fn left_out(&self) -> &[String] {
        &self.left_out
    }
}

impl Source for PlySource {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn triangles(&self, take: &mut dyn FnMut(&Triangles) -> io::Result<()>) -> io::Result<()> {
        let mut window = Window::new(self);
        let mut some = Triangles::default();
        while window.next()? {
            some.resize(window.triangles(), self.layout.width());
            self.decode_all(&window, &mut some)?;
            take(&some)?;
        }
        Ok(())
    }
}

/// Consecutive rows of faces, decoded by one thread.
#[derive(Clone, Copy, Debug, Default)]
struct Group {
    /// Byte of the window that the first row begins at.
    at: usize,
    /// First row, counted in the file.
    first: u64,
    rows: usize,
    triangles: usize,
}

/// Part of the file that is in memory.
struct Window<'s> {
    source: &'s PlySource,
    bytes: Vec<u8>,
    /// Byte of the file that the window begins at.
    start: u64,
    /// Byte of the window that the next row begins at.
    at: usize,
    /// Next row, counted in the file.
    row: u64,
    groups: Vec<Group>,
}

impl<'s> Window<'s> {
    fn new(source: &'s PlySource) -> Self {
        let start = source.faces.start;
        Self { source, bytes: Vec::new(), start, at: 0, row: 0, groups: Vec::new() }
    }

    /// Returns the number of triangles of the current rows.
    fn triangles(&self) -> usize {
        self.groups.iter().map(|group| group.triangles).sum()
    }

    /// Goes on to the next rows, with at most [`MOST_TRIANGLES`] triangles; false at the end.
    fn next(&mut self) -> io::Result<bool> {
        self.groups.clear();
        let mut triangles = 0;
        while self.row < self.source.faces.count {
            match self.source.faces.row(&self.bytes[self.at..]) {
                Ok(row) => {
                    let more = row.corners.saturating_sub(2);
                    if triangles + more > MOST_TRIANGLES {
                        if triangles == 0 {
                            return Err(self.too_long());
                        }
                        break;
                    }
                    triangles += more;
                    self.add(row.size, more);
                }
                Err(RowFault::Needs(_)) if !self.groups.is_empty() => break,
                Err(RowFault::Needs(size)) => self.fill(size)?,
                Err(RowFault::Negative(length)) => {
                    let reason = format!("has a list of negative length {length}");
                    return Err(self.source.wrong(self.place(), self.row, &reason));
                }
            }
        }
        Ok(!self.groups.is_empty())
    }

    /// Adds a row to the current ones.
    fn add(&mut self, size: usize, triangles: usize) {
        if self.groups.last().is_none_or(|group| group.triangles >= GROUP) {
            self.groups.push(Group { at: self.at, first: self.row, ..Group::default() });
        }
        if let Some(group) = self.groups.last_mut() {
            group.rows += 1;
            group.triangles += triangles;
        }
        self.at += size;
        self.row += 1;
    }

    /// Returns the byte of the file that the next row begins at.
    fn place(&self) -> u64 {
        self.start + self.at as u64
    }

    /// Reads on from the next row, which needs this many bytes.
    fn fill(&mut self, size: u64) -> io::Result<()> {
        let (at, length) = (self.place(), self.source.file.length);
        if at.saturating_add(size) > length {
            let (row, count) = (self.row, self.source.faces.count);
            let reason = format!("the file ends inside face {row} of {count}");
            return Err(self.source.file.invalid_at(length, reason));
        }
        if size > WINDOW as u64 {
            return Err(self.too_long());
        }
        let there = usize::try_from(length - at).unwrap_or(usize::MAX);
        self.bytes.resize(WINDOW.min(there), 0);
        (self.start, self.at) = (at, 0);
        self.source.file.read(at, &mut self.bytes)
    }

    fn too_long(&self) -> io::Error {
        let most = MOST_TRIANGLES + 2;
        let reason = format!("is too long to be read in passing; it may have {most} corners");
        self.source.wrong(self.place(), self.row, &reason)
    }
}

impl PlySource {
    /// Decodes the current rows of a window.
    fn decode_all(&self, window: &Window<'_>, some: &mut Triangles) -> io::Result<()> {
        let width = self.layout.width();
        let (mut places, mut values) = (&mut some.places[..], &mut some.values[..]);
        let mut work = Vec::with_capacity(window.groups.len());
        for group in &window.groups {
            let (own, rest) = places.split_at_mut(group.triangles);
            let (own_values, rest_values) = values.split_at_mut(group.triangles * 3 * width);
            (places, values) = (rest, rest_values);
            work.push((
                group,
                Slots { places: own.as_flattened_mut(), values: own_values, width, at: 0 },
            ));
        }
        // The first error in the order of the file, whichever thread found one first.
        let decoded: Vec<io::Result<()>> = work
            .into_par_iter()
            .map(|(group, slots)| {
                let mut cache = self.caches.take();
                let decoded = self.decode(group, window, slots, &mut cache);
                self.caches.give(cache);
                decoded
            })
            .collect();
        decoded.into_iter().collect()
    }

    /// Decodes the rows of a group.
    fn decode(
        &self,
        group: &Group,
        window: &Window<'_>,
        mut slots: Slots<'_>,
        cache: &mut Cache,
    ) -> io::Result<()> {
        let (mut vertices, mut polygon) = (Vec::new(), Polygon::default());
        let mut at = group.at;
        for row in group.first..group.first + group.rows as u64 {
            at += self.read_vertices(row, (window, at), &mut vertices)?;
            match vertices[..] {
                [a, b, c] => {
                    for vertex in [a, b, c] {
                        let (place, values) = self.vertex(cache, vertex)?;
                        slots.put(place, values);
                    }
                }
                _ => {
                    polygon.clear();
                    for &vertex in &vertices {
                        let (place, values) = self.vertex(cache, vertex)?;
                        polygon.places.push(place);
                        polygon.values.extend_from_slice(values);
                    }
                    polygon.cut_into(&mut slots);
                }
            }
        }
        self.layout.fill_normals(slots.places.as_chunks().0, slots.values);
        Ok(())
    }

    /// Returns the place of a vertex, and its values.
    #[inline]
    fn vertex<'c>(&self, cache: &'c mut Cache, vertex: u64) -> io::Result<([f64; 3], &'c [f32])> {
        self.caches.vertex(cache, vertex, |page: Page<'_>| {
            page.bytes.resize(page.count * self.vertices.size, 0);
            let at = self.vertices.start + page.first * self.vertices.size as u64;
            self.file.read(at, page.bytes)?;
            let read = self.vertices.read(page.first, page.bytes, page.places, page.values);
            read.map_err(|error| self.file.invalid(error))
        })
    }

    /// Reads the vertices of a row; returns the size of the row.
    #[inline]
    fn read_vertices(
        &self,
        row: u64,
        (window, at): (&Window<'_>, usize),
        vertices: &mut Vec<u64>,
    ) -> io::Result<usize> {
        let bytes = &window.bytes[at..];
        let place = window.start + at as u64;
        let wrong = |reason: &str| self.wrong(place, row, reason);
        let face = self.faces.row(bytes).map_err(|_| wrong("has changed"))?;
        vertices.clear();
        let count = self.vertices.count;
        self.faces.vertices(face, bytes, count, vertices).map_err(|index| {
            wrong(&format!("refers to vertex {index}, but there are only {count}, counted from 0"))
        })?;
        Ok(face.size)
    }

    /// Creates the error of a face, by the byte of the file that it begins at.
    fn wrong(&self, place: u64, row: u64, reason: &str) -> io::Error {
        self.file.invalid_at(place, format!("face {row} of {} {reason}", self.faces.count))
    }
}

#[cfg(test)]
mod tests;

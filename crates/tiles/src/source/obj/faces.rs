//! Triangles from the rows of faces.

use std::io;

use meshlod_io::obj::OutlineRow;
use rayon::prelude::*;

use super::{ObjCaches, ObjSource};
use crate::source::polygon::{Polygon, Slots};
use crate::source::table::{Pages, Table};
use crate::source::{MOST_TRIANGLES, Triangles};

/// Words of faces that are in memory at a time.
const WINDOW: usize = 1 << 20;

/// Number of triangles from which faces are decoded by another thread.
const GROUP: usize = 1 << 12;

/// Consecutive faces, decoded by one thread.
#[derive(Clone, Copy, Debug)]
struct RowGroup {
    /// Words of the window.
    start: usize,
    end: usize,
    /// Number of the material of the first face.
    material: u32,
    triangles: usize,
}

/// Faces of a source, some at a time.
pub(super) struct Batches<'s> {
    source: &'s ObjSource,
    words: Vec<u32>,
    /// Word of the window that the next row begins at.
    at: usize,
    /// Byte of the file that the window ends at.
    end: u64,
    material: u32,
    groups: Vec<RowGroup>,
}

impl<'s> Batches<'s> {
    pub fn new(source: &'s ObjSource) -> Self {
        Self { source, words: Vec::new(), at: 0, end: 0, material: 0, groups: Vec::new() }
    }

    /// Goes on to the next triangles, at most [`MOST_TRIANGLES`]; false at the end.
    pub fn next(&mut self, some: &mut Triangles) -> io::Result<bool> {
        self.groups.clear();
        let mut triangles = 0;
        loop {
            let Some((row, size)) = OutlineRow::read(&self.words[self.at..]) else {
                if !self.groups.is_empty() || !self.fill()? {
                    break;
                }
                continue;
            };
            match row {
                OutlineRow::Material(number) => self.material = number,
                OutlineRow::Face { vertices, .. } => {
                    let more = vertices.len().saturating_sub(2);
                    if triangles > 0 && triangles + more > MOST_TRIANGLES {
                        break;
                    }
                    triangles += more;
                    self.add(size, more);
                }
            }
            self.at += size;
        }
        some.resize(triangles, self.source.layout.width());
        self.decode_all(some)?;
        Ok(triangles > 0)
    }

    /// Reads on from the next row; false at the end of the file.
    fn fill(&mut self) -> io::Result<bool> {
        let file = &self.source.faces;
        if self.end >= file.length {
            return Ok(false);
        }
        self.words.drain(..self.at);
        self.at = 0;
        let bytes = file.part(self.end, 4 * WINDOW)?;
        self.end += bytes.len() as u64;
        self.words.extend(bytes.as_chunks().0.iter().map(|&word| u32::from_le_bytes(word)));
        Ok(true)
    }

    /// Adds a face of some words to the current ones.
    fn add(&mut self, size: usize, triangles: usize) {
        let (start, material) = (self.at, self.material);
        if self.groups.last().is_none_or(|group| group.triangles >= GROUP) {
            self.groups.push(RowGroup { start, end: start, material, triangles: 0 });
        }
        if let Some(group) = self.groups.last_mut() {
            group.end = start + size;
            group.triangles += triangles;
        }
    }

    fn decode_all(&self, some: &mut Triangles) -> io::Result<()> {
        let width = self.source.layout.width();
        let mut rest = (&mut some.places[..], &mut some.values[..], &mut some.materials[..]);
        let mut work = Vec::with_capacity(self.groups.len());
        for group in &self.groups {
            let (places, places_left) = rest.0.split_at_mut(group.triangles);
            let (values, values_left) = rest.1.split_at_mut(group.triangles * 3 * width);
            let (materials, materials_left) = rest.2.split_at_mut(group.triangles);
            rest = (places_left, values_left, materials_left);
            let places = places.as_flattened_mut();
            work.push((group, Slots { places, values, width, at: 0 }, materials));
        }
        let decode = |(group, slots, materials): (&RowGroup, Slots<'_>, &mut [u16])| {
            let mut caches = self.source.take();
            let words = &self.words[group.start..group.end];
            let decoded =
                self.source.decode(words, group.material, (slots, materials), &mut caches);
            self.source.give(caches);
            decoded
        };
        work.into_par_iter().map(decode).collect()
    }
}

impl ObjSource {
    /// Decodes rows from the one on that comes after a material was set.
    fn decode(
        &self,
        words: &[u32],
        mut material: u32,
        (mut slots, materials): (Slots<'_>, &mut [u16]),
        caches: &mut ObjCaches,
    ) -> io::Result<()> {
        let mut polygon = Polygon::default();
        let mut at = 0;
        while let Some((row, size)) = OutlineRow::read(&words[at..]) {
            at += size;
            let OutlineRow::Face { vertices, uvs, normals } = row else {
                if let OutlineRow::Material(number) = row {
                    material = number;
                }
                continue;
            };
            let first = slots.at;
            polygon.clear();
            for (corner, &vertex) in vertices.iter().enumerate() {
                let ids = [uvs, normals].map(|ids| ids.get(corner).copied().unwrap_or(0));
                self.corner(vertex.into(), ids, caches, &mut polygon)?;
            }
            polygon.cut_into(&mut slots);
            let label = self.labels.get(material as usize).copied().unwrap_or(0) as u16;
            materials[first / 3..slots.at / 3].fill(label);
        }
        self.layout.fill_normals(slots.places.as_chunks().0, slots.values);
        Ok(())
    }

    /// Adds a corner of a face.
    #[inline]
    fn corner(
        &self,
        vertex: u64,
        [uv, normal]: [u32; 2],
        caches: &mut ObjCaches,
        polygon: &mut Polygon,
    ) -> io::Result<()> {
        let row = self.positions.row(&mut caches.positions, vertex)?.ok_or_else(short)?;
        let half = |i: usize| u64::from(row[i]);
        polygon.places.push([0, 2, 4].map(|i| f64::from_bits(half(i) | half(i + 1) << 32)));
        if self.layout.is_empty() {
            return Ok(());
        }
        let values = &mut polygon.values;
        add_value((&self.uvs, &mut caches.uvs), uv, 2, values)?;
        add_value((&self.normals, &mut caches.normals), normal, 3, values)?;
        if let (Some(table), Some(pages)) = (&self.colors, &mut caches.colors) {
            match table.row(pages, vertex)? {
                Some(row) => {
                    values.extend(row.iter().map(|&c| f32::from_bits(c) / self.color_scale))
                }
                None => values.extend([1.0; 3]),
            }
        }
        Ok(())
    }
}

/// Adds the value with an index that counts from 1, or zeros.
#[inline]
fn add_value(
    table: (&Option<Table>, &mut Option<Pages>),
    index: u32,
    width: usize,
    values: &mut Vec<f32>,
) -> io::Result<()> {
    let (Some(table), Some(pages)) = table else { return Ok(()) };
    match index.checked_sub(1) {
        Some(row) => {
            let row = table.row(pages, row.into())?.ok_or_else(short)?;
            values.extend(row.iter().map(|&value| f32::from_bits(value)));
        }
        None => values.extend((0..width).map(|_| 0.0)),
    }
    Ok(())
}

/// Creates the error of a row that the file had when it was read.
fn short() -> io::Error {
    io::Error::new(io::ErrorKind::UnexpectedEof, "a scratch file lacks values")
}

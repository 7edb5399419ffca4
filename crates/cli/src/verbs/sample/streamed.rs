//! Samples that are written in passing, since they are larger than memory.

use std::io;
use std::path::Path;

use meshlod::Format;
use meshlod::io::ply::{StreamShape, StreamWriter};
use meshlod::io::{Precision, write_ply_stream};
use meshlod::samples::{TerrainRows, terrain_color};
use rayon::prelude::*;

use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;

/// Number of faces from which a terrain is written row by row. The file is the same as that of a
/// terrain in memory.
const LEAST: usize = 4_000_000;

/// Number of rows that are made at a time, by all threads.
const ROWS: usize = 64;

/// Terrain that is written row by row.
pub struct StreamedTerrain {
    rows: TerrainRows,
    has_colors: bool,
    precision: Precision,
}

impl StreamedTerrain {
    /// Returns the terrain of about this many faces, if these are many and the file is PLY.
    pub fn new(
        faces: usize,
        output: &Path,
        has_colors: bool,
        precision: Precision,
    ) -> Option<Self> {
        let is_ply = !files::is_pipe(output) && Format::of_path(output).ok() == Some(Format::Ply);
        let rows = TerrainRows::new(faces);
        (is_ply && faces >= LEAST).then_some(Self { rows, has_colors, precision })
    }

    /// Writes the file; returns the numbers of vertices and faces.
    pub fn write(&self, output: &Path, session: &Session) -> Result<[u64; 2], Failure> {
        let [vertices, faces] = self.rows.sizes();
        let Self { has_colors, precision, .. } = *self;
        let shape = StreamShape { vertices, faces, has_colors, precision };
        write_ply_stream(output, shape, |writer| self.fill(writer, session))?;
        Ok([vertices, faces])
    }

    fn fill(&self, writer: &mut StreamWriter<'_>, session: &Session) -> io::Result<()> {
        let count = self.rows.count();
        for first in (0..count).step_by(ROWS) {
            session.progress.step(first, Some(count));
            let rows = first..count.min(first + ROWS);
            let places: Vec<Vec<[f64; 3]>> =
                rows.into_par_iter().map(|row| self.rows.places(row).collect()).collect();
            for place in places.into_iter().flatten() {
                writer.vertex(place, terrain_color(place[1]))?;
            }
        }
        let mut faces = (0..count - 1).flat_map(|row| self.rows.faces(row));
        faces.try_for_each(|face| writer.face(face))
    }
}

//! Samples that are written in passing, since they are larger than memory.

use std::io;
use std::path::Path;

use meshlod::Format;
use meshlod::io::ply::{StreamShape, StreamWriter};
use meshlod::io::{Precision, write_ply_stream};
use meshlod::samples::{GyroidSlabs, TerrainRows, terrain_color};
use rayon::prelude::*;

use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::files;

/// Number of faces from which samples are written in passing.
const LEAST: usize = 4_000_000;

/// Number of rows of a terrain that are made at a time, by all threads.
const ROWS: usize = 64;

/// Sample that is written in passing.
pub enum Streamed {
    /// Terrain, row by row: the file is the same as that of a terrain in memory.
    Terrain { rows: TerrainRows, has_colors: bool },
    /// Gyroid, slab by slab: in a cube and not in a ball.
    Gyroid(GyroidSlabs),
}

impl Streamed {
    /// Returns the sample of a name and of about this many faces, if these are many, the file is PLY
    /// and the sample need not be in memory as a whole.
    pub fn new(name: &str, faces: usize, output: &Path, has_colors: bool) -> Option<Self> {
        let is_ply = !files::is_pipe(output) && Format::of_path(output).ok() == Some(Format::Ply);
        if !is_ply || faces < LEAST {
            return None;
        }
        match name {
            "terrain" => Some(Self::Terrain { rows: TerrainRows::new(faces), has_colors }),
            "gyroid" => Some(Self::Gyroid(GyroidSlabs::new(faces))),
            _ => None,
        }
    }

    /// Writes the file; returns the numbers of vertices and faces.
    pub fn write(
        &self,
        output: &Path,
        precision: Precision,
        session: &Session,
    ) -> Result<[u64; 2], Failure> {
        let ([vertices, faces], has_colors) = match *self {
            Self::Terrain { rows, has_colors } => (rows.sizes(), has_colors),
            Self::Gyroid(slabs) => (slabs.sizes(), false),
        };
        let shape = StreamShape { vertices, faces, has_colors, precision };
        write_ply_stream(output, shape, |writer| match *self {
            Self::Terrain { rows, .. } => write_terrain(rows, writer, session),
            Self::Gyroid(slabs) => write_gyroid(slabs, writer),
        })?;
        Ok([vertices, faces])
    }
}

fn write_terrain(
    rows: TerrainRows,
    writer: &mut StreamWriter<'_>,
    session: &Session,
) -> io::Result<()> {
    let count = rows.count();
    for first in (0..count).step_by(ROWS) {
        session.progress.step(first, Some(count));
        let some = first..count.min(first + ROWS);
        let places: Vec<Vec<[f64; 3]>> =
            some.into_par_iter().map(|row| rows.places(row).collect()).collect();
        for place in places.into_iter().flatten() {
            writer.vertex(place, terrain_color(place[1]))?;
        }
    }
    let mut faces = (0..count - 1).flat_map(|row| rows.faces(row));
    faces.try_for_each(|face| writer.face(face))
}

fn write_gyroid(slabs: GyroidSlabs, writer: &mut StreamWriter<'_>) -> io::Result<()> {
    slabs.places(|places| places.iter().try_for_each(|&place| writer.vertex(place, [0; 3])))?;
    slabs.faces(|faces| faces.iter().try_for_each(|&face| writer.face(face)))
}

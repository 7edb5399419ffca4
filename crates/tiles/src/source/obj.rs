//! Triangles of an OBJ file, which is read once, into files without a name.
//!
//! `read` goes through the text; `faces` hands on the triangles.

mod faces;
mod read;

use std::io;
use std::path::Path;
use std::sync::Mutex;

use meshlod_io::{IoError, Scene};
use meshlod_mesh::LayerKind;

use super::file::PlacedFile;
use super::table::{Pages, Table};
use super::{Source, Triangles};
use crate::layout::Layout;
use faces::Batches;
use read::{Spools, WINDOW};

/// OBJ file of any size, with little memory.
///
/// The text is read once. Vertices, texture coordinates, normals, colours and faces are kept in
/// files without a name, which take about as much room as the text; a change to the file afterwards
/// has no effect. The triangles are those that [`meshlod_io::obj::read`] makes, in the same order.
/// Faces that lack normals, where others have them, get their own.
#[derive(Debug)]
pub struct ObjSource {
    /// Rows of faces, see [`meshlod_io::obj::OutlineRow`].
    faces: PlacedFile,
    positions: Table,
    uvs: Option<Table>,
    normals: Option<Table>,
    colors: Option<Table>,
    /// Number by which colours are divided.
    color_scale: f32,
    /// Label of the faces by number of a material.
    labels: Vec<u32>,
    layout: Layout,
    idle: Mutex<Vec<ObjCaches>>,
}

/// Caches of one thread.
#[derive(Debug)]
struct ObjCaches {
    positions: Pages,
    uvs: Option<Pages>,
    normals: Option<Pages>,
    colors: Option<Pages>,
}

impl ObjSource {
    /// Reads a file into files in the folder `scratch`. Returns a scene of a mesh without faces,
    /// too, with the materials, the images and the notes of the file.
    ///
    /// # Errors
    /// Errors of the system, such as a disk that is full, and those of
    /// [`meshlod_io::obj::read`]. Also a face of more than 65,538 corners, and a line of more than
    /// 64 MiB.
    pub fn open(path: &Path, scratch: &Path) -> io::Result<(Self, Scene)> {
        Self::open_by(path, scratch, WINDOW)
    }

    /// Opens a file with a number of bytes of text in memory at a time.
    fn open_by(path: &Path, scratch: &Path, window: usize) -> io::Result<(Self, Scene)> {
        let (spools, stream) = Spools::read(path, scratch, window)?;
        let end = meshlod_io::finish_obj_stream(path, stream).map_err(invalid)?;
        let layout = Layout::of(&end.layers);
        let threads = rayon::current_num_threads();
        // Values that no face refers to are no layer.
        let table = |kind: LayerKind, spool: read::Lazy, width| {
            let spool = spool.spool.filter(|_| end.layers.iter().any(|layer| layer.kind == kind));
            spool.map(|spool| Table::new(spool, width, threads)).transpose()
        };
        let colors = if end.is_painted { spools.paint } else { spools.colors };
        let source = Self {
            faces: spools.faces.finish()?,
            positions: Table::new(spools.positions, 6, threads)?,
            uvs: table(LayerKind::Uv(0), spools.uvs, 2)?,
            normals: table(LayerKind::Normal, spools.normals, 3)?,
            colors: table(LayerKind::Color(0), colors, 3)?,
            color_scale: end.color_scale,
            labels: end.labels,
            layout,
            idle: Mutex::default(),
        };
        Ok((source, end.scene))
    }

    fn take(&self) -> ObjCaches {
        let idle = self.idle.lock().expect("no thread panics here").pop();
        let pages = |table: &Option<Table>| table.as_ref().map(Table::pages);
        idle.unwrap_or_else(|| ObjCaches {
            positions: self.positions.pages(),
            uvs: pages(&self.uvs),
            normals: pages(&self.normals),
            colors: pages(&self.colors),
        })
    }

    fn give(&self, caches: ObjCaches) {
        self.idle.lock().expect("no thread panics here").push(caches);
    }
}

impl Source for ObjSource {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn triangles(&self, take: &mut dyn FnMut(&Triangles) -> io::Result<()>) -> io::Result<()> {
        let mut batches = Batches::new(self);
        let mut some = Triangles::default();
        while batches.next(&mut some)? {
            take(&some)?;
        }
        Ok(())
    }
}

/// Makes an error in a file one of the system, for those who look inside.
fn invalid(error: IoError) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, error)
}

#[cfg(test)]
mod tests;

//! Triangles of a binary STL file, which is read in passing.

use std::io;
use std::path::Path;

use meshlod_io::stl::{FACET, SNIFFED, binary_facets, corners, facet_at};
use rayon::prelude::*;

use super::file::PlacedFile;
use super::{MOST_TRIANGLES, Source, Triangles};
use crate::layout::Layout;

/// Number of facets that a thread decodes at a time.
const GROUP: usize = 1 << 12;

/// Binary STL file that is read in passing, with little memory however large it is. Normals and
/// the attributes of facets are passed over.
#[derive(Debug)]
pub struct StlSource {
    file: PlacedFile,
    facets: u64,
    layout: Layout,
}

impl StlSource {
    /// Opens a file; `None` if it is text.
    ///
    /// # Errors
    /// Errors of the system, and a number of facets that are not there.
    pub fn open(path: &Path) -> io::Result<Option<Self>> {
        let file = PlacedFile::open(path)?;
        let head = file.part(0, SNIFFED)?;
        let facets = binary_facets(&head, file.length).map_err(|error| file.invalid(error))?;
        Ok(facets.map(|facets| Self { file, facets, layout: Layout::default() }))
    }
}

impl Source for StlSource {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn triangles(&self, take: &mut dyn FnMut(&Triangles) -> io::Result<()>) -> io::Result<()> {
        let mut some = Triangles::default();
        for first in (0..self.facets).step_by(MOST_TRIANGLES) {
            let count = (self.facets - first).min(MOST_TRIANGLES as u64) as usize;
            let bytes = self.file.part(facet_at(first), count * FACET)?;
            some.resize(count, 0);
            let rows = bytes.as_chunks::<FACET>().0.par_iter().with_min_len(GROUP).enumerate();
            let decode = |(row, place): ((usize, &[u8; FACET]), &mut [[f64; 3]; 3])| {
                *place = corners(row.1, first + row.0 as u64, self.facets)?;
                Ok(())
            };
            let decoded = rows.zip(&mut some.places).map(decode);
            // One of several errors, but always the first one of a group.
            let decoded: Result<(), _> = decoded.collect();
            decoded.map_err(|error| self.file.invalid(error))?;
            take(&some)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use meshlod_io::Scene;

    use super::*;
    use crate::source::SceneSource;
    use crate::source::fixtures::all;

    fn open(bytes: &[u8]) -> io::Result<Option<StlSource>> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.stl");
        fs::write(&path, bytes).unwrap();
        StlSource::open(&path)
    }

    #[test]
    fn triangles_are_those_of_a_scene() {
        let mut bytes = Vec::new();
        meshlod_io::stl::write(&meshlod_samples::knot(150_000), &mut bytes).unwrap();
        let source = open(&bytes).unwrap().unwrap();
        let mesh = meshlod_io::stl::read(&bytes).unwrap();
        let scene = SceneSource::new(Scene::from_mesh("a", mesh));
        assert!(all(&source) == all(&scene));
        assert_eq!(source.bounds().unwrap(), scene.bounds().unwrap());
    }

    #[test]
    fn damage_is_named_by_its_byte() {
        let mut bytes = Vec::new();
        meshlod_io::stl::write(&meshlod_samples::knot(100), &mut bytes).unwrap();
        let facets = bytes.len() / FACET - 1;
        let error = |bytes: &[u8]| match open(bytes) {
            Ok(source) => source.unwrap().triangles(&mut |_| Ok(())).unwrap_err().to_string(),
            Err(error) => error.to_string(),
        };
        let end = bytes.len() - 1;
        let message = error(&bytes[..end]);
        let count = bytes.len() / FACET - 1;
        let expected =
            format!("a.stl: byte {end}: the file ends inside facet {} of {count}", facets - 1);
        assert!(message.ends_with(&expected), "{message}");
        let at = facet_at(3) as usize;
        bytes[at + 12..][..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
        let message = error(&bytes);
        assert!(message.contains(&format!("byte {at}: facet 3 of")), "{message}");
        assert!(open(b"solid a\nendsolid\n").unwrap().is_none());
    }
}

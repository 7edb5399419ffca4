//! Back-face culling of single-sided materials.

use meshlod_mesh::{Labels, Mesh};

use crate::project::Point;
use crate::raster::is_clockwise;
use crate::{BackFaces, Style};

/// Faces of a mesh that are seen from the front only; see [`Style::single_sided`].
#[derive(Clone, Copy)]
pub(crate) struct Culling<'a> {
    labels: Option<&'a Labels>,
    /// True for each single-sided material label.
    single_sided: &'a [bool],
}

impl<'a> Culling<'a> {
    /// Culling of no face.
    pub(crate) const NONE: Self = Self { labels: None, single_sided: &[] };

    /// Returns the culling that a style asks for. Backs that are tinted are there to be seen.
    pub(crate) fn of_style(mesh: &'a Mesh, style: &Style<'a>) -> Self {
        let single_sided = style.single_sided;
        let culls = style.back_faces == BackFaces::Same && single_sided.contains(&true);
        Self { labels: mesh.materials.as_ref().filter(|_| culls), single_sided }
    }

    /// Reports whether a projected triangle of a face is not drawn, because the face is
    /// single-sided and seen from behind.
    ///
    /// The sign is that of the exact area which the rasterizer fills, so a face is either drawn or
    /// culled as a whole, and neighbours that face the same way leave no gap.
    #[inline]
    pub(crate) fn hides(&self, face: usize, triangle: &[Point; 3]) -> bool {
        let Some(labels) = self.labels else { return false };
        let label = labels.of(face) as usize;
        self.single_sided.get(label).is_some_and(|&single| single) && is_clockwise(triangle)
    }
}

//! Back-face culling of single-sided materials.

use meshlod_mesh::{Labels, Mesh};

use crate::project::Point;
use crate::raster::is_clockwise;

/// Faces of a mesh that are seen from the front only; see [`Style::single_sided`].
///
/// [`Style::single_sided`]: crate::Style::single_sided
#[derive(Clone, Copy)]
pub(crate) struct Culling<'a> {
    labels: Option<&'a Labels>,
    /// Whether each material label is single-sided.
    single_sided: &'a [bool],
}

impl<'a> Culling<'a> {
    pub(crate) fn new(mesh: &'a Mesh, single_sided: &'a [bool]) -> Self {
        let labels = mesh.materials.as_ref().filter(|_| single_sided.contains(&true));
        Self { labels, single_sided }
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

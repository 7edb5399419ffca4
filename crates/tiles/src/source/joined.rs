//! Several sources as one model.

use std::io;

use super::{Source, Triangles};
use crate::layout::Layout;

/// Several sources as one model, with the layers that all of them have.
pub struct JoinedSource {
    parts: Vec<Part>,
    layout: Layout,
}

/// Source, and what it adds to the model.
struct Part {
    source: Box<dyn Source>,
    /// Number that is added to its materials.
    first_material: u16,
    /// By value of a corner of the model: the value of a corner of the source.
    values: Vec<usize>,
    /// True if these are all values, in order.
    is_same: bool,
}

impl JoinedSource {
    /// Joins sources, each with the number that is added to its materials. Returns the names of the
    /// layers, too, that are dropped since not all have them.
    pub fn new(sources: Vec<(Box<dyn Source>, u16)>) -> (Self, Vec<String>) {
        let layouts = || sources.iter().map(|(source, _)| source.layout());
        let layout = layouts().skip(1).fold(first_layout(&sources), Layout::common);
        let mut dropped: Vec<String> = layouts().flat_map(|own| own.beyond(&layout)).collect();
        dropped.sort();
        dropped.dedup();
        let part = |(source, first_material): (Box<dyn Source>, u16)| {
            let values = source.layout().values_of(&layout);
            let is_same = values.iter().copied().eq(0..source.layout().width());
            Part { source, first_material, values, is_same }
        };
        (Self { parts: sources.into_iter().map(part).collect(), layout }, dropped)
    }
}

fn first_layout(sources: &[(Box<dyn Source>, u16)]) -> Layout {
    sources.first().map(|(source, _)| source.layout().clone()).unwrap_or_default()
}

impl Source for JoinedSource {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn bounds(&self) -> io::Result<meshlod_mesh::Bounds> {
        let mut bounds = meshlod_mesh::Bounds::default();
        for part in &self.parts {
            bounds.merge(&part.source.bounds()?);
        }
        Ok(bounds)
    }

    fn triangles(&self, take: &mut dyn FnMut(&Triangles) -> io::Result<()>) -> io::Result<()> {
        let mut own = Triangles::default();
        for part in &self.parts {
            part.source.triangles(&mut |some| match part.is_same && part.first_material == 0 {
                true => take(some),
                false => {
                    part.translate(some, &mut own);
                    take(&own)
                }
            })?;
        }
        Ok(())
    }
}

impl Part {
    /// Makes triangles of the source those of the model.
    fn translate(&self, some: &Triangles, own: &mut Triangles) {
        own.places.clone_from(&some.places);
        own.values.clear();
        let width = self.source.layout().width();
        for corner in some.values.chunks_exact(width.max(1)) {
            own.values.extend(self.values.iter().map(|&value| corner[value]));
        }
        own.materials.clear();
        own.materials.extend(some.materials.iter().map(|own| own + self.first_material));
    }
}

#[cfg(test)]
mod tests {
    use meshlod_io::Scene;
    use meshlod_mesh::LayerKind;

    use super::*;
    use crate::source::SceneSource;
    use crate::source::fixtures::{all, patch};

    #[test]
    fn layers_that_only_some_have_are_dropped() {
        let source = |kinds: &[LayerKind]| -> Box<dyn Source> {
            Box::new(SceneSource::new(Scene::from_mesh("patch", patch(4, kinds))))
        };
        let (uv, color) = (LayerKind::Uv(0), LayerKind::Color(0));
        let parts = vec![(source(&[LayerKind::Normal, uv, color]), 0), (source(&[color, uv]), 2)];
        let (joined, dropped) = JoinedSource::new(parts);
        assert_eq!(dropped, ["normal"]);
        let (both, one) = (all(&joined), all(&*source(&[uv, color])));
        let half = both.places.len() / 2;
        assert_eq!(joined.layout().width(), 5);
        assert_eq!(
            (&both.places[..half], &both.places[half..]),
            (&one.places[..], &one.places[..])
        );
        let (first, second) = both.values.split_at(both.values.len() / 2);
        assert_eq!((first, second), (&one.values[..], &one.values[..]));
        assert_eq!((both.materials[0], both.materials[half]), (0, 2));
    }
}

//! Materials of a model on the GPU.

use meshlod::Mesh;
use meshlod::mesh::{Attributes, Labels, Layer};
use meshlod::multires::LayerFormat;

use super::model::CutModel;
use crate::ViewError;
use crate::mesh::{MaterialBinding, Surface};
use crate::renderer::Renderer;

impl CutModel {
    /// Uploads the materials of the paint, at least one.
    ///
    /// # Errors
    /// A paint that does not match the model.
    pub(super) fn materials(&self, renderer: &Renderer) -> Result<Vec<MaterialBinding>, ViewError> {
        let mesh = self.without_faces();
        let surface = Surface::new(&mesh, &self.paint().as_paint())?;
        let surface = surface.with_sides(&mesh, self.single_sided());
        Ok(surface.materials.iter().map(|m| MaterialBinding::new(renderer, m)).collect())
    }

    /// Returns a mesh without faces that has the layers and the material labels of the model.
    fn without_faces(&self) -> Mesh {
        let empty = |layer: LayerFormat<'_>| {
            let (kind, name) = (layer.kind, layer.name.to_owned());
            Layer { kind, name, width: layer.width, values: Vec::new() }
        };
        let layers = self.contractions().into_iter().flat_map(|levels| levels.layers());
        let layers = layers.map(empty).collect();
        let labels = self.groups.all.iter().map(|group| group.material as usize + 1).max();
        let names = vec![String::new(); labels.unwrap_or(1).max(self.single_sided().len())];
        Mesh {
            attributes: Some(Attributes { layers, ..Attributes::default() }),
            materials: Some(Labels { names, of_face: Vec::new() }),
            ..Mesh::default()
        }
    }
}

//! Layers and primitives of a mesh, as the document declares them.

use meshlod_mesh::{Layer, LayerKind};

use crate::error::ParseError;
use crate::gltf::document::Document;
use crate::gltf::document::schema::Primitive;
use crate::gltf::read::mesh::{fits, kind};

/// Mesh whose values are not read.
pub(super) struct SurveyedMesh {
    /// Layers that the mesh would have, without values.
    pub layers: Vec<Layer>,
    /// Primitives that have faces.
    pub primitives: Vec<SurveyedPrimitive>,
}

/// Primitive whose values are not read.
pub(super) struct SurveyedPrimitive {
    /// Name in messages.
    pub part: String,
    /// Number of the primitive in its mesh.
    pub label: usize,
    /// Names and accessors of its attributes.
    pub accessors: Vec<(String, usize)>,
    pub positions: usize,
    /// Number of vertices.
    pub vertices: usize,
    pub indices: Option<usize>,
    /// Number of indices, or of vertices without them.
    pub corners: usize,
    pub mode: u32,
}

impl SurveyedPrimitive {
    /// Returns the accessor of a layer of this kind.
    pub fn accessor(&self, of: LayerKind) -> Option<usize> {
        self.accessors.iter().find(|(name, _)| kind(name) == of).map(|&(_, accessor)| accessor)
    }

    /// Returns the number of triangles, with those of strips and fans that have no area.
    pub fn steps(&self) -> usize {
        if self.mode == 4 { self.corners / 3 } else { self.corners.saturating_sub(2) }
    }
}

/// Surveys mesh `index`.
pub(super) fn survey(document: &Document<'_>, index: usize) -> Result<SurveyedMesh, ParseError> {
    let mut mesh = SurveyedMesh { layers: Vec::new(), primitives: Vec::new() };
    for (label, primitive) in document.meshes[index].primitives.iter().enumerate() {
        if primitive.has_faces() {
            let part = format!("mesh {index}, primitive {label}");
            mesh.add(document, primitive, part, label)?;
        }
    }
    Ok(mesh)
}

impl SurveyedMesh {
    fn add(
        &mut self,
        document: &Document<'_>,
        primitive: &Primitive,
        part: String,
        label: usize,
    ) -> Result<(), ParseError> {
        let wrong = |reason: String| ParseError::part(&part, reason);
        let accessors = primitive.accessors().map_err(wrong)?;
        let Some(&(_, positions)) = accessors.iter().find(|(name, _)| name == "POSITION") else {
            return Err(wrong("has no POSITION attribute".to_owned()));
        };
        let (accessor, width, _) = document.typed(positions)?;
        let vertices = accessor.count;
        if width != 3 {
            return Err(ParseError::part(format!("accessor {positions}"), "POSITION must be VEC3"));
        }
        document.plain_span(positions)?;
        for (name, accessor) in accessors.iter().filter(|(name, _)| name != "POSITION") {
            document.plain_span(*accessor)?;
            let (accessor, width, _) = document.typed(*accessor)?;
            let found = accessor.count;
            if found != vertices {
                let reason = format!("{name} has {found} elements, but POSITION has {vertices}");
                return Err(wrong(reason));
            }
            self.add_layer(name, width).map_err(wrong)?;
        }
        let corners = match primitive.indices {
            Some(indices) => {
                document.check_indices(indices)?;
                document.plain_span(indices)?;
                document.accessors[indices].count
            }
            None => vertices,
        };
        let (indices, mode) = (primitive.indices, primitive.mode);
        self.primitives.push(SurveyedPrimitive {
            part,
            label,
            accessors,
            positions,
            vertices,
            indices,
            corners,
            mode,
        });
        Ok(())
    }

    fn add_layer(&mut self, name: &str, width: usize) -> Result<(), String> {
        let kind = kind(name);
        if !fits(kind, width) {
            return Err(format!("{name} cannot have {width} components"));
        }
        let Some(layer) = self.layers.iter_mut().find(|layer| layer.name == name) else {
            self.layers.push(Layer { kind, name: name.to_owned(), width, values: Vec::new() });
            return Ok(());
        };
        if matches!(kind, LayerKind::Color(_)) {
            layer.width = layer.width.max(width);
        }
        let known = layer.width;
        if width != known && !matches!(kind, LayerKind::Color(_)) {
            return Err(format!(
                "{name} has {width} components, but {known} in an earlier primitive"
            ));
        }
        Ok(())
    }
}

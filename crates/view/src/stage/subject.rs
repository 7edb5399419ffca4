//! Subjects: things on the GPU that a stage shows.

use std::collections::HashMap;
use std::sync::Arc;

use meshlod::Mesh;
use meshlod::check::{Objects, ObjectsBy};
use meshlod::mesh::{Bounds, LayerKind, VertexId};
use meshlod::picture::{ColorMap, Normals, Paint, Values};
use meshlod::scene::OwnedPaint;
use meshlod::strip::{StripOptions, stripify};
use wgpu::RenderPass;

use super::palette::color_of;
use super::{Coloring, CompressedSubject, Display, LevelsSubject, Loaded, LoadedContent};
use crate::{GpuMesh, Placement, Renderer, ViewError};

/// Thing on the GPU that a stage shows.
#[derive(Debug)]
pub enum Subject {
    /// A mesh of one level.
    Mesh(Box<MeshSubject>),
    /// Levels of detail, and a cut of them that follows a query.
    Levels(Box<LevelsSubject>),
    /// Compressed mesh, drawn from its stored bits.
    Compressed(Box<CompressedSubject>),
}

/// Mesh on the GPU, with the data of its colourings; a clone shares the buffers.
#[derive(Clone, Debug)]
pub struct MeshSubject {
    mesh: GpuMesh,
    /// Whether each material is single-sided.
    single_sided: Arc<[bool]>,
    /// Copy of the surface in the colours of its distance from another.
    heat: Option<GpuMesh>,
    bounds: Bounds,
    vertices: usize,
    /// Colouring whose colours of faces are on the GPU.
    by_face: Option<Coloring>,
    has_uv: bool,
}

impl Subject {
    /// Uploads a file, from any thread: in slices, so that frames drawn meanwhile go on.
    ///
    /// # Errors
    /// A mesh beyond the limits of the GPU.
    pub fn new(renderer: &Renderer, loaded: &Loaded) -> Result<Self, ViewError> {
        Ok(match &loaded.content {
            LoadedContent::Levels(model) => {
                Self::Levels(Box::new(LevelsSubject::new(renderer, model)?))
            }
            // Colours of vertices are decoded.
            LoadedContent::Compressed(compressed)
                if matches!(*loaded.paint, OwnedPaint::Plain(_)) =>
            {
                let subject = CompressedSubject::new(renderer, compressed, loaded.bounds)?;
                Self::Compressed(Box::new(subject))
            }
            _ => Self::Mesh(Box::new(MeshSubject::new(renderer, loaded)?)),
        })
    }

    /// Returns the mesh of one level; `None` for other subjects.
    pub fn as_mesh(&self) -> Option<&MeshSubject> {
        if let Self::Mesh(mesh) = self { Some(mesh) } else { None }
    }

    /// Returns the box around the surface.
    pub fn bounds(&self) -> Bounds {
        match self {
            Self::Mesh(mesh) => mesh.bounds,
            Self::Levels(levels) => levels.bounds(),
            Self::Compressed(compressed) => compressed.bounds,
        }
    }

    /// Returns the number of faces that are drawn.
    pub fn faces(&self) -> usize {
        match self {
            Self::Mesh(mesh) => mesh.mesh.faces(),
            Self::Levels(levels) => levels.cut().faces(),
            Self::Compressed(compressed) => compressed.mesh().faces(),
        }
    }

    /// Returns the number of vertices of the surface.
    pub fn vertices(&self) -> usize {
        match self {
            Self::Mesh(mesh) => mesh.vertices,
            Self::Levels(levels) => levels.last_step().vertices,
            Self::Compressed(compressed) => compressed.vertices,
        }
    }

    /// Returns the size of vertices and faces on the GPU, in bytes.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Mesh(mesh) => mesh.mesh.bytes() + mesh.heat.as_ref().map_or(0, GpuMesh::bytes),
            Self::Levels(levels) => levels.cut().bytes(),
            Self::Compressed(compressed) => compressed.mesh().bytes(),
        }
    }

    /// Returns the point of the world that the placement must be set to.
    pub fn origin(&self) -> [f64; 3] {
        match self {
            Self::Mesh(mesh) => mesh.mesh.origin(),
            Self::Levels(levels) => levels.cut().origin(),
            Self::Compressed(compressed) => compressed.mesh().origin(),
        }
    }

    /// Returns true if the subject can be shown in a colouring.
    pub fn has(&self, coloring: Coloring) -> bool {
        match self {
            Self::Mesh(mesh) => match coloring {
                Coloring::Own | Coloring::Clay => true,
                Coloring::Checker => mesh.has_uv,
                Coloring::Heat => mesh.heat.is_some(),
                Coloring::Objects | Coloring::Materials | Coloring::Strips => {
                    mesh.by_face == Some(coloring)
                }
                Coloring::Parts => false,
            },
            Self::Levels(levels) => match coloring {
                Coloring::Own | Coloring::Clay => true,
                Coloring::Checker => levels.cut().has_uv(),
                _ => false,
            },
            Self::Compressed(_) => {
                matches!(coloring, Coloring::Own | Coloring::Clay | Coloring::Parts)
            }
        }
    }

    /// Returns the display in which the subject is drawn: `wanted`, with the colours of the file if
    /// the subject lacks those of `wanted`.
    pub fn display(&self, wanted: &Display) -> Display {
        let coloring = if self.has(wanted.coloring) { wanted.coloring } else { Coloring::Own };
        Display { coloring, ..*wanted }
    }

    /// Calls `set` for the placements of dissolving triangles, with the share of their pixels that
    /// is shown.
    pub(super) fn place_fade(&self, set: impl Fn(&Placement, f32)) {
        if let Self::Levels(levels) = self {
            levels.place_fade(set);
        }
    }

    /// Draws the subject; the placement must be set to [`Subject::origin`] and to the shade of
    /// [`Subject::display`].
    pub fn draw(
        &self,
        renderer: &Renderer,
        pass: &mut RenderPass<'_>,
        placement: &Placement,
        display: &Display,
    ) {
        match self {
            Self::Mesh(mesh) => mesh.draw(renderer, pass, placement, &self.display(display)),
            Self::Levels(levels) => levels.draw(renderer, pass, placement, display),
            Self::Compressed(compressed) => compressed.draw(renderer, pass, placement),
        }
    }
}

impl From<MeshSubject> for Subject {
    fn from(mesh: MeshSubject) -> Self {
        Self::Mesh(Box::new(mesh))
    }
}

impl MeshSubject {
    fn new(renderer: &Renderer, loaded: &Loaded) -> Result<Self, ViewError> {
        let mesh = &*loaded.mesh;
        let has_uv =
            mesh.attributes.as_ref().is_some_and(|all| all.layer(LayerKind::Uv(0)).is_some());
        Ok(Self {
            mesh: GpuMesh::with_sides(
                renderer,
                mesh,
                &loaded.paint.as_paint(),
                loaded.normals,
                &loaded.single_sided,
            )?,
            single_sided: Arc::clone(&loaded.single_sided),
            heat: None,
            bounds: loaded.bounds,
            vertices: mesh.positions.len(),
            by_face: None,
            has_uv,
        })
    }

    /// Uploads distances of the vertices of a mesh from another, to be shown by [`Coloring::Heat`];
    /// `most` is the distance of the darkest colour. `mesh` must be the one that the subject was
    /// made of.
    ///
    /// # Errors
    /// Distances that do not match the mesh, or a mesh beyond the limits of the GPU.
    pub fn set_heat(
        &mut self,
        renderer: &Renderer,
        mesh: &Mesh,
        normals: Normals,
        distances: &[f32],
        most: f32,
    ) -> Result<(), ViewError> {
        let range = [0.0, if most > 0.0 { most } else { 1.0 }];
        let values = Values { values: distances, map: ColorMap::Heat, range };
        let paint = Paint::VertexValues(values);
        let sides = &self.single_sided;
        self.heat = Some(GpuMesh::with_sides(renderer, mesh, &paint, normals, sides)?);
        Ok(())
    }

    /// Uploads the colours of faces that a colouring needs; does nothing for one that needs none.
    /// `mesh` must be the one that the subject was made of.
    ///
    /// # Errors
    /// A mesh that is too large to be drawn face by face.
    pub fn color_faces(
        &mut self,
        renderer: &Renderer,
        mesh: &Mesh,
        coloring: Coloring,
    ) -> Result<(), ViewError> {
        if !coloring.is_by_mesh_face() || self.by_face == Some(coloring) {
            return Ok(());
        }
        self.mesh.set_face_colors(renderer, &face_colors(mesh, coloring))?;
        self.by_face = Some(coloring);
        Ok(())
    }

    fn draw(
        &self,
        renderer: &Renderer,
        pass: &mut RenderPass<'_>,
        placement: &Placement,
        display: &Display,
    ) {
        let mesh = match (&self.heat, display.coloring) {
            (Some(heat), Coloring::Heat) => heat,
            _ => &self.mesh,
        };
        if display.wireframe || display.coloring.is_by_face() {
            mesh.draw_faces(renderer, pass, placement);
        } else {
            mesh.draw(renderer, pass, placement);
        }
    }
}

/// Returns the colour of each face by its object, material or strip.
fn face_colors(mesh: &Mesh, coloring: Coloring) -> Vec<[u8; 3]> {
    match (coloring, &mesh.materials) {
        (Coloring::Materials, Some(labels)) => {
            labels.of_face.iter().map(|&label| color_of(label)).collect()
        }
        (Coloring::Materials, None) => vec![color_of(0); mesh.faces.len()],
        (Coloring::Strips, _) => strip_colors(mesh),
        _ => {
            let objects = Objects::of(mesh, ObjectsBy::Auto);
            objects.of_face.iter().map(|object| color_of(object.0)).collect()
        }
    }
}

/// Returns the colour of each face by its strip.
fn strip_colors(mesh: &Mesh) -> Vec<[u8; 3]> {
    let key = |mut face: [VertexId; 3]| {
        face.sort_unstable();
        face
    };
    let mut colors = HashMap::with_capacity(mesh.faces.len());
    for (number, strip) in stripify(&mesh.faces, &StripOptions::default()).iter().enumerate() {
        let triangles = strip.windows(3).map(|t| key([t[0], t[1], t[2]]));
        colors.extend(triangles.map(|face| (face, color_of(number as u32))));
    }
    let color = |face: &[VertexId; 3]| colors.get(&key(*face)).copied().unwrap_or([128; 3]);
    mesh.faces.iter().map(color).collect()
}

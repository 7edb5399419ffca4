//! Reading an OBJ file part by part, for files that are larger than memory.

use meshlod_mesh::{Layer, LayerKind, Mesh};

use super::mtl::{Library, resolve_materials};
use super::outlines::Outlines;
use super::read::{ObjContent, ObjReader};
use crate::error::ParseError;
use crate::notes::{Note, grouped};
use crate::options::Resolve;
use crate::scene::{Node, Scene, SceneMesh, normals};
use crate::text::cursor::TextCursor;
use crate::vertex_attributes::named_layer;

/// Reader of an OBJ file that is given part by part, each of which it forgets.
///
/// It reads what [`read`](super::read()) does, but leaves polygons as they are: corners may refer to
/// what comes later. Memory grows with the number of names in the file alone.
pub struct ObjStream {
    content: ObjContent,
    /// Line and byte that the next part begins at.
    line: usize,
    byte: usize,
    not_finite: usize,
    /// Number of vertices up to the last coloured one.
    colored: usize,
    /// True if a colour exceeds 1, so that all are to be divided by 255.
    has_bytes: bool,
    painted: usize,
}

/// Values and faces of a part of an OBJ file, each kind in the order of the file.
#[derive(Clone, Debug, Default)]
pub struct ObjPart {
    /// Number of vertices of the parts before.
    pub first: usize,
    /// Places of vertices.
    pub positions: Vec<[f64; 3]>,
    /// Texture coordinates.
    pub uvs: Vec<[f32; 2]>,
    /// Normals of unit length, or 0 without a length.
    pub normals: Vec<[f32; 3]>,
    /// Colours of vertices from `first` on up to the last coloured one, not yet scaled.
    pub colors: Vec<[f32; 3]>,
    /// Colours from comments, which count if no vertex has another.
    pub paint: Vec<[f32; 3]>,
    /// Faces, see [`OutlineRow`](super::OutlineRow).
    pub outlines: Vec<u32>,
}

/// Contents of an OBJ file beyond its values and faces.
#[derive(Debug)]
pub struct ObjEnd {
    /// Scene of a mesh without faces: materials, images and notes.
    pub scene: Scene,
    /// Layers of corners, without values: texture coordinates, normals, colours.
    pub layers: Vec<Layer>,
    /// Label of a scene's faces by number of a material; faces without one have the last label.
    pub labels: Vec<u32>,
    /// Number by which colours are to be divided.
    pub color_scale: f32,
    /// True if colours are those from comments.
    pub is_painted: bool,
}

impl Default for ObjStream {
    fn default() -> Self {
        Self {
            content: ObjContent::in_parts(),
            line: 1,
            byte: 0,
            not_finite: 0,
            colored: 0,
            has_bytes: false,
            painted: 0,
        }
    }
}

impl ObjStream {
    /// Returns the number of bytes at the beginning of some that end with a statement; 0 if more are
    /// needed to tell.
    pub fn whole_statements(bytes: &[u8]) -> usize {
        TextCursor::whole_statements(bytes)
    }

    /// Reads the next part of a file, which ends with a statement or with the file.
    ///
    /// # Errors
    /// The line and the reason, as those of [`read`](super::read()).
    pub fn read(&mut self, bytes: &[u8]) -> Result<ObjPart, ParseError> {
        let text = match self.byte {
            0 => TextCursor::new(bytes)?,
            first => TextCursor::of_part(bytes, self.line, first)?,
        };
        let mut reader = ObjReader { text, content: std::mem::take(&mut self.content) };
        reader.statements()?;
        self.line = reader.text.line() + 1;
        self.byte += bytes.len();
        self.not_finite += reader.text.not_finite();
        self.content = reader.content;
        Ok(self.take())
    }

    /// Takes the values and faces that were read.
    fn take(&mut self) -> ObjPart {
        let content = &mut self.content;
        let first = content.before.vertices;
        content.before = content.counts();
        let mut normals = std::mem::take(&mut content.pools.normals);
        normals.iter_mut().for_each(|normal| *normal = normals::unit(*normal).unwrap_or_default());
        let colors = std::mem::take(&mut content.pools.colors);
        if !colors.is_empty() {
            self.colored = first + colors.len();
            self.has_bytes |= colors.as_flattened().iter().any(|&c| c > 1.0);
        }
        let paint = std::mem::take(&mut content.polypaint.colors);
        self.painted += paint.len();
        let outlines = content.outlines.as_mut().map(|own| std::mem::take(&mut own.words));
        ObjPart {
            first,
            positions: std::mem::take(&mut content.positions),
            uvs: std::mem::take(&mut content.pools.uvs),
            normals,
            colors,
            paint,
            outlines: outlines.unwrap_or_default(),
        }
    }

    /// Ends a file, and loads its materials and images.
    ///
    /// # Errors
    /// A corner that refers to what the file does not have, and a file without faces.
    pub fn finish(self, resolve: Resolve<'_>) -> Result<ObjEnd, ParseError> {
        let Self { mut content, not_finite, colored, painted, .. } = self;
        let outlines = content.outlines.take().unwrap_or_default();
        outlines.check(content.before)?;
        let vertices = content.before.vertices;
        if outlines.faces == 0 {
            let reason = format!("the file ends without faces ({vertices} vertices)");
            let line = self.line.saturating_sub(1);
            return Err(content.first_thin.unwrap_or_else(|| ParseError::line(line, reason)));
        }
        let is_painted = colored == 0 && painted > 0;
        let layers = layers(&outlines, colored > 0 || is_painted && vertices > 0);
        let mut library = Library::default();
        content.libraries.iter().for_each(|name| library.add(name, resolve));
        let bare = bare_note(&outlines);
        let (names, label_of) = outlines.names.finish();
        let resolved = resolve_materials(&names, &library, resolve);
        let none = resolved.materials.len();
        let label = |label: Option<usize>| label.and_then(|label| *resolved.labels.get(label)?);
        let labels = label_of.into_iter().map(|own| label(own).unwrap_or(none) as u32).collect();
        content.skipped.not_finite = not_finite;
        content.skipped.masks = content.polypaint.masked;
        let unused = painted.saturating_sub(vertices);
        content.skipped.paint = if is_painted { unused } else { painted };
        let mut notes = content.skipped.notes(content.has_object);
        notes.extend(bare);
        notes.extend(resolved.notes);
        let mesh = SceneMesh { name: String::new(), mesh: Mesh::default(), materials: Vec::new() };
        let scene = Scene {
            meshes: vec![mesh],
            nodes: vec![Node { mesh: Some(0), ..Node::default() }],
            roots: vec![0],
            materials: resolved.materials,
            images: resolved.images,
            notes,
            ..Scene::default()
        };
        let color_scale = if self.has_bytes { 255.0 } else { 1.0 };
        Ok(ObjEnd { scene, layers, labels, color_scale, is_painted })
    }
}

/// Returns the layers that corners have.
fn layers(outlines: &Outlines, has_colors: bool) -> Vec<Layer> {
    let kinds = [
        (outlines.has_uvs, LayerKind::Uv(0), 2),
        (outlines.has_normals, LayerKind::Normal, 3),
        (has_colors, LayerKind::Color(0), 3),
    ];
    let there = kinds.into_iter().filter(|&(is_there, ..)| is_there);
    there.map(|(_, kind, width)| named_layer(kind, width, Vec::new())).collect()
}

/// Notes the faces that lack normals, although others have them.
fn bare_note(outlines: &Outlines) -> Option<Note> {
    if !outlines.has_normals || outlines.bare == 0 {
        return None;
    }
    let all = grouped(usize::try_from(outlines.faces).unwrap_or(usize::MAX));
    let what = format!("of {all} faces that lack normals, which get their own");
    Some(Note::changed(outlines.bare, &what, &what))
}

//! Reading OBJ files in one pass over the bytes.

use std::num::NonZeroU32;

use meshlod_mesh::{Mesh, VertexId};

use super::bare_faces;
use super::labels::LabelRuns;
use super::mtl::{Library, resolve_materials};
use super::outlines::Outlines;
use super::polypaint::Polypaint;
use super::skipped::Skipped;
use super::smoothing::SmoothingRuns;
use super::wedges;
use super::wedges::{CornerIds, Pools};
use crate::error::ParseError;
use crate::polygon::triangulate;
use crate::scene::{Node, Scene, SceneMesh};
use crate::text::cursor::{TextCursor, quoted, text_of};

/// Parses an OBJ file as one mesh under one node; `resolve` loads the material library and the
/// textures, or returns `None` if a file does not exist.
///
/// Polygons are triangulated. A `v` gives three coordinates and, if present, a colour; a `vt` gives
/// two coordinates. Values of `vt`, `vn` and colours that are not finite become 0, and are counted.
/// Corners without a texture coordinate that others have get 0, too, and those without a normal get
/// that of the faces around them, which is noted. Colours above 1 are divided by 255. Colours
/// in comments `#MRGB`, the polypaint of ZBrush, are used if no vertex has another. `o` wins over
/// `g`. A material whose library or image is missing keeps its name. Materials that no face uses
/// come last. Lines, points, curves, faces with fewer than three corners and other statements are
/// counted in [`Scene::notes`].
///
/// Cost: O(n), n = bytes, plus that of triangulating concave polygons.
/// # Errors
/// The line and the reason: an invalid number, a coordinate that is not finite, an index out of
/// range. Also a file without faces of three corners, or one that is not text.
pub fn read(
    bytes: &[u8],
    resolve: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
) -> Result<Scene, ParseError> {
    let mut reader = ObjReader::new(bytes)?;
    reader.statements()?;
    reader.finish(resolve)
}

/// Corner of a face; its ids count from 1 and are not yet range-checked.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub(super) vertex: NonZeroU32,
    pub(super) ids: CornerIds,
}

/// Polygon that refers to elements later in the file, for which `n - 2` placeholder faces are
/// added.
struct Forward {
    line: usize,
    first_face: usize,
    corners: Vec<Corner>,
}

pub(super) struct ObjReader<'a> {
    pub(super) text: TextCursor<'a>,
    pub(super) content: ObjContent,
}

/// Contents of a file up to a statement.
#[derive(Default)]
pub(super) struct ObjContent {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) pools: Pools,
    faces: Vec<[VertexId; 3]>,
    /// Attribute ids of each face's corners; empty until a corner has any.
    corners: Vec<[CornerIds; 3]>,
    forward: Vec<Forward>,
    objects: LabelRuns,
    materials: LabelRuns,
    smoothing: SmoothingRuns,
    pub(super) has_object: bool,
    pub(super) libraries: Vec<String>,
    pub(super) skipped: Skipped,
    pub(super) polypaint: Polypaint,
    /// Error about the first face with too few corners, in case the file has no others.
    pub(super) first_thin: Option<ParseError>,
    /// Current polygon, its vertices and its triangles.
    polygon: Vec<Corner>,
    outline: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    /// Faces as they are in the file, if it is read part by part: they take the place of `faces`,
    /// `corners`, `forward` and the runs.
    pub(super) outlines: Option<Outlines>,
    /// Numbers of values that were taken from `positions` and `pools` already.
    pub(super) before: ValueCounts,
}

/// Numbers of the values that corners may refer to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ValueCounts {
    pub(super) vertices: usize,
    pub(super) uvs: usize,
    pub(super) normals: usize,
}

impl ObjContent {
    /// Content of a file that is read part by part.
    pub(super) fn in_parts() -> Self {
        Self { outlines: Some(Outlines::default()), ..Self::default() }
    }

    pub(super) fn counts(&self) -> ValueCounts {
        ValueCounts {
            vertices: self.before.vertices + self.positions.len(),
            uvs: self.before.uvs + self.pools.uvs.len(),
            normals: self.before.normals + self.pools.normals.len(),
        }
    }
}

impl<'a> ObjReader<'a> {
    fn new(bytes: &'a [u8]) -> Result<Self, ParseError> {
        Ok(Self { text: TextCursor::new(bytes)?, content: ObjContent::default() })
    }

    /// Reads all statements of the text.
    pub(super) fn statements(&mut self) -> Result<(), ParseError> {
        loop {
            self.statement()?;
            if !self.text.next_line() {
                return Ok(());
            }
        }
    }

    // Long because each kind of statement has its line.
    fn statement(&mut self) -> Result<(), ParseError> {
        if !self.text.more() {
            if self.text.take_word(b"#MRGB ") {
                self.content.polypaint.add(self.text.raw_line());
            }
            return Ok(());
        }
        match self.text.word() {
            b"v" => self.vertex(),
            b"vt" => self.uv(),
            b"vn" => self.normal(),
            b"f" => self.face(),
            b"o" => {
                self.content.has_object = true;
                let name = self.text.name();
                if self.content.outlines.is_none() {
                    self.content.objects.set(self.content.faces.len(), name);
                }
                Ok(())
            }
            b"g" => {
                let name = self.text.name();
                if !self.content.has_object && self.content.outlines.is_none() {
                    self.content.objects.set(self.content.faces.len(), name.clone());
                }
                if !name.is_empty() {
                    self.content.skipped.groups.insert(name);
                }
                Ok(())
            }
            b"usemtl" => {
                let name = self.text.name();
                match &mut self.content.outlines {
                    Some(outlines) => outlines.set_material(name),
                    None => self.content.materials.set(self.content.faces.len(), name),
                }
                Ok(())
            }
            b"mtllib" => {
                let name = self.text.name();
                self.content.libraries.push(name);
                Ok(())
            }
            b"s" => {
                let group = text_of(self.text.word());
                // Only the names are of interest where faces are not kept.
                if self.content.outlines.is_some() {
                    self.content.smoothing = SmoothingRuns::default();
                }
                if let Err(unknown) = self.content.smoothing.set(self.content.faces.len(), group) {
                    self.content.skipped.smoothing.insert(unknown);
                }
                Ok(())
            }
            // Lines, curves, and vendor extensions of the format.
            other if is_keyword(other) => {
                self.content.skipped.statement(other);
                Ok(())
            }
            other => Err(self.text.error(format!("{} is not an OBJ statement", quoted(other)))),
        }
    }

    fn vertex(&mut self) -> Result<(), ParseError> {
        const NEED: &str = "a vertex needs three coordinates";
        let position = [self.text.number(NEED)?, self.text.number(NEED)?, self.text.number(NEED)?];
        if self.content.counts().vertices == u32::MAX as usize {
            return Err(self.text.error("more than 2^32 vertices are not supported"));
        }
        self.content.positions.push(position);
        if self.text.more() { self.vertex_extras() } else { Ok(()) }
    }

    /// Reads the numbers after a position: `w`, `r g b`, `r g b a` or `w r g b`, distinguished by
    /// their count. The first of four is taken as red.
    fn vertex_extras(&mut self) -> Result<(), ParseError> {
        let mut extras = [0.0; 4];
        let mut count = 0;
        while count < extras.len() && self.text.more() {
            extras[count] = self.text.attribute("")?;
            count += 1;
        }
        if count < 3 {
            self.content.skipped.weights += usize::from(count > 0 && extras[0] != 1.0);
        } else {
            let [r, g, b, a] = extras;
            self.content.skipped.opacities += usize::from(count == 4 && a != 1.0 && a != 255.0);
            self.content.pools.add_color(self.content.positions.len(), [r, g, b]);
        }
        Ok(())
    }

    fn uv(&mut self) -> Result<(), ParseError> {
        let u = self.text.attribute("a texture coordinate needs a number")?;
        let v = if self.text.more() { self.text.attribute("")? } else { 0.0 };
        self.content.pools.uvs.push([u, v]);
        if self.text.more() {
            self.content.skipped.depths +=
                usize::from(!self.text.attribute("").is_ok_and(|w| w == 0.0));
        }
        Ok(())
    }

    fn normal(&mut self) -> Result<(), ParseError> {
        const NEED: &str = "a normal needs three numbers";
        let normal =
            [self.text.attribute(NEED)?, self.text.attribute(NEED)?, self.text.attribute(NEED)?];
        self.content.pools.normals.push(normal);
        Ok(())
    }

    fn face(&mut self) -> Result<(), ParseError> {
        self.content.polygon.clear();
        let mut known = true;
        while self.text.more() {
            let corner = self.corner()?;
            known &= is_known(corner, self.content.counts());
            self.content.polygon.push(corner);
        }
        if self.content.polygon.len() < 3 {
            return self.thin_face();
        }
        if let Some(outlines) = &mut self.content.outlines {
            return outlines.add(&self.content.polygon, known, &self.text);
        }
        let first_face = self.content.faces.len();
        if first_face + self.content.polygon.len() > u32::MAX as usize / 3 {
            return Err(self.text.error("more than 2^32 corners are not supported"));
        }
        self.triangulate(known);
        let has_ids = !self.content.corners.is_empty()
            || self.content.polygon.iter().any(|corner| corner.ids != CornerIds::default());
        if has_ids {
            // Has an effect once, for the faces before the first one with ids.
            self.content.corners.resize(first_face, Default::default());
        }
        for triangle in &self.content.triangles {
            let corners = triangle.map(|i| self.content.polygon[i as usize]);
            self.content.faces.push(corners.map(|corner| VertexId(corner.vertex.get() - 1)));
            if has_ids {
                self.content.corners.push(corners.map(|corner| corner.ids));
            }
        }
        if !known {
            let corners = self.content.polygon.clone();
            self.content.forward.push(Forward { line: self.text.line(), first_face, corners });
        }
        Ok(())
    }

    /// Skips a face with too few corners.
    #[cold]
    fn thin_face(&mut self) -> Result<(), ParseError> {
        let found = self.content.polygon.len();
        let reason = format!("a face needs at least three corners, but this one has {found}");
        let error = self.text.error(reason);
        self.content.first_thin.get_or_insert(error);
        self.content.skipped.thin_faces += 1;
        Ok(())
    }

    /// Triangulates `polygon` into `triangles`; as a fan while some positions are still unknown.
    fn triangulate(&mut self, known: bool) {
        self.content.triangles.clear();
        if known {
            self.content.outline.clear();
            self.content
                .outline
                .extend(self.content.polygon.iter().map(|corner| corner.vertex.get() - 1));
            triangulate(
                &self.content.positions,
                &self.content.outline,
                &mut self.content.triangles,
            );
        } else {
            self.content
                .triangles
                .extend((2..self.content.polygon.len() as u32).map(|i| [0, i - 1, i]));
        }
    }

    /// Reads `v`, `v/vt`, `v//vn` or `v/vt/vn`; the number after a slash may be missing.
    fn corner(&mut self) -> Result<Corner, ParseError> {
        let vertex = self.index("vertex", self.content.counts().vertices)?;
        let mut ids = CornerIds::default();
        if self.text.take(b'/') {
            ids.uv = self.optional_index("texture coordinate", self.content.counts().uvs)?;
            if self.text.take(b'/') {
                ids.normal = self.optional_index("normal", self.content.counts().normals)?;
            }
        }
        if !self.text.at_blank() {
            return Err(self.text.refuse("a valid part of a corner; write 1, 1/2, 1//3 or 1/2/3"));
        }
        Ok(Corner { vertex, ids })
    }

    fn optional_index(
        &mut self,
        what: &str,
        count: usize,
    ) -> Result<Option<NonZeroU32>, ParseError> {
        if self.text.at_blank() || self.text.comes(b'/') {
            return Ok(None);
        }
        self.index(what, count).map(Some)
    }

    /// Reads an index counted from 1 or, if negative, back from the last of the `count` preceding
    /// elements.
    #[inline]
    fn index(&mut self, what: &str, count: usize) -> Result<NonZeroU32, ParseError> {
        let written = self.text.integer("an index is missing")?;
        let index = if written < 0 { written + 1 + count as i64 } else { written };
        match u32::try_from(index).ok().and_then(NonZeroU32::new) {
            Some(index) => Ok(index),
            None => Err(out_of_range(self.text.line(), what, written, count)),
        }
    }

    fn finish(
        mut self,
        resolve: &mut dyn FnMut(&str) -> Option<Vec<u8>>,
    ) -> Result<Scene, ParseError> {
        self.settle_forward()?;
        if self.content.faces.is_empty() {
            let points = self.content.positions.len();
            let reason = format!("the file ends without faces ({points} vertices)");
            return Err(self.content.first_thin.unwrap_or_else(|| self.text.error(reason)));
        }
        let objects = self.content.objects.finish(self.content.faces.len());
        let materials = self.content.materials.finish(self.content.faces.len());
        let smoothing = self.content.smoothing.finish(self.content.faces.len());
        self.content.skipped.not_finite = self.text.not_finite();
        self.content.skipped.masks = self.content.polypaint.masked;
        self.content.skipped.paint = self
            .content
            .pools
            .add_paint(self.content.polypaint.colors, self.content.positions.len());
        // Without attributes at corners, colours change only between separate vertices.
        let has_split_seams = self.content.corners.is_empty();
        let attributes = wedges::attributes(
            self.content.positions.len(),
            &self.content.faces,
            &self.content.corners,
            self.content.pools,
        );
        let mut library = Library::default();
        for name in &self.content.libraries {
            library.add(name, resolve);
        }
        let used = materials.as_ref().map_or(&[][..], |labels| &labels.names);
        let resolved = resolve_materials(used, &library, resolve);
        let mut mesh = Mesh {
            attributes,
            materials,
            objects,
            face_layers: smoothing.into_iter().collect(),
            ..Mesh::new(self.content.positions, self.content.faces)
        };
        let bare = bare_faces::compute_normals(&mut mesh, &self.content.corners);
        let mut notes = self.content.skipped.notes(self.content.has_object);
        notes.extend(bare);
        notes.extend(resolved.notes);
        Ok(Scene {
            meshes: vec![SceneMesh { name: String::new(), mesh, materials: resolved.labels }],
            nodes: vec![Node { mesh: Some(0), ..Node::default() }],
            roots: vec![0],
            materials: resolved.materials,
            images: resolved.images,
            has_split_seams,
            notes,
            ..Scene::default()
        })
    }

    /// Checks and triangulates the polygons that referred to later elements.
    fn settle_forward(&mut self) -> Result<(), ParseError> {
        for Forward { line, first_face, corners } in std::mem::take(&mut self.content.forward) {
            for &corner in &corners {
                check_range(line, corner, self.content.counts())?;
            }
            self.content.polygon = corners;
            self.triangulate(true);
            for (i, triangle) in self.content.triangles.iter().enumerate() {
                let corners = triangle.map(|corner| self.content.polygon[corner as usize]);
                self.content.faces[first_face + i] = corners.map(|c| VertexId(c.vertex.get() - 1));
                if !self.content.corners.is_empty() {
                    self.content.corners[first_face + i] = corners.map(|c| c.ids);
                }
            }
        }
        Ok(())
    }
}

fn is_keyword(word: &[u8]) -> bool {
    word[0].is_ascii_alphabetic() && word.iter().all(|&b| b.is_ascii_alphanumeric() || b == b'_')
}

#[inline]
fn is_known(corner: Corner, counts: ValueCounts) -> bool {
    let within =
        |id: Option<NonZeroU32>, count: usize| id.is_none_or(|id| id.get() as usize <= count);
    corner.vertex.get() as usize <= counts.vertices
        && within(corner.ids.uv, counts.uvs)
        && within(corner.ids.normal, counts.normals)
}

pub(super) fn check_range(
    line: usize,
    corner: Corner,
    counts: ValueCounts,
) -> Result<(), ParseError> {
    let ids = [
        ("vertex", Some(corner.vertex), counts.vertices),
        ("texture coordinate", corner.ids.uv, counts.uvs),
        ("normal", corner.ids.normal, counts.normals),
    ];
    for (what, id, count) in ids {
        if let Some(id) = id.filter(|id| id.get() as usize > count) {
            return Err(out_of_range(line, what, id.get().into(), count));
        }
    }
    Ok(())
}

#[cold]
fn out_of_range(line: usize, what: &str, written: i64, count: usize) -> ParseError {
    let there = match count {
        _ if written == 0 => "indices start at 1".to_owned(),
        0 => "there is none".to_owned(),
        1 => "there is only 1".to_owned(),
        _ => format!("there are only {count}"),
    };
    let so_far = if written < 0 && count > 0 { " so far" } else { "" };
    ParseError::line(line, format!("a face refers to {what} {written}, but {there}{so_far}"))
}

//! Reading OBJ files in one pass over the bytes.

use std::num::NonZeroU32;

use meshlod_mesh::{Mesh, VertexId};

use super::bare_faces;
use super::labels::LabelRuns;
use super::mtl::{Library, resolve_materials};
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
    loop {
        reader.statement()?;
        if !reader.text.next_line() {
            break;
        }
    }
    reader.finish(resolve)
}

/// Corner of a face; its ids count from 1 and are not yet range-checked.
#[derive(Clone, Copy)]
struct Corner {
    vertex: NonZeroU32,
    ids: CornerIds,
}

/// Polygon that refers to elements later in the file, for which `n - 2` placeholder faces are
/// added.
struct Forward {
    line: usize,
    first_face: usize,
    corners: Vec<Corner>,
}

struct ObjReader<'a> {
    text: TextCursor<'a>,
    positions: Vec<[f64; 3]>,
    pools: Pools,
    faces: Vec<[VertexId; 3]>,
    /// Attribute ids of each face's corners; empty until a corner has any.
    corners: Vec<[CornerIds; 3]>,
    forward: Vec<Forward>,
    objects: LabelRuns,
    materials: LabelRuns,
    smoothing: SmoothingRuns,
    has_object: bool,
    libraries: Vec<String>,
    skipped: Skipped,
    polypaint: Polypaint,
    /// Error about the first face with too few corners, in case the file has no others.
    first_thin: Option<ParseError>,
    /// Current polygon, its vertices and its triangles.
    polygon: Vec<Corner>,
    outline: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

impl<'a> ObjReader<'a> {
    fn new(bytes: &'a [u8]) -> Result<Self, ParseError> {
        Ok(Self {
            text: TextCursor::new(bytes)?,
            positions: Vec::new(),
            pools: Pools::default(),
            faces: Vec::new(),
            corners: Vec::new(),
            forward: Vec::new(),
            objects: LabelRuns::default(),
            materials: LabelRuns::default(),
            smoothing: SmoothingRuns::default(),
            has_object: false,
            libraries: Vec::new(),
            skipped: Skipped::default(),
            polypaint: Polypaint::default(),
            first_thin: None,
            polygon: Vec::new(),
            outline: Vec::new(),
            triangles: Vec::new(),
        })
    }

    fn statement(&mut self) -> Result<(), ParseError> {
        if !self.text.more() {
            if self.text.take_word(b"#MRGB ") {
                self.polypaint.add(self.text.raw_line());
            }
            return Ok(());
        }
        match self.text.word() {
            b"v" => self.vertex(),
            b"vt" => self.uv(),
            b"vn" => self.normal(),
            b"f" => self.face(),
            b"o" => {
                self.has_object = true;
                let name = self.text.name();
                self.objects.set(self.faces.len(), name);
                Ok(())
            }
            b"g" => {
                let name = self.text.name();
                if !self.has_object {
                    self.objects.set(self.faces.len(), name.clone());
                }
                if !name.is_empty() {
                    self.skipped.groups.insert(name);
                }
                Ok(())
            }
            b"usemtl" => {
                let name = self.text.name();
                self.materials.set(self.faces.len(), name);
                Ok(())
            }
            b"mtllib" => {
                let name = self.text.name();
                self.libraries.push(name);
                Ok(())
            }
            b"s" => {
                let group = text_of(self.text.word());
                if let Err(unknown) = self.smoothing.set(self.faces.len(), group) {
                    self.skipped.smoothing.insert(unknown);
                }
                Ok(())
            }
            // Lines, curves, and vendor extensions of the format.
            other if is_keyword(other) => {
                self.skipped.statement(other);
                Ok(())
            }
            other => Err(self.text.error(format!("{} is not an OBJ statement", quoted(other)))),
        }
    }

    fn vertex(&mut self) -> Result<(), ParseError> {
        const NEED: &str = "a vertex needs three coordinates";
        let position = [self.text.number(NEED)?, self.text.number(NEED)?, self.text.number(NEED)?];
        if self.positions.len() == u32::MAX as usize {
            return Err(self.text.error("more than 2^32 vertices are not supported"));
        }
        self.positions.push(position);
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
            self.skipped.weights += usize::from(count > 0 && extras[0] != 1.0);
        } else {
            let [r, g, b, a] = extras;
            self.skipped.opacities += usize::from(count == 4 && a != 1.0 && a != 255.0);
            self.pools.add_color(self.positions.len(), [r, g, b]);
        }
        Ok(())
    }

    fn uv(&mut self) -> Result<(), ParseError> {
        let u = self.text.attribute("a texture coordinate needs a number")?;
        let v = if self.text.more() { self.text.attribute("")? } else { 0.0 };
        self.pools.uvs.push([u, v]);
        if self.text.more() {
            self.skipped.depths += usize::from(!self.text.attribute("").is_ok_and(|w| w == 0.0));
        }
        Ok(())
    }

    fn normal(&mut self) -> Result<(), ParseError> {
        const NEED: &str = "a normal needs three numbers";
        let normal =
            [self.text.attribute(NEED)?, self.text.attribute(NEED)?, self.text.attribute(NEED)?];
        self.pools.normals.push(normal);
        Ok(())
    }

    fn face(&mut self) -> Result<(), ParseError> {
        self.polygon.clear();
        let mut known = true;
        while self.text.more() {
            let corner = self.corner()?;
            known &= is_known(corner, self.positions.len(), &self.pools);
            self.polygon.push(corner);
        }
        if self.polygon.len() < 3 {
            return self.thin_face();
        }
        let first_face = self.faces.len();
        if first_face + self.polygon.len() > u32::MAX as usize / 3 {
            return Err(self.text.error("more than 2^32 corners are not supported"));
        }
        self.triangulate(known);
        let has_ids = !self.corners.is_empty()
            || self.polygon.iter().any(|corner| corner.ids != CornerIds::default());
        if has_ids {
            // Has an effect once, for the faces before the first one with ids.
            self.corners.resize(first_face, Default::default());
        }
        for triangle in &self.triangles {
            let corners = triangle.map(|i| self.polygon[i as usize]);
            self.faces.push(corners.map(|corner| VertexId(corner.vertex.get() - 1)));
            if has_ids {
                self.corners.push(corners.map(|corner| corner.ids));
            }
        }
        if !known {
            let corners = self.polygon.clone();
            self.forward.push(Forward { line: self.text.line(), first_face, corners });
        }
        Ok(())
    }

    /// Skips a face with too few corners.
    #[cold]
    fn thin_face(&mut self) -> Result<(), ParseError> {
        let found = self.polygon.len();
        let reason = format!("a face needs at least three corners, but this one has {found}");
        let error = self.text.error(reason);
        self.first_thin.get_or_insert(error);
        self.skipped.thin_faces += 1;
        Ok(())
    }

    /// Triangulates `polygon` into `triangles`; as a fan while some positions are still unknown.
    fn triangulate(&mut self, known: bool) {
        self.triangles.clear();
        if known {
            self.outline.clear();
            self.outline.extend(self.polygon.iter().map(|corner| corner.vertex.get() - 1));
            triangulate(&self.positions, &self.outline, &mut self.triangles);
        } else {
            self.triangles.extend((2..self.polygon.len() as u32).map(|i| [0, i - 1, i]));
        }
    }

    /// Reads `v`, `v/vt`, `v//vn` or `v/vt/vn`; the number after a slash may be missing.
    fn corner(&mut self) -> Result<Corner, ParseError> {
        let vertex = self.index("vertex", self.positions.len())?;
        let mut ids = CornerIds::default();
        if self.text.take(b'/') {
            ids.uv = self.optional_index("texture coordinate", self.pools.uvs.len())?;
            if self.text.take(b'/') {
                ids.normal = self.optional_index("normal", self.pools.normals.len())?;
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
        if self.faces.is_empty() {
            let points = self.positions.len();
            let reason = format!("the file ends without faces ({points} vertices)");
            return Err(self.first_thin.unwrap_or_else(|| self.text.error(reason)));
        }
        let objects = self.objects.finish(self.faces.len());
        let materials = self.materials.finish(self.faces.len());
        let smoothing = self.smoothing.finish(self.faces.len());
        self.skipped.not_finite = self.text.not_finite();
        self.skipped.masks = self.polypaint.masked;
        self.skipped.paint = self.pools.add_paint(self.polypaint.colors, self.positions.len());
        // Without attributes at corners, colours change only between separate vertices.
        let has_split_seams = self.corners.is_empty();
        let attributes =
            wedges::attributes(self.positions.len(), &self.faces, &self.corners, self.pools);
        let mut library = Library::default();
        for name in &self.libraries {
            library.add(name, resolve);
        }
        let used = materials.as_ref().map_or(&[][..], |labels| &labels.names);
        let resolved = resolve_materials(used, &library, resolve);
        let mut mesh = Mesh {
            attributes,
            materials,
            objects,
            face_layers: smoothing.into_iter().collect(),
            ..Mesh::new(self.positions, self.faces)
        };
        let bare = bare_faces::compute_normals(&mut mesh, &self.corners);
        let mut notes = self.skipped.notes(self.has_object);
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
        for Forward { line, first_face, corners } in std::mem::take(&mut self.forward) {
            for &corner in &corners {
                check_range(line, corner, self.positions.len(), &self.pools)?;
            }
            self.polygon = corners;
            self.triangulate(true);
            for (i, triangle) in self.triangles.iter().enumerate() {
                let corners = triangle.map(|corner| self.polygon[corner as usize]);
                self.faces[first_face + i] = corners.map(|c| VertexId(c.vertex.get() - 1));
                if !self.corners.is_empty() {
                    self.corners[first_face + i] = corners.map(|c| c.ids);
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
fn is_known(corner: Corner, positions: usize, pools: &Pools) -> bool {
    let within =
        |id: Option<NonZeroU32>, count: usize| id.is_none_or(|id| id.get() as usize <= count);
    corner.vertex.get() as usize <= positions
        && within(corner.ids.uv, pools.uvs.len())
        && within(corner.ids.normal, pools.normals.len())
}

fn check_range(
    line: usize,
    corner: Corner,
    positions: usize,
    pools: &Pools,
) -> Result<(), ParseError> {
    let ids = [
        ("vertex", Some(corner.vertex), positions),
        ("texture coordinate", corner.ids.uv, pools.uvs.len()),
        ("normal", corner.ids.normal, pools.normals.len()),
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

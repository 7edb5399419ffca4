//! Values of PLY faces beyond their vertices: texture coordinates, textures, colours, labels and
//! scalars.

use super::body::{BodyReader, Row};
use super::face_scalars::FaceScalars;
use super::header::{Element, Property, Shape};
use super::layers::{OTHER_COLORS, greatest};
use super::scalar::Scalar;
use crate::error::ParseError;

/// Names of integer properties that assign a face to a part of the model.
const LABELS: [&str; 14] = [
    "label",
    "labels",
    "segment",
    "segment_id",
    "segmentation",
    "class",
    "category",
    "category_id",
    "object",
    "object_id",
    "group",
    "group_id",
    "part",
    "instance",
];

/// Reports whether a property of this name labels faces.
pub(super) fn is_label(name: &str) -> bool {
    LABELS.contains(&name)
}

/// Returns the properties red, green, blue and, where there is one, alpha of a face, under the first
/// of their names that all three have; empty if there is none.
pub(super) fn colors_of(properties: &[Property]) -> Vec<Option<usize>> {
    let usual: &[&str] = &["red", "green", "blue", "alpha"];
    let sets = [usual].into_iter().chain(OTHER_COLORS);
    let mut found = sets.map(|names| names.iter().map(|name| one(properties, name)).collect());
    let is_whole = |of: &Vec<Option<usize>>| of[..3].iter().all(Option::is_some);
    found.find(is_whole).unwrap_or_default()
}

/// Returns the index of the scalar property of a name.
fn one(properties: &[Property], name: &str) -> Option<usize> {
    properties.iter().position(|p| p.name == name && matches!(p.shape, Shape::One(_)))
}

/// Use of a property of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    Uvs,
    Texture,
    /// Component of the colour, and the divisor of its numbers.
    Color(usize, f64),
    Label,
    /// Scalar of no other use, with its column.
    Scalar(usize),
    /// Not kept.
    Other,
}

/// Values of one face of the file, which may be a polygon.
#[derive(Debug, Default)]
pub(super) struct FaceRow {
    uvs: Vec<f32>,
    texture: f64,
    color: [f32; 4],
    label: f64,
}

/// Values of all triangles. Each array is empty or, once finished, has an entry per triangle.
#[derive(Debug, Default)]
pub(super) struct FaceValues {
    roles: Vec<Role>,
    /// Distinct uses of the values in [`FaceRow`]; few, even with many properties.
    of_row: Vec<Role>,
    pub scalars: FaceScalars,
    has_scalars: bool,
    /// Texture coordinates of the three corners.
    pub uvs: Vec<[[f32; 2]; 3]>,
    /// Texture number; -1 for none.
    pub textures: Vec<i64>,
    /// RGBA, from 0 to 1.
    pub colors: Vec<[f32; 4]>,
    pub has_alpha: bool,
    /// Type of the property `red`.
    pub color_kind: Option<Scalar>,
    pub labels: Vec<i64>,
    /// Name and type of the property of `labels`.
    pub label_property: Option<(String, Scalar)>,
    /// Names of the properties that are not kept.
    pub skipped: Vec<String>,
    /// Faces whose list of texture coordinates does not match their vertices.
    pub bad_lists: usize,
    /// Texture coordinates, colours and scalars that are not finite, read as 0.
    pub not_finite: usize,
    /// Labels and scalars of 64-bit integers that may not be exact.
    pub rounded: usize,
}

impl FaceValues {
    /// Assigns a use to every property of an element but its vertex list, at index `list`.
    pub fn begin(&mut self, element: &Element, list: usize) {
        let properties = &element.properties;
        self.roles = vec![Role::Other; properties.len()];
        let is_uvs = |p: &Property| {
            matches!((&*p.name, p.shape), ("texcoord" | "texcoords", Shape::List { .. }))
        };
        if let Some(uvs) = properties.iter().position(is_uvs) {
            self.roles[uvs] = Role::Uvs;
        }
        if let Some(texture) = one(properties, "texnumber") {
            self.roles[texture] = Role::Texture;
        }
        for (i, at) in colors_of(properties).into_iter().enumerate() {
            let Some(at) = at else { continue };
            self.roles[at] = Role::Color(i, greatest(&properties[at]));
            self.has_alpha |= i == 3;
            if let (0, Shape::One(kind)) = (i, properties[at].shape) {
                self.color_kind = Some(kind);
            }
        }
        let label = properties.iter().position(|p| match p.shape {
            Shape::One(kind) => is_label(&p.name) && kind.whole_range().is_some(),
            Shape::List { .. } => false,
        });
        if let Some(at) = label
            && let Shape::One(kind) = properties[at].shape
        {
            self.roles[at] = Role::Label;
            self.label_property.get_or_insert((properties[at].name.clone(), kind));
        }
        let has_use = |role: &&Role| !matches!(role, Role::Other | Role::Color(1.., _));
        self.of_row = self.roles.iter().filter(has_use).copied().collect();
        self.begin_scalars(properties, list);
    }

    /// Makes columns of all scalars without a use; lists without a use are dropped.
    fn begin_scalars(&mut self, properties: &[Property], list: usize) {
        self.has_scalars = false;
        for (i, Property { name, shape }) in properties.iter().enumerate() {
            match *shape {
                _ if i == list || self.roles[i] != Role::Other => {}
                Shape::One(kind) => {
                    self.roles[i] = Role::Scalar(self.scalars.add_column(name, kind));
                    self.has_scalars = true;
                }
                Shape::List { .. } => self.skipped.push(name.clone()),
            }
        }
    }

    /// Reads the property at index `at` of a row.
    pub fn read<B: BodyReader>(
        &mut self,
        at: usize,
        into: &mut FaceRow,
        body: &mut B,
        row: Row,
    ) -> Result<(), ParseError> {
        let shape = row.element.properties[at].shape;
        match (self.roles[at], shape) {
            (Role::Uvs, Shape::List { length, item }) => {
                into.uvs.clear();
                for _ in 0..body.length(length, item, row)? {
                    into.uvs.push(self.finite(body.number(item, row)?));
                }
            }
            (Role::Texture, Shape::One(kind)) => into.texture = body.number(kind, row)?,
            (Role::Color(i, unit), Shape::One(kind)) => {
                into.color[i] = self.finite(body.number(kind, row)? / unit);
            }
            (Role::Label, Shape::One(kind)) => {
                into.label = body.number(kind, row)?;
                self.rounded += usize::from(kind.may_round(into.label));
            }
            (Role::Scalar(column), Shape::One(kind)) => {
                let value = body.number(kind, row)?;
                self.rounded += usize::from(kind.may_round(value));
                self.not_finite += usize::from(!value.is_finite());
                self.scalars.push(column, if value.is_finite() { value } else { 0.0 });
            }
            _ => body.skip_property(shape, row)?,
        }
        Ok(())
    }

    fn finite(&mut self, value: f64) -> f32 {
        let short = value as f32;
        if short.is_finite() {
            return short;
        }
        self.not_finite += 1;
        0.0
    }

    /// Counts a face of `corners` corners whose texture coordinates do not match them.
    pub fn check_row(&mut self, row: &mut FaceRow, corners: usize) {
        if self.of_row.contains(&Role::Uvs) && row.uvs.len() != 2 * corners {
            row.uvs.clear();
            self.bad_lists += 1;
        }
    }

    /// Appends the values of a triangle between these corners of the face; it is triangle `index`.
    pub fn push(&mut self, index: usize, row: &FaceRow, corners: [u32; 3]) {
        for role in &self.of_row {
            match role {
                Role::Uvs => {
                    self.uvs.resize(index, Default::default());
                    let uv = |corner: u32| {
                        let at = 2 * corner as usize;
                        row.uvs.get(at..at + 2).map_or([0.0; 2], |uv| [uv[0], uv[1]])
                    };
                    self.uvs.push(corners.map(uv));
                }
                Role::Texture => {
                    self.textures.resize(index, -1);
                    self.textures.push(row.texture as i64);
                }
                Role::Color(0, _) => {
                    self.colors.resize(index, [1.0; 4]);
                    let [r, g, b, a] = row.color;
                    self.colors.push([r, g, b, if self.has_alpha { a } else { 1.0 }]);
                }
                Role::Label => {
                    self.labels.resize(index, 0);
                    self.labels.push(row.label as i64);
                }
                Role::Color(..) | Role::Scalar(_) | Role::Other => {}
            }
        }
    }

    /// Ends the face of the triangles from `first` to `end`.
    pub fn end_row(&mut self, first: usize, end: usize) {
        if self.has_scalars {
            self.scalars.end_row(first, end);
        }
    }

    /// Fills in default values for the last triangles, whose element lacks these values.
    pub fn finish(&mut self, triangles: usize) {
        fn fill<T: Clone>(values: &mut Vec<T>, count: usize, value: T) {
            if !values.is_empty() {
                values.resize(count, value);
            }
        }
        fill(&mut self.uvs, triangles, Default::default());
        fill(&mut self.textures, triangles, -1);
        fill(&mut self.colors, triangles, [1.0; 4]);
        fill(&mut self.labels, triangles, 0);
    }
}

//! Layout of a PLY file to be written: values at vertices and values at faces.

use std::borrow::Cow;
use std::collections::BTreeSet;

use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh};

use super::extras::PlyExtras;
use super::face_values::is_label;
use super::scalar::Scalar;
use crate::notes::Note;
use crate::scene::material::{Material, Shading};
use crate::scene::{Image, Scene};
use crate::vertex_attributes::{distinct_wedges, has_seams};

/// Layout of a file. Faces hold values that would split vertices, where PLY allows it.
pub(super) struct Plan<'a> {
    pub mesh: Cow<'a, Mesh>,
    /// Names of the texture files, by texture number.
    pub textures: Vec<String>,
    /// Texture number of each face, -1 for none, unless all faces have texture 0 or none.
    pub texture_of_face: Option<Vec<i32>>,
    /// Index of the layer that is written as lists at faces, because of its seams.
    pub uvs: Option<usize>,
    /// Index of the colour layer that is written at faces, since each face has one colour.
    pub colors: Option<usize>,
    pub labels: Option<FaceLabels>,
}

/// Labels of faces as numbers.
pub(super) struct FaceLabels {
    pub property: String,
    pub kind: Scalar,
    /// Number of each object.
    pub numbers: Vec<i64>,
}

impl<'a> Plan<'a> {
    /// Lays out a mesh without materials; all wedges in use are written.
    pub fn of_mesh(mesh: &'a Mesh) -> Self {
        Self::new(Cow::Borrowed(mesh), Vec::new(), None, &PlyExtras::default())
    }

    /// Lays out the shown meshes of a scene; `images` are its images under the names to write.
    pub fn of_scene(scene: &'a Scene, images: &[Image]) -> Self {
        let mut textures = Vec::new();
        let mut names = Vec::new();
        let mut number = |image: usize| {
            let name = crate::obj::one_line(&images.get(image)?.name, str::trim);
            if name.is_empty() {
                return None;
            }
            let at = textures.iter().position(|&known| known == image).unwrap_or_else(|| {
                textures.push(image);
                names.push(name);
                textures.len() - 1
            });
            Some(at as i32)
        };
        let of_material = scene.materials.iter().map(|m| m.base_color_image.and_then(&mut number));
        let of_material: Vec<Option<i32>> = of_material.collect();
        let labels = if names.is_empty() { None } else { scene.shown_materials() };
        let texture = |&label: &u32| of_material.get(label as usize).copied().flatten();
        let of_face = labels.map(|labels| {
            labels.of_face.iter().map(|label| texture(label).unwrap_or(-1)).collect::<Vec<i32>>()
        });
        let of_face = of_face.filter(|of_face| of_face.iter().any(|&texture| texture != 0));
        Self::new(textured_mesh(scene), names, of_face, &scene.ply)
    }

    fn new(
        mesh: Cow<'a, Mesh>,
        textures: Vec<String>,
        texture_of_face: Option<Vec<i32>>,
        extras: &PlyExtras,
    ) -> Self {
        let (mut uvs, mut colors) = (None, None);
        if let Some(attributes) = &mesh.attributes {
            let find = |kind| attributes.layers.iter().position(|layer| layer.kind == kind);
            let at_faces = |&i: &usize| has_seams(&mesh, attributes, &attributes.layers[i]);
            uvs = find(LayerKind::Uv(0));
            uvs = uvs.filter(|uvs| texture_of_face.is_some() || at_faces(uvs));
            colors = find(LayerKind::Color(0)).filter(|&i| {
                is_color(&attributes.layers[i])
                    && is_flat(attributes, &attributes.layers[i])
                    && at_faces(&i)
            });
        }
        let labels = FaceLabels::of(&mesh, extras);
        Self { mesh, textures, texture_of_face, uvs, colors, labels }
    }

    /// Lists the layers whose values are written at vertices.
    pub fn vertex_layers(&self) -> Vec<&Layer> {
        let layers = self.mesh.attributes.as_ref().map_or(&[][..], |a| &a.layers).iter();
        let at_vertices = |&(i, _): &(usize, &Layer)| Some(i) != self.uvs && Some(i) != self.colors;
        layers.enumerate().filter(at_vertices).map(|(_, layer)| layer).collect()
    }

    /// Counts the vertices added by seams of vertex layers.
    fn split(&self) -> usize {
        let layers = self.vertex_layers();
        let (Some(attributes), false) = (&self.mesh.attributes, layers.is_empty()) else {
            return 0;
        };
        let first = distinct_wedges(&self.mesh, attributes, &layers);
        let mut used = vec![false; attributes.wedge_count];
        let corners = attributes.corners.as_flattened();
        corners.iter().for_each(|w| used[first[w.index()] as usize] = true);
        let rows = used.into_iter().filter(|&used| used).count();
        let vertices = self.mesh.used_vertices().into_iter().filter(|&used| used).count();
        rows.saturating_sub(vertices)
    }
}

/// Returns the shown mesh of a scene; the set of texture coordinates that its textures use is
/// swapped with the first one.
fn textured_mesh(scene: &Scene) -> Cow<'_, Mesh> {
    let mut mesh = scene.shown_mesh();
    let set = main_texture_set(scene);
    let find = |mesh: &Mesh, set: u8| {
        let layers = &mesh.attributes.as_ref()?.layers;
        layers.iter().position(|layer| layer.kind == LayerKind::Uv(set))
    };
    let (first, own) = (find(&mesh, 0), find(&mesh, set));
    if first != own
        && let Some(own) = own
        && let Some(attributes) = &mut mesh.to_mut().attributes
    {
        let layers = &mut attributes.layers;
        if let Some(first) = first {
            let name = layers[first].name.clone();
            layers[first].name = std::mem::replace(&mut layers[own].name, name);
            layers[first].kind = LayerKind::Uv(set);
        }
        layers[own].kind = LayerKind::Uv(0);
    }
    mesh
}

/// Returns the set of texture coordinates of the first texture, since PLY has a single set.
fn main_texture_set(scene: &Scene) -> u8 {
    textured_sets(scene).first().map_or(0, |&(_, set)| set)
}

/// Lists the shown materials with textures, and the set of texture coordinates of each.
fn textured_sets(scene: &Scene) -> Vec<(&Material, u8)> {
    let sets = scene.texture_sets();
    if sets.iter().all(|&set| set == 0) {
        return Vec::new();
    }
    let shown = scene.shown_materials().map(|labels| labels.of_face).unwrap_or_default();
    let shown: BTreeSet<u32> = shown.into_iter().collect();
    let shown = shown.into_iter().map(|label| label as usize);
    let textured = shown.filter_map(|label| Some((scene.materials.get(label)?, *sets.get(label)?)));
    textured.filter(|(material, _)| material.base_color_image.is_some()).collect()
}

impl FaceLabels {
    /// Returns the labels if all objects are named as by the reader: `label 3`.
    fn of(mesh: &Mesh, extras: &PlyExtras) -> Option<Self> {
        let objects = mesh.objects.as_ref()?;
        let (property, _) = objects.names.first()?.split_once(' ')?;
        let number = |name: &String| {
            let number = name.strip_prefix(property)?.strip_prefix(' ')?;
            number.parse::<i64>().ok()
        };
        let numbers: Vec<i64> = objects.names.iter().map(number).collect::<Option<_>>()?;
        let fits = |kind: &Scalar| {
            kind.whole_range().is_some_and(|(least, most)| {
                numbers.iter().all(|&number| (least..=most).contains(&number.into()))
            })
        };
        let known = extras.kind(&format!("face {property}"), Scalar::I32);
        let kind = [known, Scalar::I32, Scalar::U32].into_iter().find(fits)?;
        is_label(property).then(|| Self { property: property.to_owned(), kind, numbers })
    }
}

/// Reports whether a layer of colours has names in PLY.
pub(super) fn is_color(layer: &Layer) -> bool {
    matches!((layer.kind, layer.width), (LayerKind::Color(_), 3 | 4))
}

/// Reports whether a layer has one value in each face.
fn is_flat(attributes: &Attributes, layer: &Layer) -> bool {
    attributes
        .corners
        .iter()
        .all(|&[a, b, c]| layer.of(a) == layer.of(b) && layer.of(b) == layer.of(c))
}

/// Lists the parts and layers of a scene that a PLY file lacks.
pub(crate) fn limits(scene: &Scene) -> Vec<Note> {
    let plan = Plan::of_scene(scene, &scene.images);
    let shown = scene.shown_materials().map(|labels| labels.of_face).unwrap_or_default();
    let shown: BTreeSet<u32> = shown.into_iter().collect();
    let shown = shown.iter().filter_map(|&label| scene.materials.get(label as usize));
    let (with, without): (Vec<_>, Vec<_>) = shown.partition(|material| {
        let image = material.base_color_image.and_then(|image| scene.images.get(image));
        image.is_some_and(|image| !image.name.trim().is_empty())
    });
    let colored: Vec<_> = with.iter().filter(|m| m.base_color != [1.0; 4]).collect();
    let richer: Vec<_> = with.iter().filter(|m| m.shading != Shading::default()).collect();
    let main = main_texture_set(scene);
    let other = textured_sets(scene).into_iter().filter(|&(_, set)| set != main);
    let other: Vec<_> = other.map(|(material, _)| material).collect();
    let objects = if plan.labels.is_some() { Vec::new() } else { scene.object_names() };
    let split = if scene.had_split_seams() { 0 } else { plan.split() };
    vec![
        Note::left_out(without.len(), "material", "materials")
            .named(without.iter().map(|m| &*m.name).filter(|name| !name.is_empty())),
        Note::left_out(
            colored.len(),
            "colour of a textured material",
            "colours of textured materials",
        )
        .named(colored.iter().map(|m| &*m.name).filter(|name| !name.is_empty())),
        Note::left_out(
            richer.len(),
            "material's properties beside its texture",
            "materials' properties beside their textures",
        )
        .named(richer.iter().map(|m| &*m.name).filter(|name| !name.is_empty())),
        Note::left_out(
            other.len(),
            "material with texture coordinates of its own",
            "materials with texture coordinates of their own",
        )
        .named(other.iter().map(|m| &*m.name).filter(|name| !name.is_empty())),
        Note::left_out(objects.len(), "name of an object", "names of objects").named(objects),
        Note::changed(
            split,
            "vertex split at seams of its attributes",
            "vertices split at seams of their attributes",
        ),
    ]
}

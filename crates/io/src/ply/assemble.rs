//! Assembling a scene from the vertices and faces of a PLY file.

use std::collections::{BTreeMap, BTreeSet};

use meshlod_mesh::{
    Attributes, Buckets, FaceLayer, Labels, Layer, LayerKind, Mesh, VertexId, WedgeId,
};

use super::extras::PlyExtras;
use super::face_values::FaceValues;
use super::header::{Element, Header};
use super::scalar::Scalar;
use super::vertices::Vertices;
use crate::notes::Note;
use crate::options::Resolve;
use crate::scene::image_file::is_image;
use crate::scene::material::Material;
use crate::scene::{Image, Node, Scene, SceneMesh};
use crate::vertex_attributes::{named_layer, per_vertex};

/// Contents of the body of a file.
pub(super) struct Body {
    pub vertices: Vertices,
    pub faces: Vec<[VertexId; 3]>,
    pub values: FaceValues,
    /// Faces of fewer than three corners, which were dropped.
    pub thin_faces: usize,
    /// Bytes after the last row of the last element.
    pub bytes_left: usize,
}

/// Largest number of distinct face colours that are kept as seams. If all faces differ, as in a
/// scan, seams would leave nothing to simplify.
const MOST_FACE_COLORS: usize = 256;

/// Builds the scene: one mesh under one node, and a material for each texture.
pub(super) fn scene(header: Header, body: Body, resolve: Resolve<'_>) -> Scene {
    let mut notes = notes(&header, &body);
    let Body { vertices, faces, mut values, .. } = body;
    let mut types: BTreeMap<String, Scalar> = vertices.types.into_iter().collect();
    if let Some(kind) = values.color_kind.filter(|&kind| kind != Scalar::U8) {
        types.extend(["red", "green", "blue", "alpha"].map(|c| (format!("face {c}"), kind)));
    }
    let face_layers = face_layers(&mut values, faces.len(), &mut types, &mut notes);
    let objects = objects(&mut values, &mut types);
    let has_split_seams = values.uvs.is_empty() && values.colors.is_empty();
    let (materials, images) = materials(&header.textures, resolve);
    let (labels, of_label) = textures(&values, &materials, &mut notes);
    let (positions, layers) = (vertices.positions, vertices.layers);
    let attributes = attributes(positions.len(), &faces, layers, values, &mut notes);
    let bare = Mesh::new(positions, faces);
    let mesh = Mesh { attributes, materials: labels, objects, face_layers, ..bare };
    Scene {
        meshes: vec![SceneMesh { name: String::new(), mesh, materials: of_label }],
        nodes: vec![Node { mesh: Some(0), ..Node::default() }],
        roots: vec![0],
        materials,
        images,
        ply: PlyExtras { remarks: header.remarks, types },
        has_split_seams,
        notes,
        ..Scene::default()
    }
}

/// Notes the parts of the file that the scene lacks.
fn notes(header: &Header, body: &Body) -> Vec<Note> {
    let Body { vertices, values, .. } = body;
    let skipped = |e: &&Element| e.name != "vertex" && !e.holds_faces() && e.count > 0;
    let skipped = || header.elements.iter().filter(skipped);
    let rows = skipped().map(|element| usize::try_from(element.count).unwrap_or(usize::MAX));
    let unknown = header.unknown.len();
    let properties: Vec<&String> = vertices.lists.iter().chain(&values.skipped).collect();
    let rows = rows.fold(0, usize::saturating_add);
    let mut notes = vec![
        Note::left_out(unknown, "unknown line of the header", "unknown lines of the header")
            .named(&header.unknown),
        Note::left_out(rows, "row of an unknown element", "rows of unknown elements")
            .named(skipped().map(|element| super::header::shown(&element.name))),
        Note::left_out(
            properties.len(),
            "list of vertices or faces",
            "lists of vertices and faces",
        )
        .named(properties.iter().map(|name| super::header::shown(name))),
        Note::left_out(
            values.bad_lists,
            "list of texture coordinates that does not match its face",
            "lists of texture coordinates that do not match their faces",
        )
        .remedied("a list needs two numbers for each corner of its face"),
        Note::thin_faces(body.thin_faces),
        Note::left_out(body.bytes_left, "byte behind the last row", "bytes behind the last row")
            .remedied("if they are rows, correct the counts in the header"),
        Note::changed(
            values.not_finite,
            "value of a face that is not finite read as 0",
            "values of faces that are not finite read as 0",
        ),
        Note::not_finite(vertices.not_finite),
        Note::changed(vertices.rounded, "value rounded to 32 bits", "values rounded to 32 bits"),
        Note::changed(
            values.rounded,
            "64-bit integer rounded to 53 bits",
            "64-bit integers rounded to 53 bits",
        ),
    ];
    notes.retain(|note| note.count > 0);
    notes
}

/// Converts the scalars of faces to layers of the triangles.
fn face_layers(
    values: &mut FaceValues,
    triangles: usize,
    types: &mut BTreeMap<String, Scalar>,
    notes: &mut Vec<Note>,
) -> Vec<FaceLayer> {
    let scalars = std::mem::take(&mut values.scalars);
    let own: Vec<(String, Scalar)> =
        scalars.types().iter().map(|(name, &kind)| ((*name).to_owned(), kind)).collect();
    let Some(layers) = scalars.into_layers(triangles) else {
        let (one, many) = (
            "property of faces whose polygons have too many corners",
            "properties of faces whose polygons have too many corners",
        );
        let names = own.iter().map(|(name, _)| super::header::shown(name));
        let note = Note::left_out(own.len(), one, many).named(names);
        notes.push(note.remedied("divide the polygons into triangles"));
        return Vec::new();
    };
    types.extend(own.into_iter().map(|(name, kind)| (format!("face {name}"), kind)));
    layers
}

/// Converts the labels of faces to objects, named as in `label 3`.
fn objects(values: &mut FaceValues, types: &mut BTreeMap<String, Scalar>) -> Option<Labels> {
    let (name, kind) = values.label_property.take()?;
    if values.labels.is_empty() {
        return None;
    }
    let distinct: BTreeSet<i64> = values.labels.iter().copied().collect();
    let number: BTreeMap<i64, u32> = distinct.iter().copied().zip(0..).collect();
    let names = distinct.iter().map(|label| format!("{name} {label}")).collect();
    let of_face = values.labels.iter().map(|label| number[label]).collect();
    types.insert(format!("face {name}"), kind);
    Some(Labels { names, of_face })
}

/// Converts the texture numbers of faces to material labels; returns the material of each label.
fn textures(
    values: &FaceValues,
    materials: &[Material],
    notes: &mut Vec<Note>,
) -> (Option<Labels>, Vec<Option<usize>>) {
    let count = materials.len();
    if values.textures.is_empty() {
        return (None, vec![(count > 0).then_some(0)]);
    }
    let number = |texture: i64| usize::try_from(texture).ok().filter(|&number| number < count);
    let unknown = values.textures.iter().filter(|&&t| t >= 0 && number(t).is_none()).count();
    // Many programs write the number 0 where there is no texture at all.
    if unknown > 0 && (count > 0 || values.textures.iter().any(|&texture| texture > 0)) {
        let (one, many) =
            ("face whose texture has no TextureFile", "faces whose textures have no TextureFile");
        let note = Note::left_out(unknown, one, many);
        notes
            .push(note.remedied("add a line `comment TextureFile` to the header for each texture"));
    }
    let has_none = values.textures.iter().any(|&texture| number(texture).is_none());
    if count == 0 || (count == 1 && !has_none) {
        return (None, vec![(count > 0).then_some(0)]);
    }
    let of_face: Vec<u32> =
        values.textures.iter().map(|&texture| number(texture).unwrap_or(count) as u32).collect();
    let labels = count + usize::from(has_none);
    let names = materials.iter().map(|m| m.name.clone()).chain(has_none.then(String::new));
    let of_label = (0..labels).map(|label| (label < count).then_some(label)).collect();
    (Some(Labels { names: names.collect(), of_face }), of_label)
}

/// Makes a material for each texture file, named without its suffix, and loads each image once.
fn materials(textures: &[String], resolve: Resolve<'_>) -> (Vec<Material>, Vec<Image>) {
    let mut images: Vec<Image> = Vec::new();
    let mut image_of: BTreeMap<String, usize> = BTreeMap::new();
    let material = |file: &String| {
        let name = file.replace('\\', "/");
        let image = *image_of.entry(name).or_insert_with_key(|name| {
            // As with glTF, a file from elsewhere must not make the writer copy arbitrary files.
            let bytes = resolve(file).filter(|bytes| is_image(name, bytes)).unwrap_or_default();
            images.push(Image { name: name.clone(), bytes });
            images.len() - 1
        });
        let plain = images[image].name.rsplit('/').next().unwrap_or_default();
        let stem = plain.rsplit_once('.').map_or(plain, |(stem, _)| stem);
        let (name, base_color_image) = (stem.to_owned(), Some(image));
        Material { name, base_color_image, ..Material::default() }
    };
    let materials = textures.iter().map(material).collect();
    (materials, images)
}

/// Builds the attributes: a wedge per vertex, or per vertex and distinct face values.
fn attributes(
    vertices: usize,
    faces: &[[VertexId; 3]],
    mut layers: Vec<Layer>,
    mut values: FaceValues,
    notes: &mut Vec<Note>,
) -> Option<Attributes> {
    let colors = std::mem::take(&mut values.colors);
    let width = if values.has_alpha { 4 } else { 3 };
    let mut face_colors = None;
    if !colors.is_empty() {
        if layers.iter().any(|layer| layer.kind == LayerKind::Color(0)) {
            let (one, many) = (
                "colour of a face, as vertices have colours",
                "colours of faces, as vertices have colours",
            );
            let note = Note::left_out(colors.len(), one, many);
            notes.push(note.remedied("remove the colours of the vertices to keep them"));
        } else if has_few(&colors) {
            face_colors = Some(colors);
        } else {
            let (one, many) =
                ("colour of a face averaged at vertices", "colours of faces averaged at vertices");
            notes.push(Note::changed(colors.len(), one, many));
            layers.push(averaged(vertices, faces, &colors, width));
        }
    }
    let uvs = std::mem::take(&mut values.uvs);
    if uvs.is_empty() && face_colors.is_none() {
        return per_vertex(vertices, faces, layers);
    }
    if !uvs.is_empty() {
        make_room_for_uvs(&mut layers);
    }
    let key = |corner: usize| {
        let [u, v] = uvs.get(corner / 3).map_or([0.0; 2], |uvs| uvs[corner % 3]);
        let [r, g, b, a] = face_colors.as_ref().map_or([0.0; 4], |colors| colors[corner / 3]);
        [u, v, r, g, b, a].map(f32::to_bits)
    };
    let (corners, sources) = wedges(vertices, faces, key);
    for layer in &mut layers {
        let own = std::mem::take(&mut layer.values);
        let of = |&(vertex, _): &(usize, u32)| &own[vertex * layer.width..][..layer.width];
        layer.values = sources.iter().flat_map(of).copied().collect();
    }
    let keys = || sources.iter().map(|&(_, corner)| key(corner as usize).map(f32::from_bits));
    if !uvs.is_empty() {
        layers.push(named_layer(LayerKind::Uv(0), 2, keys().flat_map(|k| [k[0], k[1]]).collect()));
    }
    if face_colors.is_some() {
        let values = keys().flat_map(|key| key.into_iter().skip(2).take(width)).collect();
        layers.push(named_layer(LayerKind::Color(0), width, values));
    }
    Some(Attributes { corners, wedge_count: sources.len(), layers })
}

fn has_few(colors: &[[f32; 4]]) -> bool {
    let mut distinct = BTreeSet::new();
    colors.iter().all(|color| {
        distinct.insert(color.map(f32::to_bits));
        distinct.len() <= MOST_FACE_COLORS
    })
}

/// Averages the colours of the faces around each vertex; white without faces.
fn averaged(vertices: usize, faces: &[[VertexId; 3]], colors: &[[f32; 4]], width: usize) -> Layer {
    let mut sums = vec![([0.0f64; 4], 0u32); vertices];
    for (face, color) in faces.iter().zip(colors) {
        for v in face {
            let (sum, count) = &mut sums[v.index()];
            (0..4).for_each(|i| sum[i] += f64::from(color[i]));
            *count += 1;
        }
    }
    let mean = |(sum, count): ([f64; 4], u32)| match count {
        0 => [1.0; 4],
        _ => sum.map(|x| (x / f64::from(count)) as f32),
    };
    let values = sums.into_iter().flat_map(|sum| mean(sum).into_iter().take(width)).collect();
    named_layer(LayerKind::Color(0), width, values)
}

/// Renumbers the texture coordinates of vertices, since those of faces are the first set.
fn make_room_for_uvs(layers: &mut [Layer]) {
    let sets: BTreeSet<u8> = layers
        .iter()
        .filter_map(|layer| match layer.kind {
            LayerKind::Uv(set) => Some(set),
            _ => None,
        })
        .collect();
    let free = (1..=u8::MAX).find(|set| !sets.contains(set));
    if let Some(layer) = layers.iter_mut().find(|layer| layer.kind == LayerKind::Uv(0)) {
        layer.kind = free.map_or(LayerKind::Other, LayerKind::Uv);
    }
}

/// Assigns one wedge to the corners of a vertex with equal keys. Returns the wedge of each corner,
/// and the vertex and one corner of each wedge.
fn wedges<K: Ord>(
    vertices: usize,
    faces: &[[VertexId; 3]],
    key: impl Fn(usize) -> K,
) -> (Vec<[WedgeId; 3]>, Vec<(usize, u32)>) {
    let around = Buckets::new(vertices, faces.as_flattened().iter().map(|v| v.index()));
    let mut corners = vec![[WedgeId::default(); 3]; faces.len()];
    let of_corner = corners.as_flattened_mut();
    let mut sources = Vec::with_capacity(vertices);
    let mut keyed: Vec<(K, u32)> = Vec::new();
    for vertex in 0..vertices {
        keyed.clear();
        keyed.extend(around.of(vertex).iter().map(|&corner| (key(corner as usize), corner)));
        keyed.sort_unstable();
        for same in keyed.chunk_by(|(a, _), (b, _)| a == b) {
            same.iter().for_each(|&(_, corner)| {
                of_corner[corner as usize] = WedgeId::new(sources.len());
            });
            sources.push((vertex, same[0].1));
        }
    }
    (corners, sources)
}

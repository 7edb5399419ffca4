//! Reading a glTF mesh: its primitives merged into one surface.

use meshlod_mesh::{Attributes, Labels, Layer, LayerKind, Mesh, VertexId, WedgeId, weld};
use rustc_hash::FxHashMap;

use crate::error::ParseError;
use crate::gltf::document::Document;
use crate::gltf::document::accessor::Values;
use crate::gltf::document::schema::Primitive;
use crate::options::Weld;
use crate::vertex_attributes::pad;

/// Reads mesh `index` with all its triangle primitives; the material label of a face is the number
/// of its primitive. Points and lines get a label but no faces.
///
/// Primitives with the same POSITION accessor share their vertices; primitives with the same
/// accessors share their wedges. Attributes that are not finite are replaced, and counted.
pub(crate) fn read(
    document: &Document<'_>,
    index: usize,
    how: Weld,
) -> Result<(Mesh, Replaced), ParseError> {
    let mut builder = Builder::default();
    for (p, primitive) in document.meshes[index].primitives.iter().enumerate() {
        builder.labels.names.push(format!("primitive {p}"));
        if primitive.has_faces() {
            builder.add(document, primitive, &format!("mesh {index}, primitive {p}"))?;
        }
    }
    let replaced = builder.replaced;
    let mut mesh = builder.finish(document, &format!("mesh {index}"))?;
    match how {
        Weld::Off => 0,
        Weld::Exact => weld(&mut mesh, 0.0),
        Weld::Within(epsilon) => weld(&mut mesh, epsilon),
    };
    Ok((mesh, replaced))
}

/// Returns the layer kind of an attribute.
pub(crate) fn kind(name: &str) -> LayerKind {
    let numbered = |prefix| name.strip_prefix(prefix).and_then(|set| set.parse::<u8>().ok());
    match name {
        "NORMAL" => LayerKind::Normal,
        "TANGENT" => LayerKind::Tangent,
        // Features of 3D Tiles and of `EXT_mesh_features`.
        "_BATCHID" => LayerKind::Label,
        name if name.starts_with("_FEATURE_ID_") => LayerKind::Label,
        _ => numbered("TEXCOORD_")
            .map(LayerKind::Uv)
            .or_else(|| numbered("COLOR_").map(LayerKind::Color))
            .or_else(|| numbered("JOINTS_").map(LayerKind::Joints))
            .or_else(|| numbered("WEIGHTS_").map(LayerKind::Weights))
            .unwrap_or(LayerKind::Other),
    }
}

/// Flips texture coordinates between an origin at the upper left and one at the lower left.
///
/// In 32 bits, `1 - v` rounds small v by up to 2^-25. After the first flip, two more restore the
/// value bit for bit, so writing a level and reading it again changes nothing.
pub(crate) fn flip_v(uvs: &mut [f32]) {
    for uv in uvs.as_chunks_mut::<2>().0 {
        uv[1] = 1.0 - uv[1];
    }
}

/// Mesh under construction, one primitive at a time.
#[derive(Default)]
struct Builder {
    mesh: Mesh,
    labels: Labels,
    corners: Vec<[WedgeId; 3]>,
    wedge_count: usize,
    layers: Vec<Layer>,
    layer_by_name: FxHashMap<String, usize>,
    /// POSITION accessor → its first vertex.
    vertex_pools: FxHashMap<usize, usize>,
    /// All accessors of a primitive → its first wedge.
    wedge_pools: FxHashMap<Vec<(String, usize)>, usize>,
    replaced: Replaced,
}

/// Number of replaced attributes that were not finite.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Replaced {
    /// Normals, which become zero and are later computed from the faces.
    pub normals: usize,
    /// Components of other attributes, which become 0.
    pub values: usize,
}

impl Replaced {
    pub fn is_empty(self) -> bool {
        self.normals == 0 && self.values == 0
    }

    pub fn add(&mut self, other: Self) {
        self.normals += other.normals;
        self.values += other.values;
    }
}

/// Replaces and counts values that are not finite.
pub(crate) fn make_finite(kind: LayerKind, of: &mut Values) -> Replaced {
    let mut replaced = Replaced::default();
    for element in of.values.chunks_exact_mut(of.width) {
        let odd = element.iter().filter(|x| !x.is_finite()).count();
        if odd == 0 {
            continue;
        }
        if kind == LayerKind::Normal {
            element.fill(0.0);
            replaced.normals += 1;
        } else {
            element.iter_mut().filter(|x| !x.is_finite()).for_each(|x| *x = 0.0);
            replaced.values += odd;
        }
    }
    replaced
}

impl Builder {
    fn add(
        &mut self,
        document: &Document<'_>,
        primitive: &Primitive,
        part: &str,
    ) -> Result<(), ParseError> {
        let accessors = primitive.accessors().map_err(|reason| ParseError::part(part, reason))?;
        let Some(&(_, positions)) = accessors.iter().find(|(name, _)| name == "POSITION") else {
            return Err(ParseError::part(part, "has no POSITION attribute"));
        };
        let first_vertex = match self.vertex_pools.get(&positions) {
            Some(&first) => first,
            None => self.add_vertices(document, positions)?,
        };
        let count = document.accessors[positions].count;
        let first_wedge = match self.wedge_pools.get(&accessors) {
            Some(&first) => first,
            None => self.add_wedges(document, accessors, count, part)?,
        };
        let indices = match primitive.indices {
            Some(indices) => document.indices(indices, count)?,
            None => (0..count as u32).collect(),
        };
        document.spend(part, indices.len() * 3)?;
        let label = self.labels.names.len() as u32 - 1;
        for face in triangles(primitive.mode, &indices) {
            let at = |first: usize| face.map(|i| first as u32 + i);
            self.mesh.faces.push(at(first_vertex).map(VertexId));
            self.corners.push(at(first_wedge).map(WedgeId));
            self.labels.of_face.push(label);
        }
        Ok(())
    }

    fn add_vertices(
        &mut self,
        document: &Document<'_>,
        accessor: usize,
    ) -> Result<usize, ParseError> {
        let Values { width, values } = document.floats(accessor)?;
        if width != 3 {
            return Err(ParseError::part(format!("accessor {accessor}"), "POSITION must be VEC3"));
        }
        let first = self.mesh.positions.len();
        let points = values.as_chunks::<3>().0;
        self.mesh.positions.extend(points.iter().map(|point| point.map(f64::from)));
        ids_fit(accessor, self.mesh.positions.len())?;
        self.vertex_pools.insert(accessor, first);
        Ok(first)
    }

    fn add_wedges(
        &mut self,
        document: &Document<'_>,
        accessors: Vec<(String, usize)>,
        count: usize,
        part: &str,
    ) -> Result<usize, ParseError> {
        let first = self.wedge_count;
        for (name, accessor) in accessors.iter().filter(|(name, _)| name != "POSITION") {
            let values = document.stored_floats(*accessor)?;
            if values.count() != count {
                let found = values.count();
                let reason = format!("{name} has {found} elements, but POSITION has {count}");
                return Err(ParseError::part(part, reason));
            }
            self.add_values(name, values, first)
                .map_err(|reason| ParseError::part(part, reason))?;
        }
        self.wedge_count += count;
        ids_fit(accessors[0].1, self.wedge_count)?;
        self.wedge_pools.insert(accessors, first);
        Ok(first)
    }

    /// Appends values to the layer of that name; earlier wedges without values are filled by
    /// [`pad`].
    fn add_values(&mut self, name: &str, mut new: Values, first: usize) -> Result<(), String> {
        let kind = kind(name);
        if !fits(kind, new.width) {
            return Err(format!("{name} cannot have {} components", new.width));
        }
        self.replaced.add(make_finite(kind, &mut new));
        if matches!(kind, LayerKind::Uv(_)) {
            flip_v(&mut new.values);
        }
        let Some(&known) = self.layer_by_name.get(name) else {
            let (name, width) = (name.to_owned(), new.width);
            self.layer_by_name.insert(name.clone(), self.layers.len());
            let mut layer = Layer { kind, name, width, values: Vec::new() };
            pad(&mut layer, first);
            layer.values.append(&mut new.values);
            self.layers.push(layer);
            return Ok(());
        };
        let layer = &mut self.layers[known];
        if matches!(kind, LayerKind::Color(_)) && new.width != layer.width {
            add_alpha(&mut new.width, &mut new.values);
            add_alpha(&mut layer.width, &mut layer.values);
        }
        if new.width != layer.width {
            let (known, width) = (layer.width, new.width);
            return Err(format!(
                "{name} has {width} components, but {known} in an earlier primitive"
            ));
        }
        pad(layer, first);
        layer.values.append(&mut new.values);
        Ok(())
    }

    fn finish(mut self, document: &Document<'_>, part: &str) -> Result<Mesh, ParseError> {
        let width: usize = self.layers.iter().map(|layer| layer.width).sum();
        document.spend(part, width.saturating_mul(self.wedge_count))?;
        for layer in &mut self.layers {
            pad(layer, self.wedge_count);
        }
        if !self.layers.is_empty() {
            let Self { corners, wedge_count, layers, .. } = self;
            self.mesh.attributes = Some(Attributes { corners, wedge_count, layers });
        }
        self.mesh.materials = Some(self.labels);
        Ok(self.mesh)
    }
}

fn ids_fit(accessor: usize, count: usize) -> Result<(), ParseError> {
    if u32::try_from(count).is_ok() {
        return Ok(());
    }
    let reason = "exceeds the limit of 2^32 vertices in a mesh";
    Err(ParseError::part(format!("accessor {accessor}"), reason))
}

pub(crate) fn fits(kind: LayerKind, width: usize) -> bool {
    match kind {
        LayerKind::Normal => width == 3,
        LayerKind::Uv(_) => width == 2,
        LayerKind::Color(_) => matches!(width, 3 | 4),
        LayerKind::Tangent | LayerKind::Joints(_) | LayerKind::Weights(_) => width == 4,
        LayerKind::Other | LayerKind::Label => true,
    }
}

/// Turns RGB colours into opaque RGBA.
fn add_alpha(width: &mut usize, values: &mut Vec<f32>) {
    if *width == 3 {
        let opaque = |&[r, g, b]: &[f32; 3]| [r, g, b, 1.0];
        *values = values.as_chunks().0.iter().flat_map(opaque).collect();
        *width = 4;
    }
}

/// Lists the triangles of an index list, strip or fan. Degenerate triangles, which strips and fans
/// use as joints, are dropped.
pub(crate) fn triangles(mode: u32, indices: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    let list = (mode == 4).then(|| indices.as_chunks::<3>().0.iter().copied());
    let windows = if mode == 4 { &[][..] } else { indices };
    let turning = windows.windows(3).enumerate().filter_map(move |(i, next)| {
        let &[a, b, c] = next else { return None };
        let face = match mode {
            5 if i % 2 == 1 => [b, a, c],
            5 => [a, b, c],
            _ => [windows[0], b, c],
        };
        (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]).then_some(face)
    });
    list.into_iter().flatten().chain(turning)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_finite_is_replaced_and_counted() {
        let (nan, inf) = (f32::NAN, f32::INFINITY);
        let mut normals = Values { width: 3, values: vec![0.0, nan, 1.0, 1.0, 0.0, 0.0] };
        let replaced = make_finite(LayerKind::Normal, &mut normals);
        assert_eq!((replaced.normals, replaced.values), (1, 0));
        assert_eq!(normals.values, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
        let mut uvs = Values { width: 2, values: vec![nan, inf, 0.5, -inf] };
        let replaced = make_finite(LayerKind::Uv(0), &mut uvs);
        assert_eq!((replaced.normals, replaced.values), (0, 3));
        assert_eq!(uvs.values, [0.0, 0.0, 0.5, 0.0]);
    }

    #[test]
    fn lists_strips_and_fans_give_their_triangles() {
        let of = |mode, indices: &[u32]| triangles(mode, indices).collect::<Vec<_>>();
        assert_eq!(of(4, &[0, 1, 2, 2, 2, 3, 9]), [[0, 1, 2], [2, 2, 3]]);
        assert_eq!(of(5, &[0, 1, 2, 3, 4]), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
        assert_eq!(of(5, &[0, 1, 2, 2, 5, 5, 6, 7]), [[0, 1, 2], [6, 5, 7]]);
        assert_eq!(of(6, &[0, 1, 2, 3]), [[0, 1, 2], [0, 2, 3]]);
        for mode in 4..=6 {
            assert!(of(mode, &[0, 1]).is_empty());
        }
    }

    #[test]
    fn texture_coordinates_turn_to_a_fixed_point() {
        for v in [0.1, 1e-9, 0.3, 0.7, 1.0, -3.3, 5.3, 0.0] {
            let mut once = [0.0, v];
            flip_v(&mut once);
            let mut thrice = once;
            flip_v(&mut thrice);
            flip_v(&mut thrice);
            assert_eq!(once[1].to_bits(), thrice[1].to_bits(), "{v}");
        }
    }
}

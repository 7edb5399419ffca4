//! Building wedges from the corners of an OBJ file.

use std::num::NonZeroU32;

use meshlod_mesh::{Attributes, Buckets, Layer, LayerKind, VertexId, WedgeId};

use crate::vertex_attributes::{named_layer, normalize_colors, per_vertex};

/// Attribute ids of a corner, counted from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CornerIds {
    pub(super) uv: Option<NonZeroU32>,
    pub(super) normal: Option<NonZeroU32>,
}

/// Values that corners refer to by id, and vertex colours.
#[derive(Default)]
pub(super) struct Pools {
    pub(super) uvs: Vec<[f32; 2]>,
    pub(super) normals: Vec<[f32; 3]>,
    /// Colours of the vertices up to the last coloured one; may be empty.
    pub(super) colors: Vec<[f32; 3]>,
}

impl Pools {
    /// Sets the colour of the last of `vertices`; earlier ones without a colour are white.
    pub(super) fn add_color(&mut self, vertices: usize, color: [f32; 3]) {
        self.colors.resize(vertices - 1, WHITE);
        self.colors.push(color);
    }

    /// Gives vertices the colours from comments, unless the file has vertex colours; vertices
    /// without one are white. Returns the number of unused colours.
    pub(super) fn add_paint(&mut self, mut paint: Vec<[f32; 3]>, vertices: usize) -> usize {
        if !self.colors.is_empty() {
            return paint.len();
        }
        let unused = paint.len().saturating_sub(vertices);
        paint.truncate(vertices);
        self.colors = paint;
        unused
    }

    fn uv(&self, ids: CornerIds) -> [f32; 2] {
        ids.uv.map_or([0.0; 2], |id| self.uvs[id.get() as usize - 1])
    }

    fn normal(&self, ids: CornerIds) -> [f32; 3] {
        ids.normal.map_or([0.0; 3], |id| self.normals[id.get() as usize - 1])
    }

    /// Returns the values of a corner as bits; corners of a vertex with equal keys share a wedge.
    fn key(&self, ids: CornerIds) -> [u32; 5] {
        let ([u, v], [x, y, z]) = (self.uv(ids), self.normal(ids));
        [u, v, x, y, z].map(f32::to_bits)
    }
}

const WHITE: [f32; 3] = [1.0; 3];

/// Builds the attributes of a mesh: one wedge per vertex and distinct uv and normal, compared by
/// *value*, so that exporters which repeat the values at each corner cause no seams.
///
/// `corners` is empty or has an entry per face; its ids must exist in the pools. Wedges are
/// numbered by vertex. Returns `None` if no corner and no vertex has attributes.
pub(super) fn attributes(
    vertices: usize,
    faces: &[[VertexId; 3]],
    corners: &[[CornerIds; 3]],
    mut pools: Pools,
) -> Option<Attributes> {
    normalize_colors(pools.colors.as_flattened_mut());
    if !pools.colors.is_empty() {
        pools.colors.resize(vertices, WHITE);
    }
    if corners.is_empty() {
        let colors = Some(pools.colors.into_flattened()).filter(|colors| !colors.is_empty());
        let layers = colors.map(|values| named_layer(LayerKind::Color(0), 3, values));
        return per_vertex(vertices, faces, layers.into_iter().collect());
    }
    let ids = corners.as_flattened();
    let mut numbers = vec![[WedgeId::default(); 3]; faces.len()];
    let shown = number(vertices, faces, ids, &pools, numbers.as_flattened_mut());
    let layers = layers(&shown, ids, &pools);
    Some(Attributes { corners: numbers, wedge_count: shown.len(), layers })
}

/// Wedge under construction: its vertex and a corner with its values.
struct WedgeSource {
    vertex: usize,
    corner: u32,
}

/// Numbers the wedges vertex by vertex, storing the wedge of each corner in `numbers`.
fn number(
    vertices: usize,
    faces: &[[VertexId; 3]],
    ids: &[CornerIds],
    pools: &Pools,
    numbers: &mut [WedgeId],
) -> Vec<WedgeSource> {
    let corners = Buckets::new(vertices, faces.as_flattened().iter().map(|v| v.index()));
    let mut shown: Vec<WedgeSource> = Vec::with_capacity(vertices);
    let mut keyed: Vec<([u32; 5], u32)> = Vec::new();
    for vertex in 0..vertices {
        let around = corners.of(vertex);
        let Some((&corner, others)) = around.split_first() else { continue };
        if others.iter().all(|&other| ids[other as usize] == ids[corner as usize]) {
            for &corner in around {
                numbers[corner as usize] = WedgeId::new(shown.len());
            }
            shown.push(WedgeSource { vertex, corner });
            continue;
        }
        // Sorted instead of compared pairwise, as one vertex may have a million corners.
        keyed.clear();
        keyed.extend(around.iter().map(|&corner| (pools.key(ids[corner as usize]), corner)));
        keyed.sort_unstable();
        for same in keyed.chunk_by(|(a, _), (b, _)| a == b) {
            for &(_, corner) in same {
                numbers[corner as usize] = WedgeId::new(shown.len());
            }
            shown.push(WedgeSource { vertex, corner: same[0].1 });
        }
    }
    shown
}

fn layers(shown: &[WedgeSource], ids: &[CornerIds], pools: &Pools) -> Vec<Layer> {
    let of = |shown: &WedgeSource| ids[shown.corner as usize];
    let mut layers = Vec::new();
    if ids.iter().any(|ids| ids.uv.is_some()) {
        let values = shown.iter().flat_map(|shown| pools.uv(of(shown))).collect();
        layers.push(named_layer(LayerKind::Uv(0), 2, values));
    }
    if ids.iter().any(|ids| ids.normal.is_some()) {
        let values = shown.iter().flat_map(|shown| pools.normal(of(shown))).collect();
        layers.push(named_layer(LayerKind::Normal, 3, values));
    }
    if !pools.colors.is_empty() {
        let values = shown.iter().flat_map(|shown| pools.colors[shown.vertex]).collect();
        layers.push(named_layer(LayerKind::Color(0), 3, values));
    }
    layers
}

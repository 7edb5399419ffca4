//! Attributes while the surface shrinks: wedges follow their vertices.
//!
//! Where an edge is contracted, the wedges that meet along it become one, blended at the new place.
//! A wedge of the removed end that meets none has nowhere to go; so a seam can only be contracted
//! along itself, or by an end that has no seam onto one that has.

use meshlod_mesh::{Attributes, FaceId, Layer, LayerKind, Mesh, VertexId, WedgeId};
use rustc_hash::FxHashMap;

use crate::contracted::Freedom;
use crate::neighbourhood::Neighbourhood;
use crate::refusal::Refusal;
use crate::surface::Surface;

/// The wedges of a surface: those of its mesh, split further where the material changes, so that
/// the borders of materials are seams like any other.
pub(crate) struct Wedges {
    corners: Vec<[WedgeId; 3]>,
    layers: Vec<Layer>,
    count: usize,
}

impl Wedges {
    /// The wedges of a mesh that has attributes or materials.
    pub(crate) fn of(mesh: &Mesh) -> Option<Self> {
        let several_materials = mesh.materials.as_ref().filter(|m| m.names.len() > 1);
        let mut wedges = match (&mesh.attributes, several_materials) {
            (Some(attributes), _) => Self {
                corners: attributes.corners.clone(),
                layers: attributes.layers.clone(),
                count: attributes.wedge_count,
            },
            (None, Some(_)) => {
                let corners = mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
                Self { corners, layers: Vec::new(), count: mesh.positions.len() }
            }
            (None, None) => return None,
        };
        if let Some(materials) = several_materials {
            wedges.split_by(&materials.of_face);
        }
        Some(wedges)
    }

    /// Gives each label its own wedges; the first label to use one keeps it.
    fn split_by(&mut self, labels: &[u32]) {
        let mut owner = vec![u32::MAX; self.count];
        let mut copies = FxHashMap::default();
        for (corners, &label) in self.corners.iter_mut().zip(labels) {
            for wedge in corners {
                let owner = &mut owner[wedge.index()];
                if *owner == u32::MAX {
                    *owner = label;
                }
                if *owner != label {
                    let source = *wedge;
                    *wedge = *copies.entry((source, label)).or_insert_with(|| {
                        for layer in &mut self.layers {
                            let from = source.index() * layer.width;
                            layer.values.extend_from_within(from..from + layer.width);
                        }
                        self.count += 1;
                        WedgeId::new(self.count - 1)
                    });
                }
            }
        }
    }

    /// The wedge at a corner of a face.
    #[inline]
    pub(crate) fn at(&self, face: FaceId, corner: usize) -> WedgeId {
        self.corners[face.index()][corner]
    }

    /// The wedges at the ends of the edge in each of its faces; equal pairs once.
    pub(crate) fn pair(
        &self,
        surface: &Surface,
        [v0, v1]: [VertexId; 2],
        pairs: &mut Vec<[WedgeId; 2]>,
    ) {
        for &face in surface.star(v0) {
            if surface.face(face).contains(&v1) {
                let pair = [v0, v1].map(|v| self.at(face, surface.corner(face, v)));
                if !pairs.contains(&pair) {
                    pairs.push(pair);
                }
            }
        }
    }

    /// Which ends of the edge can be given up: those whose every wedge meets exactly one wedge of
    /// the other end.
    pub(crate) fn freedom(
        &self,
        surface: &Surface,
        ends: [VertexId; 2],
        pairs: &[[WedgeId; 2]],
    ) -> Result<Freedom, Refusal> {
        let gives_up = |end: usize| {
            surface.star(ends[end]).iter().all(|&face| {
                let wedge = self.at(face, surface.corner(face, ends[end]));
                pairs.iter().filter(|pair| pair[end] == wedge).count() == 1
            })
        };
        match (gives_up(0), gives_up(1)) {
            (true, true) => Ok(Freedom::Free),
            (true, false) => Ok(Freedom::At(1)),
            (false, true) => Ok(Freedom::At(0)),
            (false, false) => Err(Refusal::Seam),
        }
    }

    /// Moves the corners of the removed end to the wedges of the kept one, and blends those a way
    /// `t` (0 to 1) towards what they replace.
    pub(crate) fn contract(&mut self, hood: &Neighbourhood, kept: usize, t: f64) {
        let gone = 1 - kept;
        for spoke in hood.spokes.iter().filter(|spoke| spoke.owner() != kept) {
            let wedge = &mut self.corners[spoke.face.index()][spoke.corner()];
            if let Some(pair) = hood.wedge_pairs.iter().find(|pair| pair[gone] == *wedge) {
                *wedge = pair[kept];
            }
        }
        if t > 0.0 {
            for pair in &hood.wedge_pairs {
                self.layers.iter_mut().for_each(|layer| blend(layer, pair[kept], pair[gone], t));
            }
        }
    }

    /// The values of a wedge in all layers, one after the other.
    pub(crate) fn values(&self, wedge: WedgeId) -> impl Iterator<Item = f32> + '_ {
        self.layers.iter().flat_map(move |layer| layer.of(wedge)).copied()
    }

    /// How many values a wedge has in all layers.
    pub(crate) fn width(&self) -> usize {
        self.layers.iter().map(|layer| layer.width).sum()
    }

    /// Gives a wedge back the values that [`Self::values`] gave.
    pub(crate) fn restore(&mut self, wedge: WedgeId, mut values: &[f32]) {
        for layer in &mut self.layers {
            let (these, rest) = values.split_at(layer.width);
            layer.of_mut(wedge).copy_from_slice(these);
            values = rest;
        }
    }

    pub(crate) fn set(&mut self, face: FaceId, corner: usize, wedge: WedgeId) {
        self.corners[face.index()][corner] = wedge;
    }

    /// The attributes of the faces at `kept`, in that order, with all wedges still in place.
    pub(crate) fn select(&self, kept: &[u32]) -> Attributes {
        Attributes {
            corners: kept.iter().map(|&f| self.corners[f as usize]).collect(),
            wedge_count: self.count,
            layers: self.layers.clone(),
        }
    }
}

/// Moves a wedge's values a way `t` towards another's, as its kind asks.
fn blend(layer: &mut Layer, wedge: WedgeId, toward: WedgeId, t: f64) {
    let (from, to) = (wedge.index() * layer.width, toward.index() * layer.width);
    // Joints are names, not amounts: they and their weights come from the nearer end.
    if matches!(layer.kind, LayerKind::Joints(_) | LayerKind::Weights(_)) {
        if t > 0.5 {
            layer.values.copy_within(to..to + layer.width, from);
        }
        return;
    }
    for i in 0..layer.width {
        layer.values[from + i] += (layer.values[to + i] - layer.values[from + i]) * t as f32;
    }
    if matches!(layer.kind, LayerKind::Normal | LayerKind::Tangent) {
        let direction = &mut layer.values[from..from + 3];
        let length = direction.iter().map(|x| x * x).sum::<f32>().sqrt();
        if length > 0.0 {
            direction.iter_mut().for_each(|x| *x /= length);
        }
    }
}

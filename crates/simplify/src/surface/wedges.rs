//! Attributes of a surface being simplified: its wedges follow their vertices.
//!
//! When an edge is contracted, the wedges that meet along it become one, with the values of the
//! surface next to the new position. A chart of the removed end that meets none would be lost. A
//! seam can therefore only be contracted along itself, or from an end off the seam onto it.

use meshlod_mesh::{Attributes, FaceId, Labels, Layer, Mesh, VertexId, WedgeId};
use rustc_hash::FxHashMap;

use crate::refusal::Refusal;
use crate::surface::charts::{charts, is_shading};
use crate::surface::contracted::Freedom;
use crate::surface::interpolate::interpolate;
use crate::surface::nearest::Nearby;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Flags, Placed, Surface};

/// Wedges of a surface: those of its mesh, split further where the material or the object changes,
/// so that borders between them are seams like any other.
pub(crate) struct Wedges {
    corners: Vec<[WedgeId; 3]>,
    layers: Vec<Layer>,
    charts: Vec<WedgeId>,
}

impl Wedges {
    /// Builds the wedges of a mesh with attributes, materials or objects.
    pub(crate) fn new(mesh: &Mesh) -> Option<Self> {
        let labels = labels(mesh);
        let (mut corners, mut layers, count) = match (&mesh.attributes, &labels) {
            (Some(a), _) => (a.corners.clone(), a.layers.clone(), a.wedge_count),
            (None, Some(_)) => {
                let corners = mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
                (corners, Vec::new(), mesh.positions.len())
            }
            (None, None) => return None,
        };
        let labels = labels.map(|of_face| split_by(&of_face, &mut corners, &mut layers, count));
        let labels = labels.unwrap_or_default();
        let count = count.max(labels.len());
        let of_corners =
            mesh.faces.iter().flatten().copied().zip(corners.iter().flatten().copied());
        let charts = charts(&layers, &labels, count, of_corners);
        Some(Self { corners, layers, charts })
    }

    /// Returns the attribute layers of all wedges.
    #[inline]
    pub(crate) fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Returns the number of wedges, including wedges that no face uses any more.
    #[inline]
    pub(crate) fn count(&self) -> usize {
        self.charts.len()
    }

    /// Returns the wedge at a corner of a face.
    #[inline]
    pub(crate) fn at(&self, face: FaceId, corner: usize) -> WedgeId {
        self.corners[face.index()][corner]
    }

    /// Returns the wedges at the corners of a face.
    #[inline]
    pub(crate) fn of(&self, face: FaceId) -> [WedgeId; 3] {
        self.corners[face.index()]
    }

    /// Collects the wedges at the two ends of an edge in each of its faces; equal pairs occur once.
    pub(crate) fn pair(
        &self,
        surface: &Surface,
        [v0, v1]: [VertexId; 2],
        pairs: &mut Vec<[WedgeId; 2]>,
    ) {
        let shorter = if surface.valence(v0) <= surface.valence(v1) { v0 } else { v1 };
        for face in surface.star(shorter) {
            let vertices = surface.face(face);
            if vertices.contains(&v0) && vertices.contains(&v1) {
                let pair = [v0, v1].map(|v| self.at(face, surface.corner(face, v)));
                if !pairs.contains(&pair) {
                    pairs.push(pair);
                }
            }
        }
    }

    /// Returns the chart at a corner of a face.
    #[inline]
    pub(crate) fn chart_at(&self, face: FaceId, corner: usize) -> WedgeId {
        self.chart(self.at(face, corner))
    }

    #[inline]
    pub(crate) fn chart(&self, wedge: WedgeId) -> WedgeId {
        self.charts[wedge.index()]
    }

    #[inline]
    pub(crate) fn same_chart(&self, a: WedgeId, b: WedgeId) -> bool {
        self.chart(a) == self.chart(b)
    }

    /// Determines which ends of an edge can be removed: every chart of such an end meets exactly
    /// one chart of the other.
    pub(crate) fn freedom(
        &self,
        surface: &Surface,
        ends: [VertexId; 2],
        pairs: &[[WedgeId; 2]],
    ) -> Result<Freedom, Refusal> {
        let gives_up = |end: usize| {
            surface.star(ends[end]).all(|face| {
                let chart = self.chart_at(face, surface.corner(face, ends[end]));
                let mut met = pairs.iter().filter(|pair| self.chart(pair[end]) == chart);
                let other = |pair: &[WedgeId; 2]| self.chart(pair[1 - end]);
                met.next().is_some_and(|first| met.all(|pair| other(pair) == other(first)))
            })
        };
        match (gives_up(0), gives_up(1)) {
            (true, true) => Ok(Freedom::Free),
            (true, false) => Ok(Freedom::AlongNormal(1)),
            (false, true) => Ok(Freedom::AlongNormal(0)),
            (false, false) => Err(Refusal::Seam),
        }
    }

    /// Determines how free a face with a corner on a seam is: that corner stays, and each of the
    /// others must be able to follow its edge to it. `room` is scratch space for the wedges that
    /// meet there.
    pub(crate) fn freedom_of_face(
        &self,
        surface: &Surface,
        corners: &[VertexId],
        room: &mut Vec<[WedgeId; 2]>,
    ) -> Result<Freedom, Refusal> {
        let on_seam = |v: &VertexId| surface.flags(*v).any(Flags::SEAM);
        let stays = corners.iter().position(on_seam).ok_or(Refusal::Seam)?;
        for (i, &v) in corners.iter().enumerate().filter(|&(i, _)| i != stays) {
            room.clear();
            let ends = [corners[stays], v];
            self.pair(surface, ends, room);
            if on_seam(&corners[i]) || self.freedom(surface, ends, room)?.kept() == Some(1) {
                return Err(Refusal::Seam);
            }
        }
        room.clear();
        Ok(Freedom::AlongNormal(stays))
    }

    /// Iterates over the wedges whose values a contraction changes, possibly with repetitions.
    pub(crate) fn changing<'a>(
        &'a self,
        neighbourhood: &'a Neighbourhood,
        kept: usize,
    ) -> impl Iterator<Item = WedgeId> + 'a {
        let paired = neighbourhood.wedge_pairs.iter().map(move |pair| pair[kept]);
        let alone = neighbourhood.spokes.iter().filter_map(|spoke| {
            let wedge = self.at(spoke.face, spoke.corner());
            let meets = |pair: &[WedgeId; 2]| pair[spoke.owner()] == wedge;
            (!neighbourhood.wedge_pairs.iter().any(meets)).then_some(wedge)
        });
        paired.chain(alone)
    }

    /// Merges the wedges of the two ends, before `surface` itself changes. Wedges that meet along
    /// the edge become one. The others stay with their faces and their shading, and take their
    /// texture coordinates from the wedge that their chart became.
    pub(crate) fn contract(
        &mut self,
        surface: &Surface,
        neighbourhood: &Neighbourhood,
        placed: &Placed,
    ) {
        let (pairs, kept) = (&neighbourhood.wedge_pairs, placed.kept);
        // An end that stays in place or moves along its normal keeps its values exactly.
        let moves = placed.position != surface.position(neighbourhood.contracted[kept]);
        if moves && neighbourhood.freedom == Freedom::Free && !neighbourhood.is_decided {
            self.take_values(&Nearby::new(self, surface, neighbourhood, placed), pairs, kept);
        }
        for spoke in &neighbourhood.spokes {
            let wedge = self.at(spoke.face, spoke.corner());
            let end = spoke.owner();
            let met = pairs.iter().filter(|pair| pair[end] == wedge);
            // The lowest of several, as in the kernel, whose contractions are replayed here.
            if let Some(pair) = met.min_by_key(|pair| pair[kept]) {
                self.set(spoke.face, spoke.corner(), pair[kept]);
            } else if let Some(pair) = pairs.iter().find(|p| self.same_chart(p[end], wedge)) {
                self.follow(wedge, pair[kept]);
            }
        }
    }

    /// Gives merged wedges the values at their new positions.
    fn take_values(&mut self, nearby: &Nearby, pairs: &[[WedgeId; 2]], kept: usize) {
        let mut taken: Vec<(WedgeId, Vec<f32>)> = Vec::with_capacity(pairs.len());
        for wedge in pairs.iter().map(|pair| pair[kept]) {
            let done = taken.iter().any(|(other, _)| *other == wedge);
            if let (false, [Some(shading), Some(texture)]) =
                (done, nearby.places(wedge, self.chart(wedge)))
            {
                let mut values = Vec::with_capacity(2 * self.width());
                interpolate(&self.layers, &texture, &mut values);
                if shading != texture {
                    interpolate(&self.layers, &shading, &mut values);
                    self.shade(&mut values);
                }
                taken.push((wedge, values));
            }
        }
        // Written only now, because the old values were still needed.
        for (wedge, values) in taken {
            self.restore(wedge, &values);
        }
    }

    /// Copies the shading of the second set of values into the first.
    fn shade(&self, values: &mut [f32]) {
        let (first, second) = values.split_at_mut(self.width());
        let mut start = 0;
        for layer in &self.layers {
            let end = start + layer.width;
            if is_shading(layer) {
                first[start..end].copy_from_slice(&second[start..end]);
            }
            start = end;
        }
    }

    /// Gives a wedge the chart and texture values of another; its shading stays.
    fn follow(&mut self, wedge: WedgeId, other: WedgeId) {
        for layer in self.layers.iter_mut().filter(|layer| !is_shading(layer)) {
            let from = other.index() * layer.width;
            layer.values.copy_within(from..from + layer.width, wedge.index() * layer.width);
        }
        self.charts[wedge.index()] = self.chart(other);
    }

    /// Iterates over the values of a wedge, layer by layer.
    pub(crate) fn values(&self, wedge: WedgeId) -> impl Iterator<Item = f32> + '_ {
        self.layers.iter().flat_map(move |layer| layer.of(wedge)).copied()
    }

    /// Returns the number of values of a wedge in all layers.
    pub(crate) fn width(&self) -> usize {
        self.layers.iter().map(|layer| layer.width).sum()
    }

    /// Restores the values of a wedge as [`Self::values`] returned them.
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

    /// Returns the attributes of the faces in `kept`, in that order, with all wedges included.
    pub(crate) fn select(&self, kept: &[u32]) -> Attributes {
        Attributes {
            corners: kept.iter().map(|&f| self.corners[f as usize]).collect(),
            wedge_count: self.charts.len(),
            layers: self.layers.clone(),
        }
    }
}

/// Combines material and object of every face into one label, if there are several.
pub(crate) fn labels(mesh: &Mesh) -> Option<Vec<u32>> {
    let several = |labels: &&Labels| labels.names.len() > 1;
    let [materials, objects] =
        [&mesh.materials, &mesh.objects].map(|labels| labels.as_ref().filter(several));
    let (Some(materials), Some(objects)) = (materials, objects) else {
        return materials.or(objects).map(|labels| labels.of_face.clone());
    };
    let mut numbers = FxHashMap::default();
    let pairs = materials.of_face.iter().zip(&objects.of_face);
    let number = |pair| {
        let next = numbers.len() as u32;
        *numbers.entry(pair).or_insert(next)
    };
    Some(pairs.map(number).collect())
}

/// Splits wedges between labels: the first label to use a wedge keeps it, the others get copies.
/// Returns the label of each wedge.
fn split_by(
    labels: &[u32],
    corners: &mut [[WedgeId; 3]],
    layers: &mut [Layer],
    count: usize,
) -> Vec<u32> {
    let mut owner = vec![u32::MAX; count];
    let mut copies = FxHashMap::default();
    for (corners, &label) in corners.iter_mut().zip(labels) {
        for wedge in corners {
            if owner[wedge.index()] == u32::MAX {
                owner[wedge.index()] = label;
            }
            if owner[wedge.index()] != label {
                let source = *wedge;
                *wedge = *copies.entry((source, label)).or_insert_with(|| {
                    for layer in layers.iter_mut() {
                        let from = source.index() * layer.width;
                        layer.values.extend_from_within(from..from + layer.width);
                    }
                    owner.push(label);
                    WedgeId::new(owner.len() - 1)
                });
            }
        }
    }
    owner
}

//! The attribute layers of a mesh: the costed ones as channels, scaled to lengths; the others are
//! only carried along.

use std::ops::Range;

use glam::{DVec3, Vec3};
use meshlod_mesh::{Layer, LayerKind, Mesh, WedgeId};

use crate::kernel::mesh::local_frame::Frame;
use crate::options::AttributeWeights;
use crate::surface::charts::is_shading;

/// Largest absolute value of a channel, in the frame's units.
const MAX_LENGTH: f64 = 1e9;

/// A costed layer, or the costed part of one.
#[derive(Clone, Debug)]
struct CostedLayer {
    layer: usize,
    /// Its channels.
    channels: Range<usize>,
    /// Length in the frame's units per unit of its values.
    scale: f64,
    /// Smallest and largest of its values, as channels.
    range: [f32; 2],
    is_normal: bool,
    is_uv: bool,
}

/// Attribute layers of a mesh, with the scales by which costs measure them.
pub(crate) struct AttributeLayers<'m> {
    layers: &'m [Layer],
    costed: Vec<CostedLayer>,
    /// Weight of lengths in uv relative to lengths on the surface.
    pub(crate) uv_weight: f32,
    /// Layers that are not, or not fully, held by channels.
    pub(crate) uncosted: Vec<UncostedLayer>,
}

/// A layer whose values are held by slot, beside the channels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UncostedLayer {
    layer: usize,
    pub(crate) kind: LayerKind,
    pub(crate) width: usize,
}

/// A surviving slot with the input wedge it came from. `moved` is false if it still has that
/// wedge's values.
pub(crate) struct SurvivingWedge<const K: usize> {
    pub(crate) slot: u32,
    /// Index of the wedge, split ones included.
    pub(crate) own: u32,
    pub(crate) wedge: u32,
    pub(crate) moved: bool,
    pub(crate) channels: [f32; K],
}

impl<'m> AttributeLayers<'m> {
    /// Selects the costed layers, weighted as in the policy engine, up to `most` channels, the
    /// first layers first.
    pub(crate) fn new(
        mesh: &'m Mesh,
        frame: &Frame,
        weights: &AttributeWeights,
        most: usize,
    ) -> Self {
        let layers = mesh.attributes.as_ref().map_or(&[][..], |all| &all.layers);
        let mut costed: Vec<CostedLayer> = Vec::new();
        let diagonal = mesh.bounds().diagonal();
        for (i, layer) in layers.iter().enumerate() {
            let (width, scale) = match layer.kind {
                LayerKind::Normal => (3, weights.normal * diagonal),
                LayerKind::Color(_) => (3, weights.color * diagonal),
                LayerKind::Uv(_) if weights.uv > 0.0 => (2, weights.uv * length_of_uv(mesh, layer)),
                _ => continue,
            };
            let scale = scale / frame.unit;
            let start = costed.last().map_or(0, |last| last.channels.end);
            let fits = layer.width >= width && start + width <= most;
            if fits && scale > 0.0 && scale.is_finite() {
                let channels = start..start + width;
                let range = range(layer, width, scale);
                let is_normal = layer.kind == LayerKind::Normal;
                let is_uv = width == 2;
                costed.push(CostedLayer { layer: i, channels, scale, range, is_normal, is_uv });
            }
        }
        let uv_weight = weights.uv as f32;
        let mut this = Self { layers, costed, uv_weight, uncosted: Vec::new() };
        this.find_uncosted();
        this
    }

    /// Returns the number of attribute channels.
    pub(crate) fn channels(&self) -> usize {
        self.costed.last().map_or(0, |last| last.channels.end)
    }

    /// Returns the first of the two channels of each uv layer.
    pub(crate) fn uvs(&self) -> impl Iterator<Item = usize> + '_ {
        self.costed.iter().filter(|costed| costed.is_uv).map(|costed| costed.channels.start)
    }

    fn find_uncosted(&mut self) {
        let Self { layers, costed, .. } = &*self;
        let is_held = |i: usize, width: usize| {
            costed.iter().any(|costed| costed.layer == i && costed.channels.len() == width)
        };
        let uncosted = layers.iter().enumerate().filter(|(i, layer)| !is_held(*i, layer.width));
        let uncosted = uncosted.map(|(layer, &Layer { kind, width, .. })| UncostedLayer {
            layer,
            kind,
            width,
        });
        self.uncosted = uncosted.collect();
    }

    /// Returns for each of the uncosted layers its values at these wedges. A slot without a wedge
    /// has zeros.
    pub(crate) fn uncosted_values(&self, wedges: &[u32]) -> Vec<Vec<f32>> {
        let values = |&UncostedLayer { layer, width, .. }: &UncostedLayer| {
            let mut values = vec![0.0; width * wedges.len()];
            for (slot, &wedge) in wedges.iter().enumerate().filter(|(_, w)| **w != u32::MAX) {
                values[slot * width..][..width]
                    .copy_from_slice(self.layers[layer].of(WedgeId(wedge)));
            }
            values
        };
        self.uncosted.iter().map(values).collect()
    }

    /// Returns the channels of a wedge. NaN and infinity become zero, and lengths are clamped such
    /// that their squares fit in a float.
    pub(crate) fn channels_of<const K: usize>(&self, wedge: u32) -> [f32; K] {
        let mut channels = [0.0; K];
        for CostedLayer { layer, channels: at, scale, .. } in &self.costed {
            let values = self.layers[*layer].of(WedgeId(wedge));
            for (channel, &x) in channels[at.clone()].iter_mut().zip(values) {
                let length = (f64::from(x) * scale).clamp(-MAX_LENGTH, MAX_LENGTH);
                *channel = if x.is_finite() { length as f32 } else { 0.0 };
            }
        }
        channels
    }

    /// Makes the best-fitting channels valid: normals get their length, all others are clamped to
    /// the input's range. `before` replaces a normal that cancels out.
    #[inline(always)]
    pub(crate) fn clamp_values<const K: usize>(&self, channels: &mut [f32; K], before: &[f32; K]) {
        for CostedLayer { channels: at, scale, range: [low, high], is_normal, .. } in &self.costed {
            let values = &mut channels[at.clone()];
            if *is_normal {
                let unit = Vec3::new(values[0], values[1], values[2]).normalize_or_zero();
                match unit == Vec3::ZERO {
                    true => values.copy_from_slice(&before[at.clone()]),
                    false => values.copy_from_slice(&(unit * *scale as f32).to_array()),
                }
            } else {
                values.iter_mut().for_each(|x| *x = x.clamp(*low, *high));
            }
        }
    }

    /// Copies all channels but the normals from others.
    pub(crate) fn copy_textures<const K: usize>(&self, channels: &mut [f32; K], other: &[f32; K]) {
        for CostedLayer { channels: at, .. } in self.costed.iter().filter(|c| !c.is_normal) {
            channels[at.clone()].copy_from_slice(&other[at.clone()]);
        }
    }

    /// Returns the layers in which all wedges of a chart agree; `None` if no layer is shading, so
    /// that each wedge is its own chart.
    pub(crate) fn textures(&self) -> Option<Vec<&'m Layer>> {
        let any_shading = self.layers.iter().any(is_shading);
        any_shading.then(|| self.layers.iter().filter(|layer| !is_shading(layer)).collect())
    }

    /// Returns the attribute layers of the surviving slots. `uncosted` are the values of the uncosted
    /// layer with this number at a slot.
    pub(crate) fn layers<'v, const K: usize>(
        &self,
        left: &[SurvivingWedge<K>],
        uncosted: impl Fn(usize, u32) -> &'v [f32],
    ) -> Vec<Layer> {
        let of_layer = |(i, layer): (usize, &Layer)| {
            let costed = self.costed.iter().find(|costed| costed.layer == i);
            let carried = self.uncosted.iter().position(|uncosted| uncosted.layer == i);
            let mut values = Vec::with_capacity(left.len() * layer.width);
            for SurvivingWedge { slot, wedge, moved, channels, .. } in left {
                if !moved {
                    values.extend_from_slice(layer.of(WedgeId(*wedge)));
                    continue;
                }
                let start = values.len();
                match carried {
                    Some(number) => values.extend_from_slice(uncosted(number, *slot)),
                    None => values.resize(start + layer.width, 0.0),
                }
                if let Some(CostedLayer { channels: at, scale, .. }) = costed {
                    let own = channels[at.clone()].iter().map(|&x| (f64::from(x) / scale) as f32);
                    values[start..].iter_mut().zip(own).for_each(|(value, x)| *value = x);
                }
            }
            Layer { values, kind: layer.kind, name: layer.name.clone(), width: layer.width }
        };
        self.layers.iter().enumerate().map(of_layer).collect()
    }
}

/// Returns the smallest and largest of the first `width` values of all wedges, as channels.
fn range(layer: &Layer, width: usize, scale: f64) -> [f32; 2] {
    let costed = layer.values.chunks_exact(layer.width).flat_map(|values| &values[..width]);
    // NaN and infinity count as zero.
    let counted = costed.map(|&x| if x.is_finite() { x } else { 0.0 });
    let widest = counted
        .fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    widest.map(|x| if x.is_finite() { (f64::from(x) * scale) as f32 } else { 0.0 })
}

/// Returns the length of a unit of uv on the surface: the square root of the area on the surface
/// over that in uv.
fn length_of_uv(mesh: &Mesh, layer: &Layer) -> f64 {
    let Some(attributes) = &mesh.attributes else { return 0.0 };
    let (mut area, mut in_texture) = (0.0, 0.0);
    for (face, wedges) in mesh.faces.iter().zip(&attributes.corners) {
        let [a, b, c] = mesh.triangle(*face);
        area += (b - a).cross(c - a).length();
        let uv = |w: WedgeId| DVec3::new(layer.of(w)[0].into(), layer.of(w)[1].into(), 0.0);
        let [a, b, c] = wedges.map(uv);
        let twice = (b - a).cross(c - a).z.abs();
        in_texture += if twice.is_finite() { twice } else { 0.0 };
    }
    (area / in_texture).sqrt()
}

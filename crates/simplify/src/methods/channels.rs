//! Attribute channels of the quadric methods, in model units.
//!
//! A channel is one value of a layer times a length, so that attributes can be weighed against
//! distances whatever the size of the model and of its textures. For normals and colours this
//! length is the diagonal. For texture coordinates it is the average length of a unit of uv on the
//! model, so that an error is the distance that the texture slides.

use glam::DVec3;
use meshlod_mesh::{FaceId, Layer, LayerKind, WedgeId};

use crate::options::AttributeWeights;
use crate::surface::Surface;
use crate::surface::wedges::Wedges;

/// Layer with a nonzero weight.
struct Counted {
    layer: usize,
    /// Number of its values that count; the rest, such as alpha, does not.
    width: usize,
    scale: f64,
}

/// Weighted attribute values of the wedges, as channels comparable to lengths.
pub(crate) struct Channels {
    counted: Vec<Counted>,
}

impl Channels {
    /// Selects the attribute channels of a surface; `None` if no layer has a weight.
    pub(crate) fn new(surface: &Surface, weights: &AttributeWeights) -> Option<Self> {
        let wedges = surface.wedges.as_ref()?;
        let diagonal = diagonal(surface);
        let counted = wedges.layers().iter().enumerate().filter_map(|(i, layer)| {
            let (width, scale) = match layer.kind {
                LayerKind::Normal => (3, weights.normal * diagonal),
                LayerKind::Color(_) => (3, weights.color * diagonal),
                LayerKind::Uv(_) if weights.uv > 0.0 => {
                    (2, weights.uv * length_of_uv(surface, wedges, layer))
                }
                _ => return None,
            };
            let counts = scale > 0.0 && scale.is_finite() && layer.width >= width;
            counts.then_some(Counted { layer: i, width, scale })
        });
        let counted: Vec<_> = counted.collect();
        (!counted.is_empty()).then_some(Self { counted })
    }

    /// Returns the number of attribute channels.
    pub(crate) fn count(&self) -> usize {
        self.counted.iter().map(|counted| counted.width).sum()
    }

    /// Returns the values of a wedge in all channels, in model units. Values that are not finite
    /// count as zero.
    pub(crate) fn values<'a>(
        &'a self,
        wedges: &'a Wedges,
        wedge: WedgeId,
    ) -> impl Iterator<Item = f64> + 'a {
        self.counted.iter().flat_map(move |counted| {
            let values = wedges.layers()[counted.layer].of(wedge)[..counted.width].iter();
            values.map(|&x| if x.is_finite() { f64::from(x) * counted.scale } else { 0.0 })
        })
    }
}

fn live_faces(surface: &Surface) -> impl Iterator<Item = FaceId> + '_ {
    (0..surface.face_count()).map(FaceId::new).filter(|&face| surface.is_alive(face))
}

fn diagonal(surface: &Surface) -> f64 {
    let corners = || live_faces(surface).flat_map(|f| surface.face(f)).map(|v| surface.position(v));
    let low = corners().fold(DVec3::INFINITY, DVec3::min);
    let high = corners().fold(DVec3::NEG_INFINITY, DVec3::max);
    low.distance(high)
}

/// Returns the length of a unit of uv on the surface: the root of the ratio of surface area to
/// texture area.
fn length_of_uv(surface: &Surface, wedges: &Wedges, layer: &Layer) -> f64 {
    let (mut area, mut in_texture) = (0.0, 0.0);
    for face in live_faces(surface) {
        let uv = |w: WedgeId| DVec3::from([layer.of(w)[0].into(), layer.of(w)[1].into(), 0.0]);
        let [a, b, c] = wedges.of(face).map(uv);
        area += surface.area_normal(face).length();
        in_texture += (b - a).cross(c - a).length();
    }
    (area / in_texture).sqrt()
}

//! Values that a corner of a face has beside its point, and their bytes in scratch files.

use meshlod_mesh::{Attributes, Layer, LayerKind};
use serde::{Deserialize, Serialize};

/// Attribute layers that tiles keep, with their place in the values of a corner.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Layout {
    layers: Vec<LayoutLayer>,
}

/// Attribute layer of all tiles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct LayoutLayer {
    /// Bytes that stand for the type, see [`LayerKind::tag`].
    tag: (u8, u8),
    name: String,
    width: usize,
}

impl Layout {
    /// Returns the layout of the layers that tiles keep: normals, texture coordinates and colours.
    pub fn of<'l>(layers: impl IntoIterator<Item = &'l Layer>) -> Self {
        let kept = layers.into_iter().filter(|layer| Self::keeps(layer)).map(|layer| LayoutLayer {
            tag: layer.kind.tag(),
            name: layer.name.clone(),
            width: layer.width,
        });
        Self { layers: kept.collect() }
    }

    /// Returns true for layers that tiles keep.
    pub fn keeps(layer: &Layer) -> bool {
        matches!(layer.kind, LayerKind::Normal | LayerKind::Uv(_) | LayerKind::Color(_))
    }

    /// Returns true if corners have nothing but their point.
    pub fn is_empty(&self) -> bool {
        self.layers.is_empty()
    }

    /// Returns the number of values of a corner.
    pub fn width(&self) -> usize {
        self.layers.iter().map(|layer| layer.width).sum()
    }

    /// Returns the number of bytes of a corner's values in scratch files.
    pub fn bytes(&self) -> usize {
        self.layers.iter().map(|layer| layer.width * layer.value_bytes()).sum()
    }

    /// Appends the values of a corner as bytes: colours as one each, others as `f32`.
    pub fn pack(&self, values: &[f32], bytes: &mut Vec<u8>) {
        let mut rest = values;
        for layer in &self.layers {
            let (own, after) = rest.split_at(layer.width);
            match layer.value_bytes() {
                1 => bytes.extend(own.iter().map(|x| (x.clamp(0.0, 1.0) * 255.0).round() as u8)),
                _ => own.iter().for_each(|x| bytes.extend(x.to_le_bytes())),
            }
            rest = after;
        }
    }

    /// Appends the values that were packed.
    pub fn unpack(&self, bytes: &[u8], values: &mut Vec<f32>) {
        let mut rest = bytes;
        for layer in &self.layers {
            let (own, after) = rest.split_at(layer.width * layer.value_bytes());
            match layer.value_bytes() {
                1 => values.extend(own.iter().map(|&x| f32::from(x) / 255.0)),
                _ => values.extend(own.as_chunks().0.iter().map(|&x| f32::from_le_bytes(x))),
            }
            rest = after;
        }
    }

    /// Returns the values of a point between the three corners of a triangle, by its weights.
    /// Directions have their length.
    pub fn blend(&self, corners: [&[f32]; 3], weights: [f32; 3], values: &mut Vec<f32>) {
        let first = values.len();
        values.extend((0..self.width()).map(|i| {
            corners.iter().zip(weights).map(|(corner, weight)| weight * corner[i]).sum::<f32>()
        }));
        let mut at = first;
        for layer in &self.layers {
            if layer.kind().is_direction() {
                let own = &mut values[at..at + layer.width];
                let length = own.iter().map(|x| x * x).sum::<f32>().sqrt();
                own.iter_mut().filter(|_| length > 0.0).for_each(|x| *x /= length);
            }
            at += layer.width;
        }
    }

    /// Returns the layers that two layouts have in common; of colours, as many components.
    #[must_use]
    pub fn common(mut self, other: &Self) -> Self {
        self.layers.retain_mut(|layer| match other.find(layer) {
            Some((_, found)) => {
                layer.width = layer.width.min(found.width);
                true
            }
            None => false,
        });
        self
    }

    /// Returns the names of the layers that another layout lacks.
    pub fn beyond(&self, other: &Self) -> Vec<String> {
        let own = self.layers.iter().filter(|layer| other.find(layer).is_none());
        own.map(|layer| layer.kind().to_string()).collect()
    }

    /// Returns, for each value of a corner in a layout whose layers this one has, which value it is
    /// here.
    pub fn values_of(&self, other: &Self) -> Vec<usize> {
        let found = |layer: &LayoutLayer| self.find(layer).map(|(at, _)| at..at + layer.width);
        other.layers.iter().filter_map(found).flatten().collect()
    }

    /// Returns the layer of the same kind, and its first value.
    fn find(&self, like: &LayoutLayer) -> Option<(usize, &LayoutLayer)> {
        let mut at = 0;
        for layer in &self.layers {
            if layer.tag == like.tag {
                return Some((at, layer));
            }
            at += layer.width;
        }
        None
    }

    /// Replaces normals without a length by those of their triangles.
    pub fn fill_normals(&self, places: &[[[f64; 3]; 3]], values: &mut [f32]) {
        let mut at = 0;
        for layer in &self.layers {
            if layer.kind() == LayerKind::Normal {
                for (corner, values) in values.chunks_exact_mut(self.width()).enumerate() {
                    let normal = &mut values[at..at + 3];
                    if normal.iter().all(|&x| x == 0.0) {
                        normal.copy_from_slice(&unit_normal(&places[corner / 3]));
                    }
                }
            }
            at += layer.width;
        }
    }

    /// Returns empty layers, to be filled wedge by wedge.
    pub fn attributes(&self) -> Option<Attributes> {
        let layer = |of: &LayoutLayer| Layer {
            kind: of.kind(),
            name: of.name.clone(),
            width: of.width,
            values: Vec::new(),
        };
        let layers = self.layers.iter().map(layer).collect();
        (!self.is_empty()).then(|| Attributes { wedge_count: 0, corners: Vec::new(), layers })
    }
}

/// Returns the normal of a triangle; upwards if it has no area.
fn unit_normal([a, b, c]: &[[f64; 3]; 3]) -> [f32; 3] {
    let from_a = |p: &[f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let ([ux, uy, uz], [vx, vy, vz]) = (from_a(b), from_a(c));
    let normal = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    match length > 0.0 && length.is_finite() {
        true => normal.map(|x| (x / length) as f32),
        false => [0.0, 1.0, 0.0],
    }
}

impl LayoutLayer {
    fn kind(&self) -> LayerKind {
        LayerKind::from_tag(self.tag.0, self.tag.1).unwrap_or(LayerKind::Other)
    }

    fn value_bytes(&self) -> usize {
        if matches!(self.kind(), LayerKind::Color(_)) { 1 } else { 4 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_bytes_and_directions_keep_their_length() {
        let layer = |kind, width| Layer { kind, name: String::new(), width, values: Vec::new() };
        let layers = [layer(LayerKind::Normal, 3), layer(LayerKind::Color(0), 3)];
        let layout = Layout::of(&layers);
        assert_eq!((layout.width(), layout.bytes()), (6, 15));
        let values = [0.6, 0.8, 0.0, 1.0, 0.2, 0.0];
        let (mut bytes, mut back) = (Vec::new(), Vec::new());
        layout.pack(&values, &mut bytes);
        layout.unpack(&bytes, &mut back);
        assert_eq!((bytes.len(), &back[..]), (15, &values[..]));

        let other = [-0.6, 0.8, 0.0, 0.0, 0.2, 0.0];
        let mut between = Vec::new();
        layout.blend([&values, &other, &other], [0.5, 0.25, 0.25], &mut between);
        assert_eq!(between, [0.0, 1.0, 0.0, 0.5, 0.2, 0.0]);
    }
}

//! Charts of a tile: faces of one material that are joined by wedges, and where their texels are.

use meshlod_mesh::{LayerKind, Mesh, UnionFind, WedgeId};
use rustc_hash::FxHashMap;

/// Distance that texture coordinates may be beyond an image without repeating it: rounding, and less
/// than the gutter around charts.
const TOLERANCE: f64 = 1e-4;

/// Chart: faces of one material that are joined by wedges.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chart {
    /// Label of its material.
    pub label: u32,
    /// Least and greatest texture coordinates, less [`Chart::shift`].
    pub bounds: [[f64; 2]; 2],
    /// Whole numbers by which the chart is beside the image that repeats.
    pub shift: [f64; 2],
}

/// Charts of a tile.
#[derive(Debug, Default)]
pub(super) struct Charts {
    /// All charts, in the order of their first faces.
    pub all: Vec<Chart>,
    /// Chart of each wedge; `None` for wedges that no face uses.
    pub of_wedge: Vec<Option<u32>>,
}

impl Chart {
    /// Returns true if the chart needs more than one copy of the image.
    pub fn repeats(&self) -> bool {
        let is_within = |x: &f64| (-TOLERANCE..=1.0 + TOLERANCE).contains(x);
        !self.bounds.iter().flatten().all(is_within)
    }
}

impl Charts {
    /// Finds the charts of a mesh by its first texture coordinates; none without these. Wedges of
    /// several materials become one for each.
    pub fn find(mesh: &mut Mesh) -> Self {
        split_wedges(mesh);
        let uvs =
            mesh.attributes.as_ref().and_then(|own| Some((own, own.layer(LayerKind::Uv(0))?)));
        let Some((attributes, uvs)) = uvs else { return Self::default() };
        let mut joined = UnionFind::new(attributes.wedge_count);
        for [a, b, c] in &attributes.corners {
            joined.union(a.0, b.0);
            joined.union(b.0, c.0);
        }
        let mut this = Self { all: Vec::new(), of_wedge: vec![None; attributes.wedge_count] };
        let mut chart_of: FxHashMap<u32, u32> = FxHashMap::default();
        for (face, corners) in attributes.corners.iter().enumerate() {
            let chart = *chart_of.entry(joined.find(corners[0].0)).or_insert_with(|| {
                let label = label(mesh, face);
                let bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
                this.all.push(Chart { label, bounds, shift: [0.0; 2] });
                this.all.len() as u32 - 1
            });
            for wedge in corners {
                this.of_wedge[wedge.index()] = Some(chart);
                this.all[chart as usize].cover(uvs.of(*wedge));
            }
        }
        this.all.iter_mut().for_each(Chart::move_to_image);
        this
    }
}

impl Chart {
    /// Makes the bounds cover texture coordinates. Those that are no numbers make them infinite.
    fn cover(&mut self, uv: &[f32]) {
        for axis in 0..2 {
            let x = f64::from(uv[axis]);
            let x = if x.is_nan() { f64::INFINITY } else { x };
            let [low, high] = &mut self.bounds;
            (low[axis], high[axis]) = (low[axis].min(x), high[axis].max(x));
        }
    }

    /// Moves the bounds by whole numbers into the image, if they fit.
    fn move_to_image(&mut self) {
        self.shift = self.bounds[0].map(|low| (low + TOLERANCE).floor());
        let shift = self.shift;
        self.bounds = self.bounds.map(|side| [0, 1].map(|axis| side[axis] - shift[axis]));
    }
}

/// Returns the label of a face's material; 0 if there are none.
pub(super) fn label(mesh: &Mesh, face: usize) -> u32 {
    mesh.materials.as_ref().map_or(0, |labels| labels.of(face))
}

/// Gives each material wedges of its own.
fn split_wedges(mesh: &mut Mesh) {
    let labels: Vec<u32> = (0..mesh.faces.len()).map(|face| label(mesh, face)).collect();
    let Some(attributes) = &mut mesh.attributes else { return };
    let mut owner: Vec<Option<u32>> = vec![None; attributes.wedge_count];
    let mut copies: FxHashMap<(WedgeId, u32), WedgeId> = FxHashMap::default();
    for (corners, label) in attributes.corners.iter_mut().zip(labels) {
        for wedge in corners {
            if *owner[wedge.index()].get_or_insert(label) == label {
                continue;
            }
            *wedge = *copies.entry((*wedge, label)).or_insert_with(|| {
                for layer in &mut attributes.layers {
                    let first = wedge.index() * layer.width;
                    layer.values.extend_from_within(first..first + layer.width);
                }
                attributes.wedge_count += 1;
                WedgeId::new(attributes.wedge_count - 1)
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::{Attributes, Labels, Layer, VertexId};

    use super::*;

    /// Triangles with wedges, of the materials 0 and 1, with these texture coordinates.
    fn mesh(corners: &[[u32; 3]], of_face: &[u32], uvs: &[[f32; 2]]) -> Mesh {
        let values = uvs.as_flattened().to_vec();
        let layer = Layer { kind: LayerKind::Uv(0), name: "uv".into(), width: 2, values };
        let attributes = Attributes {
            corners: corners.iter().map(|face| face.map(WedgeId)).collect(),
            wedge_count: uvs.len(),
            layers: vec![layer],
        };
        let faces = corners.iter().map(|face| face.map(VertexId)).collect();
        let positions = uvs.iter().map(|uv| [uv[0].into(), uv[1].into(), 0.0]).collect();
        let names = vec!["a".to_owned(), "b".to_owned()];
        Mesh {
            attributes: Some(attributes),
            materials: Some(Labels { names, of_face: of_face.to_vec() }),
            ..Mesh::new(positions, faces)
        }
    }

    const UVS: [[f32; 2]; 5] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]];

    #[test]
    fn faces_that_share_a_wedge_are_one_chart() {
        let mut joined = mesh(&[[0, 1, 4], [4, 2, 3]], &[0, 0], &UVS);
        assert_eq!(Charts::find(&mut joined).all.len(), 1);
    }

    #[test]
    fn charts_of_two_materials_share_no_wedge() {
        let mut mesh = mesh(&[[0, 1, 4], [4, 2, 3], [2, 4, 1]], &[0, 1, 1], &UVS);
        let charts = Charts::find(&mut mesh);
        mesh.validate().unwrap();
        assert_eq!(charts.all.iter().map(|chart| chart.label).collect::<Vec<_>>(), [0, 1]);
        let attributes = mesh.attributes.as_ref().unwrap();
        assert_eq!(attributes.wedge_count, 7, "copies of the wedges 4 and 1");
        for (face, corners) in attributes.corners.iter().enumerate() {
            let label = label(&mesh, face);
            let of = |wedge: &WedgeId| charts.of_wedge[wedge.index()].unwrap();
            assert!(corners.iter().all(|wedge| charts.all[of(wedge) as usize].label == label));
        }
    }

    #[test]
    fn a_chart_beside_the_image_does_not_repeat_it_but_a_wider_one_does() {
        let beside = UVS.map(|[u, v]| [3.0 + u, v - 2.0]);
        let chart = &Charts::find(&mut mesh(&[[0, 1, 2]], &[0], &beside)).all[0];
        assert_eq!((chart.shift, chart.bounds), ([3.0, -2.0], [[0.0; 2], [1.0; 2]]));
        assert!(!chart.repeats());
        for wider in [1.1, f32::NAN, f32::INFINITY] {
            let wide = UVS.map(|[u, v]| [wider * u, v]);
            assert!(Charts::find(&mut mesh(&[[0, 1, 2]], &[0], &wide)).all[0].repeats(), "{wider}");
        }
    }
}

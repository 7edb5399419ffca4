//! Faces near a box.

use glam::Vec3;
use meshlod_mesh::FaceId;

use crate::Bvh;
use crate::box3::{Box3, round_down, round_up};
use crate::bvh::INNER;

impl Bvh {
    /// Calls `visit` with every face that meets an axis-aligned box, given by its least and greatest
    /// corners in model units, and with some more around it: faces are compared by groups.
    ///
    /// Cost: O(log n + faces visited), n = faces.
    pub fn faces_near_box(&self, [min, max]: [[f64; 3]; 2], mut visit: impl FnMut(FaceId)) {
        let [min, max] = [min, max].map(|corner| self.frame.local(corner).to_array());
        let lo = Vec3::from_array(min.map(|x| round_down(x - SLACK)));
        let hi = Vec3::from_array(max.map(|x| round_up(x + SLACK)));
        let reach = Box3 { lo, hi };
        let mut waiting = vec![0];
        while let Some(index) = waiting.pop() {
            let node = &self.nodes[index as usize];
            for child in 0..4 {
                let corner =
                    |of: &[glam::Vec4; 3]| Vec3::new(of[0][child], of[1][child], of[2][child]);
                if !reach.meets(&Box3 { lo: corner(&node.lo), hi: corner(&node.hi) }) {
                    continue;
                }
                let (first, count) = (node.first[child], node.count[child]);
                if count == INNER {
                    waiting.push(first);
                } else {
                    let slots = first as usize..first as usize + usize::from(count);
                    self.faces[slots].iter().for_each(|&face| visit(face));
                }
            }
        }
    }
}

/// Rounding of local coordinates, where the mesh is about 4 wide.
const SLACK: f64 = 1e-12;

#[cfg(test)]
mod tests {
    use super::*;
    use meshlod_mesh::{Mesh, VertexId};

    #[test]
    fn every_face_that_meets_the_box_is_visited() {
        // Small triangles on a line, far from the origin.
        let at = |i: usize| 1000.0 + i as f64;
        let corners = |i: usize| [[at(i), 0.0, 0.0], [at(i) + 0.5, 0.0, 0.0], [at(i), 0.5, 0.0]];
        let faces = (0..500).map(|i| [0, 1, 2].map(|k| VertexId::new(3 * i + k))).collect();
        let mesh = Mesh::new((0..500).flat_map(corners).collect(), faces);
        let bvh = Bvh::new(&mesh).unwrap();
        let visited = |min: [f64; 3], max: [f64; 3]| {
            let mut visited = Vec::new();
            bvh.faces_near_box([min, max], |face| visited.push(face.index()));
            visited.sort_unstable();
            visited
        };
        let some = visited([at(100), 0.25, 0.0], [at(107) + 0.5, 0.25, 0.0]);
        assert!((100..=107).all(|face| some.binary_search(&face).is_ok()), "{some:?}");
        assert!(some.len() < 24, "{some:?}");
        // A box that only touches.
        assert!(visited([at(7) + 0.5, 0.0, 0.0], [at(7) + 0.75, 1.0, 1.0]).contains(&7));
        assert_eq!(visited([0.0, 1.0, 0.0], [2000.0, 2.0, 1.0]), Vec::<usize>::new());
        assert_eq!(visited([0.0; 3], [2000.0, 1.0, 0.0]).len(), 500);
    }
}

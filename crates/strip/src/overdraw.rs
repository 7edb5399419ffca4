//! Overdraw: how often a covered pixel is shaded.

use meshlod_mesh::VertexId;

/// Pixels along each side of a view. The triangles of a dense mesh cover few pixels, as when it is
/// drawn.
const SIZE: usize = 256;

/// Estimates overdraw: the average number of times that a covered pixel is shaded if `triangles`
/// are drawn in order.
///
/// It is the mean over orthographic views along the axes from both ends: at least 1, or 0 if
/// nothing is visible.
///
/// A pixel is shaded if its centre lies in a triangle that faces the viewer and nothing drawn
/// before is nearer. Triangles with non-finite positions are not drawn.
///
/// # Panics
/// On a vertex without a position.
pub fn overdraw(
    triangles: impl Iterator<Item = [VertexId; 3]> + Clone,
    positions: &[[f64; 3]],
) -> f64 {
    let Some(frame) = Frame::new(triangles.clone().flatten().map(|v| positions[v.index()])) else {
        return 0.0;
    };
    let (mut shaded, mut covered) = (0, 0);
    for axis in 0..3 {
        for from_above in [true, false] {
            let mut view = View::new();
            for triangle in triangles.clone() {
                let corners = triangle.map(|v| frame.seen(positions[v.index()], axis, from_above));
                view.draw(corners);
            }
            shaded += view.shaded;
            covered += view.nearest.iter().filter(|depth| depth.is_finite()).count();
        }
    }
    if covered == 0 { 0.0 } else { shaded as f64 / covered as f64 }
}

/// The cube in view.
struct Frame {
    low: [f64; 3],
    /// Pixels per unit of length.
    scale: f64,
}

impl Frame {
    /// Encloses the positions; `None` without a finite extent.
    fn new(positions: impl Iterator<Item = [f64; 3]>) -> Option<Self> {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        for position in positions.filter(|p| p.iter().all(|x| x.is_finite())) {
            for k in 0..3 {
                low[k] = low[k].min(position[k]);
                high[k] = high[k].max(position[k]);
            }
        }
        let extent = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        (extent > 0.0 && extent.is_finite()).then(|| Self { low, scale: SIZE as f64 / extent })
    }

    /// Projects a position to pixels and depth.
    fn seen(&self, position: [f64; 3], axis: usize, from_above: bool) -> [f64; 3] {
        let at = |k: usize| (position[k] - self.low[k]) * self.scale;
        let [x, y, z] = [at((axis + 1) % 3), at((axis + 2) % 3), at(axis)];
        // Seen from below the picture is mirrored, so that counter-clockwise triangles still face
        // the viewer.
        if from_above { [x, y, -z] } else { [y, x, z] }
    }
}

/// A depth buffer for one direction.
struct View {
    /// Smallest depth by pixel.
    nearest: Vec<f64>,
    shaded: usize,
}

impl View {
    fn new() -> Self {
        Self { nearest: vec![f64::INFINITY; SIZE * SIZE], shaded: 0 }
    }

    fn draw(&mut self, corners: [[f64; 3]; 3]) {
        let [a, b, c] = corners;
        let area = cross(a, b, c);
        if !(area > 0.0 && area.is_finite()) {
            return;
        }
        let first = |k: usize| a[k].min(b[k]).min(c[k]).clamp(0.0, SIZE as f64) as usize;
        let end = |k: usize| a[k].max(b[k]).max(c[k]).clamp(0.0, SIZE as f64).ceil() as usize;
        for y in first(1)..end(1) {
            for x in first(0)..end(0) {
                let at = [x as f64 + 0.5, y as f64 + 0.5, 0.0];
                let weights = [cross(b, c, at), cross(c, a, at), cross(a, b, at)];
                // Both triangles at an edge take a centre on it, which does not matter to the
                // estimate.
                if weights.iter().all(|&weight| weight >= 0.0) {
                    let depth = (weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]) / area;
                    let nearest = &mut self.nearest[y * SIZE + x];
                    if depth < *nearest {
                        *nearest = depth;
                        self.shaded += 1;
                    }
                }
            }
        }
    }
}

/// Returns twice the area of a triangle in the picture, positive if it winds counter-clockwise.
fn cross(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;

    use super::*;

    #[test]
    fn a_ball_is_never_shaded_twice_whatever_the_order() {
        let mesh = samples::sphere(2000);
        let forth = overdraw(mesh.faces.iter().copied(), &mesh.positions);
        assert!((1.0..1.01).contains(&forth), "{forth}");
    }

    #[test]
    fn what_is_drawn_behind_first_is_shaded_twice() {
        let positions = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 1.0],
            [0.0, 1.0, 1.0],
        ];
        let [low, high] = [[0, 1, 2], [3, 4, 5]].map(|face| face.map(VertexId));
        assert_eq!(overdraw([high, low].into_iter(), &positions), 1.0);
        assert_eq!(overdraw([low, high].into_iter(), &positions), 2.0);
        assert_eq!(overdraw([].into_iter(), &positions), 0.0);
    }
}

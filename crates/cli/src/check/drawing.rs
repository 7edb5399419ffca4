//! Pictures of a mesh with its findings marked.

use meshlod::Mesh;
use meshlod::mesh::VertexId;
use meshlod::picture::{
    Background, Camera, Lighting, Normals, Paint, Picture, PictureError, Style, UpAxis, View,
    render,
};

use crate::check::marks::{Mark, Marks};

/// Width and height of a picture, in pixels.
pub const SIZE: [u32; 2] = [576, 480];

/// Colour of unmarked faces.
const PLAIN: [u8; 3] = [214, 216, 219];

/// Half the width of a line, as a fraction of the diagonal.
const LINE: f64 = 0.002;

/// Returns the views from which a mesh is drawn: their names and viewing directions.
pub fn views() -> [(&'static str, [f64; 3]); 4] {
    let [x, y, z] = View::three_quarter(UpAxis::Y).direction;
    [
        ("from the front", [x, y, z]),
        ("from behind", [-x, y, -z]),
        ("from above", [x, 3.0 * z, z]),
        ("from below", [-x, -2.0 * z, z]),
    ]
}

/// Part of a mesh to draw.
#[derive(Clone, Copy, PartialEq)]
pub enum Part {
    /// The whole mesh.
    Whole,
    /// Only the marked faces and edges, so that those inside are visible.
    Marked,
}

/// A mesh to draw, with its findings marked by colours and lines.
pub struct Drawing {
    mesh: Mesh,
    colors: Vec<[u8; 3]>,
}

impl Drawing {
    pub fn new(mesh: &Mesh, marks: &Marks, part: Part) -> Self {
        let finite = |v: &VertexId| {
            mesh.positions.get(v.index()).is_some_and(|p| p.iter().all(|x| x.is_finite()))
        };
        let mut this = Self { mesh: Mesh::default(), colors: Vec::new() };
        this.mesh.positions = mesh.positions.clone();
        for (face, mark) in mesh.faces.iter().zip(&marks.of_face) {
            if face.iter().all(finite) && (part == Part::Whole || mark.is_some()) {
                this.mesh.faces.push(*face);
                this.colors.push(mark.map_or(PLAIN, Mark::color));
            }
        }
        let width = LINE * mesh.bounds().diagonal();
        for (edge, mark) in &marks.edges {
            if edge.iter().all(finite) {
                this.line(edge.map(|v| mesh.positions[v.index()]), width, mark.color());
            }
        }
        for (vertex, mark) in marks.vertices.iter().filter(|(vertex, _)| finite(vertex)) {
            let [x, y, z] = mesh.positions[vertex.index()];
            let reach = 2.0 * width;
            this.line([[x, y - reach, z], [x, y + reach, z]], reach, mark.color());
        }
        this
    }

    /// Renders the mesh with its marks.
    ///
    /// # Errors
    ///
    /// The errors of [`render`].
    pub fn picture(&self, camera: &Camera) -> Result<Picture, PictureError> {
        let style = Style {
            size: SIZE,
            paint: Paint::FaceColors(&self.colors),
            normals: Normals::Flat,
            lighting: Lighting::Soft,
            background: Background::Transparent,
            ..Style::default()
        };
        render(&self.mesh, camera, &style)
    }

    /// Adds a three-sided prism around a line.
    fn line(&mut self, [a, b]: [[f64; 3]; 2], width: f64, color: [u8; 3]) {
        let along = [0, 1, 2].map(|axis| b[axis] - a[axis]);
        let first = VertexId::new(self.mesh.positions.len());
        for end in [a, b] {
            for offset in corners(along) {
                let corner = [0, 1, 2].map(|axis| end[axis] + width * offset[axis]);
                self.mesh.positions.push(corner);
            }
        }
        let v = |i: u32| VertexId(first.0 + i);
        for i in 0..3 {
            let j = (i + 1) % 3;
            self.mesh.faces.push([v(i), v(j), v(3 + j)]);
            self.mesh.faces.push([v(i), v(3 + j), v(3 + i)]);
            self.colors.extend([color; 2]);
        }
    }
}

/// Returns three unit vectors across a line, a third of a turn apart.
fn corners(along: [f64; 3]) -> [[f64; 3]; 3] {
    let least = (0..3).min_by(|&i, &j| along[i].abs().total_cmp(&along[j].abs())).unwrap_or(0);
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let across = unit(cross(along, axis));
    let up = unit(cross(along, across));
    let half_sqrt_3 = 0.75_f64.sqrt();
    [(1.0, 0.0), (-0.5, half_sqrt_3), (-0.5, -half_sqrt_3)]
        .map(|(x, y)| [0, 1, 2].map(|i| x * across[i] + y * up[i]))
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

/// Normalizes a vector; the zero vector stays zero.
fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 { v.map(|x| x / length) } else { [0.0; 3] }
}

//! Densities of triangles, by which the client chooses a level.
//!
//! The client shows the finest level whose density, divided by the share of the screen that the box
//! of a primitive takes, is below 200,000: "the desired max amount of triangles on screen when the
//! mesh is filling the screen". Triangles divided by area are such a number only for a primitive
//! whose box is one unit long: a scan in millimetres would have a millionth of its density in
//! metres. So area is measured in squares of the longest side of the box: the density is that of
//! the triangles on the screen when the box fills it, whatever the unit.

use meshlod_mesh::Mesh;

/// Returns the density of one triangle on each primitive of a mesh, given by its faces; 1 where
/// there is no area.
pub(crate) fn of_one_triangle(mesh: &Mesh, primitives: &[Vec<u32>]) -> Vec<f64> {
    primitives.iter().map(|faces| one_over_area(mesh, faces)).collect()
}

fn one_over_area(mesh: &Mesh, faces: &[u32]) -> f64 {
    let (mut min, mut max) = ([f64::MAX; 3], [f64::MIN; 3]);
    let mut area = 0.0;
    for &face in faces {
        let [a, b, c] = mesh.faces[face as usize].map(|v| mesh.positions[v.index()]);
        for point in [a, b, c] {
            for axis in 0..3 {
                min[axis] = min[axis].min(point[axis]);
                max[axis] = max[axis].max(point[axis]);
            }
        }
        let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
        let cross =
            [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        area += 0.5 * cross.map(|x| x * x).iter().sum::<f64>().sqrt();
    }
    let side = (0..3).map(|axis| max[axis] - min[axis]).fold(0.0, f64::max);
    let density = side * side / area;
    if density.is_finite() && density > 0.0 { density } else { 1.0 }
}

/// Rounds a density to six digits, which is plenty, and shorter.
pub(crate) fn rounded(density: f64) -> f64 {
    format!("{density:.5e}").parse().unwrap_or(density)
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::cube;

    use super::*;

    #[test]
    fn the_unit_does_not_matter() {
        let all = vec![(0..12).collect::<Vec<u32>>(), vec![]];
        let mut mesh = cube();
        let density = of_one_triangle(&mesh, &all);
        assert!((density[0] - 1.0 / 6.0).abs() < 1e-12, "a cube has six sides: {density:?}");
        assert_eq!(density[1], 1.0);
        mesh.positions.iter_mut().for_each(|point| *point = point.map(|x| 1000.0 * x));
        assert!((of_one_triangle(&mesh, &all)[0] - density[0]).abs() < 1e-12);
    }

    #[test]
    fn six_digits_are_left() {
        assert_eq!(rounded(123456.789), 123457.0);
        assert_eq!(rounded(0.0), 0.0);
    }
}

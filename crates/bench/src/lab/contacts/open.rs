//! Finds open edges of a simplified mesh that its input does not have.

use meshlod::mesh::{Mesh, VertexId};
use meshlod::simplify::History;

/// Bit pattern of a position; 0 and -0 are equal.
type Place = [u64; 3];

/// A side of a face: the two positions it runs between, and its vertices.
type Run = ([Place; 2], [VertexId; 2]);

/// Lists the face sides that no other face traverses in the opposite direction between the same
/// positions, in any component; duplicates are listed once.
pub fn open_sides(mesh: &Mesh) -> Vec<[VertexId; 2]> {
    let ends = mesh.faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let place = |v: VertexId| place(mesh.positions[v.index()]);
    let runs = ends.map(|[a, b]| ([place(a), place(b)], [a, b]));
    let mut runs: Vec<Run> = runs.filter(|([a, b], _)| a != b).collect();
    runs.sort_unstable();
    runs.dedup_by_key(|(places, _)| *places);
    let runs_back = |[a, b]: [Place; 2]| runs.binary_search_by_key(&[b, a], |run| run.0).is_ok();
    let open = runs.iter().filter(|(places, _)| !runs_back(*places));
    open.map(|&(_, ends)| ends).collect()
}

/// Counts the open sides of a simplified mesh that are not among the positions `known`.
pub fn newly_open(level: &Mesh, known: impl Iterator<Item = [[f64; 3]; 2]>) -> usize {
    let mut known: Vec<[Place; 2]> = known.map(|ends| ends.map(place)).collect();
    known.sort_unstable();
    let places = |side: &[VertexId; 2]| side.map(|v| place(level.positions[v.index()]));
    let open = open_sides(level);
    open.iter().filter(|side| known.binary_search(&places(side)).is_err()).count()
}

/// Returns, for each vertex of a mesh, the position of the vertex it was merged into by the
/// recorded contractions.
pub fn positions_after(mesh: &Mesh, history: &History) -> Vec<[f64; 3]> {
    let mut positions = mesh.positions.clone();
    for contraction in history.contractions() {
        let kept = contraction.contracted[usize::from(contraction.kept)];
        positions[kept.index()] = contraction.to;
    }
    // From last to first, so that the position of the kept vertex is known.
    for contraction in history.contractions().iter().rev() {
        let kept = contraction.contracted[usize::from(contraction.kept)];
        for v in contraction.contracted.iter() {
            positions[v.index()] = positions[kept.index()];
        }
    }
    positions
}

/// Keeps the sides that lie on one of `known` up to rounding, since cutting faces splits a side
/// into several.
pub fn lying_on(
    sides: Vec<[VertexId; 2]>,
    mesh: &Mesh,
    known: &[[[f64; 3]; 2]],
) -> Vec<[VertexId; 2]> {
    let near = ROUNDING * mesh.bounds().diagonal();
    let lies_on = |side: &[VertexId; 2]| {
        let ends = side.map(|v| mesh.positions[v.index()]);
        known.iter().any(|on| ends.iter().all(|&end| distance_squared(end, on) <= near * near))
    };
    sides.into_iter().filter(lies_on).collect()
}

/// Tolerance for cut positions, as a part of the diagonal.
const ROUNDING: f64 = 1e-9;

/// Squared distance of a point and a segment.
fn distance_squared(p: [f64; 3], [a, b]: &[[f64; 3]; 2]) -> f64 {
    let less = |p: &[f64; 3], q: &[f64; 3]| [0, 1, 2].map(|axis| p[axis] - q[axis]);
    let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let (along, to) = (less(b, a), less(&p, a));
    let t = (dot(to, along) / dot(along, along).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    let off = less(&to, &along.map(|x| t * x));
    dot(off, off)
}

fn place(position: [f64; 3]) -> Place {
    position.map(|x| (x + 0.0).to_bits())
}

#[cfg(test)]
mod tests {
    use meshlod::samples;
    use meshlod::simplify::{Options, Simplifier, Target};

    use super::*;

    /// Builds a flat grid whose left and right half are two components with coincident vertices.
    fn halves(cells: usize) -> Mesh {
        let mut mesh = Mesh::default();
        for half in 0..2 {
            let first = mesh.positions.len();
            let at = |i: usize, j: usize| VertexId::new(first + i * (cells + 1) + j);
            for (i, j) in (0..=cells).flat_map(|i| (0..=cells).map(move |j| (i, j))) {
                // A wave, so that no two edges cost the same.
                let [x, y] = [(i + half * cells) as f64, j as f64];
                mesh.positions.push([x, y, (x * 0.7).sin() + (y * 0.9).cos()]);
            }
            for (i, j) in (0..cells).flat_map(|i| (0..cells).map(move |j| (i, j))) {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                mesh.faces.extend([[a, b, c], [a, c, d]]);
            }
        }
        mesh
    }

    fn newly_open_by(locks: meshlod::mesh::Locks) -> usize {
        let mesh = halves(12);
        let options = Options { locks, ..Options::default() };
        let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
        let mut history = History::default();
        simplifier.run(Target::Ratio(0.3), &mut history).unwrap();
        let now = positions_after(&mesh, &history);
        let open = open_sides(&mesh);
        newly_open(&simplifier.level(), open.iter().map(|side| side.map(|v| now[v.index()])))
    }

    #[test]
    fn a_border_that_another_component_closes_is_not_open() {
        assert_eq!(open_sides(&halves(3)).len(), 4 * 3 + 2 * 3);
        assert!(open_sides(&samples::sphere(100)).is_empty());
    }

    #[test]
    fn what_comes_apart_is_newly_open_and_what_was_open_is_not() {
        let mesh = halves(12);
        let ties = meshlod::check::UniquePositions::of(&mesh.positions).groups(|_| true);
        let tied = meshlod::mesh::Locks { ties, ..Default::default() };
        assert_eq!(newly_open_by(tied), 0);
        assert!(newly_open_by(Default::default()) > 6);
    }

    #[test]
    fn parts_of_an_edge_lie_on_it() {
        let corners = vec![[0.0; 3], [1.0, 2.0, 3.0], [0.1, 0.2, 0.3], [0.5, 1.0, 1.6]];
        let mesh = Mesh::new(corners.clone(), vec![[0, 1, 3].map(VertexId)]);
        let sides = [[2, 1], [0, 3]].map(|side| side.map(VertexId)).to_vec();
        let on = lying_on(sides.clone(), &mesh, &[[corners[0], corners[1]]]);
        assert_eq!(on, sides[..1]);
    }
}

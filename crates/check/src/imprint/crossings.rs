//! Splits the intersection segments in a face where they cross each other.

use glam::{DVec2, DVec3};
use meshlod_mesh::{FaceId, Mesh};
use rustc_hash::FxHashMap;

use super::points::{EndPoint, IntersectionPoints, IntersectionSegment, PointId, rounding};
use crate::intersect::{orientation, project, projection_axis};

/// Distance, in multiples of the rounding error, within which two faces may place the same
/// crossing: segments that cross at narrow angles amplify the rounding of their ends.
const SPREAD: f64 = 1e4;

/// Splits intersection segments where they cross in a face. Three faces that meet at a point have a
/// single intersection point there, whichever of them is processed.
pub fn split_at_crossings(points: &mut IntersectionPoints, mesh: &Mesh) {
    let mut known: FxHashMap<[FaceId; 3], PointId> = FxHashMap::default();
    for face in points.faces() {
        let segments = std::mem::take(&mut points.inside_mut(face).segments);
        let ends = |segment: &IntersectionSegment| {
            segment.ends.map(|end| match end {
                EndPoint::Corner(v) => DVec3::from(mesh.positions[v.index()]),
                EndPoint::Point(point) => points.position(point),
            })
        };
        let positions: Vec<_> = segments.iter().map(ends).collect();
        let mut on_segments: Vec<Vec<(f64, PointId)>> = vec![Vec::new(); segments.len()];
        let triangle = mesh.triangle(mesh.faces[face.index()]);
        let rounding = rounding(&triangle);
        for Crossing { pair, along, position } in crossings(&triangle, &positions) {
            let [a, b] = pair.map(|i| &segments[i]);
            if a.other == b.other || a.ends.iter().any(|end| b.ends.contains(end)) {
                continue;
            }
            let mut three = [face, a.other, b.other];
            three.sort_unstable();
            // If two of the faces are coplanar up to rounding, the known point may be far away.
            let is_near =
                |id: &PointId| points.position(*id).distance(position) <= SPREAD * rounding;
            let point = match known.get(&three).copied().filter(is_near) {
                Some(point) => point,
                None => points.add(position, rounding),
            };
            known.insert(three, point);
            points.inside_mut(face).points.push(point);
            pair.iter().zip(along).for_each(|(&i, t)| on_segments[i].push((t, point)));
        }
        let pieces = segments.iter().zip(on_segments).flat_map(|(segment, on)| split(segment, on));
        points.inside_mut(face).segments = pieces.collect();
    }
}

/// Splits a segment at points given with their parameters.
fn split(segment: &IntersectionSegment, mut at: Vec<(f64, PointId)>) -> Vec<IntersectionSegment> {
    at.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let [first, last] = segment.ends;
    let inner = at.into_iter().map(|(_, point)| EndPoint::Point(point));
    let ends: Vec<EndPoint> = [first].into_iter().chain(inner).chain([last]).collect();
    let pieces = ends.windows(2).filter(|ends| ends[0] != ends[1]);
    pieces.map(|ends| IntersectionSegment { ends: [ends[0], ends[1]], ..*segment }).collect()
}

/// A crossing of two segments between their ends.
struct Crossing {
    /// Indices of the segments, the lower first.
    pair: [usize; 2],
    /// Parameter of the crossing on each segment.
    along: [f64; 2],
    position: DVec3,
}

/// Limit on the pairs of segments tested in a face, beyond what faces of real meshes need.
const MOST_TESTS: usize = 1 << 24;

/// Finds all proper crossings of segments in a triangle by a sweep.
fn crossings(triangle: &[DVec3; 3], segments: &[[DVec3; 2]]) -> Vec<Crossing> {
    let Some((axis, _)) = projection_axis(triangle).filter(|_| segments.len() > 1) else {
        return Vec::new();
    };
    let flat: Vec<[DVec2; 2]> =
        segments.iter().map(|ends| ends.map(|end| project(axis, end))).collect();
    let least = |i: usize| flat[i][0].x.min(flat[i][1].x);
    let greatest = |i: usize| flat[i][0].x.max(flat[i][1].x);
    let mut order: Vec<usize> = (0..segments.len()).collect();
    order.sort_by(|&i, &j| least(i).total_cmp(&least(j)).then(i.cmp(&j)));
    let pairs = order.iter().enumerate().flat_map(|(index, &i)| {
        let beside = order[index + 1..].iter().take_while(move |&&j| least(j) <= greatest(i));
        beside.map(move |&j| [i.min(j), i.max(j)])
    });
    let crossing = |pair: [usize; 2]| {
        let along = cross(pair.map(|i| flat[i]))?;
        let [from, to] = segments[pair[0]];
        Some(Crossing { pair, along, position: from + (to - from) * along[0] })
    };
    let mut found: Vec<Crossing> = pairs.take(MOST_TESTS).filter_map(crossing).collect();
    found.sort_by_key(|crossing| crossing.pair);
    found
}

/// Returns the parameters at which two segments cross; `None` if they do not cross between their
/// ends.
fn cross([[a, b], [c, d]]: [[DVec2; 2]; 2]) -> Option<[f64; 2]> {
    let [of_c, of_d] = [c, d].map(|p| orientation(a, b, p));
    let [of_a, of_b] = [a, b].map(|p| orientation(c, d, p));
    let opposite = |x: f64, y: f64| (x < 0.0 && y > 0.0) || (x > 0.0 && y < 0.0);
    (opposite(of_a, of_b) && opposite(of_c, of_d))
        .then(|| [of_a / (of_a - of_b), of_c / (of_c - of_d)])
}

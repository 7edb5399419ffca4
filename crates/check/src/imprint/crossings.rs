//! Where lines of several components cross each other in a face.

use glam::{DVec2, DVec3};
use meshlod_mesh::{FaceId, Mesh};
use rustc_hash::FxHashMap;

use super::spots::{Line, Mark, SpotId, Spots, rounding};
use crate::intersect::{open_axis, turn, without};

/// How many times as far as rounding may a crossing be where another face has it: lines that cross at
/// narrow angles spread what rounding makes of their ends.
const SPREAD: f64 = 1e4;

/// Cuts lines where they cross in a face. Three faces that meet at a point have one spot there,
/// whichever of them is looked at.
pub fn cross_lines(spots: &mut Spots, mesh: &Mesh) {
    let mut known: FxHashMap<[FaceId; 3], SpotId> = FxHashMap::default();
    for face in spots.faces() {
        let lines = std::mem::take(&mut spots.inside_mut(face).lines);
        let ends = |line: &Line| {
            line.ends.map(|mark| match mark {
                Mark::Corner(v) => DVec3::from(mesh.positions[v.index()]),
                Mark::Spot(spot) => spots.place(spot),
            })
        };
        let segments: Vec<_> = lines.iter().map(ends).collect();
        let mut on_lines: Vec<Vec<(f64, SpotId)>> = vec![Vec::new(); lines.len()];
        let triangle = mesh.triangle(mesh.faces[face.index()]);
        let rounding = rounding(&triangle);
        for Crossing { pair, along, place } in crossings(&triangle, &segments) {
            let [a, b] = pair.map(|line| &lines[line]);
            if a.other == b.other || a.ends.iter().any(|end| b.ends.contains(end)) {
                continue;
            }
            let mut three = [face, a.other, b.other];
            three.sort_unstable();
            // Where two of the faces are in one plane but for rounding, it may be anywhere else.
            let is_here = |spot: &SpotId| spots.place(*spot).distance(place) <= SPREAD * rounding;
            let spot = match known.get(&three).copied().filter(is_here) {
                Some(spot) => spot,
                None => spots.add(place, rounding),
            };
            known.insert(three, spot);
            spots.inside_mut(face).spots.push(spot);
            pair.iter().zip(along).for_each(|(&line, t)| on_lines[line].push((t, spot)));
        }
        let cut = lines.iter().zip(on_lines).flat_map(|(line, on_line)| cut_line(line, on_line));
        spots.inside_mut(face).lines = cut.collect();
    }
}

/// A line in pieces, one after the other.
fn cut_line(line: &Line, mut at: Vec<(f64, SpotId)>) -> Vec<Line> {
    at.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let marks = at.into_iter().map(|(_, spot)| Mark::Spot(spot));
    let marks: Vec<Mark> = [line.ends[0]].into_iter().chain(marks).chain([line.ends[1]]).collect();
    let pieces = marks.windows(2).filter(|ends| ends[0] != ends[1]);
    pieces.map(|ends| Line { ends: [ends[0], ends[1]], ..*line }).collect()
}

/// Two segments that cross between their ends.
struct Crossing {
    /// The lower first.
    pair: [usize; 2],
    /// The part of the way from the start of each to its end.
    along: [f64; 2],
    place: DVec3,
}

/// How many pairs of segments in a face may be looked at; it takes more lines than faces of a mesh
/// that is meant have.
const MOST_LOOKS: usize = 1 << 24;

/// All crossings of segments in a triangle, by a sweep; none that is only a touch.
fn crossings(triangle: &[DVec3; 3], segments: &[[DVec3; 2]]) -> Vec<Crossing> {
    let Some((axis, _)) = open_axis(triangle).filter(|_| segments.len() > 1) else {
        return Vec::new();
    };
    let flat: Vec<[DVec2; 2]> =
        segments.iter().map(|ends| ends.map(|end| without(axis, end))).collect();
    let least = |i: usize| flat[i][0].x.min(flat[i][1].x);
    let greatest = |i: usize| flat[i][0].x.max(flat[i][1].x);
    let mut order: Vec<usize> = (0..segments.len()).collect();
    order.sort_by(|&i, &j| least(i).total_cmp(&least(j)).then(i.cmp(&j)));
    let pairs = order.iter().enumerate().flat_map(|(place, &i)| {
        let beside = order[place + 1..].iter().take_while(move |&&j| least(j) <= greatest(i));
        beside.map(move |&j| [i.min(j), i.max(j)])
    });
    let crossing = |pair: [usize; 2]| {
        let along = cross(pair.map(|i| flat[i]))?;
        let [from, to] = segments[pair[0]];
        Some(Crossing { pair, along, place: from + (to - from) * along[0] })
    };
    let mut found: Vec<Crossing> = pairs.take(MOST_LOOKS).filter_map(crossing).collect();
    found.sort_by_key(|crossing| crossing.pair);
    found
}

/// How far along each two segments cross, if neither ends at the other.
fn cross([[a, b], [c, d]]: [[DVec2; 2]; 2]) -> Option<[f64; 2]> {
    let [of_c, of_d] = [c, d].map(|p| turn(a, b, p));
    let [of_a, of_b] = [a, b].map(|p| turn(c, d, p));
    let parts = |x: f64, y: f64| (x < 0.0 && y > 0.0) || (x > 0.0 && y < 0.0);
    (parts(of_a, of_b) && parts(of_c, of_d)).then(|| [of_a / (of_a - of_b), of_c / (of_c - of_d)])
}

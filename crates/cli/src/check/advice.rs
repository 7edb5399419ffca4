//! Advice: the meaning of each kind of finding, and what to do about it.

use meshlod::check::Kind;

use meshlod::jobs::{Grade, Group};

/// Explanation of a group of findings. Words between backticks are commands.
pub struct Advice {
    /// Description of the defect, or of what is there.
    pub about: &'static str,
    /// Command that mends it, or the case in which it may stay.
    pub remedy: &'static str,
}

/// Returns the explanation of a group of findings.
pub fn advice(group: Group) -> Advice {
    let [about, remedy] = match (group.kind, group.grade) {
        (Kind::CoincidentVertices | Kind::Contact, Grade::Touch) => touch(group.kind),
        (Kind::SelfIntersection | Kind::Contact | Kind::Crowded, _) => intersection(group.kind),
        (Kind::NonFiniteVertex | Kind::BadIndex | Kind::BadAttributes, _) => invalid(group.kind),
        _ => surface(group.kind),
    };
    Advice { about, remedy }
}

fn touch(kind: Kind) -> [&'static str; 2] {
    match kind {
        Kind::CoincidentVertices => [
            "Objects share these places, as the parts of a model may.",
            "Nothing, if they are parts: `simplify --lock-contacts` keeps them together. If they should be \
             one surface, `repair --weld 0` makes them one.",
        ],
        _ => [
            "Objects touch here and do not pass through each other, as the parts of a model may.",
            "Nothing, if that is meant: `simplify --lock-contacts` keeps them together at every level, \
             and `check --locks FILE.json` writes the locks for other programs.",
        ],
    }
}

fn intersection(kind: Kind) -> [&'static str; 2] {
    match kind {
        Kind::SelfIntersection => [
            "Faces of one object pass through each other.",
            "`repair --fuse` unites closed components that cross. A component that folds through itself \
             must be mended where it was modelled.",
        ],
        Kind::Contact => [
            "Objects pass through each other, so that faces are hidden inside.",
            "`repair --fuse` makes closed objects one surface without what is inside; \
             `simplify --lock-contacts` keeps them as they are and together.",
        ],
        _ => [
            "So many faces meet that the search for them was given up; there may be more.",
            "`repair` drops duplicate faces, which are the usual cause; then check again. Where many \
             instances overlap, check fewer at once.",
        ],
    }
}

fn invalid(kind: Kind) -> [&'static str; 2] {
    match kind {
        Kind::NonFiniteVertex => [
            "A coordinate is not a number or infinite.",
            "`repair` drops the vertex and its faces.",
        ],
        Kind::BadIndex => {
            ["A face refers to a vertex that is not there.", "`repair` drops the face."]
        }
        _ => [
            "Attributes, materials or objects do not fit the faces.",
            "`repair` drops what does not fit.",
        ],
    }
}

fn surface(kind: Kind) -> [&'static str; 2] {
    match kind {
        Kind::UnusedVertex => {
            ["No face uses the vertex.", "Nothing must be done; `repair` drops it."]
        }
        Kind::CoincidentVertices => [
            "Vertices of one object lie at exactly the same place.",
            "`--weld 0` makes them one vertex in every command that reads the mesh. `repair` sews borders \
             that lie on each other without it, and so does `simplify`.",
        ],
        Kind::DegenerateFace => {
            ["The face has no area.", "`repair` removes it and leaves no hole."]
        }
        Kind::DuplicateFace => [
            "The face has the same vertices as an earlier one.",
            "`repair` drops a copy; the two sides of a leaf get vertices of their own.",
        ],
        Kind::InconsistentEdge => [
            "The two faces of the edge are wound in opposite directions.",
            "`repair` turns faces until neighbours agree, except on one-sided surfaces.",
        ],
        Kind::BoundaryLoop => [
            "The surface ends here.",
            "Nothing, if it is meant to be open. `repair --holes N` closes holes of up to N edges, and \
             `--weld EPS` or `repair --stitch EPS` joins borders that lie near each other.",
        ],
        Kind::NonManifoldEdge => [
            "Three faces or more share the edge.",
            "`repair` divides the surface there. `simplify` does so by itself, but with `--topology keep` \
             it leaves the edge in place.",
        ],
        Kind::NonManifoldVertex => [
            "Parts of the surface hang together at this vertex only.",
            "`repair` gives each part a vertex of its own. `simplify` does so by itself, but with \
             `--topology keep` it leaves the vertex in place.",
        ],
        _ => [
            "A closed shell faces inwards.",
            "Nothing, if it is the wall of a cavity. Else `repair` turns it outwards.",
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_group_is_told_apart_and_has_a_remedy() {
        let touches = [Kind::CoincidentVertices, Kind::Contact].map(|kind| (kind, Grade::Touch));
        let others = Kind::ALL.map(|kind| (kind, Grade::Warning));
        let groups = touches.into_iter().chain(others);
        let mut abouts: Vec<_> = groups
            .map(|(kind, grade)| {
                let Advice { about, remedy } = advice(Group { kind, grade });
                assert!(remedy.contains('`') && remedy.matches('`').count() % 2 == 0, "{remedy}");
                about
            })
            .collect();
        let all = abouts.len();
        abouts.sort_unstable();
        abouts.dedup();
        assert_eq!(abouts.len(), all);
    }
}

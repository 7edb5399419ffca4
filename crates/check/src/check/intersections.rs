//! Finds self-intersections and contacts: faces that intersect elsewhere than in shared vertices
//! and edges.

use std::ops::ControlFlow;

use meshlod_mesh::FaceId;

use super::Visit;
use super::subject::Subject;
use crate::finding::Finding;
use crate::objects::ObjectId;

pub fn self_intersections(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    for (faces, [object, other]) in pairs(subject) {
        if object == other
            && let Some(intersection) =
                subject.intersecting_pairs().intersection(subject.mesh, faces)
        {
            visit(&Finding::SelfIntersection { object, faces, intersection })?;
        }
    }
    ControlFlow::Continue(())
}

pub fn contacts(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    for (mut faces, mut objects) in pairs(subject) {
        if objects[0] > objects[1] {
            faces.reverse();
            objects.reverse();
        }
        if objects[0] < objects[1]
            && let Some(intersection) =
                subject.intersecting_pairs().intersection(subject.mesh, faces)
        {
            visit(&Finding::Contact { objects, faces, intersection })?;
        }
    }
    ControlFlow::Continue(())
}

pub fn crowded(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    match subject.intersecting_pairs().complete() {
        true => ControlFlow::Continue(()),
        false => visit(&Finding::Crowded { found: subject.intersecting_pairs().pairs().len() }),
    }
}

/// Iterates over the pairs of intersecting faces with their objects.
fn pairs<'a>(subject: &'a Subject) -> impl Iterator<Item = ([FaceId; 2], [ObjectId; 2])> + 'a {
    let of_face = &subject.objects().of_face;
    let pairs = subject.intersecting_pairs().pairs().iter();
    pairs.map(|&faces| (faces, faces.map(|face| of_face[face.index()])))
}

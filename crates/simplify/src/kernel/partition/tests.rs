use meshlod_fixtures as fixtures;
use meshlod_fixtures::shape::bare;
use meshlod_mesh::{Mesh, VertexId};
use meshlod_samples as samples;

use super::*;
use crate::kernel::attributes::bare::NoAttributes;
use crate::kernel::contraction_log::Logged;
use crate::kernel::mesh::local_frame::Frame;
use crate::kernel::metric::Metric;
use crate::kernel::metric::swept_volume::SweptVolume;
use crate::kernel::schedule::bucket_queue::NONE;
use crate::kernel::setup::build_rings::Fans;
use crate::kernel::setup::vertex_order::{Order, is_face};

struct Test {
    mesh: Mesh,
    order: Order,
    partition: Partition<NoAttributes<SweptVolume>>,
}

impl Test {
    fn new(mesh: Mesh, part: usize) -> Self {
        let frame = Frame::new(&mesh, &mesh.bounds());
        let (order, places) = Order::new(&mesh, &frame);
        let face = |i: usize| order.face(&mesh.faces[i]);
        let (count, weight) = (mesh.faces.len(), SweptVolume::BOUNDARY_WEIGHT);
        let fans = Fans::new::<SweptVolume>((&places, Vec::new()), count, face, weight);
        assert!(fans.irregular.is_empty());
        let partition =
            Partition::of_at_most(part, fans.store, NoAttributes(SweptVolume), fans.faces);
        Self { mesh, order, partition }
    }

    /// Compares the faces that are left by the rings with those by the contracted input
    /// vertices.
    fn check(&mut self) {
        let live_vertices = self.partition.store.live_vertices();
        let face = |face: &[VertexId; 3]| self.order.face(face).map(|v| live_vertices[v as usize]);
        let faces = self.mesh.faces.iter().map(face);
        let mut left = faces.filter(|&face| is_face(face)).collect::<Vec<_>>();
        assert_eq!(left.len(), self.partition.live_faces);
        left.iter_mut().for_each(|face| {
            let least = (0..3).min_by_key(|&i| face[i]).unwrap();
            face.rotate_left(least);
        });
        left.sort_unstable();
        let mut ringed = Vec::new();
        for (mut collapse_loop, _) in self.partition.loops() {
            for v in collapse_loop.vertices.ids() {
                collapse_loop.vertices.refresh(v);
                let ring = collapse_loop.vertices.neighbours(v);
                if live_vertices[v as usize] != v {
                    continue;
                }
                for i in 0..ring.len() {
                    let (b, c) = (ring[i], ring[(i + 1) % ring.len()]);
                    if v < b && v < c && b != GHOST && c != GHOST {
                        ringed.push([v, b, c]);
                    }
                }
            }
        }
        ringed.sort_unstable();
        assert_eq!(ringed, left);
    }
}

fn meshes() -> [Mesh; 5] {
    [
        samples::sphere(3000),
        samples::knot(3000),
        bare(samples::terrain(3000)),
        fixtures::grid(40),
        fixtures::cone(2000),
    ]
}

#[test]
fn rings_match_the_faces_in_every_round() {
    for mesh in meshes() {
        let faces = mesh.faces.len();
        let mut test = Test::new(mesh, 100);
        assert!(test.partition.parts.len() > 4);
        test.check();
        loop {
            test.partition.round(faces / 20, NONE, None, &mut |_| ());
            test.check();
            if test.partition.parts.len() == 1 {
                break;
            }
            test.partition.merge_parts();
            test.check();
        }
        assert!(test.partition.live_faces.abs_diff(faces / 20) <= 1);
        assert!(test.partition.store.all.iter().all(|v| !v.flags.any(VertexFlags::OUTER)));
    }
}

#[test]
fn parts_cost_no_accuracy() {
    for mesh in [samples::sphere(8000), samples::knot(8000), samples::torus(8000)] {
        let faces = mesh.faces.len() / 10;
        let [one, several] = [usize::MAX, 300].map(|part| {
            let mut test = Test::new(mesh.clone(), part);
            test.partition.run(faces, NONE, None, &mut |_| ());
            let used = test.partition.store.all.iter().filter(|v| !v.flags.any(VertexFlags::DEAD));
            used.map(|v| f64::from(v.moved).sqrt()).sum::<f64>()
        });
        assert!(several < 1.05 * one, "{several} {one}");
    }
}

#[test]
fn levels_on_the_way_have_few_untouched_vertices() {
    let mut test = Test::new(samples::sphere(160_000), 20_000);
    let all = &test.partition.store.all;
    let mut untouched: Vec<bool> = all.iter().map(|v| v.flags.any(VertexFlags::OUTER)).collect();
    let mut fine = untouched.iter().filter(|&&is| is).count();
    let mut live = all.len();
    test.partition.log = Some(Steps::default());
    test.partition.run(100, NONE, None, &mut |_| ());
    assert!(fine > 500 && test.partition.live_faces <= 100);
    for done in test.partition.log.unwrap().log {
        live -= 1;
        let Logged::Contraction(done) = done else { continue };
        for v in [done.kept, done.gone] {
            fine -= usize::from(std::mem::take(&mut untouched[v as usize]));
        }
        assert!(fine < live / 4, "{fine} of {live} are as in the input");
    }
}

#[test]
fn a_target_within_a_round_is_met_and_can_be_continued() {
    let mut test = Test::new(samples::sphere(4000), 200);
    for faces in [3901, 3900, 3300, 2000, 1999, 500, 50] {
        test.partition.run(faces, NONE, None, &mut |_| ());
        test.check();
        assert!(
            test.partition.live_faces.abs_diff(faces) <= 1 && test.partition.live_faces <= faces
        );
    }
}

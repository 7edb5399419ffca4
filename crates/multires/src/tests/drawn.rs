//! Cuts as a renderer follows them: normals for every wedge, and slots whose wedges have changed.

use meshlod_mesh::{LayerKind, Mesh};
use meshlod_simplify::Method;

use super::attributes;
use super::walks::{Dice, forest, query};
use crate::{Cut, Forest, Hierarchy, Implicit, LayerFormat, SlotMesh, UpdateLimits};

/// Gives a model the normal (node, 0, 1) at each node, and checks every cut of a walk.
fn check(name: &str, mesh: &Mesh, mt: Implicit) {
    let of_nodes: Vec<[f32; 3]> =
        (0..mt.node_count()).map(|node| [node as f32, 0.0, 1.0]).collect();
    let bare = mt.clone();
    let mt = mt.with_normals(&of_nodes);
    mt.certify().unwrap();
    let of_kind = |layer: &LayerFormat<'_>| layer.kind == LayerKind::Normal;
    assert_eq!(mt.layers().filter(of_kind).count(), 1, "{name}");
    let start: usize = mt.layers().take_while(|l| !of_kind(l)).map(|layer| layer.width).sum();
    let mut values = Vec::new();
    let (mut before, mut cut) = (Cut::new(&bare), Cut::new(&mt));
    let mut dice = Dice(11);
    for _ in 0..6 {
        let query = query(&mut dice, mesh);
        before.update(&query, &UpdateLimits::default()).unwrap();
        cut.update(&query, &UpdateLimits::default()).unwrap();
        assert!(before.triangles().eq(cut.triangles()), "{name}: another cut");
        for (slot, nodes) in cut.triangles() {
            let wedges = cut.wedges(slot).unwrap();
            for (node, wedge) in nodes.into_iter().zip(wedges) {
                values.clear();
                mt.append_values(wedge, &mut values);
                assert_eq!(values[start..start + 3], of_nodes[node as usize], "{name}");
            }
        }
    }
}

#[test]
fn normals_come_to_every_wedge_and_change_no_cut() {
    let torus = meshlod_samples::torus(900);
    check("torus", &torus, Implicit::new(&forest(&torus, Method::Qem)).unwrap());
    for (name, mesh) in attributes::meshes() {
        let forest = Forest::lossless(&mesh, &Default::default()).unwrap();
        check(name, &mesh, Implicit::new(&forest).unwrap());
    }
}

#[test]
fn touched_slots_keep_a_copy_of_the_wedges() {
    for (name, mesh) in attributes::meshes() {
        let forest = Forest::lossless(&mesh, &Default::default()).unwrap();
        let model = Hierarchy::from(Implicit::new(&forest).unwrap());
        let mut cut = model.cut();
        let mut copy: Vec<_> =
            (0..cut.slot_mesh().slots() as u32).map(|slot| cut.slot_mesh().wedges(slot)).collect();
        let (mut dice, mut touched) = (Dice(4), 0);
        for _ in 0..8 {
            let limits = UpdateLimits { changes: Some((60.0 * dice.roll()) as usize), time: None };
            cut.update(&query(&mut dice, &mesh), &limits).unwrap();
            copy.resize(cut.slot_mesh().slots(), None);
            for slot in cut.slot_mesh().touched_slots() {
                copy[slot as usize] = cut.slot_mesh().wedges(slot);
                touched += 1;
            }
            assert!(
                (0..cut.slot_mesh().slots() as u32)
                    .all(|slot| copy[slot as usize] == cut.slot_mesh().wedges(slot))
            );
        }
        assert!(touched > 0, "{name}");
    }
}

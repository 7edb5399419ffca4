//! Certified models are sound, and unsound ones are not certified.

use std::collections::BTreeSet;

use meshlod_fixtures as fixtures;
use meshlod_mesh::{Mesh, VertexId};
use meshlod_samples as samples;
use meshlod_simplify::Method;

use super::walks::{Dice, METHODS, each, forest, in_forest, query, topology};
use crate::implicit::Order;
use crate::{Certificate, CertifyError, Cut, Explicit, Flaw, Implicit, Query};

#[test]
fn built_models_are_certified() {
    each(|what, _, forest| {
        let mt = Implicit::new(forest).unwrap();
        let certificate = mt.certify().unwrap_or_else(|why| panic!("{what}: {why}"));
        assert_eq!(certificate.sound + certificate.odd, mt.update_count(), "{what}");
    });
}

#[test]
fn only_non_manifold_updates_count_as_such() {
    let certify = |mesh: &Mesh, method| Implicit::new(&forest(mesh, method)).unwrap().certify();
    for method in [Method::Qem, Method::LeeJang] {
        let sound = certify(&samples::terrain(600), method).unwrap();
        assert!(sound.sound > 200 && sound.odd == 0, "{sound:?}");
    }
    let turned = certify(&fixtures::moebius(40), Method::Qem).unwrap();
    assert!(turned.odd > 0, "a strip of one side is not oriented somewhere: {turned:?}");
}

/// Changes one field of one update at a time. Models that still pass must give sound cuts only:
/// another level can be equally valid, and swapped wings give another surface without a crack.
#[test]
fn certified_models_are_sound() {
    let mesh = samples::terrain(160);
    let expected = topology(&mesh);
    let mut dice = Dice(3);
    let mut reasons = BTreeSet::new();
    let (mut passed, mut refused) = (0, 0);
    for method in [Method::Qem, Method::LeeJang, Method::LindstromTurkFaces] {
        let mt = Implicit::new(&forest(&mesh, method)).unwrap();
        assert_eq!(mt.certify(), Ok(Certificate { sound: mt.update_count(), odd: 0 }));
        for changed in (0..mt.update_count() as u32).flat_map(|update| mt.corrupted(update)) {
            if let Err(unsound) = changed.certify() {
                reasons.insert(match unsound {
                    CertifyError::Update { why, .. } => Some(why),
                    CertifyError::FullFaces { .. } | CertifyError::BaseWedges => None,
                });
                refused += 1;
                continue;
            }
            passed += 1;
            let random = [(); 3].map(|()| query(&mut dice, &mesh));
            for query in random.into_iter().chain([Query::uniform(0.0)]) {
                let level = Cut::at(&changed, &query).unwrap().level();
                assert_eq!(topology(&level.mesh()), expected, "{query:?}");
            }
        }
    }
    assert!(passed > 100 && refused > 100, "{passed} passed, {refused} were refused");
    assert!(reasons.len() >= 5, "{reasons:?}");
}

/// Both wings at one vertex give its edge a third face: at the last vertex of an open fan beside a
/// single one, which the search for edges without an opposite must not take for such an edge.
#[test]
fn one_vertex_is_not_both_wings() {
    let mesh = samples::terrain(160);
    for method in METHODS {
        let mt = Implicit::new(&forest(&mesh, method)).unwrap();
        for update in 0..mt.update_count() as u32 {
            for changed in mt.with_both_wings_at_one_vertex(update) {
                let found = changed.certify();
                let is_refused = found.is_err_and(
                    |why| matches!(why, CertifyError::Update { update: at, .. } if at == update),
                );
                assert!(is_refused, "update {update} by {}: {found:?}", method.name());
            }
        }
    }
}

/// Without its mark an update at an open fan does not wait for the last vertex of the fan.
#[test]
fn updates_at_open_fans_are_marked() {
    for mesh in [samples::terrain(160), fixtures::grid(8)] {
        for method in METHODS {
            let mt = Implicit::new(&forest(&mesh, method)).unwrap();
            let open: Vec<u32> = (0..mt.update_count() as u32).filter(|&u| mt.is_open(u)).collect();
            assert!(open.len() > 5, "{}", method.name());
            for update in open {
                let why = Flaw::NotMarkedOpen;
                let found = mt.without_open_mark(update).certify();
                assert_eq!(found, Err(CertifyError::Update { update, why }), "{}", method.name());
            }
        }
    }
}

#[test]
fn splits_without_wings_are_marked_too() {
    let mesh = damaged(samples::terrain(300), 14);
    let mt = Implicit::new(&forest(&mesh, Method::Qem)).unwrap();
    let non_fan = (0..mt.update_count() as u32).filter(|&u| mt.non_fan_split(u).is_some());
    let is_refused = |&u: &u32| match mt.without_open_mark(u).certify() {
        Err(CertifyError::Update { update, why: Flaw::NotMarkedOpen }) => update == u,
        // Where as many faces enter each edge as leave it, the mark makes no difference.
        found => found.unwrap() != mt.certify().unwrap(),
    };
    assert!(non_fan.filter(is_refused).count() > 3);
}

/// Three faces at edges of the ring, faces turned over, and vertices merged.
#[test]
fn models_of_damaged_meshes_are_certified_and_give_their_cuts() {
    for seed in 0..20 {
        for base in [samples::terrain(300), fixtures::grid(12), fixtures::moebius(60)] {
            let merged = fixtures::with_merged_vertices(&base, 1 + seed as usize, seed);
            for mesh in [merged, damaged(base, seed)] {
                let forest = forest(&mesh, METHODS[seed as usize % METHODS.len()]);
                let (order, explicit) = (Order::new(&forest), Explicit::new(&forest));
                let mt = Implicit::in_order(&forest, &order).unwrap();
                mt.certify().unwrap_or_else(|why| panic!("{seed}: {why}"));
                let mut dice = Dice(seed);
                for _ in 0..4 {
                    let query = query(&mut dice, &mesh);
                    let level = Cut::at(&mt, &query).unwrap().level();
                    let expected = explicit.extract(&query).unwrap();
                    assert_eq!(
                        in_forest(&level, &order),
                        expected.canonical(),
                        "{seed}: {query:?}"
                    );
                }
            }
        }
    }
}

/// Adds faces at edges of a mesh, and turns others over.
fn damaged(mesh: Mesh, seed: u64) -> Mesh {
    let mut dice = Dice(seed);
    let mut mesh = Mesh { attributes: None, ..mesh };
    let (faces, vertices) = (mesh.faces.len() as f64, mesh.positions.len() as f64);
    for _ in 0..seed % 15 {
        let [a, b, c] = mesh.faces[(dice.roll() * faces) as usize];
        let far = VertexId::new((dice.roll() * vertices) as usize);
        let more = [[a, b, far], [b, a, far], [b, a, c]];
        mesh.faces.push(more[(dice.roll() * 3.0) as usize]);
        if dice.roll() < 0.4 {
            mesh.faces[(dice.roll() * faces) as usize].swap(0, 1);
        }
    }
    mesh
}

#[test]
fn wrong_faces_of_non_fan_splits_are_found() {
    let mt = Implicit::new(&forest(&fixtures::moebius(60), Method::Qem)).unwrap();
    let all = mt.corrupted_non_fan();
    assert!(!all.is_empty());
    for changed in all {
        let found = changed.certify();
        assert!(matches!(found, Err(CertifyError::Update { why: Flaw::NoWing, .. })), "{found:?}");
        // An uncertified model may have cracks, but no face with missing corners.
        let level = Cut::at(&changed, &Query::uniform(0.0)).unwrap().level();
        assert!(level.mesh().validate().is_ok());
    }
}

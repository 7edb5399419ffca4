//! Certified models are sound, and unsound ones are not certified.

use std::collections::BTreeSet;

use meshlod_fixtures as fixtures;
use meshlod_mesh::Mesh;
use meshlod_samples as samples;
use meshlod_simplify::Method;

use super::walks::{Dice, each, forest, query, topology};
use crate::{Certificate, CertifyError, Cut, Flaw, Implicit, Query};

#[test]
fn built_models_are_certified() {
    each(|what, _, forest| {
        let mt = Implicit::new(forest).unwrap();
        let certificate = mt.certify().unwrap_or_else(|why| panic!("{what}: {why}"));
        assert_eq!(certificate.sound + certificate.non_manifold, mt.update_count(), "{what}");
    });
}

#[test]
fn only_non_manifold_updates_count_as_such() {
    let certify = |mesh: &Mesh, method| Implicit::new(&forest(mesh, method)).unwrap().certify();
    for method in [Method::Qem, Method::LeeJang] {
        let sound = certify(&samples::terrain(600), method).unwrap();
        assert!(sound.sound > 200 && sound.non_manifold == 0, "{sound:?}");
    }
    let turned = certify(&fixtures::moebius(40), Method::Qem).unwrap();
    assert!(turned.non_manifold > 0, "a strip of one side is not oriented somewhere: {turned:?}");
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
    for method in [Method::Qem, Method::LeeJang] {
        let mt = Implicit::new(&forest(&mesh, method)).unwrap();
        assert_eq!(mt.certify(), Ok(Certificate { sound: mt.update_count(), non_manifold: 0 }));
        for changed in (0..mt.update_count() as u32).flat_map(|update| mt.corrupted(update)) {
            if let Err(unsound) = changed.certify() {
                reasons.insert(match unsound {
                    CertifyError::Update { why, .. } => Some(why),
                    CertifyError::FullFaces { .. } => None,
                });
                refused += 1;
                continue;
            }
            passed += 1;
            for _ in 0..3 {
                let query = query(&mut dice, &mesh);
                let level = Cut::at(&changed, &query).unwrap().level();
                assert_eq!(topology(&level.mesh()), expected, "{query:?}");
            }
        }
    }
    assert!(passed > 100 && refused > 100, "{passed} passed, {refused} were refused");
    assert!(reasons.len() >= 5, "{reasons:?}");
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

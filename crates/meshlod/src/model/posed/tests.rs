use meshlod_fixtures::{folding_strip, ridged_strip, shared_mesh};
use meshlod_io::Weld;
use meshlod_measure::{CertifiedOptions, certified_distance};
use meshlod_multires::{Archive, Forest, ModelFile, Query, Storage, StoredErrors};
use meshlod_simplify::Options;

use super::*;
use crate::model::verified::extract_verified;
use crate::model::{ModelScene, PlacedScene, measured_poses, place_scene};
use crate::{Constraints, read};

/// Levels of a scene as bytes, with errors measured in its poses or without.
fn levels(scene: &Scene, posed: bool) -> (Archive<Vec<u8>>, PoseCounts) {
    let placed = place_scene(scene.clone(), &Constraints::default(), Options::default()).unwrap();
    let PlacedScene { mesh, options, rest, .. } = placed;
    let mut rest = rest.unwrap();
    let mut forest = Forest::new(&mesh, &options).unwrap();
    forest.smooth_errors();
    let poses = rest.poses(&mesh).unwrap();
    assert!(poses.notes.is_empty(), "{:?}", poses.notes);
    let counts = poses.counts;
    if posed {
        rest.note_poses(counts);
        forest.pose_by(std::sync::Arc::new(poses));
    }
    let storage = Storage { errors: StoredErrors::Measured, ..Storage::default() };
    let archive = Archive::write(&forest, &storage).unwrap().0;
    let resources = rest.resources(&archive.chunk_lengths());
    (archive.with_resources(&resources).unwrap(), counts)
}

/// The level of a file at an error, as a scene.
fn level(archive: &Archive<Vec<u8>>, error: f64) -> Scene {
    let level = archive.extract(&Query::uniform(error)).unwrap().level.mesh();
    ModelScene::read(archive).unwrap().into_scene("", level).unwrap()
}

/// Greatest distance of two scenes that are posed alike, both ways.
fn apart(a: &Scene, b: &Scene, moment: Option<Moment>) -> f64 {
    let [a, b] = [a, b].map(|scene| posed_mesh(scene, &Animator::new(scene).unwrap(), moment));
    certified_distance(&a, &b, &CertifiedOptions::default()).unwrap().symmetric().lower
}

fn scene(glb: &[u8]) -> Scene {
    meshlod_io::gltf::read(glb, &mut |_| None, Weld::Exact).unwrap()
}

#[test]
fn levels_of_a_flat_sheet_are_near_it_when_it_bends() {
    for (what, glb) in [("fold", folding_strip(100)), ("ridge", ridged_strip(100))] {
        let scene = scene(&glb);
        let (unposed, _) = levels(&scene, false);
        let (posed, counts) = levels(&scene, true);
        assert_eq!(counts, PoseCounts { measured: counts.measured, animations: 1 });
        assert_eq!(measured_poses(&posed).unwrap(), Some(counts), "{what}");
        assert_eq!(measured_poses(&unposed).unwrap(), None, "{what}");
        let error = 0.004;
        let [bare, level] = [&unposed, &posed].map(|archive| level(archive, error));
        // Not only at the times at which it was measured.
        for seconds in [0.3, 0.8, 1.0, 1.9] {
            let moment = Some(Moment { animation: 0, seconds });
            let far = apart(&scene, &level, moment);
            assert!(far <= 1.5 * error, "{what}, {seconds}: {far}");
        }
        let moment = Some(Moment { animation: 0, seconds: 1.0 });
        let far = apart(&scene, &bare, moment);
        assert!(far > 2.0 * error, "{what}: {far} without poses");
        let [all, few] = [&scene, &level].map(|scene| scene.meshes[0].mesh.faces.len());
        assert!(few < all, "{what}: {few} of {all}");
        // The check of a cut knows nothing of poses, so it must start from all errors.
        let file = ModelFile::Contractions(posed);
        let checked = extract_verified(&file, &Query::uniform(error)).unwrap().extract.level;
        assert!(checked.faces.len() >= few, "{what}");
    }
}

#[test]
fn animations_that_only_move_meshes_cost_nothing() {
    let Some(path) = shared_mesh("cesium-milk-truck.glb") else {
        println!("skipped: cesium-milk-truck.glb is not there");
        return;
    };
    let scene = read(&path, &meshlod_io::ReadOptions::default()).unwrap();
    let (posed, counts) = levels(&scene, true);
    assert_eq!(counts, PoseCounts::default());
    assert!(posed.into_source() == levels(&scene, false).0.into_source());
}

#[test]
fn levels_of_shared_models_are_near_them_while_they_move() {
    for name in ["fox.glb", "cesium-man.glb"] {
        let Some(path) = shared_mesh(name) else {
            println!("skipped: {name} is not there");
            continue;
        };
        let scene = read(&path, &meshlod_io::ReadOptions::default()).unwrap();
        let animator = Animator::new(&scene).unwrap();
        let (posed, counts) = levels(&scene, true);
        let (unposed, _) = levels(&scene, false);
        assert!((50..=64).contains(&counts.measured), "{name}: {counts:?}");
        let size = posed_mesh(&scene, &animator, None).bounds().diagonal();
        for part in [0.01, 0.03] {
            let error = part * size;
            let [level, bare] = [&posed, &unposed].map(|archive| level(archive, error));
            let (mut worst, mut without) = (0f64, 0f64);
            for animation in 0..animator.animation_count() {
                for step in 0..7 {
                    let moment = Some(Moment { animation, seconds: 0.07 + 0.17 * f64::from(step) });
                    worst = worst.max(apart(&scene, &level, moment) / error);
                    without = without.max(apart(&scene, &bare, moment) / error);
                }
            }
            let [faces, fewer] = [&level, &bare].map(|scene| scene.meshes[0].mesh.faces.len());
            println!(
                "{name} at {part}: {worst:.2} of the error in {faces} faces; without poses \
                 {without:.2} in {fewer}"
            );
            // Points are no proof, and these times were not measured.
            assert!(worst < 2.0, "{name} at {part}: {worst}");
        }
    }
}

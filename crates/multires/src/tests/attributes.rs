//! Attributes of cuts.

use std::collections::BTreeMap;

use meshlod_fixtures as fixtures;
use meshlod_mesh::{Labels, LayerKind, Mesh};
use meshlod_samples as samples;
use meshlod_simplify::{Method, Options};

use super::walks::{Dice, query};
use crate::{Archive, Cut, Forest, Implicit, Level, Model, Query, Storage, UpdateLimits};

/// Returns models with seams, creases and several materials.
pub(crate) fn meshes() -> Vec<(&'static str, Mesh)> {
    let mut two = fixtures::charted(&samples::sphere(900));
    let names = ["even", "odd"].map(String::from).to_vec();
    let of_face = |f: usize| u32::from(two.triangle(two.faces[f])[0].z > 0.2);
    let of_face = (0..two.faces.len()).map(of_face).collect();
    two.materials = Some(Labels { names, of_face });
    vec![
        ("torus", fixtures::charted(&samples::torus(800))),
        ("gyroid", fixtures::charted(&samples::gyroid(900))),
        ("two materials", two),
        ("strip", fixtures::seam_strip()),
        ("fish", samples::fish(2000)),
    ]
}

fn forests(mut check: impl FnMut(&str, &Mesh, Forest)) {
    for (name, mesh) in meshes() {
        for method in [Method::LindstromTurk, Method::Qem, Method::LeeJang, Method::QemEndpoint] {
            let options = Options { method, ..Options::default() };
            check(name, &mesh, Forest::new(&mesh, &options).unwrap());
        }
    }
}

/// Returns the corners of each face by node and wedge, in a canonical order.
fn canonical(level: &Level) -> Vec<[[u32; 2]; 3]> {
    let wedges = level.wedges.as_ref().unwrap();
    let faces = level.faces.iter().zip(&wedges.corners).map(|(face, corners)| {
        let mut face = [0, 1, 2].map(|k| [level.nodes[face[k] as usize], corners[k]]);
        let least = (0..3).min_by_key(|&k| face[k]).unwrap();
        face.rotate_left(least);
        face
    });
    let mut faces: Vec<_> = faces.collect();
    faces.sort_unstable();
    faces
}

#[test]
fn cuts_have_the_same_wedges_however_they_are_reached() {
    forests(|name, mesh, forest| {
        let model = Model::new(&forest).unwrap();
        let mt = model.implicit();
        mt.certify().unwrap();
        let (mut moving, mut extractor) = (Cut::new(mt), model.extractor());
        let mut dice = Dice(11);
        for _ in 0..12 {
            let query = query(&mut dice, mesh);
            moving.update(&query, &UpdateLimits::default()).unwrap();
            let expected = canonical(&Cut::at(mt, &query).unwrap().level());
            assert_eq!(canonical(&moving.level()), expected, "{name}: {query:?}");
            assert_eq!(canonical(extractor.exact(&query).unwrap()), expected, "{name}: {query:?}");
        }
    });
}

/// Returns the values at each corner of each face, by position, and the materials.
pub(crate) fn corner_values(mesh: &Mesh) -> BTreeMap<String, usize> {
    let mut all = BTreeMap::new();
    let attributes = mesh.attributes.as_ref().unwrap();
    for (f, (face, corners)) in mesh.faces.iter().zip(&attributes.corners).enumerate() {
        let mut corners = [0, 1, 2].map(|k| {
            let at = mesh.positions[face[k].index()];
            let values: Vec<&[f32]> = attributes.layers.iter().map(|l| l.of(corners[k])).collect();
            format!("{at:?} {values:?}")
        });
        corners.sort();
        let material = mesh.materials.as_ref().map(|labels| labels.of(f));
        *all.entry(format!("{corners:?} {material:?}")).or_insert(0) += 1;
    }
    all
}

#[test]
fn the_finest_cut_has_the_attributes_of_the_input() {
    for (name, mesh) in meshes() {
        let forest = Forest::lossless(&mesh, &Options::default()).unwrap();
        let model = Model::new(&forest).unwrap();
        let level = model.extractor().uniform(0.0).unwrap().mesh();
        level.validate().unwrap();
        assert_eq!(corner_values(&level), corner_values(&mesh), "{name}");
        let level = Cut::at(model.implicit(), &Query::uniform(0.0)).unwrap().level().mesh();
        assert_eq!(corner_values(&level), corner_values(&mesh), "{name}");
    }
}

#[test]
fn a_model_read_back_has_the_same_wedges() {
    forests(|name, mesh, forest| {
        let mt = Implicit::new(&forest).unwrap();
        let again = Model::from_implicit(&mt).unwrap();
        let tolerance = mesh.bounds().diagonal() / 100.0;
        let first = Model::new(&forest).unwrap().extractor().uniform(tolerance).unwrap().mesh();
        let second = again.extractor().uniform(tolerance).unwrap().mesh();
        assert_eq!(corner_values(&first), corner_values(&second), "{name}");
    });
}

#[test]
fn textures_do_not_tear() {
    // Where two faces of a chart meet at an edge in the input, they share its wedges; charts of
    // `charted` lie in different unit squares, so a face that mixed two would be wide.
    forests(|name, mesh, forest| {
        let Some(uvs) = mesh.attributes.as_ref().and_then(|a| a.layer(LayerKind::Uv(0))) else {
            return;
        };
        if !["torus", "gyroid"].contains(&name) || uvs.values.is_empty() {
            return;
        }
        let mt = Implicit::new(&forest).unwrap();
        let mut dice = Dice(5);
        for _ in 0..6 {
            let level = Cut::at(&mt, &query(&mut dice, mesh)).unwrap().level().mesh();
            let attributes = level.attributes.unwrap();
            for corners in &attributes.corners {
                let charts = corners.map(|w| attributes.layers[0].of(w)[0].floor());
                assert_eq!([charts[0]; 3], charts, "{name}");
            }
        }
    });
}

#[test]
fn a_file_keeps_wedges_and_values_within_bounds() {
    forests(|name, mesh, forest| {
        let storage = Storage { updates_per_chunk: 100, ..Storage::default() };
        let bytes = Archive::write(&forest, &storage).unwrap().0.into_source();
        let archive = Archive::open(bytes).unwrap();
        let (mt, _) = archive.read().unwrap();
        let plain = Implicit::new(&forest).unwrap();
        let finest = |mt: &Implicit| Cut::at(mt, &Query::uniform(0.0)).unwrap().level();
        let [was, is] = [&plain, &mt].map(|mt| finest(mt).mesh());
        is.validate().unwrap();
        assert_eq!(
            is.attributes.as_ref().unwrap().wedge_count,
            was.attributes.as_ref().unwrap().wedge_count
        );
        let count = |mesh: &Mesh| mesh.materials.as_ref().map(|m| m.of_face.iter().sum::<u32>());
        assert_eq!(count(&is), count(&was), "{name}");
        let mut dice = Dice(3);
        for _ in 0..6 {
            // What is read in part is what the whole file gives.
            let query = query(&mut dice, mesh);
            let part = archive.extract(&query).unwrap().level.mesh();
            let whole = Cut::at(&mt, &query).unwrap().level().mesh();
            assert_eq!(corner_values(&part), corner_values(&whole), "{name}: {query:?}");
        }
        let some = archive.extract_at_most(mesh.faces.len() / 4, &Query::uniform(0.0)).unwrap();
        some.level.mesh().validate().unwrap();
        assert!(some.level.wedges.is_some());
    });
}

#[test]
fn a_lossless_file_keeps_attributes_to_the_bit() {
    for (name, mesh) in meshes() {
        let forest = Forest::lossless(&mesh, &Options::default()).unwrap();
        let bytes = Archive::write(&forest, &Storage::default()).unwrap().0.into_source();
        let found = Archive::open(bytes).unwrap().extract(&Query::uniform(0.0)).unwrap();
        assert_eq!(corner_values(&found.level.mesh()), corner_values(&mesh), "{name}");
    }
}

#[test]
fn damaged_wedges_are_errors_or_sound_models() {
    let mesh = fixtures::charted(&samples::torus(150));
    let forest = Forest::new(&mesh, &Options::default()).unwrap();
    let bytes = Archive::write(&forest, &Storage::default()).unwrap().0.into_source();
    let mut dice = Dice(8);
    for _ in 0..1500 {
        let mut damaged = bytes.clone();
        let at = (dice.roll() * bytes.len() as f64) as usize;
        damaged[at] ^= 1 << (dice.roll() * 8.0) as u32;
        Archive::rewrite_checksums(&mut damaged);
        let Ok(archive) = Archive::open(damaged) else { continue };
        if let Ok((mt, _)) = archive.read() {
            let level = Cut::at(&mt, &Query::uniform(0.0)).unwrap().level().mesh();
            level.validate().unwrap();
        }
        if let Ok(found) = archive.extract(&Query::uniform(0.01)) {
            found.level.mesh().validate().ok();
        }
    }
}

//! Round trips of whole files, prefixes and queries, and the refusal of damaged files.

mod attribute_bytes;
mod attribute_memory;
mod lossless;
mod resources;
mod wrong;

use meshlod_mesh::Mesh;
use meshlod_samples as samples;
use meshlod_simplify::Method;

use super::write::{diagonal, lattice};
use super::*;
use crate::implicit::Order;
use crate::tests::walks::{Dice, each_by, forest, query, topology};
use crate::{Cut, Forest, Implicit, Level, Model, Query, UpdateLimits};

/// Options with chunks so small that even a small mesh has many.
fn small() -> Storage {
    Storage { updates_per_chunk: 20, ..Storage::default() }
}

/// Runs a check on edge contractions and on face contractions.
fn each(check: impl FnMut(&str, &Mesh, &Forest)) {
    each_by(&[Method::Qem, Method::LeeJang], check);
}

fn bytes(forest: &Forest) -> Vec<u8> {
    Archive::write(forest, &small()).unwrap().0.into_source()
}

/// Faces of a level by the positions of their corners, independent of numbering.
fn by_place(level: &Level) -> Vec<[[u32; 3]; 3]> {
    let corner = |v: u32| level.positions[v as usize].map(f32::to_bits);
    in_order(level.faces.iter().map(|face| face.map(corner)))
}

/// Sorts faces, each rotated to start at its least corner.
fn in_order<C: Ord>(faces: impl Iterator<Item = [C; 3]>) -> Vec<[C; 3]> {
    let mut faces: Vec<_> = faces.collect();
    for face in &mut faces {
        let least = (0..3).min_by(|&a, &b| face[a].cmp(&face[b])).unwrap();
        face.rotate_left(least);
    }
    faces.sort_unstable();
    faces
}

#[test]
fn a_file_gives_back_the_model() {
    each(|what, mesh, forest| {
        let lattice = lattice(forest, &small(), diagonal(forest));
        let rounded = forest.clone().quantized(lattice, StoredErrors::AsRecorded).forest;
        let rounded = Implicit::in_order(&rounded, &Order::for_file(&rounded)).unwrap();
        let (read, certificate) = Archive::open(bytes(forest)).unwrap().read().unwrap();
        assert_eq!(certificate, rounded.certify().unwrap(), "{what}");
        assert_eq!(read.bytes(), rounded.bytes(), "{what}");
        let mut dice = Dice(11);
        for _ in 0..8 {
            let query = query(&mut dice, mesh);
            let [was, is] = [&rounded, &read].map(|mt| Cut::at(mt, &query).unwrap().level());
            assert!(is.canonical() == was.canonical(), "{what}: {query:?}");
            assert!(by_place(&is) == by_place(&was), "{what}: {query:?}");
        }
    });
}

#[test]
fn what_was_read_can_be_narrow_and_answers_alike() {
    each(|what, mesh, forest| {
        let read = Archive::open(bytes(forest)).unwrap().read().unwrap().0;
        let narrow = read.compacted().unwrap_or_else(|| panic!("{what}"));
        assert_eq!(narrow.certify(), read.certify(), "{what}");
        let fewer = (40 - 22) * read.update_count() + 6 * read.root_count();
        // Allows for a table of 512 least levels and for the roots' positions.
        assert!(narrow.bytes() <= read.bytes() - fewer + 1024 + 8 * read.root_count(), "{what}");
        let [mut was, mut is] = [&read, &narrow].map(Cut::new);
        let mut dice = Dice(23);
        for _ in 0..40 {
            let query = query(&mut dice, mesh);
            for cut in [&mut was, &mut is] {
                cut.update(&query, &UpdateLimits::default()).unwrap();
            }
            assert!(is.level() == was.level(), "{what}: {query:?}");
        }
        let mut model = Model::from_implicit(&read).unwrap();
        let query = Query::uniform(0.01);
        let expected = model.extractor().exact(&query).unwrap().clone();
        assert!(model.compact(), "{what}");
        assert!(*model.extractor().exact(&query).unwrap() == expected, "{what}");
    });
}

#[test]
fn what_was_read_makes_a_model_again() {
    each(|what, mesh, forest| {
        let read = Archive::open(bytes(forest)).unwrap().read().unwrap().0;
        let model = Model::from_implicit(&read).unwrap();
        assert_eq!(model.implicit().certify(), read.certify(), "{what}");
        let mut extractor = model.extractor();
        let mut dice = Dice(11);
        for _ in 0..8 {
            let query = query(&mut dice, mesh);
            let expected = by_place(&Cut::at(&read, &query).unwrap().level());
            let cut = Cut::at(model.implicit(), &query).unwrap().level();
            assert!(by_place(&cut) == expected, "{what}: {query:?}");
            assert!(by_place(extractor.exact(&query).unwrap()) == expected, "{what}: {query:?}");
        }
    });
}

#[test]
fn a_query_reads_what_it_needs() {
    let mut spared = 0;
    each(|what, mesh, forest| {
        let archive = Archive::open(bytes(forest)).unwrap();
        let model = archive.read().unwrap().0;
        let mut dice = Dice(5);
        for _ in 0..12 {
            let query = query(&mut dice, mesh);
            let part = archive.extract(&query).unwrap();
            let whole = Cut::at(&model, &query).unwrap().level();
            assert!(by_place(&part.level) == by_place(&whole), "{what}: {query:?}");
            spared += archive.update_count() - part.updates;
        }
    });
    assert!(spared > 10_000, "{spared}");
}

#[test]
fn every_start_of_a_file_is_a_cut() {
    each(|what, mesh, forest| {
        let bytes = bytes(forest);
        let archive = Archive::open(bytes.clone()).unwrap();
        let mut faces = 0;
        for (count, end) in archive.chunk_ends().enumerate() {
            let cut_off = Archive::open(bytes[..end as usize].to_vec()).unwrap();
            assert_eq!(
                (cut_off.complete_chunks(), cut_off.chunk_count()),
                (count, archive.chunk_count())
            );
            let (model, _) = cut_off.read().unwrap_or_else(|why| panic!("{what}, {count}: {why}"));
            let finest = Cut::at(&model, &Query::uniform(0.0)).unwrap().level().mesh();
            let (is, was) = (topology(&finest), topology(mesh));
            assert!(is == was || is.is_simpler_than(&was), "{what}, {count} chunks: {is:?}");
            assert!(model.full_faces() >= faces);
            faces = model.full_faces();
            if let Some(&byte) = bytes.get(end as usize) {
                let more = Archive::open([&bytes[..end as usize], &[byte]].concat()).unwrap();
                assert_eq!(more.complete_chunks(), count, "an unfinished chunk is not there yet");
            }
        }
        assert_eq!(faces, forest.full_faces());
    });
}

/// With tens of chunks per band: an answer that stopped within a band would be fine on one side
/// only.
#[test]
fn as_much_is_read_as_it_takes() {
    let forest = forest(&samples::knot(4000), Method::Qem);
    let archive = Archive::open(bytes(&forest)).unwrap();
    let model = Model::from_implicit(&archive.read().unwrap().0).unwrap();
    let query = Query::uniform(1.0);
    let mut spared = 0;
    for faces in [0, 50, 400, 900, 1500, 2200, 3000, 9000] {
        let part = archive.extract_at_most(faces, &query).unwrap();
        let mut extractor = model.extractor();
        let whole = extractor.at_most(faces, &query).unwrap();
        assert_eq!(part.level.faces.len(), whole.faces.len());
        let least = |level: &Level, mt: &Implicit| mt.least_error_above(&level.nodes);
        let read = archive.read_chunks(part.chunks).unwrap().0;
        // Updates with equal errors may be applied in any order, but their error is determined.
        let of_part = least(&part.level, Model::from_implicit(&read).unwrap().implicit());
        assert_eq!(of_part, least(whole, model.implicit()), "{faces}");
        spared += archive.chunk_count() - part.chunks;
    }
    assert!(spared > 100, "{spared}");
}

#[test]
fn a_file_that_was_written_is_the_one_that_is_read() {
    let forest = forest(&samples::torus(800), Method::Qem);
    let written = Archive::write(&forest, &small()).unwrap().0;
    let read = Archive::open(written.source.clone()).unwrap();
    assert_eq!(read.header, written.header);
    assert_eq!(read.complete_chunks(), written.complete_chunks());
    assert!(read.chunk_ends().eq(written.chunk_ends()));
}

#[test]
fn vertices_move_as_little_as_asked() {
    let mesh = samples::torus(800);
    let forest = forest(&mesh, Method::Qem);
    for rounding in [1e-2, 1e-5] {
        let storage = Storage { rounding: Some(rounding), ..small() };
        let archive = Archive::write(&forest, &storage).unwrap().0;
        assert!(archive.rounding() <= rounding && archive.rounding() > 0.3 * rounding);
        let level = archive.extract(&Query::uniform(0.0)).unwrap().level.mesh();
        let nearest = |p: &[f64; 3]| {
            let squared = |q: &[f64; 3]| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>();
            mesh.positions.iter().map(squared).fold(f64::INFINITY, f64::min).sqrt()
        };
        let most = level.positions.iter().map(nearest).fold(0.0, f64::max);
        assert!(most <= rounding, "{most} of {rounding}");
    }
}

#[test]
fn what_is_damaged_is_refused() {
    let forest = forest(&samples::torus(300), Method::LeeJang);
    let bytes = bytes(&forest);
    let open = |bytes: &[u8]| Archive::open(bytes.to_vec()).and_then(|archive| archive.read());
    assert!(open(&bytes).is_ok());
    for at in 0..bytes.len() {
        let mut wrong = bytes.clone();
        wrong[at] ^= 1 << (at % 8);
        assert!(open(&wrong).is_err(), "a change of byte {at} is not detected");
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert!(matches!(open(&longer), Err(FileError::TrailingData { .. })));
    let base = Archive::open(bytes.clone()).unwrap().chunk_ends().next().unwrap() as usize;
    for end in 0..base {
        assert!(matches!(open(&bytes[..end]), Err(FileError::Truncated { .. } | FileError::Magic)));
    }
}

/// Malformed data with matching checksums is refused or gives sound meshes.
#[test]
fn what_is_made_to_mislead_does_no_harm() {
    let mesh: Mesh = samples::terrain(200);
    let (mut refused, mut passed) = (0, 0);
    for method in [Method::Qem, Method::LeeJang] {
        let bytes = bytes(&forest(&mesh, method));
        let mut dice = Dice(23);
        for at in 0..bytes.len() {
            let mut wrong = bytes.clone();
            wrong[at] = (256.0 * dice.roll()) as u8;
            Archive::rewrite_checksums(&mut wrong);
            let Ok(archive) = Archive::open(wrong) else {
                refused += 1;
                continue;
            };
            let _ = archive.extract(&query(&mut dice, &mesh));
            match archive.read() {
                Ok((model, _)) => {
                    passed += 1;
                    let level = Cut::at(&model, &query(&mut dice, &mesh)).unwrap().level();
                    assert!(level.positions.iter().flatten().all(|x| x.is_finite()));
                }
                Err(_) => refused += 1,
            }
        }
    }
    assert!(refused > 500 && passed > 100, "{refused} refused, {passed} passed");
}

/// On a lattice so coarse that half of the triangles would be degenerate.
#[test]
fn no_triangle_loses_its_area() {
    let mesh = samples::knot(4000);
    for method in [Method::Qem, Method::LeeJang] {
        let forest = forest(&mesh, method);
        for part in [1e-4, 1e-3, 3e-3] {
            let storage = Storage { rounding: Some(part * mesh.bounds().diagonal()), ..small() };
            let archive = Archive::write(&forest, &storage).unwrap().0;
            let model = archive.read().unwrap().0;
            let mut flat = 0;
            model.each_triangle(|nodes| {
                let [a, b, c] = nodes.map(|n| glam::DVec3::from(model.position(n)));
                flat += usize::from((b - a).cross(c - a).length_squared() == 0.0);
            });
            assert_eq!(flat, 0, "{part}");
        }
    }
}

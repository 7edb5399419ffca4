use meshlod_multires::{
    Archive, Cut, Focus, HeightField, Implicit, Level, Model, ModelFile, Query, Rtin,
    RtinExtractor, Tolerance, UpdateLimits, ViewCamera,
};

use crate::accept::accept;
use crate::models;

/// Opens a file of all levels, queries it, and walks its cuts.
pub fn run(bytes: &[u8]) {
    // With the right checksums, more mutations get past the header.
    let mut bytes = bytes.to_vec();
    models::seal(&mut bytes);
    match ModelFile::open(bytes) {
        Ok(ModelFile::Contractions(archive)) => take_parts(&archive),
        Ok(ModelFile::HeightField(field, _)) => walk_field(&field),
        Err(_) => {}
    }
}

/// Runs queries directly on an uncertified file, and walks the certified models read from it.
fn take_parts(archive: &Archive<Vec<u8>>) {
    for index in 0..archive.resource_count() {
        let _ = archive.resource(index);
    }
    let queries = queries(archive.diagonal());
    for query in &queries {
        if let Ok(taken) = archive.extract(query) {
            accept_level(&taken.level);
        }
        if let Ok(taken) = archive.extract_at_most(50, query) {
            accept_level(&taken.level);
        }
    }
    for chunks in [archive.chunk_count() / 2, archive.chunk_count()] {
        if let Ok((model, _)) = archive.read_chunks(chunks) {
            walk(&model, &queries);
        }
    }
}

/// Follows the queries back and forth.
fn walk(implicit: &Implicit, queries: &[Query<'_>]) {
    let mut cut = Cut::new(implicit);
    for query in queries.iter().chain(queries.iter().rev()) {
        let change =
            cut.update(query, &UpdateLimits::default()).expect("the query was accepted before");
        assert!(change.done, "there is all the time");
        accept_level(&cut.level());
    }
    let model = Model::from_implicit(implicit).expect("the model has a certificate");
    let mut extractor = model.extractor();
    for query in queries {
        accept_level(extractor.exact(query).expect("the query is valid"));
        for faces in [0, 1 + implicit.full_faces() / 2, usize::MAX] {
            accept_level(extractor.at_most(faces, query).expect("the query is valid"));
        }
    }
}

fn walk_field(field: &HeightField) {
    let model = Rtin::new(field);
    let is_sound = model.certify().is_ok();
    let mut extractor = RtinExtractor::new(&model);
    for query in &queries(field.bounds().diagonal()) {
        if let Ok(level) = model.level(query) {
            accept_level(&level);
        }
        if let Ok(level) = extractor.at_most(100, query) {
            accept_level(level);
        }
    }
    assert!(is_sound, "right triangles have no cracks, whatever the heights");
}

fn accept_level(level: &Level) {
    accept(&level.mesh());
}

/// Queries of all kinds, in the scale of the file.
fn queries(diagonal: f64) -> Vec<Query<'static>> {
    // At other scales directions have no length.
    let side = if (1e-100..1e100).contains(&diagonal) { diagonal } else { 1.0 };
    let camera = ViewCamera {
        eye: [side, 0.5 * side, 0.1 * side],
        look: [0.0; 3],
        up: [0.0, 0.0, 1.0],
        fov_rad: 0.8,
        viewport: [640, 480],
    };
    let near = |focus| Query { focus, tolerance: Tolerance::Uniform(0.0) };
    vec![
        Query::uniform(0.1 * side),
        near(Focus::Sphere { center: [0.0; 3], radius: 0.1 * side }),
        Query::pixels(camera, 1.0),
        near(Focus::Frustum(camera)),
        near(Focus::Point([0.5, 0.5, 0.5])),
        Query::uniform(0.0),
        Query::uniform(f64::MAX),
    ]
}

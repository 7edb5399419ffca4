//! Writes what cuts of a `.mlod` file are, for the tests of `web`: another reader has to find the same.
//!
//! `web_conformance IN.mlod OUT.json [QUERIES]`: random walks of queries, in which most move a camera a
//! little, on the whole file and on its first half, and queries that read only some of the chunks. Of
//! each the file has the answer: numbers of changes, and hashes of nodes, wedges and changed slots.

use std::error::Error;
use std::fmt::Write as _;

use meshlod_multires::{
    Archive, Focus, Hierarchy, HierarchyCut, ModelFile, Query, SlotMesh, Tolerance, UpdateLimits,
    ViewCamera,
};

type Failure = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [from, to, rest @ ..] = &arguments[..] else {
        return Err("usage: web_conformance IN.mlod OUT.json [QUERIES]".into());
    };
    let queries = rest.first().map_or(Ok(300), |count| count.parse::<usize>())?;
    let file = ModelFile::open(std::fs::read(from)?)?;
    let model = file.read()?;
    let mut random = Random(queries as u64);
    let mut out = String::from("{");
    write_model(&model, &mut out)?;
    out.push_str("\"walks\":[");
    for (at, (changes, hysteresis)) in WALKS.into_iter().enumerate() {
        out.push_str(if at > 0 { ",\n" } else { "\n" });
        let walk = Walk { chunks: None, changes, hysteresis, steps: queries / 5 };
        walk.write(&model, &mut random, &mut out)?;
    }
    if let ModelFile::Contractions(archive) = &file {
        out.push_str(",\n");
        let half = archive.chunk_count() / 2;
        let part = Hierarchy::from(archive.read_chunks(half)?.0);
        let walk = Walk { chunks: Some(half), changes: None, hysteresis: None, steps: queries / 5 };
        walk.write(&part, &mut random, &mut out)?;
        write_extracts(archive, &model, queries / 5, &mut random, &mut out)?;
    } else {
        out.push(']');
    }
    out.push('}');
    std::fs::write(to, out)?;
    Ok(())
}

/// Limits of changes, and hysteresis, of the walks on the whole file.
const WALKS: [(Option<usize>, Option<f64>); 3] =
    [(None, None), (Some(40), None), (None, Some(0.3))];

/// A sequence of queries that one cut follows.
struct Walk {
    /// Number of chunks that are there, of a part of the file.
    chunks: Option<usize>,
    changes: Option<usize>,
    hysteresis: Option<f64>,
    steps: usize,
}

impl Walk {
    fn write(
        &self,
        model: &Hierarchy,
        random: &mut Random,
        out: &mut String,
    ) -> Result<(), Failure> {
        let Self { chunks, changes, hysteresis, steps } = *self;
        let optional = |x: Option<usize>| x.map_or("null".to_owned(), |x| x.to_string());
        write!(out, "{{\"chunks\":{},\"changes\":{},", optional(chunks), optional(changes))?;
        write!(out, "\"hysteresis\":{},\"steps\":[", hysteresis.unwrap_or(0.0))?;
        let mut cut = model.cut();
        // Height fields have none.
        if let HierarchyCut::Contractions(cut) = &mut cut {
            cut.set_hysteresis(hysteresis)?;
        }
        let mut path = Path::around(model);
        let limits = UpdateLimits { changes, time: None };
        for step in 0..steps {
            let query = path.next(random);
            let change = cut.update(&query, &limits)?;
            out.push_str(if step > 0 { ",\n" } else { "\n" });
            write!(out, "{{{},\"change\":", described(&query))?;
            let done = u32::from(change.done);
            write!(out, "[{},{},{},{done}],", change.splits, change.merges, change.inspected)?;
            write_mesh(cut.slot_mesh(), out)?;
        }
        out.push_str("]}");
        Ok(())
    }
}

/// Writes the faces of a mesh, and hashes of its slots, their wedges and their changes.
fn write_mesh(mesh: &dyn SlotMesh, out: &mut String) -> Result<(), Failure> {
    let (mut slots, mut wedges, mut patches) = (Hash::new(), Hash::new(), Hash::new());
    for slot in 0..mesh.slots() as u32 {
        slots.add_all(&mesh.triangle(slot).unwrap_or([u32::MAX; 3]));
        wedges.add_all(&mesh.wedges(slot).unwrap_or([u32::MAX; 3]));
    }
    mesh.patches().for_each(|patch| {
        patches.add(patch.slot);
        patches.add_all(&patch.old.unwrap_or([u32::MAX; 3]));
        patches.add_all(&patch.new.unwrap_or([u32::MAX; 3]));
    });
    let (faces, vertices) = (mesh.face_count(), mesh.vertex_count());
    write!(out, "\"faces\":{faces},\"vertices\":{vertices},")?;
    write!(out, "\"slots\":{},\"wedges\":{},\"patches\":{}}}", slots.0, wedges.0, patches.0)?;
    Ok(())
}

/// Writes hashes of the positions and attributes of all levels.
fn write_model(model: &Hierarchy, out: &mut String) -> Result<(), Failure> {
    let mut positions = Hash::new();
    for node in 0..model.node_count() as u32 {
        model.position(node).iter().for_each(|x| positions.add_f64(*x));
    }
    write!(out, "\"nodes\":{},\"positions\":{},", model.node_count(), positions.0)?;
    write!(out, "\"most\":{},", model.most_faces())?;
    if let Hierarchy::Contractions(mt) = model {
        let (mut values, mut labels, mut row) = (Hash::new(), Hash::new(), Vec::new());
        for wedge in 0..mt.wedge_count() as u32 {
            row.clear();
            mt.append_values(wedge, &mut row);
            row.iter().for_each(|x| values.add(x.to_bits()));
            labels.add(mt.material_of(wedge).unwrap_or(u32::MAX));
            labels.add(mt.object_of(wedge).unwrap_or(u32::MAX));
        }
        write!(out, "\"allWedges\":{},", mt.wedge_count())?;
        write!(out, "\"values\":{},\"labels\":{},", values.0, labels.0)?;
    }
    Ok(())
}

/// Writes queries that are answered from the chunks that they need.
fn write_extracts(
    archive: &Archive<Vec<u8>>,
    model: &Hierarchy,
    count: usize,
    random: &mut Random,
    out: &mut String,
) -> Result<(), Failure> {
    out.push_str("],\"extracts\":[");
    let mut path = Path::around(model);
    for at in 0..count {
        let query = path.somewhere(random);
        let answer = archive.extract(&query)?;
        let mut faces = Hash::new();
        let nodes = &answer.level.nodes;
        answer.level.faces.iter().flatten().for_each(|&at| faces.add(nodes[at as usize]));
        out.push_str(if at > 0 { ",\n" } else { "\n" });
        write!(out, "{{{},\"chunks\":{},", described(&query), answer.chunks)?;
        write!(out, "\"bytes\":{},\"faces\":{}", answer.bytes, answer.level.faces.len())?;
        write!(out, ",\"nodes\":{}}}", faces.0)?;
    }
    out.push(']');
    Ok(())
}

/// A camera that moves around a model, and other queries now and then.
struct Path {
    center: [f64; 3],
    diagonal: f64,
    angle: f64,
    distance: f64,
    pixels: f64,
    fov_rad: f64,
    last: Query<'static>,
}

impl Path {
    fn around(model: &Hierarchy) -> Self {
        let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for node in 0..model.node_count() as u32 {
            for (k, x) in model.position(node).into_iter().enumerate() {
                (min[k], max[k]) = (min[k].min(x), max[k].max(x));
            }
        }
        let side = |k: usize| max[k] - min[k];
        let diagonal = (0..3).map(|k| side(k) * side(k)).sum::<f64>().sqrt();
        let center = [0, 1, 2].map(|k| 0.5 * (min[k] + max[k]));
        let last = Query::uniform(diagonal);
        Self { center, diagonal, angle: 0.0, distance: 1.5, pixels: 2.0, fov_rad: 0.8, last }
    }

    /// Mostly moves the camera a little; else another query, or the last one again.
    fn next(&mut self, random: &mut Random) -> Query<'static> {
        let roll = random.next();
        if roll > 0.25 {
            self.angle += 0.05 * random.next();
            self.distance = (self.distance + 0.1 * (random.next() - 0.5)).clamp(0.1, 3.0);
            self.last = Query::pixels(self.camera(), self.pixels);
        } else if roll > 0.1 {
            self.last = self.somewhere(random);
        } else if roll > 0.05 {
            self.pixels = 0.2 + 6.0 * random.next();
            self.fov_rad = 0.3 + random.next();
            self.last = Query::pixels(self.camera(), self.pixels);
        }
        self.last.clone()
    }

    /// A query of any kind.
    fn somewhere(&mut self, random: &mut Random) -> Query<'static> {
        let mut point = || {
            let x = [random.next(), random.next(), random.next()];
            [0, 1, 2].map(|k| self.center[k] + 0.8 * self.diagonal * (x[k] - 0.5))
        };
        let (a, b) = (point(), point());
        let [low, high] = [f64::min, f64::max].map(|of| [0, 1, 2].map(|k| of(a[k], b[k])));
        self.angle += random.next();
        let camera = self.camera();
        let focus = match (8.0 * random.next()) as u32 {
            0 => Focus::Everything,
            1 => Focus::Point(a),
            2 => Focus::Segment([a, b]),
            3 => Focus::Box([low, high]),
            4 => Focus::Sphere { center: a, radius: 0.2 * self.diagonal * random.next() },
            _ => Focus::Frustum(camera),
        };
        let tolerance = match (6.0 * random.next()) as u32 {
            0 => Tolerance::Uniform(0.0),
            1 | 2 => Tolerance::Uniform(0.01 * self.diagonal * random.next()),
            _ => Tolerance::Pixels { camera, pixels: 4.0 * random.next() },
        };
        Query { focus, tolerance }
    }

    fn camera(&self) -> ViewCamera {
        let (away, [x, y, z]) = (self.distance * self.diagonal, self.center);
        let (sin, cos) = self.angle.sin_cos();
        ViewCamera {
            eye: [x + away * cos, y + 0.4 * away, z + away * sin],
            look: self.center,
            up: [0.0, 1.0, 0.0],
            fov_rad: self.fov_rad,
            viewport: [1280, 720],
        }
    }
}

/// Writes a query as fields of JSON.
fn described(query: &Query<'_>) -> String {
    let focus = match &query.focus {
        Focus::Everything => "null".to_owned(),
        Focus::Point(at) => format!("{{\"point\":{at:?}}}"),
        Focus::Segment(ends) => format!("{{\"segment\":{ends:?}}}"),
        Focus::Box(corners) => format!("{{\"box\":{corners:?}}}"),
        Focus::Sphere { center, radius } => {
            format!("{{\"sphere\":{{\"center\":{center:?},\"radius\":{radius:?}}}}}")
        }
        Focus::Frustum(camera) => format!("{{\"frustum\":{}}}", described_camera(camera)),
        Focus::Ground(_) => unreachable!("no walk has it"),
    };
    let tolerance = match &query.tolerance {
        Tolerance::Uniform(most) => format!("{most:?}"),
        Tolerance::Pixels { camera, pixels } => {
            format!("{{\"pixels\":{pixels:?},\"camera\":{}}}", described_camera(camera))
        }
        _ => unreachable!("no walk has it"),
    };
    format!("\"focus\":{focus},\"tolerance\":{tolerance}")
}

fn described_camera(camera: &ViewCamera) -> String {
    let ViewCamera { eye, look, up, fov_rad, viewport } = camera;
    format!(
        "{{\"eye\":{eye:?},\"look\":{look:?},\"up\":{up:?},\"fov\":{fov_rad:?},\"viewport\":{viewport:?}}}"
    )
}

/// Numbers from 0 to 1, the same in each run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1u64 << 24) as f64
    }
}

/// Hash of words: FNV-1a with words in place of bytes.
struct Hash(u32);

impl Hash {
    fn new() -> Self {
        Self(0x811C_9DC5)
    }

    fn add(&mut self, word: u32) {
        self.0 = (self.0 ^ word).wrapping_mul(0x0100_0193);
    }

    fn add_all(&mut self, words: &[u32]) {
        words.iter().for_each(|&word| self.add(word));
    }

    fn add_f64(&mut self, x: f64) {
        let bits = x.to_bits();
        self.add_all(&[bits as u32, (bits >> 32) as u32]);
    }
}

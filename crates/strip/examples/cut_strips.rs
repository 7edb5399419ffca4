//! Strips of textured cuts along two walks, beside strips built anew: what they send per triangle.
//!
//! `cargo run --release -p meshlod-strip --example cut_strips -- spot.obj duck.glb`, with meshes of
//! the shared folder. `--thorough` in front repairs with [`StripEffort::Thorough`], `--endpoint`
//! builds the model from half-edge contractions, and `--bare` leaves attributes and materials out.
//! docs/notes/strips.md has the figures.

use meshlod_fixtures::shared_mesh;
use meshlod_mesh::{Bounds, Mesh};
use meshlod_multires::{Cut, Forest, Model, Query, QueryError, SlotMesh, UpdateLimits, ViewCamera};
use meshlod_simplify::{Method, Options};
use meshlod_strip::{
    CutStrips, StripEffort, StripIndices, StripOptions, StripQuality, StripStatistics, stripify,
};

/// Sizes of cuts, in percent of the faces.
const SIZES: [usize; 5] = [100, 50, 25, 10, 1];

/// Frames of a quarter of an orbit.
const FRAMES: u32 = 60;

/// Halvings of the range in which a tolerance is searched for.
const HALVINGS: usize = 30;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (flags, names): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|argument| argument.starts_with("--"));
    let has = |name: &str| flags.iter().any(|flag| flag == name);
    let effort = if has("--thorough") { StripEffort::Thorough } else { StripEffort::Quick };
    let method = if has("--endpoint") { Method::QemEndpoint } else { Method::LindstromTurk };
    println!(
        "Sent per triangle: vertices, and indices with restarts. The most is in vertices, the"
    );
    println!("buffer in entries. Changes and entries rewritten are those of a step.\n");
    println!(
        "| mesh | walk | % | triangles | followed | fast | best | most | buffer | changes | rewritten |"
    );
    println!("|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
    for name in &names {
        let Some(path) = shared_mesh(name) else { continue };
        let mut mesh = meshlod_io::read(&path, &Default::default())?.flatten();
        if has("--bare") {
            mesh = Mesh::new(mesh.positions, mesh.faces);
        }
        let mut forest = Forest::new(&mesh, &Options { method, ..Options::default() })?;
        forest.smooth_errors();
        let model = Model::new(&forest)?;
        levels(name, &model, mesh.bounds().diagonal(), effort)?;
        for size in SIZES {
            orbit(name, &model, (size, &mesh.bounds()), effort)?;
        }
    }
    Ok(())
}

/// Goes from all faces to the coarsest size and back by hundredths, and reports on the way back.
fn levels(name: &str, model: &Model, diagonal: f64, effort: StripEffort) -> Result<(), QueryError> {
    let full = model.implicit().full_faces();
    let mut extractor = model.extractor();
    let mut tolerance = |percent: usize| {
        smallest(diagonal, |tolerance| {
            Ok(extractor.uniform(tolerance)?.faces.len() <= full * percent / 100)
        })
    };
    let mut walker = Walker::new(model, &Query::uniform(0.0), effort)?;
    for percent in (SIZES[4]..100).rev() {
        walker.go(&Query::uniform(tolerance(percent)?))?;
    }
    walker.report(name, "down and up", SIZES[4]);
    for percent in SIZES[4] + 1..=100 {
        walker.go(&Query::uniform(tolerance(percent)?))?;
        if SIZES.contains(&percent) {
            walker.report(name, "down and up", percent);
        }
    }
    Ok(())
}

/// Goes a quarter around the model at a tolerance in pixels that shows a part of the faces at first.
fn orbit(
    name: &str,
    model: &Model,
    (percent, bounds): (usize, &Bounds),
    effort: StripEffort,
) -> Result<(), QueryError> {
    let (mt, center) = (model.implicit(), bounds.center());
    let camera = |frame: u32| {
        let (sin, cos) = (f64::from(frame) / f64::from(FRAMES) * 1.57).sin_cos();
        let away = bounds.diagonal();
        ViewCamera {
            eye: [center[0] + away * sin, center[1] + 0.3 * away, center[2] + away * cos],
            look: center,
            up: [0.0, 1.0, 0.0],
            fov_rad: 0.8,
            viewport: [1920, 1080],
        }
    };
    let pixels = smallest(1000.0, |pixels| {
        let cut = Cut::at(mt, &Query::pixels(camera(0), pixels))?;
        Ok(cut.face_count() <= mt.full_faces() * percent / 100)
    })?;
    let mut walker = Walker::new(model, &Query::pixels(camera(0), pixels), effort)?;
    for frame in 1..=FRAMES {
        walker.go(&Query::pixels(camera(frame), pixels))?;
    }
    walker.report(name, "orbit", percent);
    Ok(())
}

/// Returns the smallest value up to `most` that is enough, within a part in thousands.
fn smallest(
    most: f64,
    mut is_enough: impl FnMut(f64) -> Result<bool, QueryError>,
) -> Result<f64, QueryError> {
    if is_enough(0.0)? {
        return Ok(0.0);
    }
    let [mut low, mut high] = [(most * 1e-9).ln(), most.ln()];
    for _ in 0..HALVINGS {
        let middle = (low + high) / 2.0;
        *(if is_enough(middle.exp())? { &mut high } else { &mut low }) = middle;
    }
    Ok(high.exp())
}

/// A cut with its strips.
struct Walker<'m> {
    model: &'m Model,
    cut: Cut<'m>,
    strips: CutStrips,
    indices: StripIndices,
    /// Vertices sent per triangle where they were most, changes, and entries of the index buffers
    /// rewritten, since the last report.
    most: f64,
    changes: usize,
    rewritten: usize,
    steps: usize,
}

impl<'m> Walker<'m> {
    fn new(model: &'m Model, start: &Query<'_>, effort: StripEffort) -> Result<Self, QueryError> {
        let cut = Cut::at(model.implicit(), start)?;
        let mut strips = CutStrips::new(model.implicit(), &cut, &StripOptions::default(), effort);
        let indices = strips.indices(model.implicit());
        Ok(Self { model, cut, strips, indices, most: 0.0, changes: 0, rewritten: 0, steps: 0 })
    }

    fn go(&mut self, query: &Query<'_>) -> Result<(), QueryError> {
        self.cut.update(query, &UpdateLimits::default())?;
        self.changes += self.strips.update(&self.cut);
        self.strips.update_indices(self.model.implicit(), &mut self.indices);
        let changed = (0..self.indices.sets()).flat_map(|set| self.indices.changed(set));
        self.rewritten += changed.map(ExactSizeIterator::len).sum::<usize>();
        self.steps += 1;
        let sent = self.strips.strips().vertices().len() as f64;
        self.most = self.most.max(sent / self.cut.face_count().max(1) as f64);
        Ok(())
    }

    fn report(&mut self, name: &str, walk: &str, percent: usize) {
        let Self { model, cut, strips, .. } = self;
        assert_eq!(strips.difference(model.implicit(), cut), Default::default(), "{name}");
        let count = cut.face_count();
        let corners = |(slot, nodes)| cut.wedges(slot).unwrap_or(nodes);
        let faces: Vec<_> =
            cut.triangles().map(|triangle| corners(triangle).map(|i| strips.vertex(i))).collect();
        let anew = |quality| stripify(&faces, &StripOptions { quality, ..StripOptions::default() });
        let sent = [strips.strips(), anew(StripQuality::Fast), anew(StripQuality::QUICK)];
        let [followed, fast, best] = sent.map(|strips| {
            let sent = StripStatistics::new(&strips);
            let per_triangle = |entries: usize| entries as f64 / count.max(1) as f64;
            let [vertices, indices] =
                [sent.vertices_sent, sent.indices_with_restart].map(per_triangle);
            format!("{vertices:.3} {indices:.3}")
        });
        let entries = (0..self.indices.sets()).map(|set| self.indices.indices(set).len());
        let buffer = entries.sum::<usize>() as f64 / count.max(1) as f64;
        let [changes, rewritten] =
            [self.changes, self.rewritten].map(|sum| sum / self.steps.max(1));
        let most = self.most;
        println!(
            "| {name} | {walk} | {percent} | {count} | {followed} | {fast} | {best} | {most:.3} | {buffer:.3} | {changes} | {rewritten} |"
        );
        (self.most, self.changes, self.rewritten, self.steps) = (0.0, 0, 0, 0);
    }
}

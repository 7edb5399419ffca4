//! Measures the number of vertices that triangle strips send at each level.

use meshlod::mesh::VertexId;
use meshlod::strip::{
    Difference, Filter, MergeTree, SkipStrip, StripEffort, StripOptions, StripQuality,
    StripStatistics, Strips, difference, stripify,
};

use crate::peer::meshopt_strips;

/// Triangle strips of the full-resolution mesh, from which those of all levels are derived.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Base {
    Meshopt,
    Fast,
    Best,
}

pub const BASES: [Base; 3] = [Base::Meshopt, Base::Fast, Base::Best];

impl Base {
    pub fn name(self) -> &'static str {
        match self {
            Self::Meshopt => "meshoptimizer",
            Self::Fast => "`fast`",
            Self::Best => "`best`",
        }
    }

    pub fn strips(self, faces: &[[VertexId; 3]]) -> Strips {
        match self {
            Self::Meshopt => meshopt_strips(faces),
            Self::Fast => of_quality(faces, StripQuality::Fast),
            Self::Best => best(faces),
        }
    }
}

/// A mesh and its recorded contractions, with the vertices that rebuilt strips send.
pub struct Model {
    name: &'static str,
    tree: MergeTree,
    /// Vertices sent by strips rebuilt at each level, from a tenth of the faces to all.
    anew: [usize; 10],
}

impl Model {
    pub fn new(file: &'static str, tree: MergeTree) -> Self {
        let anew = std::array::from_fn(|tenth| {
            let contractions = contractions_to(&tree, 10 * (tenth + 1));
            best(&tree.level(contractions)).vertices().len()
        });
        Self { name: file.split('.').next().unwrap_or(file), tree, anew }
    }
}

/// Vertices that triangle strips of a model send, at ten levels from a tenth of its faces to all.
pub struct Levels {
    model: &'static str,
    levels: Vec<SentLevel>,
}

/// Vertices that triangle strips send at one level.
pub struct SentLevel {
    pub percent: usize,
    pub triangles: usize,
    /// Number of vertices sent with STSS, DTFF, quick repair, thorough repair, and rebuilt strips.
    pub sent: [usize; 5],
    /// Number of strips by DTFF that begin odd, each of which costs a vertex; [KY05] counts none.
    pub odd_starts: usize,
}

impl Levels {
    /// Measures the strips at all levels of a model.
    ///
    /// # Panics
    /// If strips do not draw exactly the triangles of a level.
    pub fn of(model: &Model, base: Base) -> Self {
        let mut skip = SkipStrip::new(model.tree.clone(), base.strips(model.tree.faces()));
        let levels =
            (1..).zip(&model.anew).map(|(tenth, &anew)| level(&mut skip, 10 * tenth, anew));
        Self { model: model.name, levels: levels.collect() }
    }

    pub fn model(&self) -> &'static str {
        self.model
    }

    pub fn levels(&self) -> &[SentLevel] {
        &self.levels
    }

    /// Returns the number of vertices sent per triangle of the full-resolution mesh.
    pub fn of_mesh(&self) -> f64 {
        self.levels.last().map_or(0.0, |level| level.each(0))
    }

    /// Returns the mean percentage of vertices saved relative to STSS, by DTFF, quick repair,
    /// thorough repair and rebuilt strips.
    pub fn saved(&self) -> [f64; 4] {
        let saved = |way: usize, level: &SentLevel| {
            100.0 * (1.0 - level.sent[way] as f64 / level.sent[0] as f64)
        };
        [1, 2, 3, 4].map(|way| {
            self.levels.iter().map(|level| saved(way, level)).sum::<f64>()
                / self.levels.len() as f64
        })
    }

    /// Returns the largest number of vertices per triangle at any level, for STSS, DTFF, quick
    /// repair and thorough repair.
    pub fn most(&self) -> [f64; 4] {
        [0, 1, 2, 3].map(|way| self.levels.iter().map(|level| level.each(way)).fold(0.0, f64::max))
    }

    /// Formats the measurements of all levels as table rows.
    pub fn rows(&self) -> impl Iterator<Item = Vec<String>> + '_ {
        self.levels.iter().map(|level| {
            let mut row = vec![format!("{} %", level.percent), level.triangles.to_string()];
            row.extend((0..5).map(|way| format!("{:.3}", level.each(way))));
            row.extend([1, 3].map(|way| format!("{:.1}", level.over_independent(way))));
            row.push(format!("{:.1}", level.as_published()));
            row
        })
    }
}

impl SentLevel {
    /// Returns the number of vertices sent per triangle, with the strips of this column of `sent`.
    pub fn each(&self, way: usize) -> f64 {
        self.sent[way] as f64 / self.triangles as f64
    }

    /// Returns the percentage of vertices saved relative to sending independent triangles.
    pub fn over_independent(&self, way: usize) -> f64 {
        100.0 * (1.0 - self.each(way) / 3.0)
    }

    /// Returns the percentage that DTFF saves relative to sending independent triangles if odd
    /// starts cost nothing.
    fn as_published(&self) -> f64 {
        100.0 * (1.0 - (self.sent[1] - self.odd_starts) as f64 / (3 * self.triangles) as f64)
    }
}

fn level(skip: &mut SkipStrip, percent: usize, anew: usize) -> SentLevel {
    skip.set_level(contractions_to(skip.tree(), percent));
    let faces = skip.tree().level(skip.level());
    let ways = [
        skip.display(Filter::Stss),
        skip.display(Filter::Dtff),
        skip.repaired(StripEffort::Quick),
        skip.repaired(StripEffort::Thorough),
    ];
    let odd_starts = StripStatistics::new(&ways[1]).odd_starts;
    let [stss, dtff, quick, repair] = ways.map(|strips| {
        assert_eq!(difference(&strips, &faces), Difference::default());
        strips.vertices().len()
    });
    SentLevel {
        percent,
        triangles: faces.len(),
        sent: [stss, dtff, quick, repair, anew],
        odd_starts,
    }
}

fn contractions_to(tree: &MergeTree, percent: usize) -> usize {
    tree.contractions_to(tree.faces().len() * percent / 100)
}

/// Small meshes are annealed several times, so they get more moves than this.
fn best(faces: &[[VertexId; 3]]) -> Strips {
    of_quality(faces, StripQuality::Best { moves_per_face: 100.0 })
}

fn of_quality(faces: &[[VertexId; 3]], quality: StripQuality) -> Strips {
    stripify(faces, &StripOptions { quality, ..StripOptions::default() })
}

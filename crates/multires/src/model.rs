//! All that the several ways to extract a mesh want, of one forest.

use std::sync::OnceLock;

use crate::cut::{CertifyError, Cut};
use crate::forest::{BuildError, Forest};
use crate::implicit::{
    Dependencies, Extractor, Faces, Implicit, Order, SaturatedBalls, SplitRule, Weight,
};
use crate::query::QueryError;

/// An [`Implicit`] model with what makes static extraction fast: the finest faces, and what updates
/// need of each other.
///
/// It never changes once it is made: any number of threads may have a [`Cut`] or an [`Extractor`] of it.
/// Where there is room for the implicit model alone, [`Cut::new`] takes that.
#[derive(Clone, Debug)]
pub struct Model {
    implicit: Implicit,
    faces: Faces,
    dependencies: Dependencies,
    /// Balls that nest, by the range of tolerances for which they do.
    saturated: Vec<SaturatedBalls>,
    /// How many faces each update brings, once somebody asks for the best of so many.
    weights: OnceLock<Vec<Weight>>,
}

/// What a [`Model`] takes in memory, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModelBytes {
    /// The implicit model, which is enough for a [`Cut`].
    pub implicit: usize,
    /// The face list.
    pub faces: usize,
    /// What updates need.
    pub dependencies: usize,
    /// The balls of all ranges that were asked for.
    pub saturated: usize,
}

impl Model {
    /// All levels of a simplification.
    ///
    /// Cost: linear.
    /// # Errors
    /// More than 2³¹ nodes: half as many vertices.
    pub fn new(forest: &Forest) -> Result<Self, BuildError> {
        Self::with_rule(forest, SplitRule::default())
    }

    /// All levels of a model that was read from a file.
    ///
    /// Cost: linear; every update is made once.
    /// # Errors
    /// One that has no certificate.
    pub fn from_implicit(implicit: &Implicit) -> Result<Self, CertifyError> {
        implicit.certify()?;
        Ok(Self::from_certified(implicit))
    }

    /// The same of one that has a certificate.
    pub(crate) fn from_certified(implicit: &Implicit) -> Self {
        Self::new(&Forest::from_implicit(implicit)).expect("its nodes were numbered before")
    }

    /// The same, whose [`Extractor`] obeys another rule. A [`Cut`] obeys the strict one in any case.
    /// # Errors
    /// As [`Model::new`].
    pub fn with_rule(forest: &Forest, rule: SplitRule) -> Result<Self, BuildError> {
        let order = Order::new(forest);
        Ok(Self {
            implicit: Implicit::in_order(forest, &order)?,
            faces: Faces::in_order(forest, &order),
            dependencies: Dependencies::in_order(forest, &order, rule),
            saturated: Vec::new(),
            weights: OnceLock::new(),
        })
    }

    /// Nests the balls for cameras with tolerances a unit of distance between these, so that
    /// [`Extractor::saturated`] answers them: `most` pixels are `most * camera.pixel()`. A range of
    /// four is good; wider ones make larger cuts. There may be many ranges, at 8 bytes an update each.
    ///
    /// Cost: linear.
    /// # Errors
    /// A range that is none.
    pub fn saturate(&mut self, slopes: [f64; 2]) -> Result<(), QueryError> {
        self.saturated.push(SaturatedBalls::new(&self.implicit, &self.dependencies, slopes)?);
        Ok(())
    }

    /// Makes the implicit model [narrow](Implicit::narrowed), if it can be; says whether it is.
    pub fn compact(&mut self) -> bool {
        let Some(compact) = self.implicit.compacted() else { return false };
        self.implicit = compact;
        true
    }

    /// A cut that follows its queries, from the base mesh.
    pub fn cut(&self) -> Cut<'_> {
        Cut::new(&self.implicit)
    }

    /// Meshes one after the other, from scratch each.
    pub fn extractor(&self) -> Extractor<'_> {
        Extractor::new(self)
    }

    /// The model without its lists.
    pub fn implicit(&self) -> &Implicit {
        &self.implicit
    }

    /// What it takes in memory.
    pub fn bytes(&self) -> ModelBytes {
        ModelBytes {
            implicit: self.implicit.bytes(),
            faces: self.faces.bytes(),
            dependencies: self.dependencies.bytes(),
            saturated: self.saturated.iter().map(SaturatedBalls::bytes).sum(),
        }
    }

    pub(crate) fn faces(&self) -> &Faces {
        &self.faces
    }

    pub(crate) fn dependencies(&self) -> &Dependencies {
        &self.dependencies
    }

    /// The balls that were nested for such a tolerance a unit of distance, and well within their
    /// range: they are tightest in its middle.
    pub(crate) fn saturated_at(&self, slope: f64) -> Option<&SaturatedBalls> {
        let inside = |balls: &&SaturatedBalls| balls.inside(slope);
        let best = self.saturated.iter().max_by(|a, b| inside(a).total_cmp(&inside(b)));
        best.filter(|balls| balls.inside(slope) >= 1.0 - 1e-9)
    }

    /// How many faces each update brings.
    pub(crate) fn weights(&self) -> &[Weight] {
        self.weights.get_or_init(|| Weight::all(&self.implicit, &self.faces))
    }
}

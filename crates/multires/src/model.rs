//! All tables that the extraction algorithms need, built from one contraction forest.

use std::sync::OnceLock;

use crate::cut::{CertifyError, Cut};
use crate::forest::{BuildError, Forest};
use crate::implicit::{
    Dependencies, Extractor, Faces, Implicit, Order, SaturatedBalls, SplitRule, Weight,
};
use crate::query::QueryError;

/// Multiresolution model for fast extraction: an [`Implicit`] model, the face list of the finest
/// mesh, and the dependencies between updates.
///
/// A model is immutable, so any number of threads can each hold a [`Cut`] or an [`Extractor`] of
/// it. Where memory is short, [`Cut::new`] works on the implicit model alone.
#[derive(Clone, Debug)]
pub struct Model {
    implicit: Implicit,
    faces: Faces,
    dependencies: Dependencies,
    /// Bounding balls that nest along dependencies, one set per range of tolerances.
    saturated: Vec<SaturatedBalls>,
    /// Number of faces created by each update, computed when a face budget is first asked for.
    weights: OnceLock<Vec<Weight>>,
}

/// Memory used by the parts of a [`Model`], in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModelBytes {
    /// Memory used by the implicit model, which is all that a [`Cut`] needs, in bytes.
    pub implicit: usize,
    /// Memory used by the face list, in bytes.
    pub faces: usize,
    /// Memory used by the dependencies between updates, in bytes.
    pub dependencies: usize,
    /// Memory used by all nested balls prepared so far, in bytes.
    pub saturated: usize,
}

impl Model {
    /// Builds a model of all levels from a recorded simplification.
    ///
    /// Cost: linear.
    /// # Errors
    /// More than 2³¹ nodes, which is half as many vertices.
    pub fn new(forest: &Forest) -> Result<Self, BuildError> {
        Self::with_rule(forest, SplitRule::default())
    }

    /// Builds a model from an implicit one, for example one that was read from a file.
    ///
    /// Cost: linear; every update is applied once.
    /// # Errors
    /// The model fails [`Implicit::certify`].
    pub fn from_implicit(implicit: &Implicit) -> Result<Self, CertifyError> {
        implicit.certify()?;
        Ok(Self::from_certified(implicit))
    }

    /// Builds a model from an implicit one that has been certified.
    pub(crate) fn from_certified(implicit: &Implicit) -> Self {
        Self::new(&Forest::from_implicit(implicit)).expect("its nodes were numbered before")
    }

    /// Builds a model whose [`Extractor`] follows the given split rule.
    ///
    /// A [`Cut`] always follows the strict one.
    /// # Errors
    /// As for [`Model::new`].
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

    /// Prepares bounding balls that nest, so that [`Extractor::saturated`] can answer camera
    /// queries over the whole model.
    ///
    /// `slopes` is the range of tolerances per unit of distance to support; a tolerance of `p`
    /// pixels has the slope `p * camera.pixel()`. A range of a factor of four works well; wider
    /// ranges give larger cuts. Call it again for further ranges, at 8 bytes per update each.
    ///
    /// Cost: linear.
    /// # Errors
    /// The range is empty, or not positive and finite.
    pub fn saturate(&mut self, slopes: [f64; 2]) -> Result<(), QueryError> {
        self.saturated.push(SaturatedBalls::new(&self.implicit, &self.dependencies, slopes)?);
        Ok(())
    }

    /// Replaces the implicit model by its [compact form](Implicit::compacted), if there is one, and
    /// returns whether it did.
    pub fn compact(&mut self) -> bool {
        let Some(compact) = self.implicit.compacted() else { return false };
        self.implicit = compact;
        true
    }

    /// Returns a cut that starts as the base mesh, ready to follow a sequence of queries.
    pub fn cut(&self) -> Cut<'_> {
        Cut::new(&self.implicit)
    }

    /// Returns an extractor, which answers each query from scratch.
    pub fn extractor(&self) -> Extractor<'_> {
        Extractor::new(self)
    }

    /// Returns the implicit model, without the extraction tables.
    pub fn implicit(&self) -> &Implicit {
        &self.implicit
    }

    /// Returns the memory used by each part of the model.
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

    /// Returns the nested balls for a tolerance of `slope` per unit of distance. Balls are tightest
    /// in the middle of their range, so the range that holds `slope` best wins.
    pub(crate) fn saturated_at(&self, slope: f64) -> Option<&SaturatedBalls> {
        let margin = |balls: &&SaturatedBalls| balls.margin(slope);
        let best = self.saturated.iter().max_by(|a, b| margin(a).total_cmp(&margin(b)));
        best.filter(|balls| balls.margin(slope) >= 1.0 - 1e-9)
    }

    /// Returns the number of faces created by each update.
    pub(crate) fn weights(&self) -> &[Weight] {
        self.weights.get_or_init(|| Weight::all(&self.implicit, &self.faces))
    }
}

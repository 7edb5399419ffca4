//! Selector: a policy and what it keeps from frame to frame.

use std::sync::Arc;

use crate::camera::FlockCamera;
use crate::flock::Flock;
use crate::levels::LevelTable;
use crate::select::impostor_tier::ImpostorTier;
use crate::select::{Budget, InstanceLevel, Policy, PolicyName, View};

/// Chooses a level for every member of a flock in every frame.
///
/// ```
/// use std::sync::Arc;
/// use meshlod_flock::levels::{ChainOptions, LevelTable, Look, ModelAxes};
/// use meshlod_flock::select::{Budget, PolicyName, Selector};
/// use meshlod_flock::{FlockCamera, Flock, School};
///
/// let options = ChainOptions { axes: ModelAxes::FISH, ..ChainOptions::default() };
/// let table = LevelTable::new(&meshlod_samples::fish(2_000), &Look::default(), &options)?;
/// let mut flock = Flock::default();
/// flock.members.push([0.0; 3], [1.0, 0.0, 0.0]);
/// flock.members.push([0.0, 0.0, -90.0], [1.0, 0.0, 0.0]);
///
/// let table = Arc::new(table);
/// let mut selector = Selector::new(PolicyName::ScreenError, table.clone());
/// let camera = FlockCamera::look_at([0.0, 0.0, 5.0], [0.0; 3], 0.8, [1920, 1080])?;
/// let levels = selector.select(&flock, &camera, &Budget::default());
///
/// let triangles = |i: usize| levels[i].level().map_or(0, |level| table.triangle_count(level));
/// assert!(triangles(0) > 4 * triangles(1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Selector {
    policy: Box<dyn Policy>,
    table: Arc<LevelTable>,
    impostors: ImpostorTier,
    levels: Vec<InstanceLevel>,
}

impl Selector {
    /// Creates a selector that follows one of the policies of this crate.
    pub fn new(policy: PolicyName, table: Arc<LevelTable>) -> Self {
        Self::with_policy(policy.policy(&table), table)
    }

    /// Creates a selector that follows any policy.
    pub fn with_policy(policy: Box<dyn Policy>, table: Arc<LevelTable>) -> Self {
        Self { policy, table, impostors: ImpostorTier::default(), levels: Vec::new() }
    }

    /// Chooses a level for every member, in the order of the members.
    ///
    /// Allocates only where the flock has grown since the frame before; with more than 16,384
    /// members, the pool of threads may allocate a little on its own. Cost: linear in the members.
    pub fn select(
        &mut self,
        flock: &Flock,
        camera: &FlockCamera,
        budget: &Budget,
    ) -> &[InstanceLevel] {
        self.select_visible(flock, camera, budget, None)
    }

    /// Chooses a level for every member that may be visible; the others are hidden.
    ///
    /// `visible` has an entry for every member, as from an occlusion test.
    ///
    /// # Panics
    /// If `visible` has fewer entries than the flock has members.
    pub fn select_visible(
        &mut self,
        flock: &Flock,
        camera: &FlockCamera,
        budget: &Budget,
        visible: Option<&[bool]>,
    ) -> &[InstanceLevel] {
        self.levels.resize(flock.members.len(), InstanceLevel::HIDDEN);
        let view = View::new(flock, camera, &self.table, budget, visible);
        self.policy.select(&view, &mut self.levels);
        for (level, _) in self.levels.iter_mut().zip(visible.unwrap_or(&[])).filter(|(_, v)| !**v) {
            *level = InstanceLevel::HIDDEN;
        }
        self.impostors.apply(&view, &mut self.levels);
        &self.levels
    }

    /// Returns the table of the levels.
    pub fn table(&self) -> &Arc<LevelTable> {
        &self.table
    }

    /// Returns the number of triangles that the last choice draws.
    pub fn triangles(&self) -> usize {
        self.levels.iter().map(|level| level.triangles(&self.table)).sum()
    }
}

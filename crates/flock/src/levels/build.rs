//! Building of the level table of a model.

use meshlod_check::{ContactPolicy, LockOptions, locks};
use meshlod_mesh::{Labels, Lock, Locks, Mesh, VertexId};
use meshlod_simplify::{Method, Options, Simplifier, SimplifyError, Target};
use meshlod_spatial::Bvh;
use rayon::prelude::*;

use crate::levels::difference::Differences;
use crate::levels::directions::{DirectionGrid, MAX_SIDE};
use crate::levels::facing::HiddenFaces;
use crate::levels::look::Look;
use crate::levels::model::{ModelAxes, in_member_frame};
use crate::levels::pool::VertexPool;
use crate::levels::table::{Chain, ChainKind, FacingLevels, Level, LevelTable, TableError};

/// Options for building a [`LevelTable`].
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct ChainOptions {
    /// Axes of the model.
    pub axes: ModelAxes,
    /// Simplification method. With [`Method::QemEndpoint`] all levels share the model's vertices,
    /// which for the sample fish are a third of those of [`Method::LindstromTurk`], and pictures
    /// differ by half as much again.
    pub method: Method,
    /// Number of triangles of a level over that of the next finer one, between .1 and .9.
    pub step: f64,
    /// Number of triangles at which a chain ends, at least 1.
    pub coarsest: usize,
    /// Number of cells along the side of the grid of directions of coarse levels, 2 to 32. Finer
    /// levels have a half, a third, a quarter or a sixth of that, where it is a whole number.
    pub directions: usize,
    /// Vertices to keep in place or to protect; `None` for those that [`meshlod_check::locks`]
    /// finds where parts of the model meet.
    pub locks: Option<Locks>,
}

impl Default for ChainOptions {
    fn default() -> Self {
        Self {
            axes: ModelAxes::default(),
            method: Method::LindstromTurk,
            step: std::f64::consts::FRAC_1_SQRT_2,
            coarsest: 12,
            directions: 24,
            locks: None,
        }
    }
}

/// Factor on the error of the side that stays fine in a chain coarsened on one side. From about 5
/// on nearly everything on the other side goes first.
const ONE_SIDE: f64 = 8.0;

impl LevelTable {
    /// Builds the chains of a model: simplifies it as a whole and side by side, and finds what each
    /// level shows and hides from every direction.
    ///
    /// Cost: O(n log n) for each of the three simplified chains, n = faces, and a picture of 128 by
    /// 128 pixels for each level of the whole chain and each of 36 directions.
    ///
    /// # Errors
    /// An invalid model or one without extent, an option out of range, and errors of the
    /// simplifier.
    pub fn new(model: &Mesh, look: &Look, options: &ChainOptions) -> Result<Self, TableError> {
        if !(0.1..=0.9).contains(&options.step) {
            let message = format!("the step must be between 0.1 and 0.9, not {}", options.step);
            return Err(TableError::Option(message));
        }
        if !(2..=MAX_SIDE).contains(&options.directions) {
            let message = format!(
                "the directions must be between 2 and {MAX_SIDE}, not {}",
                options.directions
            );
            return Err(TableError::Option(message));
        }
        let model = in_member_frame(model, &options.axes)?;
        let own_locks = || {
            locks(&model, &LockOptions { contacts: Some(ContactPolicy::Tie), ..Default::default() })
                .locks
        };
        let locks = options.locks.clone().unwrap_or_else(own_locks);
        let kinds = [ChainKind::Whole, ChainKind::LeftCoarsened, ChainKind::RightCoarsened];
        let chains: Result<Vec<_>, _> =
            kinds.into_par_iter().map(|kind| simplified(&model, kind, &locks, options)).collect();
        let mut chains = chains?;
        chains.iter_mut().for_each(|chain| chain.insert(0, model.clone()));
        let [whole, left, right]: [Vec<Mesh>; 3] =
            chains.try_into().expect("three chains are simplified");
        let differences = Differences::measure(&whole, look)?;
        let mut table = Builder::default();
        let chains = [
            table.chain(ChainKind::Whole, &whole, &whole[0]),
            table.chain(ChainKind::LeftCoarsened, &left, &whole[0]),
            table.chain(ChainKind::RightCoarsened, &right, &whole[0]),
        ];
        let facing = table.facing(&whole, options.directions);
        let count = table.levels.len();
        if count >= LevelTable::MAX_LEVELS {
            let message =
                format!("{count} levels are too many; use a larger step or fewer directions");
            return Err(TableError::Option(message));
        }
        Ok(table.finish(chains, facing, differences))
    }
}

/// Returns the levels of a chain, finest first, without the model itself.
fn simplified(
    model: &Mesh,
    kind: ChainKind,
    locks: &Locks,
    options: &ChainOptions,
) -> Result<Vec<Mesh>, SimplifyError> {
    let mut locks = locks.clone();
    locks.of_vertex.resize(model.positions.len(), Lock::Free);
    for (position, lock) in model.positions.iter().zip(&mut locks.of_vertex) {
        let stays_fine = match kind {
            ChainKind::LeftCoarsened => position[0] <= 0.0,
            ChainKind::RightCoarsened => position[0] >= 0.0,
            _ => false,
        };
        *lock = (*lock).max(if stays_fine { Lock::Protected } else { Lock::Free });
    }
    let protection = (kind != ChainKind::Whole).then_some(ONE_SIDE);
    let options_of_run =
        Options { method: options.method, locks, protection, ..Options::default() };
    let mut simplifier = Simplifier::new(model, &options_of_run)?;
    let mut levels: Vec<Mesh> = Vec::new();
    let mut before = model.faces.len();
    let mut wanted = model.faces.len() as f64;
    loop {
        wanted *= options.step;
        let target = (wanted as usize).max(options.coarsest.max(1));
        let report = simplifier.run(Target::Faces(target), &mut ())?;
        if report.output_faces < before {
            levels.push(simplifier.level());
            before = report.output_faces;
        }
        if !report.reached || target <= options.coarsest.max(1) {
            return Ok(levels);
        }
    }
}

/// Table while it is filled.
#[derive(Default)]
struct Builder {
    pool: VertexPool,
    triangles: Vec<[u32; 3]>,
    materials: Option<Labels>,
    levels: Vec<Level>,
}

/// Most triangles of all facing chains at one depth, 9 MB of indices; a level with more in its
/// finest grid gets a coarser one. Triangles left for a fish of 4,000 by 64, 144, 256 and 576 cells:
/// 74, 66, 62 and 58 %; the half that faces away would leave 50 %.
const MOST_FACING: usize = 750_000;

impl Builder {
    /// Adds a chain of levels of a model.
    fn chain(&mut self, kind: ChainKind, meshes: &[Mesh], model: &Mesh) -> Chain {
        let errors: Vec<f32> = meshes.par_iter().map(|mesh| error(mesh, model)).collect();
        let first = self.levels.len();
        for (depth, (mesh, error)) in meshes.iter().zip(errors).enumerate() {
            let start = self.triangles.len();
            let faces = self.pool.add(mesh);
            self.triangles.extend(faces);
            if let Some(materials) = &mesh.materials {
                self.label(materials);
            }
            let triangles = start..self.triangles.len();
            self.levels.push(Level { chain: kind, depth, triangles, error });
        }
        Chain { kind, levels: first..self.levels.len() }
    }

    /// Adds the facing chains, from the levels of the whole chain, which are the first.
    fn facing(&mut self, whole: &[Mesh], side: usize) -> Vec<FacingLevels> {
        let at_depth = |(depth, mesh): (usize, &Mesh)| {
            let hidden = HiddenFaces::new(mesh);
            // Cells must lie within those of coarser grids.
            let sides = [1, 2, 3, 4, 6].into_iter().filter(|part| side.is_multiple_of(*part));
            let mut sides = sides.map(|part| side / part);
            let fits = |side: &usize| side * side * mesh.faces.len() * 6 / 10 <= MOST_FACING;
            let side = sides.find(|side| *side >= 2 && fits(side));
            let directions = DirectionGrid::new(side.unwrap_or(2));
            let cells = if side.is_some() { 0..directions.len() } else { 0..0 };
            let seen: Vec<Vec<usize>> =
                cells.map(|cell| hidden.seen_from(&directions, cell)).collect();
            (depth, directions, seen)
        };
        let depths: Vec<_> = whole.par_iter().enumerate().map(at_depth).collect();
        depths
            .into_iter()
            .map(|(depth, directions, seen)| {
                let first = self.levels.len();
                for (cell, seen) in seen.iter().enumerate() {
                    self.facing_level(depth, cell, seen);
                }
                FacingLevels { directions, levels: first..self.levels.len() }
            })
            .collect()
    }

    /// Adds the seen faces of a level of the whole chain.
    fn facing_level(&mut self, depth: usize, cell: usize, seen: &[usize]) {
        let Level { triangles, error, .. } = self.levels[depth].clone();
        let kept: Vec<u32> = seen.iter().map(|&face| (triangles.start + face) as u32).collect();
        let start = self.triangles.len();
        self.triangles.extend(
            kept.iter().map(|&triangle| self.triangles[triangle as usize]).collect::<Vec<_>>(),
        );
        if let Some(labels) = self.materials.as_ref().map(|labels| labels.select(&kept)) {
            self.label(&labels);
        }
        let triangles = start..self.triangles.len();
        self.levels.push(Level { chain: ChainKind::Facing(cell), depth, triangles, error });
    }

    fn label(&mut self, labels: &Labels) {
        let empty = || Labels { names: labels.names.clone(), of_face: Vec::new() };
        self.materials.get_or_insert_with(empty).of_face.extend(&labels.of_face);
    }

    fn finish(
        self,
        chains: [Chain; 3],
        facing: Vec<FacingLevels>,
        differences: Differences,
    ) -> LevelTable {
        let Self { pool, triangles, materials, levels } = self;
        let positions: Vec<[f32; 3]> = pool.positions.iter().map(|p| p.map(|x| x as f32)).collect();
        let (radius, half_extent) = LevelTable::extent_of(&positions);
        LevelTable {
            radius,
            half_extent,
            positions,
            layers: pool.layers,
            triangles,
            materials,
            levels,
            chains,
            facing,
            differences,
        }
    }
}

/// Returns the greatest distance of the model's vertices from a level.
fn error(level: &Mesh, model: &Mesh) -> f32 {
    let Ok(bvh) = Bvh::new(level) else { return 0.0 };
    let used: Vec<VertexId> = model.faces.iter().flatten().copied().collect();
    let square = |v: &VertexId| bvh.closest(model.positions[v.index()], None).distance_squared;
    let most = used.par_iter().map(square).reduce(|| 0.0, f64::max);
    most.sqrt() as f32
}

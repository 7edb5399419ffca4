//! Building of the level table of a model.

use meshlod_check::{LockOptions, locks};
use meshlod_mesh::{Labels, Lock, Locks, Mesh, VertexId};
use meshlod_picture::{Materials, Paint};
use meshlod_simplify::{Method, Options, Simplifier, SimplifyError, Target};
use meshlod_spatial::Bvh;
use rayon::prelude::*;

use crate::levels::difference::Differences;
use crate::levels::directions::DirectionGrid;
use crate::levels::facing::HiddenFaces;
use crate::levels::model::{ModelAxes, in_member_frame};
use crate::levels::pool::VertexPool;
use crate::levels::table::{Chain, ChainKind, Level, LevelTable, TableError};

/// Options for building a [`LevelTable`].
#[derive(Clone, Debug)]
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
    /// Number of cells along the side of the grid of directions, 2 to 16.
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
            directions: 12,
            locks: None,
        }
    }
}

/// Materials of a model, for the pictures by which levels are compared.
#[derive(Clone, Debug, Default)]
pub struct Look {
    /// Materials and textures; without any, vertex colours are shown.
    pub materials: Option<Materials>,
}

impl Look {
    /// Returns the paint for a mesh of the model.
    pub fn paint(&self) -> Paint<'_> {
        self.materials.as_ref().map_or(Paint::Colors, Paint::Materials)
    }
}

/// Factor on the error of the side that stays fine in a chain coarsened on one side. From about 5
/// on nearly everything on the other side goes first.
const ONE_SIDE: f64 = 8.0;

impl LevelTable {
    /// Builds the chains of a model: simplifies it as a whole and side by side, and finds what each
    /// level shows and hides from every direction.
    ///
    /// Cost: O(n log n) for each of the three simplified chains, n = faces, and about five pictures
    /// of 128 by 128 pixels for each level and direction.
    ///
    /// # Errors
    /// An invalid model or one without extent, an option out of range, and errors of the
    /// simplifier.
    pub fn new(model: &Mesh, look: &Look, options: &ChainOptions) -> Result<Self, TableError> {
        if !(0.1..=0.9).contains(&options.step) {
            let message = format!("the step must be between 0.1 and 0.9, not {}", options.step);
            return Err(TableError::Option(message));
        }
        let model = in_member_frame(model, &options.axes)?;
        let own_locks =
            || locks(&model, &LockOptions { contacts: true, ..Default::default() }).locks;
        let locks = options.locks.clone().unwrap_or_else(own_locks);
        let kinds = [ChainKind::Whole, ChainKind::LeftCoarsened, ChainKind::RightCoarsened];
        let chains: Result<Vec<_>, _> =
            kinds.into_par_iter().map(|kind| simplified(&model, kind, &locks, options)).collect();
        let [mut whole, left, right]: [Vec<Mesh>; 3] =
            chains?.try_into().expect("three chains are simplified");
        whole.insert(0, model);
        let directions = DirectionGrid::new(options.directions);
        let differences = Differences::measure(&whole, look)?;
        let mut table = Builder::default();
        table.simplified(ChainKind::Whole, &whole, &whole[0])?;
        table.simplified(ChainKind::LeftCoarsened, &left, &whole[0])?;
        table.simplified(ChainKind::RightCoarsened, &right, &whole[0])?;
        table.facing(&whole, &directions);
        Ok(table.finish(directions, differences))
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
    chains: Vec<Chain>,
}

impl Builder {
    /// Adds a chain of levels of a model.
    fn simplified(
        &mut self,
        kind: ChainKind,
        meshes: &[Mesh],
        model: &Mesh,
    ) -> Result<(), TableError> {
        let errors: Vec<f32> = meshes.par_iter().map(|mesh| error(mesh, model)).collect();
        let first = self.levels.len();
        for (mesh, error) in meshes.iter().zip(errors) {
            let triangles = self.pool.add(mesh);
            self.push(triangles, mesh.materials.as_ref(), error);
        }
        self.chains.push(Chain { kind, levels: first..self.levels.len() });
        Ok(())
    }

    /// Adds a facing chain for every direction, from the levels of the whole chain.
    fn facing(&mut self, whole: &[Mesh], directions: &DirectionGrid) {
        let hidden: Vec<HiddenFaces> = whole.par_iter().map(HiddenFaces::new).collect();
        for cell in 0..directions.len() {
            let first = self.levels.len();
            for (i, hidden) in hidden.iter().enumerate() {
                let Level { triangles, error, .. } = self.levels[i].clone();
                let seen = hidden.seen_from(directions, cell);
                let kept: Vec<u32> = seen.iter().map(|&f| (triangles.start + f) as u32).collect();
                let faces = kept.iter().map(|&t| self.triangles[t as usize]).collect();
                let labels = self.materials.as_ref().map(|labels| labels.select(&kept));
                self.push(faces, labels.as_ref(), error);
            }
            let kind = ChainKind::Facing(cell);
            self.chains.push(Chain { kind, levels: first..self.levels.len() });
        }
    }

    fn push(&mut self, faces: Vec<[u32; 3]>, materials: Option<&Labels>, error: f32) {
        let start = self.triangles.len();
        self.triangles.extend(faces);
        if let Some(materials) = materials {
            let all = self.materials.get_or_insert_with(|| Labels {
                names: materials.names.clone(),
                of_face: Vec::new(),
            });
            all.of_face.extend(&materials.of_face);
        }
        let triangles = start..self.triangles.len();
        self.levels.push(Level { chain: self.chains.len(), triangles, error });
    }

    fn finish(self, directions: DirectionGrid, differences: Differences) -> LevelTable {
        let Self { pool, triangles, materials, levels, chains } = self;
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
            directions,
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

//! A level of a tileset beside the model that it was made from.

use std::path::Path;

use anyhow::Result;
use meshlod::Scene;
use meshlod::measure::{DistanceOptions, PreparedSurface, surface_distance};
use meshlod::mesh::{Connectivity, Mesh};
use meshlod::picture::{Camera, ImageError, Paint, ReferenceImages, Style};
use meshlod::scene::{materials_of, single_sided_materials};

use super::tileset::Tileset;
use crate::lab::command::Program;
use crate::lab::table::Table;

/// Width and height of pictures, and their field of view in radians.
const SIDE: u32 = 1024;
const FIELD: f64 = 0.8;

/// Runs of `simplify` that look for one whose measured distance is that of a level.
const RUNS: usize = 4;

const HEADINGS: [&str; 10] = [
    "tiles",
    "faces",
    "proved",
    "measured",
    "`simplify`",
    "open",
    "non-manifold",
    "FLIP",
    "most",
    "FLIP of `simplify`",
];

/// Returns a table of the levels of a tileset, compared with the model in a file if there is one.
pub fn table(name: &str, tileset: &Tileset, model: Option<(&Program, &Path)>) -> Result<String> {
    let first = format!("{name}, level");
    let mut table = Table::new([&first[..]].into_iter().chain(HEADINGS));
    let scene = model.map(|(_, path)| meshlod::read(path, &Default::default())).transpose()?;
    let mesh = scene.as_ref().map(Scene::flatten);
    let compared = match (&model, &scene, &mesh) {
        (Some((program, path)), Some(scene), Some(mesh)) => {
            Some(LevelModel { program, path, scene, surface: PreparedSurface::new(mesh)? })
        }
        _ => None,
    };
    for depth in tileset.depths() {
        let (mut count, mut faces, mut error) = (0, 0, 0f64);
        for tile in tileset.level(depth) {
            count += 1;
            faces += tile.faces;
            error = error.max(tile.error);
        }
        let mut row = vec![depth.to_string()];
        row.extend([count.to_string(), faces.to_string(), format!("{error:.3e}")]);
        match &compared {
            Some(model) => row.extend(model.compare(tileset, depth, error)?),
            None => row.extend(std::iter::repeat_n(String::new(), 7)),
        }
        table.row(row);
    }
    Ok(table.markdown())
}

/// Model that levels are compared with.
struct LevelModel<'a> {
    program: &'a Program,
    path: &'a Path,
    scene: &'a Scene,
    surface: PreparedSurface<'a>,
}

impl LevelModel<'_> {
    /// Returns the last seven cells of the row of a level that is within an error.
    fn compare(&self, tileset: &Tileset, depth: u8, error: f64) -> Result<Vec<String>> {
        let (scene, level) = tileset.joined(depth)?;
        let distance = self.distance(&level)?;
        let faces = level.faces.len() as f64;
        let simplified = self.simplified(distance)?;
        let [open, others] = excess(self.surface.mesh(), &level);
        let seen = self.image_error(&scene, &level, error)?;
        let most = seen.views.iter().map(|view| view.flip).fold(0.0, f64::max);
        let least = simplified.as_ref().map(|least| least.flatten());
        let (ratio, own) = match simplified.as_ref().zip(least.as_ref()) {
            Some((scene, least)) => {
                let seen = self.image_error(scene, least, error)?;
                (format!("{:.2}", faces / least.faces.len() as f64), format!("{:.3}", seen.flip))
            }
            None => ("–".into(), "–".into()),
        };
        Ok(vec![
            format!("{distance:.3e}"),
            ratio,
            open.to_string(),
            others.to_string(),
            format!("{:.3}", seen.flip),
            format!("{most:.3}"),
            own,
        ])
    }

    /// Returns the greatest distance that was measured, in model units.
    fn distance(&self, level: &Mesh) -> Result<f64> {
        let level = PreparedSurface::new(level)?;
        Ok(surface_distance(&self.surface, &level, &DistanceOptions::default())?.max())
    }

    /// Returns the level with the fewest faces that `simplify --error` was seen to make within a
    /// distance that is measured; `None` if no run stayed within.
    fn simplified(&self, most: f64) -> Result<Option<Scene>> {
        let folder = tempfile::tempdir()?;
        let output = folder.path().join("level.glb");
        let [input, output_text] = [self.path, &output].map(|path| path.display().to_string());
        let (mut error, mut least, mut fewest) = (most, None, usize::MAX);
        for _ in 0..RUNS {
            let arguments = ["simplify", &input, &output_text, "--error", &error.to_string()];
            self.program.answer(arguments)?;
            let scene = meshlod::read(&output, &Default::default())?;
            let level = scene.flatten();
            let distance = self.distance(&level)?;
            if distance <= most && level.faces.len() < fewest {
                fewest = level.faces.len();
                least = Some(scene);
            }
            // Towards the distance, and just below it.
            error *= 0.995 * most / distance.max(most * 0.25);
        }
        Ok(least)
    }

    /// Compares pictures of a level with those of the model where an error is one pixel.
    fn image_error(&self, scene: &Scene, level: &Mesh, error: f64) -> Result<ImageError> {
        let original = self.surface.mesh();
        let (materials, _) = materials_of(self.scene);
        let single_sided = single_sided_materials(self.scene);
        let style = Style::comparison_of(original, &materials, &single_sided);
        let style = Style { size: [SIDE; 2], ..style };
        let distance = error * f64::from(SIDE) / (2.0 * (FIELD / 2.0).tan());
        let cameras = Camera::icosahedron_views(original).map(|view| self.nearer(&view, distance));
        let reference = ReferenceImages::seen_by(original, cameras, style.clone())?;
        let (level_materials, _) = materials_of(scene);
        let paint = match style.paint {
            Paint::Materials(_) => Paint::Materials(&level_materials),
            paint => paint,
        };
        Ok(reference.error_with(level, &paint)?)
    }

    /// Returns a camera that looks at the point closest to another one, along that direction, from
    /// where the surface is at a distance.
    fn nearer(&self, view: &Camera, distance: f64) -> Camera {
        let closest = |eye| self.surface.bvh().closest(eye, None);
        let target = closest(view.eye()).point;
        let away = view.forward().map(|x| -x);
        let at = |length: f64| [0, 1, 2].map(|axis| target[axis] + length * away[axis]);
        // From afar the surface comes no closer than by the length of a step.
        let mut length = 2.0 * (self.surface.diagonal() + distance);
        for _ in 0..10_000 {
            let beyond = closest(at(length)).distance_squared.sqrt() - distance;
            if beyond < 1e-3 * distance {
                break;
            }
            length -= beyond;
        }
        let up = if away[1].abs() > 0.99 { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] };
        let target = closest(at(length)).point;
        Camera::look_at(at(length), target, up, FIELD)
    }
}

/// Returns the numbers of open and of non-manifold edges that a level has beyond those of its
/// original, whose vertices at one point count as one.
fn excess(original: &Mesh, level: &Mesh) -> [i64; 2] {
    let mut welded = original.clone();
    meshlod::mesh::weld(&mut welded, 0.0);
    let [before, after] = [&welded, level].map(|mesh| {
        let edges = Connectivity::new(&mesh.faces, mesh.positions.len());
        [edges.boundary_edges() as i64, edges.non_manifold_edges() as i64]
    });
    [after[0] - before[0], after[1] - before[1]]
}

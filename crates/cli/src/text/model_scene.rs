//! Scenes of multiresolution files: what they have, what they lack, and how they come out.

use std::path::Path;

use meshlod::FileBytes;
use meshlod::jobs::ErrorPoses;
use meshlod::model::{ModelScene, SceneCounts, SceneQueryError};
use meshlod::multires::{ModelFile, Query};

use crate::session::Session;
use crate::session::failure::Failure;
use crate::session::model_file;
use crate::text::numbers::count;

/// Describes what a scene has beside its surface, and the poses for which errors hold.
pub fn counts_text(counts: &SceneCounts, poses: ErrorPoses) -> String {
    let has = list(&[
        (counts.nodes, "node", "nodes"),
        (counts.meshes, "mesh", "meshes"),
        (counts.materials, "material", "materials"),
        (counts.images, "image", "images"),
        (counts.skins, "skin", "skins"),
        (counts.animations, "animation", "animations"),
    ]);
    let mut text = format!("scene: {has}");
    if counts.instances > counts.meshes {
        let shown = count(counts.instances);
        text += &format!("; meshes are shown {shown} times, and errors hold for the largest");
    }
    let moving = list(&[
        (counts.skinned_meshes, "skinned mesh", "skinned meshes"),
        (counts.morphing_meshes, "mesh with morph targets", "meshes with morph targets"),
        (counts.animations, "animation", "animations"),
    ]);
    text += &match poses {
        _ if moving.is_empty() => String::new(),
        ErrorPoses::Unknown => {
            format!("\nerrors hold in the pose of the file, not in those of {moving}")
        }
        ErrorPoses::Unbent => {
            "\nanimations move meshes without bending or enlarging them: errors hold there too"
                .into()
        }
        ErrorPoses::Measured(poses) => format!(
            "\nerrors are measured over {}; they may be exceeded in poses between these and others",
            model_file::poses_text(poses),
        ),
    };
    text + "\n"
}

/// Reads the scene of a multiresolution file, with notes of what a truncated file lacks.
pub fn read(
    path: &Path,
    file: &ModelFile<FileBytes>,
    session: &Session,
) -> Result<ModelScene, Failure> {
    let ModelFile::Contractions(archive) = file else { return Ok(ModelScene::default()) };
    if archive.has_old_resources() {
        session.warn(Failure::at(
            path,
            "its materials are in the form of an earlier version and left out; build it again",
        ));
    }
    let model = ModelScene::read(archive).map_err(|error| Failure::at(path, error))?;
    session.note(path, &model.missing.notes())?;
    Ok(model)
}

/// Puts a query about the scene of a file to the levels of its meshes. Of a point, returns the place
/// where the levels have the closest one that is shown.
pub fn query<'f>(
    path: &Path,
    (file, model): (&ModelFile<FileBytes>, &ModelScene),
    query: &Query<'f>,
    max_faces: Option<usize>,
) -> Result<(Query<'f>, Option<[f64; 3]>), Failure> {
    model.query_of_levels(file, query, max_faces).map_err(|error| match error {
        SceneQueryError::File(error) => model_file::failure(path, error),
        SceneQueryError::Scene(error) => Failure::at(path, error),
    })
}

/// Lists numbers of things, without those of which there are none.
fn list(numbers: &[(usize, &str, &str)]) -> String {
    let some = numbers.iter().filter(|(number, ..)| *number > 0);
    let texts = some.map(|&(number, one, many)| match number {
        1 => format!("1 {one}"),
        _ => format!("{} {many}", count(number)),
    });
    texts.collect::<Vec<_>>().join(", ")
}

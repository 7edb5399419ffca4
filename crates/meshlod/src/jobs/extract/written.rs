//! The scene of a level in the form in which it is written, whose error holds as written.

use meshlod_io::Scene;
use meshlod_mesh::Mesh;
use meshlod_multires::{ModelFile, Source};
use meshlod_simplify::Digits;

use super::{ExtractReport, ExtractRequest};
use crate::jobs::written_as::digits;
use crate::jobs::{JobError, Remark, Watch, WrittenAs, begin};
use crate::model::cut_volume::{CutVolumeError, conserve_cut_volume};
use crate::model::scene::ModelScene;
use crate::scene::shown_rounding;

/// Makes the scene of a level that is not empty, in the form in which it is to be written, and
/// reports what writing changes. `rounding` is that of the file, in model units.
pub(super) fn written<S: Source>(
    (file, model): (&ModelFile<S>, ModelScene),
    mesh: Mesh,
    rounding: f64,
    (request, report): (&ExtractRequest, &mut ExtractReport),
    watch: &dyn Watch,
) -> Result<Scene, JobError> {
    let has_nodes = request.written_as.is_none_or(|as_| as_.format.is_gltf());
    let is_taken_back = has_nodes && !model.is_unmoved();
    if request.exact_volume && is_taken_back {
        let reason = "nodes move, turn or scale meshes, whose coordinates are rounded again";
        watch.remark(&Remark::field("exact_volume", reason));
    }
    let mut flat = model.flat_scene(request.name.clone(), mesh);
    let spare = report.error.spare(rounding);
    let form = request.written_as.map(|as_| within(spare, &flat, as_));
    let mut moves = form.map_or(0.0, |as_| flat.rounding(as_.format, as_.precision));
    if request.exact_volume {
        restore_volume(&mut flat.meshes[0].mesh, (file, digits(form)), report, watch)?;
    }
    if model.is_flat() && !has_nodes {
        report.merged_meshes = model.mesh_count();
    }
    let scene = restored(model, flat, has_nodes)?;
    if let (true, Some(as_)) = (is_taken_back, form) {
        moves = shown_rounding(&scene, as_.format, as_.precision);
    }
    report.error.note_rounding(moves);
    report.precision = form.map(|as_| as_.precision);
    report.rounded = (moves > spare).then_some(moves);
    Ok(scene)
}

/// Chooses the precision of coordinates: 64 bits if 32 would move one by more than `most`, in model
/// units, unless the precision is given.
fn within(most: f64, scene: &Scene, as_: WrittenAs) -> WrittenAs {
    match scene.rounding(as_.format, as_.precision) > most {
        true => as_.precise().of(scene),
        false => as_.of(scene),
    }
}

/// Gives the closed parts of a cut the volume that they have in the finest cut; remarks if that
/// cannot be done.
fn restore_volume<S: Source>(
    cut: &mut Mesh,
    (file, digits): (&ModelFile<S>, Digits),
    report: &mut ExtractReport,
    watch: &dyn Watch,
) -> Result<(), JobError> {
    begin(watch, "restoring the volume")?;
    match conserve_cut_volume(cut, file, digits) {
        Ok(restored) => {
            report.volume_residual = Some(restored.after.abs());
            report.volume_moved = Some(restored.farthest);
            report.error.moved += restored.farthest;
        }
        Err(CutVolumeError::File(error)) => return Err(JobError::input(error)),
        Err(error) => watch.remark(&Remark::field("exact_volume", error)),
    }
    Ok(())
}

/// Returns a scene of the level in `flat` as its format can hold it: with the nodes of the scene, or
/// with a copy for each instance of a mesh.
fn restored(model: ModelScene, mut flat: Scene, has_nodes: bool) -> Result<Scene, JobError> {
    if model.is_flat() && !has_nodes {
        // So that what the format lacks of the document is noted.
        flat.source = model.source().cloned();
        return Ok(flat);
    }
    let level = std::mem::take(&mut flat.meshes[0]);
    model.into_scene(level.name, level.mesh).map_err(JobError::input)
}

//! Evaluation of all arms on all footage.

use std::sync::Arc;

use meshlod::flock::levels::{LevelTable, Look};
use meshlod::picture::PictureError;
use serde::{Deserialize, Serialize};

use crate::evaluate::arms::Arm;
use crate::evaluate::evaluation::Evaluation;
use crate::evaluate::scene_references::{SceneReferences, StillPicture};
use crate::footage::Footage;

/// Options of an evaluation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EvaluationOptions {
    /// Arms to compare.
    pub arms: Vec<Arm>,
    /// Shares of the triangles of full detail in view at which every arm is drawn, ascending.
    pub shares: Vec<f64>,
    /// Pairs of consecutive frames that are drawn in every scene, evenly spread.
    pub pairs: usize,
    /// Image errors for which the triangles needed are found.
    pub flips: Vec<f64>,
}

impl Default for EvaluationOptions {
    fn default() -> Self {
        Self {
            arms: Arm::all(),
            shares: vec![0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4],
            pairs: 4,
            flips: vec![0.01, 0.02, 0.05],
        }
    }
}

/// Evaluates all arms on all footage. Cost: some three pictures a pair of frames, share and arm.
///
/// `watch` is called before every arm with the part of the work that is done, from 0 to 1; `still`
/// gets pictures of the first scored frame.
///
/// # Errors
/// A size that pictures cannot have.
pub fn evaluate(
    footage: &[Footage],
    table: &Arc<LevelTable>,
    look: &Look,
    options: &EvaluationOptions,
    watch: &mut dyn FnMut(f64, &str),
    still: &mut dyn FnMut(StillPicture),
) -> Result<Evaluation, PictureError> {
    let mut result = Evaluation::default();
    let filled: Vec<&Footage> = footage.iter().filter(|footage| !footage.is_empty()).collect();
    let steps = (filled.len() * (options.arms.len() + 1)) as f64;
    for (i, footage) in filled.into_iter().enumerate() {
        let done = (i * (options.arms.len() + 1)) as f64;
        watch(done / steps, &footage.name);
        let mut scene = SceneReferences::new(footage, table, look, options.pairs)?;
        result.floors.push((footage.name.clone(), scene.floor()?));
        result.full_triangles.push((footage.name.clone(), scene.full_triangles));
        still(scene.reference_still());
        for (k, &arm) in options.arms.iter().enumerate() {
            watch((done + 1.0 + k as f64) / steps, &format!("{}: {}", footage.name, arm.name()));
            for &share in &options.shares {
                let (row, picture) = scene.row(arm, share)?;
                still(picture);
                result.rows.push(row);
            }
        }
    }
    result.find_needed(&options.flips);
    Ok(result)
}

//! Results of an evaluation, and what they say about arms.

use serde::Serialize;

use crate::evaluate::bootstrap::Interval;
use crate::evaluate::curve::{Needed, Row, mean, triangles_for};
use crate::evaluate::score::FrameScore;

/// Results of an evaluation.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Evaluation {
    /// Scores of every arm in every scene at every share.
    pub rows: Vec<Row>,
    /// Triangles that every arm needs in every scene.
    pub needed: Vec<Needed>,
    /// Floor of every scene: full detail with its samples shifted by a quarter of a pixel.
    pub floors: Vec<(String, FrameScore)>,
    /// Mean triangles of full detail in view in every scene.
    pub full_triangles: Vec<(String, f64)>,
}

impl Evaluation {
    /// Finds the triangles that every arm needs for each image error.
    pub(super) fn find_needed(&mut self, flips: &[f64]) {
        for (scene, arm) in self.curves() {
            for &flip in flips {
                let triangles = triangles_for(&self.points(&scene, &arm, None), flip);
                self.needed.push(Needed {
                    scene: scene.clone(),
                    arm: arm.clone(),
                    flip,
                    triangles,
                });
            }
        }
    }

    /// Lists all pairs of scene and arm.
    fn curves(&self) -> Vec<(String, String)> {
        let mut curves: Vec<(String, String)> = Vec::new();
        for row in &self.rows {
            let curve = (row.scene.clone(), row.arm.clone());
            if !curves.contains(&curve) {
                curves.push(curve);
            }
        }
        curves
    }

    /// Returns mean triangles and FLIP of an arm in a scene, by share; of some frames or all.
    fn points(&self, scene: &str, arm: &str, frames: Option<&[usize]>) -> Vec<[f64; 2]> {
        let rows = self.rows.iter().filter(|row| row.scene == scene && row.arm == arm);
        rows.map(|row| match frames {
            None => [row.mean_triangles(), row.flip()],
            Some(frames) => [
                mean(frames.iter().map(|&f| row.triangles[f] as f64)),
                mean(frames.iter().map(|&f| row.frames[f].flip)),
            ],
        })
        .collect()
    }

    /// Returns the triangles that an arm needs over those of another for an image error, as a
    /// geometric mean over the scenes, with a bootstrap interval.
    ///
    /// `None` if one of them does not reach the error in every scene.
    pub fn ratio(&self, arm: &str, other: &str, flip: f64) -> Option<Interval> {
        let scenes: Vec<&String> = self.full_triangles.iter().map(|(scene, _)| scene).collect();
        // Both frames of a pair are drawn together: they are nearly alike.
        let pairs = self.rows.first().map_or(0, |row| row.frames.len() / 2);
        Interval::of(scenes.len(), pairs, |drawn| {
            let log = |(scene, pairs): &(usize, Vec<usize>)| {
                let frames: Vec<usize> = pairs.iter().flat_map(|p| [2 * p, 2 * p + 1]).collect();
                let points = |arm| self.points(scenes[*scene], arm, Some(&frames));
                let needs = |arm| triangles_for(&points(arm), flip);
                Some((needs(arm)? / needs(other)?).ln())
            };
            let logs: Option<Vec<f64>> = drawn.iter().map(log).collect();
            logs.filter(|logs| !logs.is_empty()).map(|logs| mean(logs.into_iter()).exp())
        })
    }

    /// Returns the mean over all scenes of a figure of an arm at a share of the triangles; `None`
    /// if the arm is off by more than a tenth of the share in one of them.
    pub fn mean(&self, arm: &str, share: f64, figure: impl Fn(&Row) -> f64) -> Option<f64> {
        let rows = self.rows.iter().filter(|row| row.arm == arm && row.share == share);
        // Some arms cannot draw so little, or so much.
        let is_near = |row: &Row| {
            let full = self.full_triangles.iter().find(|(scene, _)| *scene == row.scene);
            let full = full.map_or(0.0, |(_, full)| *full);
            (row.mean_triangles() / full / share - 1.0).abs() < 0.1
        };
        let rows: Vec<&Row> = rows.collect();
        if !rows.iter().all(|row| is_near(row)) {
            return None;
        }
        let values: Vec<f64> = rows.into_iter().map(figure).collect();
        (!values.is_empty()).then(|| mean(values.into_iter()))
    }
}

//! Scenes without faces, told apart from meshes that have lost theirs.

use meshlod_io::Scene;

use crate::jobs::JobError;

/// Refuses a scene of points or lines alone, before a job finds that there is no face.
///
/// # Errors
/// [`JobError::Input`].
pub fn refuse_points(scene: &Scene) -> Result<(), JobError> {
    match scene.has_only_points() {
        false => Ok(()),
        true => Err(JobError::input(
            "no faces: it has points or lines alone; reconstruct a surface first, as MeshLab does",
        )),
    }
}

#[cfg(all(test, feature = "multires"))]
mod tests {
    use meshlod_io::{Weld, gltf};

    use super::*;
    use crate::jobs::{LodsRequest, MeasureRequest, lods, measure};

    #[test]
    fn points_are_called_points() {
        let json = br#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0},
            "mode": 0}]}], "accessors": [{"componentType": 5126, "count": 2, "type": "VEC3",
            "min": [0, 0, 0], "max": [0, 0, 0]}]}"#;
        let points = gltf::read(json, &mut |_| None, Weld::Exact).unwrap();
        let refused = lods(points.clone(), &LodsRequest::default(), &()).unwrap_err().to_string();
        assert!(refused.contains("points or lines alone"), "{refused}");
        let request = MeasureRequest::default();
        let torus = Scene::from_mesh("", meshlod_samples::torus(60));
        assert!(matches!(measure(&torus, &points, &request, &()), Err(JobError::Second(_))));
        assert!(refuse_points(&Scene::default()).is_ok() && refuse_points(&torus).is_ok());
    }
}

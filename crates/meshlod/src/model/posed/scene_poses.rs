//! Poses of all meshes of a scene, as its levels have them.

use glam::{DMat4, DVec3};
use meshlod_io::Scene;
use meshlod_io::gltf::{Animator, Moment};
use meshlod_mesh::{Layer, Mesh, WedgeId};
use meshlod_multires::{PosedWedges, Posing};

use super::mesh_pose::{MeshPose, PoseLayers};
use super::shown::Shown;

/// Poses of a scene in which the errors of its levels are measured.
///
/// They are those of its animations at key times, at most 64, and the pose of its nodes without
/// animation. Each shows every mesh of the levels once, as one of the nodes that show it. Rigid
/// poses, in which no mesh changes its shape or size, are left out: they do not change the errors.
#[derive(Clone, Debug, Default)]
pub struct ScenePoses {
    animator: Animator,
    shown: Shown,
    /// Moments, and which of the nodes that bend a mesh show it.
    poses: Vec<(Option<Moment>, usize)>,
    /// Mesh of each object label.
    of_objects: Vec<u32>,
    /// Numbers of poses and animations.
    pub counts: PoseCounts,
    /// Reasons why something was left out, one line each.
    pub notes: Vec<String>,
}

/// Numbers of poses in which errors were measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PoseCounts {
    /// Poses in which they were measured.
    pub measured: u32,
    /// Animations that these poses are of.
    pub animations: u32,
}

/// Mesh of a scene in the form that its levels have.
#[derive(Clone, Debug)]
pub(crate) struct PosedMesh {
    /// From the levels to the mesh's own space.
    pub(crate) back: DMat4,
    /// Number of its object labels.
    pub(crate) objects: u32,
    /// Attribute layers that it has.
    pub(crate) layers: Vec<u32>,
}

/// Largest number of poses, of all nodes that show a mesh together. Each takes at most as long to
/// measure as the pose of the file.
const MOST: usize = 64;

/// Multiple of the size of a scene beyond which a pose is left out.
const FAR: f64 = 1e6;

impl ScenePoses {
    /// Chooses the poses of a scene whose meshes were merged into `mesh`; `None` if it has no
    /// animations and its nodes bend no mesh.
    ///
    /// Cost: linear in the mesh, for each pose.
    pub(crate) fn new(scene: &Scene, meshes: &[Option<PosedMesh>], mesh: &Mesh) -> Option<Self> {
        let animator = Animator::new(scene)?;
        let layers = mesh.attributes.as_ref().map_or(&[][..], |all| &all.layers);
        let corners = PosedCorners::of(mesh, meshes);
        let mut this = Self {
            notes: animator.notes.clone(),
            of_objects: corners.of_objects.clone(),
            shown: Shown::of(scene, meshes, layers, &animator),
            animator,
            ..Self::default()
        };
        this.note_joints(&corners, layers);
        let variants = this.shown.variants();
        if variants > MOST {
            this.notes.push(format!(
                "a mesh is shown by {variants} nodes that bend it; errors are measured for {MOST}"
            ));
        }
        let variants = variants.clamp(1, MOST);
        let moments = this.animator.moments((MOST / variants - 1).max(1));
        let mut animations: Vec<usize> = moments.iter().map(|at| at.animation).collect();
        animations.dedup();
        for moment in std::iter::once(None).chain(moments.into_iter().map(Some)) {
            this.add(moment, variants, (&corners, layers));
        }
        if this.poses.is_empty() && this.notes.is_empty() && this.animator.animation_count() == 0 {
            return None;
        }
        this.counts = PoseCounts {
            measured: this.poses.len() as u32,
            animations: if this.poses.is_empty() { 0 } else { animations.len() as u32 },
        };
        Some(this)
    }

    /// Adds the poses at a moment, as far as they change the shape of a mesh.
    fn add(
        &mut self,
        moment: Option<Moment>,
        variants: usize,
        (corners, layers): (&PosedCorners, &[Layer]),
    ) {
        for variant in 0..variants.min(MOST - self.poses.len()) {
            let meshes = self.meshes((moment, variant));
            if !meshes.iter().flatten().any(MeshPose::changes_shape) {
                continue;
            }
            if !corners.are_near(self.place_all(&meshes, &corners.wedges(layers))) {
                let when = moment.map_or("the pose of the nodes".to_owned(), |at| {
                    format!("animation {} at {} s", at.animation, at.seconds)
                });
                self.notes.push(format!("{when} is left out: it moves vertices too far"));
                return;
            }
            self.poses.push((moment, variant));
        }
    }

    /// Notes meshes with weights of joints that are not there.
    fn note_joints(&mut self, corners: &PosedCorners, layers: &[Layer]) {
        let meshes = &self.shown.meshes;
        let mut greatest = vec![None; meshes.len()];
        for (wedge, &object) in corners.objects.iter().enumerate().filter(|at| corners.used[at.0]) {
            let Some(mesh) = self.mesh_of(object) else { continue };
            let joint = meshes[mesh].layers.greatest_joint(layers, WedgeId::new(wedge));
            greatest[mesh] = greatest[mesh].max(joint);
        }
        for (mesh, greatest) in greatest.into_iter().enumerate() {
            for &(node, _) in &meshes[mesh].deforming {
                let joints = self.animator.skin(node).map(|skin| skin.joints.len());
                let (Some(joint), Some(joints)) = (greatest, joints) else { continue };
                if joint >= joints {
                    self.notes.push(format!(
                        "mesh {mesh} has weights of joint {joint}, but the skin of node {node} has \
                         {joints} joints; they count as none"
                    ));
                }
            }
        }
    }

    /// Returns how each mesh is shown in a pose.
    fn meshes(&self, (moment, variant): (Option<Moment>, usize)) -> Vec<Option<MeshPose>> {
        self.shown.pose(&self.animator, &self.animator.pose(moment), variant)
    }

    fn place_all(&self, meshes: &[Option<MeshPose>], wedges: &PosedWedges<'_>) -> Vec<[f64; 3]> {
        let roles = PoseLayers::of(wedges.layers);
        let place = |(wedge, (&at, &object)): (usize, (&[f64; 3], &u32))| {
            let mesh = self.mesh_of(object).and_then(|mesh| meshes.get(mesh)?.as_ref());
            let posed = |mesh: &MeshPose| {
                mesh.place(at, (&roles, wedges.layers), WedgeId::new(wedge)).to_array()
            };
            mesh.map_or(at, posed)
        };
        wedges.positions.iter().zip(wedges.objects).enumerate().map(place).collect()
    }

    fn mesh_of(&self, object: u32) -> Option<usize> {
        self.of_objects.get(object as usize).map(|&mesh| mesh as usize)
    }
}

impl Posing for ScenePoses {
    fn count(&self) -> usize {
        self.poses.len()
    }

    fn places(&self, pose: usize, wedges: &PosedWedges<'_>) -> Vec<[f64; 3]> {
        self.place_all(&self.meshes(self.poses[pose]), wedges)
    }
}

/// Wedges of the mesh that the levels are made from.
struct PosedCorners {
    positions: Vec<[f64; 3]>,
    objects: Vec<u32>,
    /// Marks the wedges that faces use.
    used: Vec<bool>,
    of_objects: Vec<u32>,
    /// Distance from the middle of the mesh beyond which poses are left out.
    reach: f64,
    middle: DVec3,
}

impl PosedCorners {
    fn of(mesh: &Mesh, meshes: &[Option<PosedMesh>]) -> Self {
        let of_mesh = |(index, mesh): (u32, &Option<PosedMesh>)| {
            let count = mesh.as_ref().map_or(0, |mesh| mesh.objects);
            std::iter::repeat_n(index, count as usize)
        };
        let of_objects = (0..).zip(meshes).flat_map(of_mesh).collect();
        let wedges = mesh.attributes.as_ref().map_or(mesh.positions.len(), |all| all.wedge_count);
        let mut this = Self {
            positions: vec![[0.0; 3]; wedges],
            objects: vec![0; wedges],
            used: vec![false; wedges],
            of_objects,
            reach: FAR * mesh.bounds().diagonal(),
            middle: (DVec3::from(mesh.bounds().min) + DVec3::from(mesh.bounds().max)) * 0.5,
        };
        for (index, face) in mesh.faces.iter().enumerate() {
            for (wedge, v) in mesh.corner_wedges(index).into_iter().zip(face) {
                this.positions[wedge.index()] = mesh.positions[v.index()];
                this.objects[wedge.index()] = mesh.objects.as_ref().map_or(0, |all| all.of(index));
                this.used[wedge.index()] = true;
            }
        }
        this
    }

    fn wedges<'w>(&'w self, layers: &'w [Layer]) -> PosedWedges<'w> {
        PosedWedges { positions: &self.positions, objects: &self.objects, layers }
    }

    /// Returns true if all wedges are in places that can be measured.
    fn are_near(&self, places: Vec<[f64; 3]>) -> bool {
        places.into_iter().zip(&self.used).filter(|(_, used)| **used).all(|(place, _)| {
            // False for what is not finite.
            DVec3::from(place).distance(self.middle) <= self.reach
        })
    }
}

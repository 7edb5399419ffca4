//! Lighting of a surface.

use glam::{DVec3, Vec3};

use crate::Lighting;

/// Lights of a picture, which move with the camera.
pub(crate) struct Lights {
    lighting: Lighting,
    to_key: Vec3,
    up: Vec3,
}

impl Lights {
    /// Creates the lights; `axes` are the camera's right, up and forward.
    pub(crate) fn new(lighting: Lighting, axes: [DVec3; 3]) -> Self {
        let [right, up, forward] = axes.map(|axis| axis.as_vec3());
        let to_key = (up * 0.75 - right * 0.6 - forward * 0.8).normalize_or_zero();
        Self { lighting, to_key, up }
    }

    /// Returns the linear light reflected by a surface; `normal` and `to_eye` are unit vectors.
    pub(crate) fn on(&self, color: Vec3, normal: Vec3, to_eye: Vec3) -> Vec3 {
        let facing = normal.dot(to_eye).max(0.0);
        match self.lighting {
            Lighting::Unlit => color,
            Lighting::Headlight => color * (0.2 + 0.8 * facing),
            Lighting::Soft => color * (0.45 + 0.55 * facing),
            Lighting::Studio => self.studio(color, normal, to_eye, facing),
        }
    }

    /// Studio lighting: a key light from the upper left, a weak one from the eye so that dark sides
    /// keep their shape, a cool sky over a warm ground, a soft gloss. The numbers are tuned by eye.
    fn studio(&self, color: Vec3, normal: Vec3, to_eye: Vec3, facing: f32) -> Vec3 {
        const SKY: Vec3 = Vec3::new(0.21, 0.235, 0.27);
        const GROUND: Vec3 = Vec3::new(0.075, 0.066, 0.06);
        const KEY: Vec3 = Vec3::new(0.90, 0.86, 0.79);
        let key = ((normal.dot(self.to_key) + 0.1) / 1.1).max(0.0);
        let ambient = GROUND.lerp(SKY, 0.5 + 0.5 * normal.dot(self.up));
        let diffuse = ambient + KEY * key + Vec3::splat(0.13 * facing);
        let half = (self.to_key + to_eye).normalize_or_zero();
        let gloss = power_of_32(normal.dot(half).max(0.0)) * 0.10;
        color * diffuse + Vec3::splat(gloss)
    }
}

fn power_of_32(x: f32) -> f32 {
    (0..5).fold(x, |x, _| x * x)
}

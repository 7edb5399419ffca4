//! Helpers of the tests on the GPU.
#![allow(dead_code)]

pub mod compressed;
pub mod cracks;

use std::sync::OnceLock;

use meshlod::Mesh;
use meshlod::picture::Picture;
use meshlod_view::Gpu;

/// Opens the GPU, once; `None`, and a line that says so, if there is none.
///
/// With `MESHLOD_REQUIRE_GPU` set, there must be one.
pub fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    let gpu = GPU.get_or_init(|| match Gpu::headless() {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            let is_required = std::env::var_os("MESHLOD_REQUIRE_GPU").is_some();
            assert!(!is_required, "{error}");
            None
        }
    });
    if gpu.is_none() {
        eprintln!("skipped: no GPU; apt-get install mesa-vulkan-drivers gives a software one");
    }
    gpu.as_ref()
}

/// Share of the pixels whose colours differ by more than `levels` of 255 in a channel, and the mean
/// difference.
pub fn difference(a: &Picture, b: &Picture, levels: u8) -> (f64, f64) {
    let pixels = a.rgba().chunks_exact(4).zip(b.rgba().chunks_exact(4));
    let (mut far, mut sum) = (0usize, 0usize);
    for (a, b) in pixels {
        let most = (0..4).map(|k| a[k].abs_diff(b[k])).max().unwrap_or(0);
        far += usize::from(most > levels);
        sum += usize::from(most);
    }
    let count = (a.rgba().len() / 4) as f64;
    (far as f64 / count, sum as f64 / count)
}

/// Closed mesh whose picture has no holes from any side: seen from the origin, it is a ball with
/// bumps.
pub fn bumpy(faces: usize) -> Mesh {
    let mut ball = meshlod::samples::sphere(faces);
    for p in &mut ball.positions {
        let [x, y, z] = *p;
        let bump = 1.0 + 0.12 * (9.0 * x).sin() * (7.0 * y + 1.0).sin() * (8.0 * z + 2.0).sin();
        *p = [x * bump, y * bump, z * bump];
    }
    ball.attributes = None;
    ball
}

//! Helpers of the tests on the GPU.
#![allow(dead_code)]

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

/// Counts background pixels inside the silhouette: those that cannot be reached from the rim of the
/// picture over background pixels. The background must be transparent.
pub fn cracks(picture: &Picture) -> usize {
    let [width, height] = [picture.width() as usize, picture.height() as usize];
    let is_background = |at: usize| picture.rgba()[4 * at + 3] == 0;
    let mut reached = vec![false; width * height];
    let is_rim = |at: usize| {
        let (x, y) = (at % width, at / width);
        x == 0 || y == 0 || x + 1 == width || y + 1 == height
    };
    let mut stack: Vec<usize> =
        (0..width * height).filter(|&at| is_rim(at) && is_background(at)).collect();
    stack.iter().for_each(|&at| reached[at] = true);
    while let Some(at) = stack.pop() {
        if is_rim(at) {
            // Rims are all in the stack from the start; only look inwards from there.
            let inwards = [at.wrapping_sub(1), at + 1, at.wrapping_sub(width), at + width];
            for next in inwards.into_iter().filter(|&next| next < width * height) {
                if !is_rim(next) && !reached[next] && is_background(next) {
                    reached[next] = true;
                    stack.push(next);
                }
            }
            continue;
        }
        for next in [at - 1, at + 1, at - width, at + width] {
            if !reached[next] && is_background(next) {
                reached[next] = true;
                stack.push(next);
            }
        }
    }
    (0..width * height).filter(|&at| is_background(at) && !reached[at]).count()
}

//! Our FLIP against its authors' implementation.

use meshlod::picture::{Camera, Paint, Picture, Style, flip, render};
use meshlod::samples;

fn theirs(reference: &Picture, test: &Picture) -> Vec<f32> {
    let image = |picture: &Picture| {
        let rgb: Vec<u8> =
            picture.rgba().chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        nv_flip::FlipImageRgb8::with_data(picture.width(), picture.height(), &rgb)
    };
    let ppd = meshlod::picture::PIXELS_PER_DEGREE as f32;
    nv_flip::flip(image(reference), image(test), ppd).to_vec()
}

#[test]
fn every_pixel_has_the_error_that_the_authors_program_gives() {
    let meshes = [samples::fish(4_000), samples::fish(400)];
    let camera = Camera::icosahedron_views(&meshes[0])[1];
    for paint in [Paint::Checker { squares: 16 }, Paint::Colors, Paint::default()] {
        let style = Style { paint, size: [300, 260], ..Style::comparison() };
        let [a, b] = meshes.each_ref().map(|mesh| render(mesh, &camera, &style).unwrap());
        let (ours, theirs) = (flip(&a, &b).unwrap(), theirs(&a, &b));
        let apart = ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs());
        let most = apart.fold(0.0, f32::max);
        assert!(most < 2e-4, "{:?}: off by {most}", style.paint);
        assert!(theirs.iter().any(|&error| error > 0.2));
    }
}

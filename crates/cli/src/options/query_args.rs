//! Parsers of the values of a multiresolution query: error limit, focus and camera.

pub use meshlod::jobs::ErrorLimit;
use meshlod::jobs::FocusRequest;
use meshlod::multires::{Focus, GroundShape, ViewCamera};

use crate::options::parse;

/// Parses an error limit: `1px`, `0.1%` or `0.5`.
pub fn error_limit(text: &str) -> Result<ErrorLimit, String> {
    match text.strip_suffix("px") {
        Some(pixels) => parse::length(pixels).map(ErrorLimit::Pixels),
        None => parse::bound(text).map(ErrorLimit::Length),
    }
}

/// Parses a focus region such as `box=x0,y0,z0,x1,y1,z1`.
pub fn focus(text: &str) -> Result<FocusRequest, String> {
    let (name, rest) = text.split_once('=').unwrap_or((text, ""));
    let numbers = || rest.split(',').map(parse::number).collect::<Result<Vec<_>, _>>();
    let focus = match (name, numbers().as_deref()) {
        ("frustum", _) if rest.is_empty() => return Ok(FocusRequest::Frustum),
        ("point", Ok(&[x, y, z])) => Focus::Point([x, y, z]),
        ("segment", Ok(&[a, b, c, x, y, z])) => Focus::Segment([[a, b, c], [x, y, z]]),
        ("ground-line", Ok(&[a, b, x, y])) => {
            return Ok(FocusRequest::Ground(GroundShape::Line([[a, b], [x, y]])));
        }
        ("ground-box", Ok(&[a, b, x, y])) => {
            return Ok(FocusRequest::Ground(GroundShape::Box([[a, b], [x, y]])));
        }
        ("box", Ok(&[a, b, c, x, y, z])) => Focus::Box([[a, b, c], [x, y, z]]),
        ("sphere", Ok(&[x, y, z, radius])) => Focus::Sphere { center: [x, y, z], radius },
        _ => {
            return Err("expected point=x,y,z, segment=x,y,z,x,y,z, box=x,y,z,x,y,z with the \
                        minimum corner first, sphere=x,y,z,r, ground-line=x,y,x,y, ground-box=x,y,x,y \
                        or frustum"
                .into());
        }
    };
    Ok(FocusRequest::Region(focus))
}

/// Form of a camera.
pub const CAMERA: &str = "eye=x,y,z look=x,y,z fov=45 1920x1080";

/// Parses a camera: `eye=x,y,z look=x,y,z fov=45 1920x1080`, with an optional `up=x,y,z`.
pub fn camera(text: &str) -> Result<ViewCamera, String> {
    let form = || {
        format!(
            "expected \"{CAMERA}\" with the vertical field of view in degrees, and up=x,y,z unless y \
             is up"
        )
    };
    let (mut eye, mut look, mut up, mut fov, mut viewport) = (None, None, None, None, None);
    for word in text.split_whitespace() {
        match word.split_once('=') {
            Some(("eye", place)) => eye = Some(triple(place)?),
            Some(("look", place)) => look = Some(triple(place)?),
            Some(("up", direction)) => up = Some(triple(direction)?),
            Some(("fov", degrees)) => fov = Some(parse::number(degrees)?.to_radians()),
            None if word.contains('x') => viewport = Some(parse::pixels(word)?),
            None | Some(_) => return Err(form()),
        }
    }
    match (eye, look, fov, viewport) {
        (Some(eye), Some(look), Some(fov_rad), Some(viewport)) => {
            Ok(ViewCamera { eye, look, up: up.unwrap_or([0.0, 1.0, 0.0]), fov_rad, viewport })
        }
        _ => Err(form()),
    }
}

fn triple(text: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = text.split(',').map(parse::number).collect::<Result<_, _>>()?;
    numbers.try_into().map_err(|_| format!("{text:?} is not three numbers separated by commas"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::parse::Bound;

    #[test]
    fn cameras_are_written_in_words() {
        let camera = camera("eye=0,0.1,0.3 look=0,0.1,0 fov=90 1920x1080").unwrap();
        assert_eq!((camera.eye, camera.viewport), ([0.0, 0.1, 0.3], [1920, 1080]));
        assert_eq!((camera.fov_rad, camera.up), (std::f64::consts::FRAC_PI_2, [0.0, 1.0, 0.0]));
        let all = "eye=0,0,1 look=0,0,0 fov=45 640x480";
        for word in all.split(' ') {
            assert!(super::camera(&all.replace(word, "")).is_err(), "without {word}");
        }
        assert!(super::camera(&format!("{all} nose=1,2,3")).is_err());
        assert!(super::camera(&all.replace("0,0,1", "0,0")).is_err());
    }

    #[test]
    fn a_focus_has_a_shape() {
        assert!(matches!(focus("frustum"), Ok(FocusRequest::Frustum)));
        assert!(matches!(
            focus("point=1,2,3"),
            Ok(FocusRequest::Region(Focus::Point([1.0, 2.0, 3.0])))
        ));
        assert!(matches!(focus("sphere=1,2,3,4"), Ok(FocusRequest::Region(Focus::Sphere { .. }))));
        assert!(matches!(
            focus("ground-box=1,2,3,4"),
            Ok(FocusRequest::Ground(GroundShape::Box([[1.0, 2.0], [3.0, 4.0]])))
        ));
        for bad in
            ["box=1,2,3", "ground-line=1,2,3", "ball=1,2,3,4", "", "point=1,2,x", "frustum=1"]
        {
            assert!(focus(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn errors_are_pixels_parts_or_lengths() {
        assert_eq!(error_limit("1px"), Ok(ErrorLimit::Pixels(1.0)));
        assert_eq!(error_limit("0.01%"), Ok(ErrorLimit::Length(Bound::OfDiagonal(0.0001))));
        assert_eq!(error_limit("0"), Ok(ErrorLimit::Length(Bound::Length(0.0))));
        assert!(error_limit("-1px").is_err() && error_limit("px").is_err());
    }
}

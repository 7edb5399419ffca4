//! Points of other libraries.

/// Point in space, with three coordinates of single or double precision.
///
/// Arrays are points; vectors of glam 0.34, and points and vectors of mint 0.5, are too, behind
/// features with the names of these crates. Those of another glam become arrays by `to_array`.
pub trait Point: Copy {
    /// Creates the point from its coordinates, rounded to its precision.
    fn from_f64(coordinates: [f64; 3]) -> Self;

    /// Returns the coordinates of the point.
    fn to_f64(self) -> [f64; 3];
}

macro_rules! impl_point {
    ($($point:ty: $float:ty),+) => {$(
        impl Point for $point {
            #[inline]
            fn from_f64(coordinates: [f64; 3]) -> Self {
                coordinates.map(|x| x as $float).into()
            }

            #[inline]
            fn to_f64(self) -> [f64; 3] {
                let coordinates: [$float; 3] = self.into();
                coordinates.map(f64::from)
            }
        }
    )+};
}

impl_point!([f32; 3]: f32, [f64; 3]: f64);

#[cfg(feature = "glam")]
impl_point!(glam::Vec3: f32, glam::Vec3A: f32, glam::DVec3: f64);

#[cfg(feature = "mint")]
impl_point!(
    mint::Point3<f32>: f32, mint::Point3<f64>: f64, mint::Vector3<f32>: f32, mint::Vector3<f64>: f64
);

#[cfg(test)]
mod tests {
    use super::*;

    /// Coordinates, the last with more digits than single precision has.
    const POINT: [f64; 3] = [1.0, -2.5, 0.1];

    fn back<P: Point>() -> [f64; 3] {
        P::from_f64(POINT).to_f64()
    }

    #[test]
    fn points_are_rounded_to_their_precision_alone() {
        assert_eq!(back::<[f64; 3]>(), POINT);
        assert_eq!(back::<[f32; 3]>(), POINT.map(|x| f64::from(x as f32)));
    }

    #[cfg(all(feature = "glam", feature = "mint"))]
    #[test]
    fn vectors_of_other_libraries_are_points() {
        let single = back::<[f32; 3]>();
        assert_eq!(glam::DVec3::from_f64(POINT), glam::DVec3::new(1.0, -2.5, 0.1));
        assert_eq!([back::<glam::Vec3>(), back::<glam::Vec3A>()], [single; 2]);
        assert_eq!([back::<glam::DVec3>(), back::<mint::Point3<f64>>()], [POINT; 2]);
        assert_eq!(back::<mint::Vector3<f64>>(), POINT);
        assert_eq!([back::<mint::Point3<f32>>(), back::<mint::Vector3<f32>>()], [single; 2]);
    }
}

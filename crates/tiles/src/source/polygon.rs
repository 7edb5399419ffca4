//! Faces of any number of corners, cut into triangles.

use meshlod_io::triangulate;

/// Triangles of a group of faces, to be filled one after the other.
pub(super) struct Slots<'t> {
    pub places: &'t mut [[f64; 3]],
    pub values: &'t mut [f32],
    /// Number of values of a corner.
    pub width: usize,
    /// Corners that are filled.
    pub at: usize,
}

impl Slots<'_> {
    /// Fills the next corner.
    #[inline]
    pub fn put(&mut self, place: [f64; 3], values: &[f32]) {
        self.places[self.at] = place;
        self.values[self.at * self.width..][..self.width].copy_from_slice(values);
        self.at += 1;
    }
}

/// Corners of a face.
#[derive(Default)]
pub(super) struct Polygon {
    pub places: Vec<[f64; 3]>,
    /// Values of all corners, one after the other.
    pub values: Vec<f32>,
    order: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

impl Polygon {
    /// Forgets all corners.
    pub fn clear(&mut self) {
        self.places.clear();
        self.values.clear();
    }

    /// Cuts the face into triangles.
    pub fn cut_into(&mut self, slots: &mut Slots<'_>) {
        let Self { places, values, order, triangles } = self;
        triangles.clear();
        order.clear();
        order.extend(0..places.len() as u32);
        triangulate(places, order, triangles);
        let width = slots.width;
        for corner in triangles.as_flattened() {
            let corner = *corner as usize;
            slots.put(places[corner], &values[corner * width..][..width]);
        }
    }
}

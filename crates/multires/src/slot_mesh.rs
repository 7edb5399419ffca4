//! The triangles of a cut as renderers copy them: by slot, with the slots that an update changed.

/// A mesh whose triangles lie in slots, of which an update changes only some.
///
/// [`Cut`](crate::Cut), [`RtinCut`](crate::RtinCut) and [`Geomorph`](crate::Geomorph) are such
/// meshes. A copy of all slots, kept up to date by [`patches`](Self::patches) or
/// [`touched_slots`](Self::touched_slots), is an index buffer.
pub trait SlotMesh {
    /// Returns the number of faces of the current mesh, in a [`Geomorph`](crate::Geomorph) those
    /// without area included.
    fn face_count(&self) -> usize;

    /// Returns the number of vertices of the current mesh.
    fn vertex_count(&self) -> usize;

    /// Returns the number of triangle slots, which is the length of a list indexed by
    /// [`Patch::slot`].
    fn slots(&self) -> usize;

    /// Returns the three nodes of the triangle in a slot, or `None` if the slot is empty.
    fn triangle(&self, slot: u32) -> Option<[u32; 3]>;

    /// Returns the wedges at the corners of the triangle in a slot, in the numbers of
    /// [`Implicit::layers`](crate::Implicit::layers); `None` if the slot is empty or the model has
    /// no wedges, as height fields have none.
    fn wedges(&self, slot: u32) -> Option<[u32; 3]>;

    /// Iterates over the triangle slots that the last update changed, in no particular order.
    fn patches(&self) -> Box<dyn Iterator<Item = Patch> + '_>;

    /// Iterates over the triangle slots that the last update wrote, in no particular order.
    ///
    /// Beside those of [`patches`](Self::patches) these may be slots that hold the same nodes as
    /// before, though at other wedges: two faces may have the same three vertices.
    fn touched_slots(&self) -> Box<dyn Iterator<Item = u32> + '_>;

    /// Iterates over the triangles of the current mesh, each by its slot and its three nodes.
    fn triangles(&self) -> Box<dyn Iterator<Item = (u32, [u32; 3])> + '_> {
        let slots = 0..self.slots() as u32;
        Box::new(slots.filter_map(|slot| Some((slot, self.triangle(slot)?))))
    }
}

/// Change of one slot in a list of triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patch {
    /// Index of the changed slot.
    pub slot: u32,
    /// Nodes of the triangle that was in the slot before; `None` if the slot was empty.
    pub old: Option<[u32; 3]>,
    /// Nodes of the triangle that is in the slot now; `None` if the slot is empty.
    pub new: Option<[u32; 3]>,
}

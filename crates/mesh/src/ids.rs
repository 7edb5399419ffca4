//! Typed 32-bit indices of vertices, faces and wedges, printed as `v12`, `f3` and `w7`.

use std::fmt;

macro_rules! id {
    ($name:ident, $letter:literal, $what:literal) => {
        #[doc = concat!("Index of ", $what, ".")]
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
        #[cfg_attr(feature = "bytemuck", derive(bytemuck::Pod, bytemuck::Zeroable))]
        #[repr(transparent)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serde", serde(transparent))]
        pub struct $name(pub u32);

        impl $name {
            #[doc = concat!("Creates the id of ", $what, ", from its index in its array.\n\n# Panics\nIf `index` is 2³² or more.")]
            #[inline]
            pub fn new(index: usize) -> Self {
                Self(u32::try_from(index).expect("ids are 32 bits"))
            }

            /// Returns the id as a `usize`, to index the array of vertices, faces or wedges.
            #[inline]
            pub const fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!($letter, "{}"), self.0)
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                fmt::Display::fmt(self, f)
            }
        }
    };
}

id!(VertexId, "v", "a vertex");
id!(FaceId, "f", "a face");
id!(WedgeId, "w", "a wedge");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_print_with_their_letter() {
        assert_eq!(format!("{} {:?} {}", VertexId(12), FaceId(3), WedgeId(7)), "v12 f3 w7");
    }

    #[cfg(feature = "bytemuck")]
    #[test]
    fn faces_are_a_list_of_indices() {
        let faces =
            [[VertexId(0), VertexId(1), VertexId(2)], [VertexId(2), VertexId(1), VertexId(3)]];
        assert_eq!(bytemuck::cast_slice::<_, u32>(&faces), [0, 1, 2, 2, 1, 3]);
    }
}

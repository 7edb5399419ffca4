//! Polygons to triangles.

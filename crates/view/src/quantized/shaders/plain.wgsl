// Positions as three f32, to compare with.

@vertex
fn bare(@location(0) position: vec3f) -> Fragment {
    return seen_at(position, vec3f(0.0), 0u);
}

// What all schemes share: a vertex at a decoded place, and its surface of one colour.

struct Scheme {
    // Sides of a cell of the grid or lattice.
    scale: vec3f,
}

@group(1) @binding(0) var<uniform> scheme: Scheme;

struct Fragment {
    @invariant @builtin(position) clip: vec4f,
    @location(0) place: vec3f,
    @location(1) normal: vec3f,
    // Number of the part or block.
    @location(2) @interpolate(flat) piece: u32,
}

// Linear light of sRGB 226, 208, 186.
const CLAY = vec3f(0.7605245, 0.6307571, 0.4910208);

// Equal places give equal bits, whatever the piece: all that follows is the same for all of them.
fn seen_at(place: vec3f, normal: vec3f, piece: u32) -> Fragment {
    return Fragment(draw.clip_from_local * vec4f(place, 1.0), place, normal, piece);
}

// Unit vector from its point on the unfolded octahedron; zero from the corner that means none.
fn unfolded(at: vec2f) -> vec3f {
    if all(at <= vec2f(-1.0)) {
        return vec3f(0.0);
    }
    let z = 1.0 - abs(at.x) - abs(at.y);
    let over = vec2f(max(-z, 0.0));
    return normalize(vec3f(at - select(-over, over, at >= vec2f(0.0)), z));
}

// Colour that tells a piece from its neighbours.
fn piece_color(piece: u32) -> vec3f {
    let hue = fract(f32(piece & 0xffffu) * 0.61803399) * 6.0;
    let color = clamp(abs((vec3f(hue) + vec3f(0.0, 4.0, 2.0)) % 6.0 - 3.0) - 1.0, vec3f(0.0), vec3f(1.0));
    return mix(vec3f(0.6), color, 0.55);
}

@fragment
fn shaded(in: Fragment, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    dissolve(in.clip);
    let to_eye = normalize(draw.eye - in.place);
    let normal = seen_normal(in.normal, in.place, to_eye, front);
    var color = select(CLAY, vec3f(1.0), has(TINT_ONLY)) * draw.tint;
    if has(FACE_COLORS) {
        color = piece_color(in.piece) * draw.tint;
    }
    if has(TINT_BACK) && !front {
        color = draw.back;
    }
    return vec4f(lit(color, normal, to_eye), 1.0);
}

// What all shaders share: how a thing is seen and lit. Lights are those of meshlod::picture.

struct Draw {
    clip_from_local: mat4x4f,
    // Eye, relative to the origin of the thing.
    eye: vec3f,
    lighting: u32,
    // Unit vectors to the key light and up.
    to_key: vec3f,
    flags: u32,
    up: vec3f,
    // Share of the pixels that are drawn, for transitions. Below 0 the share is 1 less: t - 1 draws
    // exactly the pixels that t leaves out.
    shown: f32,
    // Linear colours; alpha is the opacity of the wireframe, and the width of its lines.
    wire: vec4f,
    back: vec3f,
    wire_width: f32,
    // Multiplies the colour of the surface.
    tint: vec3f,
    seed: f32,
}

@group(0) @binding(0) var<uniform> draw: Draw;

const HEADLIGHT = 1u;
const SOFT = 2u;
const UNLIT = 3u;

const FLAT = 1u;
const TINT_BACK = 2u;
const WIREFRAME = 4u;
const FACE_COLORS = 8u;
const TINT_ONLY = 16u;
const CHECKER = 32u;

fn has(flag: u32) -> bool {
    return (draw.flags & flag) != 0u;
}

// Light that a surface reflects; normal and to_eye are unit vectors.
fn lit(color: vec3f, normal: vec3f, to_eye: vec3f) -> vec3f {
    let facing = max(dot(normal, to_eye), 0.0);
    switch draw.lighting {
        case UNLIT: { return color; }
        case HEADLIGHT: { return color * (0.2 + 0.8 * facing); }
        case SOFT: { return color * (0.45 + 0.55 * facing); }
        default: { return studio(color, normal, to_eye, facing); }
    }
}

fn studio(color: vec3f, normal: vec3f, to_eye: vec3f, facing: f32) -> vec3f {
    let key = max((dot(normal, draw.to_key) + 0.1) / 1.1, 0.0);
    let sky = vec3f(0.21, 0.235, 0.27);
    let ground = vec3f(0.075, 0.066, 0.06);
    let ambient = mix(ground, sky, 0.5 + 0.5 * dot(normal, draw.up));
    let diffuse = ambient + vec3f(0.90, 0.86, 0.79) * key + vec3f(0.13 * facing);
    let halfway = normalize(draw.to_key + to_eye);
    let gloss = pow(max(dot(normal, halfway), 0.0), 32.0) * 0.10;
    return color * diffuse + vec3f(gloss);
}

// Normal of the face around a fragment, towards the eye, from the places of its neighbours.
fn flat_normal(place: vec3f, to_eye: vec3f) -> vec3f {
    let normal = cross(dpdx(place), dpdy(place));
    let long = dot(normal, normal);
    let unit = select(to_eye, normal * inverseSqrt(long), long > 0.0);
    return select(-unit, unit, dot(unit, to_eye) >= 0.0);
}

// Shading normal on the side that is seen; flat where there is none.
fn seen_normal(normal: vec3f, place: vec3f, to_eye: vec3f, front: bool) -> vec3f {
    let face = flat_normal(place, to_eye);
    let long = dot(normal, normal);
    if has(FLAT) || !(long > 1e-12) {
        return face;
    }
    let unit = normal * inverseSqrt(long);
    return select(-unit, unit, front);
}

fn decode_srgb(color: vec3f) -> vec3f {
    let low = color / 12.92;
    let high = pow((color + 0.055) / 1.055, vec3f(2.4));
    return select(high, low, color <= vec3f(0.04045));
}

// Leaves out a share of the pixels, in a pattern that looks even.
fn dissolve(pixel: vec4f) {
    if draw.shown >= 1.0 {
        return;
    }
    let at = floor(pixel.xy) + draw.seed;
    let noise = fract(52.9829189 * fract(dot(at, vec2f(0.06711056, 0.00583715))));
    if select(noise >= draw.shown, noise < draw.shown + 1.0, draw.shown < 0.0) {
        discard;
    }
}

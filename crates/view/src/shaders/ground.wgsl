// Soft shadow on the ground: a blurred picture of the thing from above.

struct Place {
    clip_from_local: mat4x4f,
    // Middle of the square, relative to the origin; half of its side.
    middle: vec3f,
    half: f32,
    // The two sides of the square, unit vectors.
    right: vec3f,
    opacity: f32,
    ahead: vec3f,
    // Step of the blur in texels of the map, across or down.
    step: f32,
}

@group(0) @binding(0) var<uniform> place: Place;
@group(0) @binding(1) var map: texture_2d<f32>;
@group(0) @binding(2) var map_sampler: sampler;

struct Pixel {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn square(@builtin(vertex_index) i: u32) -> Pixel {
    let uv = vec2f(f32(i & 1u), f32(i >> 1u));
    let at = (uv * 2.0 - 1.0) * place.half;
    let position = place.middle + place.right * at.x - place.ahead * at.y;
    return Pixel(place.clip_from_local * vec4f(position, 1.0), uv);
}

@fragment
fn shadow(in: Pixel) -> @location(0) vec4f {
    let dark = textureSample(map, map_sampler, in.uv).a;
    // Nothing is left at the rim of the square.
    let from_middle = length(in.uv * 2.0 - 1.0);
    let fade = 1.0 - smoothstep(0.75, 1.0, from_middle);
    return vec4f(0.0, 0.0, 0.0, dark * fade * place.opacity);
}

@vertex
fn screen(@builtin(vertex_index) i: u32) -> Pixel {
    let uv = vec2f(f32(i & 1u), f32(i >> 1u)) * 2.0;
    return Pixel(vec4f(uv * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0), 0.0, 1.0), uv);
}

// Gaussian of 13 taps along the ahead vector's x and y.
@fragment
fn blur(in: Pixel) -> @location(0) vec4f {
    let weights = array(0.1964826, 0.1756650, 0.1255394, 0.0716826, 0.0327082, 0.0119294, 0.0034773);
    let step = place.ahead.xy * place.step / vec2f(textureDimensions(map));
    var sum = textureSampleLevel(map, map_sampler, in.uv, 0.0).a * weights[0];
    for (var i = 1; i < 7; i++) {
        let by = step * f32(i);
        sum += textureSampleLevel(map, map_sampler, in.uv + by, 0.0).a * weights[i];
        sum += textureSampleLevel(map, map_sampler, in.uv - by, 0.0).a * weights[i];
    }
    return vec4f(0.0, 0.0, 0.0, sum);
}

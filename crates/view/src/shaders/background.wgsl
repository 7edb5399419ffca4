// Vertical gradient behind everything, even in sRGB.

struct Gradient {
    // sRGB, and the opacity.
    top: vec4f,
    bottom: vec4f,
}

@group(0) @binding(0) var<uniform> gradient: Gradient;

struct Pixel {
    @builtin(position) clip: vec4f,
    @location(0) down: f32,
}

@vertex
fn corner(@builtin(vertex_index) i: u32) -> Pixel {
    let at = vec2f(f32(i & 1u), f32(i >> 1u)) * 2.0;
    // At infinity: depth 0.
    return Pixel(vec4f(at * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0), 0.0, 1.0), at.y);
}

@fragment
fn fill(in: Pixel) -> @location(0) vec4f {
    let color = mix(gradient.top, gradient.bottom, in.down);
    let low = color.rgb / 12.92;
    let high = pow((color.rgb + 0.055) / 1.055, vec3f(2.4));
    return vec4f(select(high, low, color.rgb <= vec3f(0.04045)), 1.0);
}

/**
 * Shaders of the viewer: metal and roughness as glTF defines them, in the light of a sky, a ground
 * and a lamp beside the viewer.
 */

/** Attributes in the order of their locations. */
export const ATTRIBUTES = ["position", "normal", "uv", "color"] as const;

/** Textures in the order of their units. */
export const TEXTURES = ["base", "normal", "surface", "occlusion", "emissive"] as const;

export const VERTEX = `#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec4 color;
uniform mat4 toClip;
uniform vec3 center;
uniform mat3 uvTransform;
uniform bool growsUpwards;
out vec3 point;
out vec3 pointNormal;
out vec2 place;
out vec4 pointColor;
void main() {
    point = position - center;
    pointNormal = normal;
    vec2 down = growsUpwards ? vec2(uv.x, 1.0 - uv.y) : uv;
    place = (uvTransform * vec3(down, 1.0)).xy;
    pointColor = color;
    gl_Position = toClip * vec4(point, 1.0);
}`;

const LIGHT = `
const float PI = 3.14159265;
// The sky, the ground and a wide window beside the viewer, blurred as a rough surface sees them.
vec3 surroundings(vec3 direction, float roughness) {
    float height = dot(direction, upward);
    float blur = mix(0.12, 1.1, roughness);
    vec3 all = mix(vec3(0.30, 0.29, 0.28), vec3(0.92, 0.95, 1.0), smoothstep(-blur, blur, height));
    float window = smoothstep(0.86 - 0.7 * roughness, 1.0, dot(direction, lamp));
    return all + window * mix(1.6, 0.35, roughness);
}
vec3 fresnel(vec3 straight, vec3 grazing, float cosine) {
    return straight + (grazing - straight) * pow(1.0 - cosine, 5.0);
}
// What the lamp gives: a diffuse part, and a highlight by the distribution of Trowbridge and Reitz.
vec3 lit(vec3 n, vec3 v, vec3 diffuse, vec3 straight, float roughness) {
    vec3 halfway = normalize(lamp + v);
    float nl = max(dot(n, lamp), 0.0);
    float nv = max(dot(n, v), 1e-3);
    float nh = max(dot(n, halfway), 0.0);
    float a = max(roughness * roughness, 2e-3);
    float d = nh * nh * (a * a - 1.0) + 1.0;
    float k = 0.5 * a;
    float shade = 4.0 * (nl * (1.0 - k) + k) * (nv * (1.0 - k) + k);
    vec3 mirrored = fresnel(straight, vec3(1.0), max(dot(lamp, halfway), 0.0));
    return nl * (diffuse + mirrored * (a * a / (d * d)) / shade);
}
vec3 encoded(vec3 c) {
    return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}`;

export const FRAGMENT = `#version 300 es
precision highp float;
in vec3 point;
in vec3 pointNormal;
in vec2 place;
in vec4 pointColor;
uniform vec3 eye;
uniform vec3 upward;
uniform vec3 lamp;
uniform vec4 base;
uniform vec3 emissive;
uniform float metal;
uniform float rough;
uniform float normalScale;
uniform float occlusionStrength;
uniform float cutoff;
uniform bool isUnlit;
uniform bool hasNormals;
uniform bool has[5];
uniform sampler2D maps[5];
out vec4 pixel;
${LIGHT}
// The normal, bent by its texture, whose axes come from how places change over the picture.
vec3 bentNormal(vec3 v) {
    vec3 x = dFdx(point), y = dFdy(point);
    vec3 n = hasNormals ? normalize(pointNormal) : normalize(cross(x, y));
    if (dot(n, n) < 0.5) n = normalize(cross(x, y));
    if (hasNormals && !gl_FrontFacing) n = -n;
    if (!has[1]) return n;
    vec2 px = dFdx(place), py = dFdy(place);
    float turned = px.x * py.y - px.y * py.x;
    if (turned == 0.0) return n;
    vec3 t = (x * py.y - y * px.y) / turned;
    vec3 b = (y * px.x - x * py.x) / turned;
    t = normalize(t - n * dot(n, t));
    b = normalize(b - n * dot(n, b));
    vec3 bent = texture(maps[1], place).xyz * 2.0 - 1.0;
    bent.xy *= normalScale;
    // Rows of images go down, and green points up.
    return normalize(t * bent.x - b * bent.y + n * max(bent.z, 1e-3));
}
void main() {
    vec4 color = base * pointColor;
    if (has[0]) color *= texture(maps[0], place);
    if (color.a < cutoff) discard;
    vec3 v = normalize(eye - point);
    vec3 n = bentNormal(v);
    vec3 light = color.rgb;
    if (!isUnlit) {
        vec4 surface = has[2] ? texture(maps[2], place) : vec4(1.0);
        float roughness = clamp(rough * surface.g, 0.04, 1.0);
        float metalness = metal * surface.b;
        float open = has[3] ? 1.0 + occlusionStrength * (texture(maps[3], place).r - 1.0) : 1.0;
        vec3 straight = mix(vec3(0.04), color.rgb, metalness);
        vec3 diffuse = color.rgb * (1.0 - metalness);
        vec3 grazing = max(vec3(1.0 - roughness), straight);
        vec3 mirrored = fresnel(straight, grazing, max(dot(n, v), 0.0));
        light = open * (diffuse * surroundings(n, 1.0) * 0.62
            + mirrored * surroundings(reflect(-v, n), roughness));
        light += 0.55 * lit(n, v, diffuse, straight, roughness);
        vec3 glow = has[4] ? texture(maps[4], place).rgb : vec3(1.0);
        light += emissive * glow;
        // Bright light becomes white slowly.
        light = mix(light, 1.0 - exp(-light), smoothstep(0.6, 1.6, light));
    }
    pixel = vec4(encoded(clamp(light, 0.0, 1.0)), color.a) ;
    pixel.rgb *= pixel.a;
}`;

#include "render/shaders.h"

namespace phyxel::shaders {
namespace {

const char* const version = "#version 330 core\n";

/// The backdrop: light, brighter in the middle of the picture. A trace of noise keeps its slow gradient from showing
/// the 256 steps of a byte.
const char* const backdrop = R"(
uniform vec2 picture_size;
vec3 backdrop() {
    vec2 p = gl_FragCoord.xy / picture_size;
    float height = smoothstep(0.25, 1.0, p.y);
    float corner = dot(p - 0.5, p - 0.5);
    vec3 color = mix(vec3(0.745, 0.765, 0.785), vec3(0.56, 0.63, 0.70), height) * (1.0 - 0.35 * corner);
    float noise = fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
    return color + (noise - 0.5) / 255.0;
}
)";

/// Key light with soft shadow (percentage-closer filtering, Reeves et al. 1987), light from the sky and from the
/// ground by the direction of the normal, a weak fill from the eye.
const char* const lighting = R"(
uniform vec3 eye, light, up;
uniform sampler2DShadow shadow_map;
uniform mat4 to_shadow;
uniform float shadow_step;    // between taps, in the map's own width
uniform float shadow_offset;  // along the normal [m], against a surface's shadow on itself

float key_visibility(vec3 position, vec3 normal) {
    vec3 p = (to_shadow * vec4(position + shadow_offset * normal, 1.0)).xyz * 0.5 + 0.5;
    // Outside of the map the loop has no turns: software rasterizers then skip it.
    bool inside = all(lessThan(abs(p.xy - 0.5), vec2(0.5)));
    int last = inside ? 2 : -3;
    float lit = 0.0, total = 1e-6;
    for (int y = -2; y <= last; ++y)
        for (int x = -2; x <= last; ++x) {
            float weight = 1.0 / (1.0 + 0.35 * float(x * x + y * y));
            lit += weight * texture(shadow_map, vec3(p.xy + shadow_step * vec2(x, y), p.z));
            total += weight;
        }
    return inside ? lit / total : 1.0;
}

vec3 shade(vec3 albedo, vec3 normal, vec3 position, float open_sky, float gloss) {
    vec3 to_eye = normalize(eye - position);
    vec3 halfway = normalize(light + to_eye);
    float facing = dot(normal, light);
    float key = smoothstep(0.0, 0.15, facing) * key_visibility(position, normal);
    vec3 sky = mix(vec3(0.26, 0.245, 0.23), vec3(0.40, 0.435, 0.48), 0.5 + 0.5 * dot(normal, up));
    vec3 diffuse = sky * open_sky + vec3(0.80, 0.77, 0.72) * max(facing, 0.0) * key +
                   0.10 * max(dot(normal, to_eye), 0.0);
    float shine = gloss * (0.22 * pow(max(dot(normal, halfway), 0.0), 48.0) * key +
                           0.10 * pow(1.0 - max(dot(normal, to_eye), 0.0), 4.0));
    return albedo * diffuse + shine;
}
)";

}  // namespace

std::string depth_vertex() {
    return std::string(version) + R"(
layout(location = 0) in vec3 position;
uniform mat4 to_world, to_clip;
void main() { gl_Position = to_clip * (to_world * vec4(position, 1.0)); }
)";
}

std::string depth_fragment() { return std::string(version) + "void main() {}\n"; }

std::string square_vertex() {
    return std::string(version) + R"(
layout(location = 0) in vec3 position;
uniform vec2 center, half_size;
out vec2 place;  // 0 to 1, from the lower left corner
void main() {
    place = position.xy * 0.5 + 0.5;
    gl_Position = vec4(center + half_size * position.xy, 0.0, 1.0);
}
)";
}

std::string backdrop_fragment() {
    return std::string(version) + backdrop + R"(
out vec4 color;
void main() { color = vec4(backdrop(), 1.0); }
)";
}

std::string overlay_fragment() {
    return std::string(version) + R"(
uniform sampler2D image;
in vec2 place;
out vec4 color;
void main() { color = texture(image, vec2(place.x, 1.0 - place.y)); }
)";
}

std::string contact_fragment() {
    // A patch dA at height h and horizontal distance r hides h^2 dA / (pi (h^2 + r^2)^2) of the light of an even sky
    // from a horizontal point: solid angle h dA / (h^2 + r^2)^(3/2) times the cosine h / (h^2 + r^2)^(1/2), over pi.
    return std::string(version) + R"(
uniform sampler2D heights;  // lowest surface above the floor, as depth
uniform float texel;        // [m]
uniform float depth, below; // [m] range of the depth map, and how far under the floor it begins
in vec2 place;
out vec4 hidden;
void main() {
    ivec2 size = textureSize(heights, 0), here = ivec2(place * vec2(size));
    float sum = 0.0;
    for (int y = -12; y <= 12; ++y)
        for (int x = -12; x <= 12; ++x) {
            ivec2 there = clamp(here + ivec2(x, y), ivec2(0), size - 1);
            float d = texelFetch(heights, there, 0).r;
            float h = max(d * depth - below, 1.5 * texel), r2 = float(x * x + y * y) * texel * texel;
            float share = h * h / ((h * h + r2) * (h * h + r2));
            sum += d < 1.0 ? share : 0.0;
        }
    hidden = vec4(min(sum * texel * texel / 3.14159265, 1.0));
}
)";
}

std::string surface_vertex() {
    return std::string(version) + R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float field;
uniform mat4 to_world, to_clip;
out vec3 world_position, world_normal;
out float value;
void main() {
    vec4 world = to_world * vec4(position, 1.0);
    world_position = world.xyz;
    world_normal = mat3(to_world) * normal;
    value = field;
    gl_Position = to_clip * world;
}
)";
}

std::string surface_fragment() {
    return std::string(version) + lighting + R"(
uniform vec3 albedo;        // linear
uniform sampler2D colors;
uniform int by_field;
uniform vec2 field_scale;   // the field's lower end, and one over its range
in vec3 world_position, world_normal;
in float value;
out vec4 color;
void main() {
    // Without a normal of its own the surface has its triangle's; seen from behind, it is turned to the eye.
    vec3 flat_normal = normalize(cross(dFdx(world_position), dFdy(world_position)));
    vec3 normal = dot(world_normal, world_normal) > 0.0 ? normalize(world_normal) : flat_normal;
    if ((dot(flat_normal, eye - world_position) < 0.0)) flat_normal = -flat_normal;
    if (dot(normal, flat_normal) < 0.0) normal = -normal;

    float t = clamp((value - field_scale.x) * field_scale.y, 0.0, 1.0);
    vec3 by_value = isnan(value) ? vec3(0.21) : texture(colors, vec2((t * 255.0 + 0.5) / 256.0, 0.5)).rgb;
    color = vec4(shade(by_field != 0 ? by_value : albedo, normal, world_position, 1.0, 1.0), 1.0);
}
)";
}

std::string floor_fragment() {
    // The pattern is averaged over the pixel (box filter of a checkerboard, I. Quilez 2010), so that it does not
    // flicker in the distance.
    return std::string(version) + backdrop + lighting + R"(
uniform vec3 middle, axis_u, axis_v;  // of the part that is seen
uniform float tile, clear_radius, fade_radius;  // [m]
uniform sampler2D contact;
uniform vec3 contact_middle;
uniform float contact_half_width;  // [m]; 0: none
in vec3 world_position, world_normal;
out vec4 color;

float checker(vec2 p) {
    vec2 w = max(fwidth(p), 1e-4);
    vec2 i = 2.0 * (abs(fract((p - 0.5 * w) * 0.5) - 0.5) - abs(fract((p + 0.5 * w) * 0.5) - 0.5)) / w;
    return 0.5 - 0.5 * i.x * i.y;
}

void main() {
    vec3 from_middle = world_position - middle;
    vec2 p = vec2(dot(from_middle, axis_u), dot(from_middle, axis_v));

    vec3 from_contact = world_position - contact_middle;
    vec2 q = vec2(dot(from_contact, axis_u), dot(from_contact, axis_v)) / max(contact_half_width, 1e-30);
    float edge = smoothstep(1.0, 0.7, max(abs(q.x), abs(q.y)));
    float hidden = edge * texture(contact, q * 0.5 + 0.5).r;

    vec2 absolute = vec2(dot(world_position, axis_u), dot(world_position, axis_v)) / tile;
    vec3 albedo = mix(vec3(0.80, 0.80, 0.795), vec3(0.70, 0.71, 0.715), checker(absolute));
    vec3 lit = shade(albedo, normalize(world_normal), world_position, 1.0 - 0.85 * hidden, 0.0);
    color = vec4(mix(lit, backdrop(), smoothstep(clear_radius, fade_radius, length(p))), 1.0);
}
)";
}

}  // namespace phyxel::shaders

// The body: triangles coloured by a field, lines and backgrounds in one flat colour each, given in metres relative to the
// camera's centre.
//
// The vertices have the components of the strain or of the rotation. These are interpolated, and the field's value is
// computed from them at each pixel, as `Field::of_components` does: the von Mises stress of a bent beam vanishes at its
// neutral axis, although it is large at all nodes.

struct View {
    // Clip space units per metre, x and y.
    scale: vec2<f32>,
    // Value at the lower end of the colour map, and the upper end minus the lower end, in the unit of the value: E times
    // the unit of the strain for a stress, E times its square for an energy.
    range: vec2<f32>,
    // Lamé constants relative to E.
    lambda: f32,
    mu: f32,
    // ε₃₃ = −thinning tr ε, and T₃₃ = out_of_plane tr T.
    thinning: f32,
    out_of_plane: f32,
    // Unit of the components.
    unit: f32,
    // Field, one of the constants below.
    field: u32,
    padding: vec2<u32>,
}

@group(0) @binding(0) var<uniform> view: View;
// The colour map at equal steps from 0 to 1.
@group(0) @binding(1) var<uniform> colormap: array<vec4<f32>, 64>;

const FIRST_COMPONENT: u32 = 0u;
const ANGLE: u32 = 1u;
const LARGEST_STRAIN: u32 = 2u;
const ENERGY_DENSITY: u32 = 3u;
const VON_MISES_BIOT: u32 = 4u;
const VON_MISES_CAUCHY: u32 = 5u;

struct Vertex {
    @location(0) position: vec2<f32>,
    // Opaque: the colour of the vertex. Transparent: the colour where the field has no value.
    @location(1) color: vec4<f32>,
    // ε₁₁, ε₂₂, ε₁₂; or cos θ, sin θ, 0; or the value, 0, 0.
    @location(2) components: vec3<f32>,
}

struct Fragment {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) color: vec4<f32>,
    @location(1) components: vec3<f32>,
}

@vertex
fn vertex(v: Vertex) -> Fragment {
    return Fragment(vec4<f32>(v.position * view.scale, 0.0, 1.0), v.color, v.components);
}

// Colours are in gamma space, as egui blends them; the target is not sRGB.
@fragment
fn flat_fragment(f: Fragment) -> @location(0) vec4<f32> {
    return f.color;
}

@fragment
fn mapped_fragment(f: Fragment) -> @location(0) vec4<f32> {
    if f.color.a > 0.0 {
        return f.color;
    }
    let e = f.components;
    if view.field == VON_MISES_CAUCHY && !has_volume(e) {
        return vec4<f32>(f.color.rgb, 1.0);
    }
    var position = 0.5;
    if view.range.y > 0.0 {
        position = (field_value(e) - view.range.x) / view.range.y;
    }
    let at = clamp(position, 0.0, 1.0) * 63.0;
    let low = min(u32(at), 62u);
    return mix(colormap[low], colormap[low + 1u], at - f32(low));
}

fn field_value(e: vec3<f32>) -> f32 {
    switch view.field {
        case ANGLE: {
            return degrees(atan2(e.y, e.x));
        }
        case LARGEST_STRAIN: {
            return abs(0.5 * (e.x + e.y)) + length(vec2<f32>(0.5 * (e.x - e.y), e.z));
        }
        case ENERGY_DENSITY: {
            let trace = e.x + e.y;
            return view.mu * (e.x * e.x + e.y * e.y + 2.0 * e.z * e.z) + 0.5 * view.lambda * trace * trace;
        }
        case VON_MISES_BIOT: {
            let t = biot(e);
            return von_mises(t, view.out_of_plane * (t.x + t.y));
        }
        case VON_MISES_CAUCHY: {
            // σ = T S / (det S (1 + ε₃₃)) in the rotated frame; T and S have the same principal axes.
            let t = biot(e);
            let s = stretch(e);
            let area = s.x * s.y - s.z * s.z;
            let ts = vec3<f32>(t.x * s.x + t.z * s.z, t.z * s.z + t.y * s.y, t.x * s.z + t.z * s.y);
            return von_mises(ts / (area * thickness(e)), view.out_of_plane * (t.x + t.y) / area);
        }
        default: {
            return e.x;
        }
    }
}

// T = 2 μ ε + λ tr(ε) I.
fn biot(e: vec3<f32>) -> vec3<f32> {
    let pressure = view.lambda * (e.x + e.y);
    return 2.0 * view.mu * e + vec3<f32>(pressure, pressure, 0.0);
}

// S = I + ε.
fn stretch(e: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(1.0, 1.0, 0.0) + view.unit * e;
}

// 1 + ε₃₃.
fn thickness(e: vec3<f32>) -> f32 {
    return 1.0 - view.thinning * view.unit * (e.x + e.y);
}

// False where the body is crushed or inverted: it has no Cauchy stress there.
fn has_volume(e: vec3<f32>) -> bool {
    let s = stretch(e);
    return s.x * s.y - s.z * s.z > 0.0 && thickness(e) > 0.0;
}

// Stress xx, yy, xy and zz.
fn von_mises(t: vec3<f32>, zz: f32) -> f32 {
    let d = vec3<f32>(t.x - t.y, t.y - zz, zz - t.x);
    return sqrt(0.5 * dot(d, d) + 3.0 * t.z * t.z);
}

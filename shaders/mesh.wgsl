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
    // 1 for ε = S − I with F = R S, 0 for linear theory, where T is the Cauchy stress.
    is_corotated: u32,
    padding: u32,
}

@group(0) @binding(0) var<uniform> view: View;
// The colour map at equal steps from 0 to 1.
@group(0) @binding(1) var<uniform> colormap: array<vec4<f32>, 64>;

const FIRST_COMPONENT: u32 = 0u;
const SECOND_COMPONENT: u32 = 1u;
const TWICE_THIRD_COMPONENT: u32 = 2u;
const LENGTH: u32 = 3u;
const ANGLE: u32 = 4u;
const LARGEST_STRAIN: u32 = 5u;
const LARGER_PRINCIPAL_STRAIN: u32 = 6u;
const SMALLER_PRINCIPAL_STRAIN: u32 = 7u;
const ENERGY_DENSITY: u32 = 8u;
// The fields from here on are of the Cauchy stress.
const VON_MISES: u32 = 9u;
const MATERIAL_STRESS_X: u32 = 10u;
const MATERIAL_STRESS_Y: u32 = 11u;
const MATERIAL_SHEAR_STRESS: u32 = 12u;
const STRESS_X: u32 = 13u;
const STRESS_Y: u32 = 14u;
const SHEAR_STRESS: u32 = 15u;
const LARGER_PRINCIPAL_STRESS: u32 = 16u;
const SMALLER_PRINCIPAL_STRESS: u32 = 17u;

struct Vertex {
    @location(0) position: vec2<f32>,
    // Opaque: the colour of the vertex. Transparent: the colour where the field has no value.
    @location(1) color: vec4<f32>,
    // ε₁₁, ε₂₂, ε₁₂; or u_x, u_y, 0; or the value, 0, 0.
    @location(2) components: vec3<f32>,
    // cos θ, sin θ.
    @location(3) rotation: vec2<f32>,
}

struct Fragment {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) color: vec4<f32>,
    @location(1) components: vec3<f32>,
    @location(2) rotation: vec2<f32>,
}

@vertex
fn vertex(v: Vertex) -> Fragment {
    return Fragment(vec4<f32>(v.position * view.scale, 0.0, 1.0), v.color, v.components, v.rotation);
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
    if view.field >= VON_MISES && !has_volume(e) {
        return vec4<f32>(f.color.rgb, 1.0);
    }
    var position = 0.5;
    if view.range.y > 0.0 {
        position = (field_value(e, f.rotation) - view.range.x) / view.range.y;
    }
    let at = clamp(position, 0.0, 1.0) * 63.0;
    let low = min(u32(at), 62u);
    return mix(colormap[low], colormap[low + 1u], at - f32(low));
}

fn field_value(e: vec3<f32>, rotation: vec2<f32>) -> f32 {
    switch view.field {
        case SECOND_COMPONENT: {
            return e.y;
        }
        case TWICE_THIRD_COMPONENT: {
            return 2.0 * e.z;
        }
        case LENGTH: {
            return length(e.xy);
        }
        case ANGLE: {
            return degrees(atan2(rotation.y, rotation.x));
        }
        case LARGEST_STRAIN: {
            return abs(0.5 * (e.x + e.y)) + radius(e);
        }
        case LARGER_PRINCIPAL_STRAIN: {
            return 0.5 * (e.x + e.y) + radius(e);
        }
        case SMALLER_PRINCIPAL_STRAIN: {
            return 0.5 * (e.x + e.y) - radius(e);
        }
        case ENERGY_DENSITY: {
            let trace = e.x + e.y;
            return view.mu * (e.x * e.x + e.y * e.y + 2.0 * e.z * e.z) + 0.5 * view.lambda * trace * trace;
        }
        case VON_MISES: {
            return von_mises(cauchy(e));
        }
        case MATERIAL_STRESS_X: {
            return cauchy(e).x;
        }
        case MATERIAL_STRESS_Y: {
            return cauchy(e).y;
        }
        case MATERIAL_SHEAR_STRESS: {
            return cauchy(e).z;
        }
        case STRESS_X: {
            return rotated(cauchy(e), rotation).x;
        }
        case STRESS_Y: {
            return rotated(cauchy(e), rotation).y;
        }
        case SHEAR_STRESS: {
            return rotated(cauchy(e), rotation).z;
        }
        case LARGER_PRINCIPAL_STRESS: {
            let t = cauchy(e);
            return 0.5 * (t.x + t.y) + radius(t.xyz);
        }
        case SMALLER_PRINCIPAL_STRESS: {
            let t = cauchy(e);
            return 0.5 * (t.x + t.y) - radius(t.xyz);
        }
        default: {
            return e.x;
        }
    }
}

// Half of the difference of the principal values of xx, yy, xy.
fn radius(e: vec3<f32>) -> f32 {
    return length(vec2<f32>(0.5 * (e.x - e.y), e.z));
}

// Cauchy stress xx, yy, xy and zz in the rotated frame: σ = T S / (det S (1 + ε₃₃)), because T and S have the same
// principal axes; in linear theory T.
fn cauchy(e: vec3<f32>) -> vec4<f32> {
    let t = biot(e);
    let zz = view.out_of_plane * (t.x + t.y);
    if view.is_corotated == 0u {
        return vec4<f32>(t, zz);
    }
    let s = stretch(e);
    let area = s.x * s.y - s.z * s.z;
    let ts = vec3<f32>(t.x * s.x + t.z * s.z, t.z * s.z + t.y * s.y, t.x * s.z + t.z * s.y);
    return vec4<f32>(ts / (area * thickness(e)), zz / area);
}

// R σ Rᵀ: xx, yy, xy; σ in linear theory, which has no rotation.
fn rotated(t: vec4<f32>, rotation: vec2<f32>) -> vec3<f32> {
    if view.is_corotated == 0u {
        return t.xyz;
    }
    let r = normalize(rotation);
    let cc = r.x * r.x;
    let ss = r.y * r.y;
    let cs = r.x * r.y;
    return vec3<f32>(
        cc * t.x + ss * t.y - 2.0 * cs * t.z,
        ss * t.x + cc * t.y + 2.0 * cs * t.z,
        cs * (t.x - t.y) + (cc - ss) * t.z,
    );
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

// False where the body is crushed or inverted: it has no Cauchy stress there. Linear theory does not see this.
fn has_volume(e: vec3<f32>) -> bool {
    if view.is_corotated == 0u {
        return true;
    }
    let s = stretch(e);
    return s.x * s.y - s.z * s.z > 0.0 && thickness(e) > 0.0;
}

// Returns the von Mises stress of xx, yy, xy and zz.
fn von_mises(t: vec4<f32>) -> f32 {
    let d = vec3<f32>(t.x - t.y, t.y - t.w, t.w - t.x);
    return sqrt(0.5 * dot(d, d) + 3.0 * t.z * t.z);
}

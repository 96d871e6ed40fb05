// The body: triangles coloured by a value, lines and backgrounds in one flat colour each, given in metres relative to the
// camera's centre.

struct Camera {
    // Clip space units per metre, x and y.
    scale: vec2<f32>,
    padding: vec2<f32>,
}

@group(0) @binding(0) var<uniform> camera: Camera;
// The colour map at equal steps from 0 to 1.
@group(0) @binding(1) var<uniform> colormap: array<vec4<f32>, 64>;

struct Vertex {
    @location(0) position: vec2<f32>,
    @location(1) color: vec4<f32>,
    // Where the value lies in the colour map; negative where the vertex has a colour of its own.
    @location(2) value: f32,
}

struct Fragment {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) color: vec4<f32>,
    @location(1) value: f32,
}

@vertex
fn vertex(v: Vertex) -> Fragment {
    return Fragment(vec4<f32>(v.position * camera.scale, 0.0, 1.0), v.color, v.value);
}

// Colours are in gamma space, as egui blends them; the target is not sRGB.
@fragment
fn flat_fragment(f: Fragment) -> @location(0) vec4<f32> {
    return f.color;
}

@fragment
fn mapped_fragment(f: Fragment) -> @location(0) vec4<f32> {
    if f.value < 0.0 {
        return f.color;
    }
    let at = clamp(f.value, 0.0, 1.0) * 63.0;
    let low = min(u32(at), 62u);
    return mix(colormap[low], colormap[low + 1u], at - f32(low));
}

// The body: triangles and lines in one flat colour each, given in metres relative to the camera's centre.

struct Camera {
    // Clip space units per metre, x and y.
    scale: vec2<f32>,
    padding: vec2<f32>,
}

@group(0) @binding(0) var<uniform> camera: Camera;

struct Vertex {
    @location(0) position: vec2<f32>,
    @location(1) color: vec4<f32>,
}

struct Fragment {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) color: vec4<f32>,
}

@vertex
fn vertex(v: Vertex) -> Fragment {
    return Fragment(vec4<f32>(v.position * camera.scale, 0.0, 1.0), v.color);
}

// Colours are in gamma space, as egui blends them; the target is not sRGB.
@fragment
fn fragment(f: Fragment) -> @location(0) vec4<f32> {
    return f.color;
}

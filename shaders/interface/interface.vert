// The interface's triangles: points of the window, in pixels from its upper left corner, to clip space.
#version 460

layout(location = 0) in vec2 position;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 colour;

layout(push_constant) uniform Window {
    vec2 points_per_window; // width and height of the window in the units of positions
} window;

layout(location = 0) out vec2 out_uv;
layout(location = 1) out vec4 out_colour;

void main() {
    gl_Position = vec4(2.0 * position / window.points_per_window - 1.0, 0.0, 1.0);
    out_uv = uv;
    out_colour = colour;
}

// One vertex of the warp mesh, in pixels of one plane. The output's first row is the framebuffer's
// first row, so that reading back needs no flip.
attribute vec2 source_px;
attribute vec2 output_px;
uniform vec2 source_size;
uniform vec2 output_size;
varying vec2 source_at;

void main() {
  source_at = (source_px + 0.5) / source_size;
  gl_Position = vec4((output_px + 0.5) / output_size * 2.0 - 1.0, 0.0, 1.0);
}

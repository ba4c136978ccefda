// Covers the target.
attribute vec2 corner;  // 0 or 1
uniform vec2 target_size;
varying vec2 target_at;

void main() {
  target_at = corner * target_size;
  gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}

// Covers a plane of NV12. The places in the source that its pixels come from are computed here, since a fragment's
// own arithmetic may be too coarse (mediump) to name a texel.
attribute vec2 corner;  // 0 or 1
uniform vec2 source_size;
uniform vec2 target_size;
varying vec2 upper_left;
varying vec2 upper_right;
varying vec2 lower_left;
varying vec2 lower_right;

// The middle of a texel among the SPACING x SPACING that a pixel stands for.
vec2 place(vec2 texel) {
  return ((corner * target_size - 0.5) * SPACING + texel + 0.5) / source_size;
}

void main() {
  upper_left = place(vec2(0.0, 0.0));
  upper_right = place(vec2(1.0, 0.0));
  lower_left = place(vec2(0.0, 1.0));
  lower_right = place(vec2(1.0, 1.0));
  gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}

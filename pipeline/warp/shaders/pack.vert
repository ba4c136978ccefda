// Covers a target whose texels each hold some bytes of a row. The places those bytes come from are
// computed here, since a fragment's own arithmetic may be too coarse (mediump) to name a texel.
attribute vec2 corner;  // 0 or 1
uniform vec2 source_size;
uniform vec2 packed_size;
varying float texel_at;
varying vec2 pixel_0;
varying vec2 pixel_1;
varying vec2 pixel_2;
varying vec2 pixel_3;

vec2 centre_of(float pixel) {
  float first = (corner.x * packed_size.x - 0.5) * PIXELS_PER_TEXEL;
  return vec2((first + pixel + min(0.5, 0.5 * PIXELS_PER_TEXEL)) / source_size.x, corner.y);
}

void main() {
  texel_at = corner.x * packed_size.x;
  pixel_0 = centre_of(0.0);
  pixel_1 = centre_of(1.0);
  pixel_2 = centre_of(2.0);
  pixel_3 = centre_of(3.0);
  gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}

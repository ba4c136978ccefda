// One pixel of one plane. CHANNELS names where the texture's format has its one or two values.
varying vec2 source_at;
uniform sampler2D source;
uniform vec2 picture_size;

vec2 texel(vec2 at) {
#ifdef MIRROR
  // Folded at the edge of the frame: GLES 2 has no mirrored wrap for these sizes.
  return texture2D(source, 1.0 - abs(mod(at, 2.0) - 1.0)).CHANNELS;
#else
  return texture2D(source, at).CHANNELS;
#endif
}

vec2 sample_at(vec2 at) {
#ifdef BICUBIC
  // Catmull-Rom, whose inner two taps have positive weights: the texture's own interpolation reads
  // both at once, so that nine readings do for sixteen taps.
  vec2 px = at * picture_size - 0.5;
  vec2 first = floor(px);
  vec2 t = px - first;
  vec2 s = 1.0 - t;
  vec2 before = -0.5 * t * s * s;
  vec2 after = -0.5 * t * t * s;
  vec2 second = t - 2.0 * after + before;
  vec2 inner = 1.0 - before - after;
  vec2 a = (first - 0.5) / picture_size;
  vec2 b = (first + 0.5 + second / inner) / picture_size;
  vec2 c = (first + 2.5) / picture_size;
  return before.y * (before.x * texel(a) + inner.x * texel(vec2(b.x, a.y)) + after.x * texel(vec2(c.x, a.y))) +
         inner.y * (before.x * texel(vec2(a.x, b.y)) + inner.x * texel(b) + after.x * texel(vec2(c.x, b.y))) +
         after.y * (before.x * texel(vec2(a.x, c.y)) + inner.x * texel(vec2(b.x, c.y)) + after.x * texel(c));
#else
  return texel(at);
#endif
}

#if defined(SHRINKING) && defined(GL_OES_standard_derivatives)
// See samples_for.
float samples_along(vec2 texture_step) {
  float step_px = length(texture_step * picture_size);
  return step_px > 1.25 ? min(ceil(step_px - 0.25), 8.0) : 1.0;
}

vec2 level() {
  vec2 across = dFdx(source_at);
  vec2 down = dFdy(source_at);
  float columns = samples_along(across);
  float rows = samples_along(down);
  vec2 sum = vec2(0.0);
  for (float row = 0.5; row < 8.0; row += 1.0) {
    if (row > rows) break;
    for (float column = 0.5; column < 8.0; column += 1.0) {
      if (column > columns) break;
      sum += clamp(sample_at(source_at + (column / columns - 0.5) * across + (row / rows - 0.5) * down), 0.0, 1.0);
    }
  }
  return sum / (columns * rows);
}
#else
vec2 level() {
  return sample_at(source_at);
}
#endif

void main() {
  gl_FragColor = vec4(level(), 0.0, 1.0);
}

// One pixel of a plane of NV12, out of a picture that lies otherwise. At the last column or row of an odd size, places
// beyond it are held at the edge.
varying vec2 upper_left;
varying vec2 upper_right;
varying vec2 lower_left;
varying vec2 lower_right;
uniform sampler2D source;
uniform sampler2D other_source;

#if defined(PLANAR)
vec2 value() {
  return vec2(texture2D(source, upper_left).r, texture2D(other_source, upper_left).r);
}
#elif defined(PACKED_422)
// A texel has a pixel's luma and, by turns, U or V.
vec2 pair(vec2 at) {
  return texture2D(source, at).CHANNELS;
}
#ifdef LUMA
vec2 value() {
  return vec2(pair(upper_left).x, 0.0);
}
#else
vec2 value() {
  vec2 sum = vec2(pair(upper_left).y + pair(lower_left).y, pair(upper_right).y + pair(lower_right).y);
  return 0.5 * sum + 0.25 / 255.0;  // what lies between two levels is rounded up
}
#endif
#else
// The matrix of BT.601 in full range (JFIF 1.02, p. 3).
vec3 colour(vec2 at) {
  return texture2D(source, at).CHANNELS;
}
#ifdef LUMA
vec2 value() {
  return vec2(dot(colour(upper_left), vec3(0.299, 0.587, 0.114)), 0.0);
}
#else
vec2 value() {
  vec3 mean = 0.25 * (colour(upper_left) + colour(upper_right) + colour(lower_left) + colour(lower_right));
  return vec2(dot(mean, vec3(-0.168736, -0.331264, 0.5)), dot(mean, vec3(0.5, -0.418688, -0.081312))) + 128.0 / 255.0;
}
#endif
#endif

void main() {
  vec2 levels = value();
  gl_FragColor = vec4(levels, 0.0, levels.y);  // the second where either version's textures have it
}

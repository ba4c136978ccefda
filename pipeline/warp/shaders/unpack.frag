// One pixel of a plane out of texels that each hold several bytes of a row, or one of a pair. Where it is
// comes from the vertex shader: gl_FragCoord is mediump, which need not tell columns beyond 1024 apart, even
// where the fragment shader's own numbers do.
varying vec2 target_at;
uniform sampler2D source;
uniform vec2 source_size;

vec4 texel(float column) {
  return texture2D(source, vec2((column + 0.5) / source_size.x, target_at.y / source_size.y));
}

void main() {
  float pixel = floor(target_at.x);
#if defined(HALVES)
  vec2 value = vec2(texel(2.0 * pixel).r, texel(2.0 * pixel + 1.0).r);
#elif defined(PAIRS)
  float column = floor(pixel / 2.0);
  vec4 four = texel(column);
  vec2 value = pixel - 2.0 * column < 0.5 ? four.rg : four.ba;
#else
  float column = floor(pixel / 4.0);
  float byte = pixel - 4.0 * column;
  vec4 four = texel(column);
  vec2 value = vec2(byte < 1.5 ? (byte < 0.5 ? four.r : four.g) : (byte < 2.5 ? four.b : four.a), 0.0);
#endif
  gl_FragColor = vec4(value, 0.0, 1.0);
}

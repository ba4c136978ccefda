// The bytes of a row that go into one texel: four into RGBA, the only thing that GLES 2 promises to read
// back, or one of a pair.
varying float texel_at;
varying vec2 pixel_0;
varying vec2 pixel_1;
varying vec2 pixel_2;
varying vec2 pixel_3;
uniform sampler2D source;

void main() {
#if defined(HALVES)
  vec4 pair = texture2D(source, pixel_0);
  gl_FragColor = vec4(mod(floor(texel_at), 2.0) < 0.5 ? pair.r : pair.g, 0.0, 0.0, 1.0);
#elif defined(PAIRS)
  gl_FragColor = vec4(texture2D(source, pixel_0).rg, texture2D(source, pixel_1).rg);
#else
  gl_FragColor = vec4(texture2D(source, pixel_0).r, texture2D(source, pixel_1).r,
                      texture2D(source, pixel_2).r, texture2D(source, pixel_3).r);
#endif
}

// Four bytes of a row into one RGBA texel, the only thing that GLES 2 promises to read back.
varying vec2 pixel_0;
varying vec2 pixel_1;
varying vec2 pixel_2;
varying vec2 pixel_3;
uniform sampler2D source;

void main() {
#ifdef PAIRS
  gl_FragColor = vec4(texture2D(source, pixel_0).rg, texture2D(source, pixel_1).rg);
#else
  gl_FragColor = vec4(texture2D(source, pixel_0).r, texture2D(source, pixel_1).r,
                      texture2D(source, pixel_2).r, texture2D(source, pixel_3).r);
#endif
}

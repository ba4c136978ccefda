// One pixel of one plane. CHANNELS names where the texture's format has its one or two values.
// MIRROR folds the coordinate at the edge of the frame: GLES 2 has no mirrored wrap for these sizes.
varying vec2 source_at;
uniform sampler2D source;

void main() {
#ifdef MIRROR
  vec2 at = 1.0 - abs(mod(source_at, 2.0) - 1.0);
  gl_FragColor = vec4(texture2D(source, at).CHANNELS, 0.0, 1.0);
#else
  gl_FragColor = vec4(texture2D(source, source_at).CHANNELS, 0.0, 1.0);
#endif
}

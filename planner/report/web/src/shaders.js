// A corner's bytes: x, y, z within the chunk, then side + 6 * owner; of a frontier, owner.
export const VOXEL_VERTEX = `
precision highp float;
uniform mat4 modelMatrix, viewMatrix, projectionMatrix;
in vec4 corner;
out vec3 place;
out float height;
flat out int side, owner;
void main() {
  int tag = int(corner.w + 0.5);
  side = tag % 6;
  owner = tag / 6;
  place = corner.xyz;
  vec4 world = modelMatrix * vec4(corner.xyz, 1.0);
  height = world.z;
  gl_Position = projectionMatrix * viewMatrix * world;
}`;

export const VOXEL_FRAGMENT = `
precision highp float;
uniform vec3 heights[4], owners[33];
uniform float lowest, highest, shade, edges;
uniform bool by_owner;
in vec3 place;
in float height;
flat in int side, owner;
out vec4 color;
const float kLight[6] = float[6](0.74, 0.84, 0.66, 0.9, 0.5, 1.0);
void main() {
  vec3 base;
  if (by_owner) {
    base = owners[owner];
  } else {
    float t = clamp((height - lowest) / max(highest - lowest, 1e-3), 0.0, 1.0) * 3.0;
    base = mix(mix(heights[0], heights[1], min(t, 1.0)), mix(heights[2], heights[3], max(t - 2.0, 0.0)), smoothstep(0.9, 2.1, t));
  }
  vec2 on = side < 2 ? place.yz : side < 4 ? place.xz : place.xy;
  vec2 width = fwidth(on), off = abs(fract(on + 0.5) - 0.5) / max(width, vec2(1e-4));
  float line = 1.0 - clamp(min(off.x, off.y) - 0.2, 0.0, 1.0);
  float near = 1.0 - smoothstep(0.08, 0.3, max(width.x, width.y));
  color = vec4(base * kLight[side] * shade * (1.0 - edges * line * near), 1.0);
}`;

export const POINT_VERTEX = `
precision highp float;
uniform mat4 modelMatrix, viewMatrix, projectionMatrix;
uniform float size;
in vec4 corner;
flat out int owner;
void main() {
  owner = int(corner.w + 0.5);
  vec4 seen = viewMatrix * modelMatrix * vec4(corner.xyz + 0.5, 1.0);
  gl_Position = projectionMatrix * seen;
  gl_PointSize = clamp(size / -seen.z, 1.5, 24.0);
}`;

export const POINT_FRAGMENT = `
precision mediump float;
uniform vec3 tints[33];
flat in int owner;
out vec4 color;
void main() {
  float r = length(gl_PointCoord - 0.5) * 2.0;
  float light = 1.0 - smoothstep(0.35, 1.0, r);
  if (light <= 0.02) discard;
  color = vec4(tints[owner], 0.75 * light);
}`;

// A square with an edge in the colour of the background; smaller if its place is worth less.
export const SQUARE_VERTEX = `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform float size;
in vec3 position;
in vec4 tint;
flat out vec3 fill;
flat out float edge;
void main() {
  fill = tint.rgb;
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  gl_Position = projectionMatrix * seen;
  gl_PointSize = clamp(size / -seen.z, 8.0, 40.0) * mix(0.5, 1.0, tint.a);
  edge = 0.5 - 1.2 / gl_PointSize;
}`;

export const SQUARE_FRAGMENT = `
precision mediump float;
uniform vec3 paper;
flat in vec3 fill;
flat in float edge;
out vec4 color;
void main() {
  vec2 off = abs(gl_PointCoord - 0.5);
  color = vec4(max(off.x, off.y) > edge ? paper : fill, 1.0);
}`;

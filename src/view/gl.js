// WebGL programs: one for faces and lines, one for cones of networks; both draw colours or names.

const LIGHT = `
uniform vec3 ground; uniform float fade, reach;
// The lamp is above and to the left of the viewer, the sky gives the rest.
vec3 lit(vec3 colour, vec3 n, float depth) {
  float lamp = max(dot(n, vec3(-0.408, 0.408, 0.816)), 0.0);
  vec3 own = pow(colour, vec3(2.2)) * (0.62 * lamp + 0.46 * (0.75 + 0.25 * n.y));
  return mix(pow(own, vec3(1.0 / 2.2)), ground, fade * clamp(0.5 - 0.5 * depth / reach, 0.0, 1.0));
}`;

const HEAD = `#version 300 es
precision highp float; precision highp int;
uniform mat4 camera; uniform mat3 turn; uniform vec4 cut; uniform int names;
`;

const FACES = [HEAD + `
layout(location = 0) in vec3 place; layout(location = 1) in vec3 normal; layout(location = 2) in vec4 colour;
layout(location = 3) in uint name;
uniform vec3 origin; uniform float size, pixels;
out vec3 n; out vec4 c; out float behind, depth; flat out uint id;
void main() {
  vec3 p = origin + size * place;
  vec4 q = camera * vec4(p, 1.0);
  gl_Position = q; n = turn * normal; c = colour; id = name; depth = -q.z; behind = cut.w - dot(cut.xyz, p);
  // Mesh edges have their length instead of a normal, and fade below ten pixels.
  if (pixels > 0.0) {
    c.a *= smoothstep(2.0, 10.0, normal.x * pixels);
    // Lifted by 1.5 pixels, so that steep faces do not cover their own edges.
    gl_Position.z -= 1.5 / pixels * length(vec3(camera[0].z, camera[1].z, camera[2].z));
  }
}`, HEAD + LIGHT + `
in vec3 n; in vec4 c; in float behind, depth; flat in uint id;
uniform float flatness;
layout(location = 0) out vec4 colour; layout(location = 1) out vec4 far;
void main() {
  if (behind < 0.0) discard;
  if (names == 1) {
    colour = vec4(uvec4(id, id >> 8u, id >> 16u, id >> 24u) & 255u) / 255.0;
    uint z = uint(gl_FragCoord.z * 16777215.0);
    far = vec4(uvec4(z, z >> 8u, z >> 16u, 255u) & 255u) / 255.0;
    return;
  }
  if (flatness > 1.5) { colour = vec4(c.rgb, c.a); return; }
  vec3 m = normalize(n);
  if (!gl_FrontFacing) m = -m;
  colour = vec4(lit(c.rgb * (gl_FrontFacing ? 1.0 : 0.62), m, depth), 1.0);
}`];

const CONES = [HEAD + `
layout(location = 0) in vec3 corner; layout(location = 1) in vec4 from; layout(location = 2) in vec4 to;
layout(location = 3) in vec4 colour; layout(location = 4) in uint name;
uniform float thinnest;
out vec3 n; out vec4 c; out float behind, depth; flat out uint id;
void main() {
  vec3 axis = to.xyz - from.xyz; float l = max(length(axis), 1e-20); axis /= l;
  vec3 e = abs(axis.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
  vec3 u = normalize(cross(axis, e)), w = cross(axis, u), out_ = u * corner.x + w * corner.y;
  float r = max(mix(from.w, to.w, clamp(corner.z, 0.0, 1.0)), thinnest);
  // Beyond its ends a cone is closed by half a ball, of one ring.
  float beyond = corner.z < 0.0 ? -1.0 : corner.z > 1.0 ? 1.0 : 0.0;
  float shrink = beyond == 0.0 ? 1.0 : 0.0;
  vec3 p = mix(from.xyz, to.xyz, clamp(corner.z, 0.0, 1.0)) + out_ * r * shrink + axis * beyond * r;
  vec4 q = camera * vec4(p, 1.0);
  gl_Position = q; n = turn * (shrink * out_ + beyond * axis + axis * (from.w - to.w) / l * shrink);
  c = colour; id = name; depth = -q.z; behind = cut.w - dot(cut.xyz, p);
}`, FACES[1]];

function program(gl, [vertex, fragment]) {
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
  const at = {};
  const count = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS);
  for (let i = 0; i < count; i++) {
    const name = gl.getActiveUniform(made, i).name;
    at[name] = gl.getUniformLocation(made, name);
  }
  return { made, at };
}

function buffer(gl, values, target = gl.ARRAY_BUFFER) {
  const made = gl.createBuffer();
  gl.bindBuffer(target, made);
  gl.bufferData(target, values, gl.STATIC_DRAW);
  return made;
}

/** Frame buffer of one pixel for names and depths, used for picking. */
function nameTarget(gl) {
  const frame = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  for (const attachment of [gl.COLOR_ATTACHMENT0, gl.COLOR_ATTACHMENT1]) {
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, 1, 1);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, attachment, gl.TEXTURE_2D, texture, 0);
  }
  const depth = gl.createRenderbuffer();
  gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
  gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, 1, 1);
  gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
  gl.drawBuffers([gl.COLOR_ATTACHMENT0, gl.COLOR_ATTACHMENT1]);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  return frame;
}

// Vectors as arrays of three numbers.
const add = (a, b, t = 1) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => { const l = Math.hypot(...a) || 1; return a.map(x => x / l); };

// The first half of the script of the page that plays an animation: its data and what draws it, by WebGL 1 alone.
#pragma once

#include <string_view>

namespace corotet::inline v0_1::detail {

/// Decodes the data, and makes what the graphics card needs. Continued in
/// animation_controls_script.hpp.
inline constexpr std::string_view page_script_data = R"js("use strict";
(() => {
const $ = id => document.getElementById(id);
const info = JSON.parse($("info").textContent);
const canvas = $("view");

function stop(reason) {
  $("missing").textContent = reason;
  $("missing").hidden = false;
  canvas.hidden = true;
  document.querySelector("footer").hidden = true;
}

// Little-endian integers in base64, as written by corotet.
function decode(id, Type) {
  const text = atob($(id).textContent.trim()), bytes = new Uint8Array(text.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = text.charCodeAt(i);
  return new Type(bytes.buffer);
}

const gl = canvas.getContext("webgl", { alpha: true, antialias: true });
if (!gl) return stop("There is no picture because this browser does not offer WebGL, by which it is drawn. " +
  "WebGL may be switched off in the settings, or need hardware acceleration. Recent Firefox, Chrome, Edge and Safari " +
  "can play this file.");
const source = decode("source", Uint32Array), triangles = decode("triangles", Uint32Array);
const lines = decode("lines", Uint32Array);
const surface = decode("surface-positions", Uint16Array), ends = decode("line-positions", Uint16Array);
const identity = new Uint32Array(info.lineVertices).map((_, i) => i);

// Drawn in units of half the diagonal of the box, from its middle: positions q / 65535 * scale - scale / 2.
const longest = Math.max(...info.extent) || 1;
const relative = info.extent.map(e => e / longest), radius = Math.hypot(...relative) / 2 || 1;
const scale = relative.map(e => e / radius);

// Positions of one frame, four numbers a vertex.
function positions(all, vertices, of, k) {
  const out = new Uint16Array(4 * of.length), begin = 3 * vertices * k;
  for (let v = 0; v < of.length; ++v)
    for (let i = 0; i < 3; ++i) out[4 * v + i] = all[begin + 3 * of[v] + i];
  return out;
}

// Unit normals, as signed bytes: the sum of the triangles' normals, weighted by area.
function normals(x) {
  const sum = new Float32Array(x.length), [sx, sy, sz] = scale;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 4 * triangles[t], b = 4 * triangles[t + 1], c = 4 * triangles[t + 2];
    const ux = (x[b] - x[a]) * sx, uy = (x[b + 1] - x[a + 1]) * sy, uz = (x[b + 2] - x[a + 2]) * sz;
    const vx = (x[c] - x[a]) * sx, vy = (x[c + 1] - x[a + 1]) * sy, vz = (x[c + 2] - x[a + 2]) * sz;
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    for (const i of [a, b, c]) { sum[i] += nx; sum[i + 1] += ny; sum[i + 2] += nz; }
  }
  const out = new Int8Array(x.length);
  for (let i = 0; i < x.length; i += 4) {
    const length = Math.hypot(sum[i], sum[i + 1], sum[i + 2]) || 1;
    for (let k = 0; k < 3; ++k) out[i + k] = Math.round(127 * sum[i + k] / length);
  }
  return out;
}

const motion = `
attribute vec3 p0, p1;
uniform float between;
uniform vec3 scale, middle;
uniform mat3 turn;
uniform vec4 lens;
uniform float away;
vec3 toEye() {
  vec3 e = turn * ((mix(p0, p1, between) - 0.5) * scale - middle) - vec3(0.0, 0.0, away);
  gl_Position = vec4(e.xy * lens.xy, lens.z * e.z + lens.w, -e.z);
  return e;
}`;
const surfaceShader = [motion + `
attribute vec3 n0, n1;
varying vec3 normal, eye;
void main() {
  eye = toEye();
  normal = turn * mix(n0, n1, between);
}`, `
precision highp float;
varying vec3 normal, eye;
uniform vec3 colour, light, up;
void main() {
  vec3 n = normal / max(length(normal), 1e-4);
  if (!gl_FrontFacing) n = -n;
  vec3 v = normalize(-eye);
  float diffuse = max(dot(n, light), 0.0), sky = 0.5 + 0.5 * dot(n, up);
  float gloss = pow(max(dot(n, normalize(light + v)), 0.0), 40.0);
  float rim = pow(1.0 - abs(dot(n, v)), 3.0);
  vec3 shade = colour * (0.26 + 0.24 * sky + 0.78 * diffuse) + 0.09 * rim + 0.20 * gloss;
  gl_FragColor = vec4(shade, 1.0);
}`];
const lineShader = [motion + "void main() { toEye(); }", `
precision mediump float;
uniform vec4 colour;
void main() { gl_FragColor = vec4(colour.rgb * colour.a, colour.a); }`];

function makeProgram(sources) {
  const program = gl.createProgram();
  sources.forEach((text, i) => {
    const shader = gl.createShader(i === 0 ? gl.VERTEX_SHADER : gl.FRAGMENT_SHADER);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  });
  ["p0", "p1", "n0", "n1"].forEach((name, i) => gl.bindAttribLocation(program, i, name));
  gl.linkProgram(program);
  const places = {};
  const uniform = name => name in places ? places[name] : places[name] = gl.getUniformLocation(program, name);
  return { program, uniform };
}

function buffer(target, data) {
  const made = gl.createBuffer();
  gl.bindBuffer(target, made);
  gl.bufferData(target, data, gl.STATIC_DRAW);
  return made;
}

// All that lives on the graphics card; made again if the card is lost. Frames are sent when they are first drawn.
let card;
function fillCard() {
  const wide = gl.getExtension("OES_element_index_uint") !== null;
  if (!wide && Math.max(source.length, identity.length) > 65536)
    return "This mesh has more vertices than WebGL on this device can number (OES_element_index_uint is missing).";
  const indices = list => buffer(gl.ELEMENT_ARRAY_BUFFER, wide ? list : new Uint16Array(list));
  card = { type: wide ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT, triangles: indices(triangles), lines: indices(lines),
    surface: makeProgram(surfaceShader), line: makeProgram(lineShader), frames: [] };
  for (const made of [card.surface, card.line])
    if (!gl.isContextLost() && !gl.getProgramParameter(made.program, gl.LINK_STATUS))
      return "The graphics driver refused to draw: " + gl.getProgramInfoLog(made.program);
  return "";
}
function frame(k) {
  if (!card.frames[k]) {
    const x = positions(surface, info.vertices, source, k);
    card.frames[k] = { x: buffer(gl.ARRAY_BUFFER, x), n: buffer(gl.ARRAY_BUFFER, normals(x)),
      ends: buffer(gl.ARRAY_BUFFER, positions(ends, info.lineVertices, identity, k)) };
  }
  return card.frames[k];
}
)js";

}  // namespace corotet::inline v0_1::detail

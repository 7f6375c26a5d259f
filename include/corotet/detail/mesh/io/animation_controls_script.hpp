// The second half of the script of the page that plays an animation: camera, picture, and the hands on them.
#pragma once

#include <string_view>

namespace corotet::inline v0_1::detail {

/// The camera, the picture, and the time that passes.
inline constexpr std::string_view page_script_view = R"js(
const refused = fillCard();
if (refused) return stop(refused);

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const sum = (a, b, s) => a.map((x, i) => x + s * b[i]);
function axes(azimuth, elevation) {
  const [along, across, up] = info.axes, zero = [0, 0, 0];
  const level = sum(sum(zero, along, Math.cos(azimuth)), across, Math.sin(azimuth));
  const right = sum(sum(zero, along, -Math.sin(azimuth)), across, Math.cos(azimuth));
  const back = sum(sum(zero, level, Math.cos(elevation)), up, Math.sin(elevation));
  const top = sum(sum(zero, level, -Math.sin(elevation)), up, Math.cos(elevation));
  return [right, top, back];
}
const opening = Math.tan(0.26);  // half of the shorter side of the picture, at distance 1
function lensOf(width, height) {
  const shorter = Math.min(width, height);
  return [shorter / (width * opening), shorter / (height * opening)];
}
// Some of the places where the animation ever is, in the axes of the first view.
const first = axes(info.azimuth, info.elevation), places = [];
for (const [all, vertices] of [[surface, info.vertices], [ends, info.lineVertices]]) {
  const stride = 3 * Math.max(1, Math.ceil(vertices * info.frames / 50000));
  for (let i = 0; i < all.length; i += stride)
    places.push(first.map(axis => dot(axis, scale.map((s, k) => (all[i + k] / 65535 - 0.5) * s))));
}
const centre = [0, 1, 2].map(k => {
  const range = places.reduce((r, p) => [Math.min(r[0], p[k]), Math.max(r[1], p[k])], [Infinity, -Infinity]);
  return (range[0] + range[1]) / 2;
});
// The distance from which all of it fills the picture.
function fit(lens) {
  return places.reduce((away, p) => Math.max(away, p[2] - centre[2] + 1.08 *
    Math.max(Math.abs(p[0] - centre[0]) * lens[0], Math.abs(p[1] - centre[1]) * lens[1])), 0.1);
}

// The eye: two angles, a factor on the distance at which all is seen, and the point that is looked at.
const view = {};
function home() {
  const middle = first.reduce((m, axis, k) => sum(m, axis, centre[k]), [0, 0, 0]);
  Object.assign(view, { azimuth: info.azimuth, elevation: info.elevation, zoom: 1, middle });
}
home();

const dark = matchMedia("(prefers-color-scheme: dark)");
const inks = () => dark.matches ? { surface: [0.22, 0.56, 0.61], line: [0.86, 0.92, 0.94] }
                                : { surface: [0.20, 0.56, 0.61], line: [0.13, 0.17, 0.25] };

function draw(time) {
  const density = Math.min(devicePixelRatio || 1, 2);
  const width = Math.max(1, Math.round(canvas.clientWidth * density));
  const height = Math.max(1, Math.round(canvas.clientHeight * density));
  if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
  gl.viewport(0, 0, width, height);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.DEPTH_TEST);

  const k = Math.min(Math.floor(time), info.frames - 1), next = Math.min(k + 1, info.frames - 1);
  const turn = axes(view.azimuth, view.elevation), lens = lensOf(width, height);
  const away = view.zoom * fit(lens), reach = 1.05 + Math.hypot(...view.middle);
  const far = away + reach, near = Math.max(away - reach, 0.01 * far);
  const use = (made, data, names) => {
    gl.useProgram(made.program);
    names.forEach((name, i) => {
      const normal = name === "n";
      gl.bindBuffer(gl.ARRAY_BUFFER, data[i]);
      gl.enableVertexAttribArray(i);
      gl.vertexAttribPointer(i, 3, normal ? gl.BYTE : gl.UNSIGNED_SHORT, true, normal ? 4 : 8, 0);
    });
    for (let i = names.length; i < 4; ++i) gl.disableVertexAttribArray(i);
    gl.uniform1f(made.uniform("between"), time - k);
    gl.uniform3fv(made.uniform("scale"), scale);
    gl.uniform3fv(made.uniform("middle"), view.middle);
    gl.uniformMatrix3fv(made.uniform("turn"), false, [0, 1, 2].flatMap(i => turn.map(a => a[i])));
    gl.uniform4f(made.uniform("lens"), lens[0], lens[1], -(far + near) / (far - near), -2 * far * near / (far - near));
    gl.uniform1f(made.uniform("away"), away);
  };
  const a = frame(k), b = frame(next), ink = inks();
  gl.disable(gl.BLEND);
  gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.polygonOffset(1, 1);
  use(card.surface, [a.x, b.x, a.n, b.n], ["p", "p", "n", "n"]);
  gl.uniform3fv(card.surface.uniform("colour"), ink.surface);
  gl.uniform3fv(card.surface.uniform("light"), info.light);
  gl.uniform3fv(card.surface.uniform("up"), turn.map(axis => dot(axis, info.axes[2])));
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, card.triangles);
  gl.drawElements(gl.TRIANGLES, triangles.length, card.type, 0);
  if (!lines.length || !$("cage").checked) return;

  use(card.line, [a.ends, b.ends], ["p", "p"]);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, card.lines);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  for (const [test, strength] of [[gl.GREATER, 0.14], [gl.LEQUAL, 0.7]]) {  // behind the surface, then before it
    gl.depthFunc(test);
    gl.depthMask(test === gl.LEQUAL);
    gl.uniform4f(card.line.uniform("colour"), ...ink.line, strength);
    gl.drawElements(gl.LINES, lines.length, card.type, 0);
  }
  gl.depthFunc(gl.LESS);
  gl.depthMask(true);
}

const last = info.frames - 1, seconds = t => (t * info.seconds).toFixed(info.decimals) + " s";
let time = 0, playing = false, before = 0, waiting = false;
function show() { if (!waiting) { waiting = true; requestAnimationFrame(paint); } }
function paint(now) {
  waiting = false;
  if (playing) {
    time += Math.max(0, Math.min(now - before, 100)) / 1000 / info.seconds * Number($("speed").value);
    if (time > last) time %= last;
    before = now;
    $("time").value = time;
  }
  $("clock").textContent = seconds(time);
  $("time").setAttribute("aria-valuetext", seconds(time));
  if (!gl.isContextLost()) draw(time);
  if (playing) show();
}
function play(on) {
  playing = on && last > 0;
  before = performance.now();
  $("play").textContent = playing ? "Pause" : "Play";
  show();
}
)js";

/// Buttons, keys, mouse and touch.
inline constexpr std::string_view page_script_hands = R"js(
const turnBy = (dx, dy) => {
  view.azimuth -= dx;
  view.elevation = Math.max(-1.55, Math.min(1.55, view.elevation + dy));
  show();
};
const zoomBy = factor => { view.zoom = Math.max(0.05, Math.min(6, view.zoom * factor)); show(); };
const moveBy = (dx, dy) => {
  const [right, top] = axes(view.azimuth, view.elevation), lens = lensOf(canvas.clientWidth, canvas.clientHeight);
  const size = 2 * view.zoom * fit(lens);
  view.middle = sum(sum(view.middle, right, -dx * size / (lens[0] * canvas.clientWidth)), top,
                    dy * size / (lens[1] * canvas.clientHeight)).map(x => Math.max(-1.5, Math.min(1.5, x)));
  show();
};

const fingers = new Map();
canvas.addEventListener("pointerdown", e => {
  canvas.setPointerCapture(e.pointerId);
  fingers.set(e.pointerId, [e.clientX, e.clientY]);
});
canvas.addEventListener("pointermove", e => {
  const from = fingers.get(e.pointerId);
  if (!from) return;
  const to = [e.clientX, e.clientY], dx = to[0] - from[0], dy = to[1] - from[1];
  fingers.set(e.pointerId, to);
  if (fingers.size === 1) {
    if (e.shiftKey || e.buttons & 6) moveBy(dx, dy);
    else turnBy(0.008 * dx, 0.008 * dy);
  } else if (fingers.size === 2) {
    const [, other] = [...fingers].find(([id]) => id !== e.pointerId);
    const apart = p => Math.max(20, Math.hypot(p[0] - other[0], p[1] - other[1]));
    zoomBy(apart(from) / apart(to));
    moveBy(dx / 2, dy / 2);
  }
});
for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, e => fingers.delete(e.pointerId));
canvas.addEventListener("contextmenu", e => e.preventDefault());
canvas.addEventListener("wheel", e => {
  e.preventDefault();
  zoomBy(Math.exp(0.0015 * Math.max(-200, Math.min(200, e.deltaY * (e.deltaMode === 1 ? 30 : 1)))));
}, { passive: false });

const keys = {
  ArrowLeft: () => turnBy(-0.1, 0), ArrowRight: () => turnBy(0.1, 0), ArrowUp: () => turnBy(0, -0.1),
  ArrowDown: () => turnBy(0, 0.1), "+": () => zoomBy(0.9), "=": () => zoomBy(0.9), "-": () => zoomBy(1 / 0.9),
  0: () => { home(); show(); },
};
document.addEventListener("keydown", e => {
  if (e.ctrlKey || e.altKey || e.metaKey) return;
  if (e.key === " " && !e.target.closest("button, select, [type=checkbox]")) play(!playing);
  else if (e.target === canvas && e.key in keys) keys[e.key]();
  else return;
  e.preventDefault();
});

$("play").addEventListener("click", () => play(!playing));
$("home").addEventListener("click", () => { home(); show(); });
$("cage").addEventListener("change", show);
$("time").addEventListener("input", () => { time = Number($("time").value); play(false); });
$("time").max = last;
$("cage-label").hidden = lines.length === 0;
for (const id of ["play", "time", "speed"]) $(id).disabled = last === 0;
addEventListener("resize", show);
dark.addEventListener("change", show);
canvas.addEventListener("webglcontextlost", e => e.preventDefault());
canvas.addEventListener("webglcontextrestored", () => {
  const reason = fillCard();
  if (reason) stop(reason); else show();
});
play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
})();
)js";

}  // namespace corotet::inline v0_1::detail

// The page that plays an animation: its look and its words. The script is in animation_script.hpp.
#pragma once

#include <string_view>

namespace corotet::inline v0_1::detail {

/// Between the title and the data: {title} and {caption} stand for what the caller gave.
inline constexpr std::string_view page_style = R"html(<style>
:root { color-scheme: light dark;
  --paper: #f6f5f1; --ink: #21303a; --quiet: #5c6970; --line: #cfd3d1; --accent: #1f7480; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #12181c; --ink: #e6ebec; --quiet: #9caab0; --line: #344047; --accent: #6cc6cf; }
}
* { box-sizing: border-box; }
html, body { height: 100%; margin: 0; }
body { display: flex; flex-direction: column; height: 100dvh; background: var(--paper); color: var(--ink);
  font: 16px/1.4 system-ui, -apple-system, "Segoe UI", Roboto, sans-serif; }
header { padding: 0.9rem 1.1rem 0; }
h1 { margin: 0; font-size: 1.15rem; font-weight: 650; overflow-wrap: anywhere; }
header p { margin: 0.15rem 0 0; font-size: 0.9rem; color: var(--quiet); overflow-wrap: anywhere; }
main { position: relative; flex: 1; min-height: 0; }
canvas { position: absolute; inset: 0; width: 100%; height: 100%; display: block; touch-action: none; cursor: grab; }
canvas:active { cursor: grabbing; }
:focus-visible { outline: 2px solid var(--accent); outline-offset: 2px; }
canvas:focus-visible { outline-offset: -3px; }
.message { position: absolute; inset: 0; margin: auto; width: min(32rem, 88%); height: fit-content;
  padding: 1rem 1.2rem; border: 1px solid var(--line); border-radius: 0.6rem; }
[hidden] { display: none !important; }
footer { padding: 0.5rem 1.1rem max(0.8rem, env(safe-area-inset-bottom)); }
.bar { display: flex; flex-wrap: wrap; align-items: center; gap: 0.5rem 0.8rem; }
.bar > * { flex: none; }
button, select { font: inherit; color: inherit; background: transparent; border: 1px solid var(--line);
  border-radius: 0.5rem; min-height: 2.6rem; padding: 0 0.8rem; cursor: pointer; }
select option { background: var(--paper); }
button:disabled, select:disabled { opacity: 0.45; cursor: default; }
button:hover, select:hover { border-color: var(--accent); }
#play { min-width: 5.2rem; color: var(--paper); background: var(--accent); border-color: var(--accent);
  font-weight: 600; }
#time { flex: 1 1 10rem; min-width: 6rem; height: 2.6rem; margin: 0; accent-color: var(--accent); }
output { min-width: 4.5em; text-align: right; font-variant-numeric: tabular-nums; }
label { display: inline-flex; align-items: center; gap: 0.4rem; min-height: 2.6rem; cursor: pointer; }
input[type=checkbox] { width: 1.15rem; height: 1.15rem; margin: 0; accent-color: var(--accent); }
.keys { margin: 0.35rem 0 0; font-size: 0.82rem; color: var(--quiet); }
@media (max-width: 34rem) {
  #time { order: -2; flex-basis: 60%; }
  output { order: -1; }
}
.touch { display: none; }
@media (pointer: coarse) { .mouse { display: none; } .touch { display: inline; } }
</style>
)html";

/// The body up to the data, after the header with title and caption.
inline constexpr std::string_view page_controls = R"html(<main>
<canvas id="view" tabindex="0" role="img" aria-labelledby="title" aria-describedby="keys"></canvas>
<p id="missing" class="message" role="alert" hidden></p>
<noscript><p class="message">This page plays an animation by JavaScript, which is switched off here. Allow scripts for
this file to see it; it loads nothing else.</p></noscript>
</main>
<footer>
<div class="bar">
<button id="play" type="button">Play</button>
<input id="time" type="range" min="0" value="0" step="1" aria-label="Time">
<output id="clock" for="time"></output>
<select id="speed" aria-label="Speed"><option value="1">1&times;</option><option value="0.5">&frac12;&times;</option>
<option value="0.25">&frac14;&times;</option><option value="0.1">0.1&times;</option></select>
<label id="cage-label"><input id="cage" type="checkbox" checked> Lines</label>
<button id="home" type="button" title="The first view again">Reset</button>
</div>
<p class="keys" id="keys"><span class="mouse">Drag to turn, shift-drag to move, wheel to zoom. Keys: space plays or
pauses; on the picture, arrows turn, + and &minus; zoom, 0 resets.</span><span class="touch">One finger turns, two
fingers move and zoom.</span></p>
</footer>
)html";

}  // namespace corotet::inline v0_1::detail

"""Prints the medians of bench/peers/run as a table: times as multiples of corotet's awake steps in the same scene."""

import math
import statistics
import sys

GRAVITY, FRICTION = 9.81, 0.3


def number(value):
    return f"{value:.3g}"


def main(path):
    runs = {}
    with open(path, encoding="utf-8") as file:
        for line in file:
            scene, engine, state, *values = line.split()
            runs.setdefault((scene, engine, state), []).append([float(v) for v in values])
    rows = {key: [statistics.median(column) for column in zip(*values)] for key, values in runs.items()}
    cosine = 1 / math.hypot(1, 0.5)
    exact = GRAVITY * (0.5 - FRICTION) * cosine
    print("| scene | engine | first s: ms a step | × | last ½ s: ms a step | × | asleep | in planes, mm"
          " | in bodies, mm (at the end) | kinetic energy, J | fastest, m/s | error |")
    print("| --- " * 12 + "|")
    for (scene, engine, state), row in rows.items():
        base = rows[scene, "corotet", "awake"]
        fall, rest, asleep, planes, bodies, last, kinetic, fastest, a, creep = row
        error = ""
        if scene == "slides":
            error = f"acceleration {100 * (a / exact - 1):+.2g} %"
        if scene == "holds":
            error = f"creep {creep:.1e} m/s"
        print(f"| {scene}, {state} | {engine.replace('_4', ', 4 substeps').replace('_', ', ')} | {number(fall)} | {number(fall / base[0])} |"
              f" {number(rest)} | {number(rest / base[1])} | {asleep:.0f} | {number(1e3 * planes)} |"
              f" {number(1e3 * bodies)} ({number(1e3 * last)}) | {number(kinetic)} | {number(fastest)} | {error} |")


main(sys.argv[1])

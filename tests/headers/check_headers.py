#!/usr/bin/env python3
"""Checks rules about the headers that no compiler enforces.

Usage: check_headers.py RULE INCLUDE_DIR [--opt-in HEADER ...]

RULE is one of
  layers     a header of a folder in detail/ includes only its own folder and the folders below it; a face header, which
             lies outside detail/, includes headers of these folders alone
  alone      what few programs need (files, mesh generation) is reached by its own face header alone
  forbidden  no exceptions, RTTI, printing or exiting, no function that C libraries round differently, no macro but
             COROTET_... and no name that is one elsewhere
  length     under 500 lines a header, at most 120 characters a line
  named      a face header includes by name what declares names for users, names outside namespace detail: the
             reference lists these alone
  umbrella   corotet/corotet.hpp includes the face headers alone, all but the opt-in ones, and through them reaches every
             header but the opt-in ones, which opt-in face headers reach; and at its top, while macros of platforms are
             put aside, every header of the standard library that any of these includes
Prints one line a violation, as file:line: reason, and ends with 1 if there is any.
"""

import argparse
import re
import sys
from pathlib import Path

# Lowest first. Element comes before mesh because a mesh is a template over its element.
LAYERS = ["core", "element", "mesh", "rotation", "material", "assembly", "solve", "terms", "dynamics", "embed", "contact", "scene"]

# The one face header that includes headers of a folder.
ALONE = {"corotet/detail/mesh/io/": "corotet/io.hpp", "corotet/detail/mesh/stuffing/": "corotet/meshing.hpp"}

FORBIDDEN = [
    (r"\bthrow\b|\btry\b|\bcatch\b", "the library does not use exceptions: return a Result"),
    (r"\.at\(|->at\(|\bstd::sto(i|l|ll|ul|ull|f|d|ld)\b", "throws on bad input: check the range, or use std::from_chars"),
    (r"\bdynamic_cast\b|\btypeid\b", "the library is used without RTTI"),
    (r"#\s*include\s*<(iostream|cassert|assert\.h)>", "the library does not print, and asserts by COROTET_ASSERT"),
    (r"\bv?printf\s*\(|\b(puts|putchar)\s*\(|\bstd::(cout|cerr|clog)\b|\bstd(out|err)\b", "the library does not print"),
    (r"\b(exit|_Exit|quick_exit|abort|terminate)\s*\(", "the library does not end the program"),
    (r"\bassert\s*\(", "assert by COROTET_ASSERT, whose handler can be replaced"),
    (r"#\s*define\s+(?!COROTET_)\w+|#\s*undef\b", "a macro must start with COROTET_ and stay defined"),
    (
        r"\b(near|far|small|huge|interface|check|verify|ensure|require|slots|emit|signals|foreach|Status|"
        r"Success|None|Bool|True|False|Always|Complex|PI|I|B[01]|IN|OUT|ERROR)\b|\b(min|max|abs|round|F)\s*\(",
        "a macro of some platform: take another name; call (std::min)(a, b), std::fabs(x)",
    ),
]
# Functions that C libraries round differently; files and pictures may hold what they return.
ROUNDED = re.compile(
    r"\bstd::(sqrt|cbrt|hypot|pow|exp2?|expm1|log(2|10|1p)?|a?(sin|cos|tan)h?|atan2|erfc?|[lt]gamma|fma)\b"
)
MAY_ROUND = ("corotet/detail/mesh/io/", "corotet/detail/core/square_root.hpp")
# Those two put such macros aside.
MACRO_HEADERS = ("corotet/detail/core/macros_off.hpp", "corotet/detail/core/macros_on.hpp")

UMBRELLA = "corotet/corotet.hpp"

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"](corotet/[^>"]+)[>"]', re.MULTILINE)
STANDARD = re.compile(r"^\s*#\s*include\s*<([a-z_]+)>", re.MULTILINE)
NAMESPACE = re.compile(r"(?:inline )?namespace ([\w: ]+) \{$")
# Comments, string, raw string and character literals (a digit separator such as 1'000 is not the start of a literal).
INERT = re.compile(
    r'R"([^\s()\\]{0,16})\(.*?\)\1"|//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|(?<![0-9A-Fa-f])\'(?:\\.|[^\'\\\n])+\'', re.DOTALL
)


def code_of(text):
    """The text with comments and literals blanked, lines kept; #include lines keep their file names."""

    def blank(match):
        return re.sub(r"[^\n]", " ", match.group())

    return INERT.sub(blank, text)


def line_of(text, position):
    return text.count("\n", 0, position) + 1


def headers_in(include_dir):
    return {path.relative_to(include_dir).as_posix(): path for path in sorted(include_dir.rglob("*.hpp"))}


def layer_of(header):
    """The folder of detail/ that it lies in; "" for one that lies elsewhere than it may, None for the face."""
    parts = header.split("/")
    if len(parts) == 2:
        return None
    return parts[2] if parts[1] == "detail" and len(parts) > 3 else ""


def is_face(header):
    """Whether users include it by name."""
    return layer_of(header) is None and header != UMBRELLA


def check_layers(headers, _opt_in):
    for name, path in headers.items():
        layer = layer_of(name)
        if layer is not None and layer not in LAYERS:
            yield f"{name}:1: folder {layer} has no place in the order {' < '.join(LAYERS)}"
            continue
        text = path.read_text(encoding="utf-8")
        for match in INCLUDE.finditer(text):
            target, where = match.group(1), f"{name}:{line_of(text, match.start(1))}"
            if target not in headers:
                yield f"{where}: includes {target}, which does not exist"
            elif name == UMBRELLA:
                continue
            elif layer_of(target) not in LAYERS:
                yield f"{where}: only {UMBRELLA} may include {target}, a header for users"
            elif layer is not None and LAYERS.index(layer_of(target)) > LAYERS.index(layer):
                yield f"{where}: {layer} may not include {target}; the order is {' < '.join(LAYERS)}"


def check_forbidden(headers, _opt_in):
    for name, path in headers.items():
        if name in MACRO_HEADERS:
            continue
        text = code_of(path.read_text(encoding="utf-8"))
        for pattern, reason in FORBIDDEN:
            for match in re.finditer(pattern, text):
                yield f"{name}:{line_of(text, match.start())}: '{match.group().strip()}': {reason}"
        if not name.startswith(MAY_ROUND):
            for match in ROUNDED.finditer(text):
                yield f"{name}:{line_of(text, match.start())}: '{match.group()}': not the same bits with every C " \
                    "library: take detail/core/elementary.hpp or square_root.hpp"


def check_length(headers, _opt_in):
    for name, path in headers.items():
        lines = path.read_text(encoding="utf-8").splitlines()
        if len(lines) >= 500:
            yield f"{name}:{len(lines)}: {len(lines)} lines; a header stays under 500"
        for number, line in enumerate(lines, 1):
            if len(line) > 120:
                yield f"{name}:{number}: {len(line)} characters; a line has at most 120"


def reached_from(headers, names):
    """All headers that these include, with themselves."""
    reached, waiting = set(), list(names)
    while waiting:
        name = waiting.pop()
        if name in headers and name not in reached:
            reached.add(name)
            waiting += INCLUDE.findall(headers[name].read_text(encoding="utf-8"))
    return reached


def check_alone(headers, _opt_in):
    for name in filter(is_face, headers):
        for reached in sorted(reached_from(headers, [name])):
            for folder, face in ALONE.items():
                if reached.startswith(folder) and name != face:
                    yield f"{name}:1: reaches {reached}, which only {face} may"


def declares_for_users(text):
    """Whether a header declares more in namespace corotet, outside its detail, than names of incomplete classes."""
    inside, users = [], ""
    for line, code in zip(text.split("\n"), code_of(text).split("\n")):
        opened = NAMESPACE.match(line)
        if opened:
            inside.append(opened.group(1))
        elif inside and line.startswith("}  // namespace"):
            inside.pop()
        elif inside and "detail" not in "::".join(inside).split("::"):
            users += code + "\n"
    return re.sub(r"(template <[^<>]*>\s*)?\b(struct|class) \w+;", "", users).strip() != ""


def check_named(headers, _opt_in):
    named = set()
    for name in filter(is_face, headers):
        named |= set(INCLUDE.findall(headers[name].read_text(encoding="utf-8")))
    for name, path in headers.items():
        if layer_of(name) is not None and name not in named and declares_for_users(path.read_text(encoding="utf-8")):
            yield f"{name}:1: declares names outside corotet::detail, but no face header includes it by name"


def check_umbrella(headers, opt_in):
    if UMBRELLA not in headers:
        yield f"{UMBRELLA}:1: does not exist"
        return
    text = headers[UMBRELLA].read_text(encoding="utf-8")
    for name in INCLUDE.findall(text):
        if not is_face(name) and name not in MACRO_HEADERS:
            yield f"{UMBRELLA}:1: includes {name}, which is not a face header"
    reached = reached_from(headers, [UMBRELLA])
    by_name = reached_from(headers, [name for name in opt_in if is_face(name)])
    for name in headers:
        if name in opt_in and name in reached:
            yield f"{UMBRELLA}:1: reaches {name}, which is opt-in"
        if name in opt_in and name not in by_name:
            yield f"{name}:1: no opt-in face header includes it"
        if name not in opt_in and name not in reached:
            yield f"{UMBRELLA}:1: does not reach {name}: a face header must include it"

    before, _, after = text.partition(MACRO_HEADERS[0])
    listed = set(STANDARD.findall(after.partition(MACRO_HEADERS[1])[0]))
    for name in sorted(reached - {UMBRELLA}):
        for standard in STANDARD.findall(headers[name].read_text(encoding="utf-8")):
            if standard not in listed:
                yield f"{UMBRELLA}:1: does not list <{standard}>, which {name} includes"


RULES = {
    "layers": check_layers,
    "alone": check_alone,
    "forbidden": check_forbidden,
    "length": check_length,
    "named": check_named,
    "umbrella": check_umbrella,
}


def violations(rule, include_dir, opt_in=()):
    headers = headers_in(Path(include_dir))
    if not headers:
        return [f"{include_dir}: no headers here"]
    return list(RULES[rule](headers, set(opt_in)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rule", choices=RULES)
    parser.add_argument("include_dir", type=Path)
    parser.add_argument("--opt-in", nargs="*", default=[], metavar="HEADER")
    arguments = parser.parse_args()
    found = violations(arguments.rule, arguments.include_dir, arguments.opt_in)
    for line in found:
        print(line)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

"""Documentation for users names what is there.

Files that docs/*.md link to exist, with the headings that they link to. README.md, docs and examples include headers of
corotet that lie outside its folders. Each C++ file of docs/snippets is shown by a page or by the reference; each listing
or comment that names a region of one repeats or finds it. Each of the main classes and functions has an example in its
comment.
"""
import re
import sys
from pathlib import Path

root = Path(__file__).resolve().parent.parent.parent
pages = [root / "README.md", root / "CONTRIBUTING.md", *sorted(root.glob("docs/**/*.md"))]
sources = [path for folder in ("examples", "docs/snippets") for path in sorted((root / folder).glob("*.[ch]pp"))]
faults = []


def anchor(heading):
    """As GitHub makes it of a heading."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def anchors(page):
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    return {anchor(heading) for heading in re.findall(r"^#+ (.*)$", text, re.MULTILINE)}


def unindented(text):
    return "\n".join(line.strip() for line in text.strip().splitlines())


for page in pages:
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        path, _, heading = target.partition("#")
        if ":" in path:
            continue
        file = (page.parent / path).resolve() if path else page
        if not file.exists():
            faults.append(f"{page.relative_to(root)} links to {target}, which does not exist")
        elif heading and file.suffix == ".md" and heading not in anchors(file):
            faults.append(f"{page.relative_to(root)} links to {target}: no such heading")

for file in pages + sources:
    for header in re.findall(r"#include <(corotet/[^>]+)>", file.read_text()):
        if header.count("/") > 1:
            faults.append(f"{file.relative_to(root)} includes <{header}>, which is not for users")
        elif not (root / "include" / header).exists():
            faults.append(f"{file.relative_to(root)} includes <{header}>, which does not exist")

shown = " ".join(path.read_text() for pattern in ("docs/**/*.md", "include/**/*.hpp") for path in root.glob(pattern))
for source in sorted(root.glob("docs/snippets/*.cpp")):
    if source.name not in shown:
        faults.append(f"docs/snippets/{source.name} is shown nowhere")

# A listing that is preceded by <!-- snippet file.cpp region --> repeats that region, up to indentation.
for page in pages:
    for name, region, listing in re.findall(r"<!-- snippet (\S+) (\S+) -->\n```cpp\n(.*?)```", page.read_text(), re.DOTALL):
        source = (root / "docs" / "snippets" / name).read_text()
        parts = re.split(rf"^ *//! \[{region}\]\n", source, flags=re.MULTILINE)
        if len(parts) != 3 or unindented(parts[1]) != unindented(listing):
            faults.append(f"{page.relative_to(root)}: the listing {name} {region} differs from docs/snippets/{name}")

WITH_EXAMPLE = """Attachment SubsteppingIntegrator AutoSolver Bdf2 BodyModel Contacts ContactPoints EmbeddedSurface ExecutorRef ImplicitEuler Integrator Materials Obstacles PinReactions
PointLocator Result SoftBody SolverOptions StepTerm TetMesh ThreadPool element_measures read_mesh save_snapshot solve_static
write_vtu""".split()
comment = re.compile(r"((?:^ *///.*\n)+)(?:^(?:template|  requires|\[\[nodiscard\]\] *$).*\n)*^.*?\b(\w+)(?: (?:final )?[:{]|;|\()", re.MULTILINE)
with_example = set()
for header in sorted(root.glob("include/corotet/**/*.hpp")):
    for text, name in comment.findall(header.read_text()):
        for source, region in re.findall(r"@snippet (\S+) (\S+)", text):
            with_example.add(name)
            file = root / "docs" / "snippets" / source
            if not file.exists() or f"//! [{region}]\n" not in file.read_text():
                faults.append(f"{header.relative_to(root)}: there is no region {region} in docs/snippets/{source}")
faults += [f"the comment of {name} has no example" for name in WITH_EXAMPLE if name not in with_example]

sys.exit("\n".join(faults) if faults else 0)

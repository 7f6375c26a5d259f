"""The first program of README.md is examples/hello.cpp, letter by letter; what README.md links to exists; and the listings
of docs/engine.md are lines of examples/engine_queries.cpp."""
import re
import sys
from pathlib import Path

root = Path(__file__).resolve().parent.parent.parent
readme = (root / "README.md").read_text()

listing = re.search(r"```cpp\n(.*?)```", readme, re.DOTALL)
if not listing or listing[1] != (root / "examples" / "hello.cpp").read_text():
    sys.exit("the first C++ listing of README.md is not examples/hello.cpp")

missing = [target for target in re.findall(r"\]\(([^)#:]+)\)|src=\"([^\":]+)\"", re.sub(r"```.*?```", "", readme, flags=re.DOTALL))
           if not (root / (target[0] or target[1])).exists()]
if missing:
    sys.exit(f"README.md links to what does not exist: {missing}")


def lines_of(text):
    return "\n".join(line.strip() for line in text.splitlines())


example = lines_of((root / "examples" / "engine_queries.cpp").read_text())
listings = re.findall(r"```cpp\n(.*?)```", (root / "docs" / "engine.md").read_text(), re.DOTALL)
unknown = [listing for listing in listings if lines_of(listing) not in example]
if not listings or unknown:
    sys.exit(f"docs/engine.md shows what is not in examples/engine_queries.cpp: {unknown}")

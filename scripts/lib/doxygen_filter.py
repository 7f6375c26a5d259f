"""What Doxygen reads instead of a header: doxygen_filter.py HEADER prints it, line for line.

All that a header declares joins the group of the face header that includes it by name: group_<its stem>. Doxygen 1.9
does not parse `namespace corotet::inline v0_1`, attributes that are macros and digit separators, and would list inline
namespaces. Definitions below a class, and deduction guides, would be listed beside it: they are left out. So are copying
and moving where they are declared only: nothing is to be said of them.
"""
import re
import sys
from pathlib import Path

header = Path(sys.argv[1])
text = header.read_text(encoding="utf-8")
face_folder = Path("include/corotet")
name = header.as_posix().split("include/", 1)[1]
group = next((face.stem for face in sorted(face_folder.glob("*.hpp"))
              if face.name != "corotet.hpp" and f"#include <{name}>" in face.read_text(encoding="utf-8")), None)
opening, closing = "namespace corotet {", "}"
if group:
    opening += f" /** @addtogroup group_{group} */ /** @{{ */"
    closing = "/** @} */ }"
isa = "::inline COROTET_ISA"
text = text.replace(isa, "").replace("inline namespace COROTET_ISA {", "").replace("}  // namespace COROTET_ISA", "")
text = text.replace("namespace corotet::inline v0_1 {", opening)
text = text.replace("namespace corotet::inline v0_1::detail {", "namespace corotet::detail {")
text = re.sub(r"^\}  // namespace corotet::inline v0_1$", closing, text, flags=re.MULTILINE)
text = text.replace("COROTET_COLD ", "")
text = re.sub(r"(?<=[0-9A-Fa-f])'(?=[0-9A-Fa-f])", "", text)
text = re.sub(r"^// Below the class, .*?(?=^/\*\* @\})", lambda below: "\n" * below[0].count("\n"), text,
              flags=re.MULTILINE | re.DOTALL)
text = re.sub(r"^template <[^\n]*>\n\w+\([^;{]*\) -> [^;]*;", lambda guide: "\n" * guide[0].count("\n"), text,
              flags=re.MULTILINE)
text = re.sub(r"^ +(\w+)\((const \1&|\1&&)\)( noexcept)?( = default)?;$", "", text, flags=re.MULTILINE)
text = re.sub(r"^ +(\w+)& operator=\((const \1&|\1&&)( other)?\)( &)?( noexcept)?( = default)?;$", "", text,
              flags=re.MULTILINE)
sys.stdout.write(text)

"""The header checks find what they are for, and nothing else."""

import tempfile
import unittest
from pathlib import Path

import check_headers


class CheckHeaders(unittest.TestCase):
    def run_rule(self, rule, files, opt_in=()):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in files.items():
                path = Path(folder) / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            return check_headers.violations(rule, folder, opt_in)

    def test_an_empty_folder_is_a_violation_of_every_rule(self):
        for rule in check_headers.RULES:
            self.assertTrue(self.run_rule(rule, {}), rule)

    def test_includes_point_downwards_only(self):
        core, mesh = "corotet/detail/core/a.hpp", "corotet/detail/mesh/b.hpp"
        down = {core: "", mesh: "#include <corotet/detail/core/a.hpp>\n"}
        up = {core: "// first line\n#include <corotet/detail/mesh/b.hpp>\n", mesh: ""}
        self.assertEqual(self.run_rule("layers", down), [])
        found = self.run_rule("layers", up)
        self.assertEqual(len(found), 1)
        self.assertTrue(found[0].startswith("corotet/detail/core/a.hpp:2:"), found)

    def test_a_missing_header_an_unknown_folder_and_the_umbrella_are_refused_as_includes(self):
        self.assertTrue(self.run_rule("layers", {"corotet/detail/core/a.hpp": "#include <corotet/detail/core/none.hpp>"}))
        self.assertTrue(self.run_rule("layers", {"corotet/other/a.hpp": ""}))
        self.assertTrue(
            self.run_rule(
                "layers", {"corotet/corotet.hpp": "", "corotet/scene/a.hpp": "#include <corotet/corotet.hpp>"}
            )
        )

    def test_each_forbidden_thing_is_found_with_its_line(self):
        for code in [
            "throw 1;",
            "try {",
            "v.at(0);",
            "std::stoi(s);",
            "dynamic_cast<A*>(b);",
            "typeid(x);",
            "#include <iostream>",
            "#include <cassert>",
            'printf("x");',
            "std::cout << x;",
            "fputs(s, stderr);",
            "exit(1);",
            "std::abort();",
            "assert(x);",
            "#define ALIGN 16",
            "#undef COROTET_X",
            "double near;",
            "class Status;",
            "template <int... I>",
            "y = std::max(1, 2);",
            "std::numeric_limits<int>::min();",
            "using std::abs; z = abs (x);",
            "y = std::sqrt(x);",
            "y = std::atan2(x, z);",
            "y = std::log1p(x);",
        ]:
            found = self.run_rule("forbidden", {"corotet/detail/core/a.hpp": "int x;\n" + code + "\n"})
            self.assertEqual(len(found), 1, (code, found))
            self.assertTrue(found[0].startswith("corotet/detail/core/a.hpp:2:"), found)

    def test_words_in_comments_literals_and_longer_names_are_allowed(self):
        code = """// throw, try, exit(1)
/* abort()
   std::cout */
#define COROTET_X 1
const char* text = "throw \\" exit(1)";
const char* raw = R"js(near = Math.max(1, "2)"); // throw
exit(1);)js";
char quote = '"'; int million = 1'000'000; char other = '"';
static_assert(true); trap_on_assert(); at(i); std::snprintf(b, n, f); retry(); on_exit_code(3);
(std::max)(1, 2); (std::numeric_limits<int>::min)(); cwiseMin(x); lane_abs(x); nearest(); int max = 1; Result<void> check_it();
"""
        self.assertEqual(self.run_rule("forbidden", {"corotet/detail/core/a.hpp": code}), [])

    def test_files_and_pictures_may_hold_what_c_libraries_round(self):
        self.assertEqual(self.run_rule("forbidden", {"corotet/detail/mesh/io/a.hpp": "std::hypot(x, y);\n"}), [])

    def test_the_headers_that_put_macros_aside_may(self):
        self.assertEqual(self.run_rule("forbidden", {"corotet/detail/core/macros_off.hpp": "#undef near\n"}), [])

    def test_length_limits(self):
        self.assertEqual(self.run_rule("length", {"corotet/detail/core/a.hpp": "x\n" * 299}), [])
        self.assertEqual(len(self.run_rule("length", {"corotet/detail/core/a.hpp": "x\n" * 500})), 1)
        self.assertEqual(self.run_rule("length", {"corotet/detail/core/a.hpp": "x" * 120}), [])
        self.assertEqual(len(self.run_rule("length", {"corotet/detail/core/a.hpp": "x" * 121})), 1)

    def test_face_headers_include_the_folders_and_only_the_umbrella_includes_them(self):
        files = {
            "corotet/corotet.hpp": "#include <corotet/face.hpp>\n",
            "corotet/face.hpp": "#include <corotet/detail/core/a.hpp>\n",
            "corotet/detail/core/a.hpp": "",
        }
        self.assertEqual(self.run_rule("layers", files), [])
        inside = files | {"corotet/detail/core/a.hpp": "#include <corotet/face.hpp>\n"}
        self.assertEqual(len(self.run_rule("layers", inside)), 1)
        beside = files | {"corotet/other.hpp": "#include <corotet/face.hpp>\n"}
        self.assertEqual(len(self.run_rule("layers", beside)), 1)

    def test_files_are_reached_by_their_face_header_alone(self):
        files = {
            "corotet/io.hpp": "#include <corotet/detail/mesh/io/read.hpp>\n",
            "corotet/detail/mesh/io/read.hpp": "",
            "corotet/detail/mesh/b.hpp": "#include <corotet/detail/mesh/io/read.hpp>\n",
        }
        self.assertEqual(self.run_rule("alone", files), [])
        dragged = files | {"corotet/face.hpp": "#include <corotet/detail/mesh/b.hpp>\n"}
        self.assertEqual(len(self.run_rule("alone", dragged)), 1)

    def test_a_face_header_names_what_declares_names_outside_detail(self):
        def header(space, code):
            return f"namespace corotet::inline v0_1{space} {{\n{code}\n}}  // namespace corotet::inline v0_1{space}\n"

        face = {"corotet/face.hpp": "#include <corotet/detail/core/a.hpp>\n", "corotet/detail/core/a.hpp": ""}
        for for_users in [
            header("", "struct S {};"),
            header("", "using S = int;"),
            header("", "namespace detail {\nstruct D {};\n}  // namespace detail\nvoid f();"),
            header("::inline COROTET_ISA", "class L {\n};"),
        ]:
            self.assertEqual(len(self.run_rule("named", face | {"corotet/detail/core/b.hpp": for_users})), 1, for_users)
            self.assertEqual(self.run_rule("named", face | {"corotet/detail/core/a.hpp": for_users}), [])
        for internal in [
            header("::detail", "struct D {};"),
            header("", "struct S;\ntemplate <class T>\nclass C;"),
            header("", "namespace detail {\nstruct D {};\n}  // namespace detail\n// struct S {};"),
        ]:
            self.assertEqual(self.run_rule("named", face | {"corotet/detail/core/b.hpp": internal}), [], internal)

    UMBRELLA = {
        "corotet/corotet.hpp": "#include <corotet/detail/core/macros_off.hpp>\n#include <vector>\n"
        "#include <corotet/detail/core/macros_on.hpp>\n#include <corotet/face.hpp>\n",
        "corotet/face.hpp": "#include <corotet/detail/mesh/b.hpp>\n",
        "corotet/detail/mesh/b.hpp": "#include <corotet/detail/core/a.hpp>\n",
        "corotet/detail/core/a.hpp": "#include <vector>\n",
        "corotet/detail/core/macros_off.hpp": "",
        "corotet/detail/core/macros_on.hpp": "",
        "corotet/extra.hpp": "#include <corotet/detail/core/extra.hpp>\n",
        "corotet/detail/core/extra.hpp": "#include <map>\n",
    }
    OPT_IN = ["corotet/extra.hpp", "corotet/detail/core/extra.hpp"]

    def test_umbrella_reaches_all_but_the_opt_in_headers(self):
        self.assertEqual(self.run_rule("umbrella", self.UMBRELLA, self.OPT_IN), [])
        self.assertEqual(len(self.run_rule("umbrella", self.UMBRELLA)), 2)
        self.assertEqual(len(self.run_rule("umbrella", self.UMBRELLA | {"corotet/detail/mesh/c.hpp": ""}, self.OPT_IN)), 1)

    def test_umbrella_reaches_no_opt_in_header_and_an_opt_in_face_header_reaches_each(self):
        reaching = self.UMBRELLA | {"corotet/detail/core/a.hpp": "#include <corotet/detail/core/extra.hpp>\n"}
        found = self.run_rule("umbrella", reaching, self.OPT_IN)
        self.assertEqual(sum("which is opt-in" in line for line in found), 1, found)
        lonely = self.UMBRELLA | {"corotet/extra.hpp": ""}
        self.assertEqual(len(self.run_rule("umbrella", lonely, self.OPT_IN)), 1)

    def test_umbrella_includes_no_header_of_the_folders(self):
        root = self.UMBRELLA["corotet/corotet.hpp"] + "#include <corotet/detail/core/a.hpp>\n"
        self.assertEqual(len(self.run_rule("umbrella", self.UMBRELLA | {"corotet/corotet.hpp": root}, self.OPT_IN)), 1)

    def test_umbrella_lists_headers_of_the_standard_library_where_macros_are_put_aside(self):
        a = self.UMBRELLA | {"corotet/detail/core/a.hpp": "#include <vector>\n#include <map>\n"}
        found = self.run_rule("umbrella", a, self.OPT_IN)
        self.assertEqual(len(found), 1)
        self.assertIn("<map>", found[0])
        late = a | {"corotet/corotet.hpp": self.UMBRELLA["corotet/corotet.hpp"] + "#include <map>\n"}
        self.assertEqual(len(self.run_rule("umbrella", late, self.OPT_IN)), 1)


if __name__ == "__main__":
    unittest.main()

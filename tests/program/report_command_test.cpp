#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "program_runner.hpp"

namespace report_command_test {
namespace {

using corotet::testing::Outcome;
using corotet::testing::ProgramTest;

class ReportCommand : public ProgramTest {
 protected:
  using Row = std::map<std::string, std::string>;

  /// A bar that is pulled along its length by gravity, without lateral strain, and damped: smooth, so that orders of
  /// convergence show on few elements. Its mesh is a grid of 4 x 1 x 1 cells.
  void write_bar(const std::string& more = "") const {
    must("mesh beam --cells 4 1 1 --size 1 0.25 0.25 -o bar.msh");
    write("bar.json", R"({"mesh": "bar.msh", "material": {"poisson": 0}, "damping": {"stiffness": 0.02},
      "gravity": [20, 0, 0], "pins": [{"box": [[0,0,0],[0,1,1]]}], "probes": [{"nearest": [1,0,0]}], "steps": 48,
      "integrator": {"dt": 0.004166666666666667}, "scalar": "double")" +
                          more + "}");
  }

  static double number(const Row& row, const std::string& column) {
    EXPECT_FALSE(row.at(column).empty()) << column << " of a run that is " << row.at("status");
    return std::atof(row.at(column).c_str());
  }

  /// The grid's row of a mesh of 4-node elements, integrator and time step.
  static const Row& find(const std::vector<Row>& rows, const std::string& mesh, const std::string& integrator,
                         double dt) {
    for (const Row& row : rows)
      if (row.at("role") == "grid" && row.at("mesh") == mesh && row.at("order") == "1" &&
          row.at("integrator") == integrator && std::abs(number(row, "dt") / dt - 1) < 1e-4)
        return row;
    ADD_FAILURE() << "no row of " << mesh << ", " << integrator << ", dt " << dt;
    return rows.front();
  }
};

TEST_F(ReportCommand, MeasuresErrorsThatAddUpAndOrdersThatAreKnown) {
  write_bar();
  must("report bar.json -o out --quick --minutes 5");  // minutes enough on any machine: nothing is left out
  const std::vector<Row> rows = read_csv("out/report.csv");
  ASSERT_GT(rows.size(), 20U);
  int on_frontier = 0;
  for (const Row& row : rows) {
    ASSERT_EQ(row.at("status"), "ok") << row.at("mesh") << " " << row.at("role");
    EXPECT_EQ(row.at("case"), "bar");
    for (const char* column : {"step_ms", "frame_ms", "spmv_us", "elements", "vertices", "setup_ms"})
      EXPECT_GT(number(row, column), 0) << column;
    for (const std::string measure : {"", "_energy", "_probe"}) {
      const double space = number(row, "space" + measure), time = number(row, "time" + measure),
                   arithmetic = number(row, "arithmetic" + measure), total = number(row, "error" + measure);
      EXPECT_LE(total, (space + time + arithmetic) * 1.001 + 1e-9) << row.at("mesh") << measure;
      EXPECT_GE(total, space - time - arithmetic - 1e-6) << row.at("mesh") << measure;
    }
    on_frontier += row.at("frontier") == "1" ? 1 : 0;
  }
  EXPECT_GE(on_frontier, 1);

  // Tet4 converges with the square of h (from above: coarse meshes miss the waves, too), backward Euler with dt, BDF2
  // with its square.
  const double dt = 1.0 / 240;
  const auto space = [&](const std::string& mesh) { return number(find(rows, mesh, "implicit_euler", dt), "space"); };
  EXPECT_NEAR(std::log2(space("4x1x1") / space("8x2x2")), 2, 0.25);
  for (const auto& [integrator, order] : {std::pair{"implicit_euler", 1.0}, std::pair{"bdf2", 2.0}}) {
    const auto time = [&](double step) { return number(find(rows, "4x1x1", integrator, step), "time"); };
    EXPECT_NEAR(std::log2(time(dt / 2) / time(dt / 4)), order, 0.1) << integrator;
  }

  // Quadratic elements bring their order only with the mass, and so the weight, that goes with their shape functions.
  double consistent = 1;
  for (const Row& row : rows)
    if (row.at("role") == "mass") consistent = number(row, "space");
  EXPECT_LT(consistent, 0.1 * space("4x1x1"));

  // A looser tolerance is a larger error of arithmetic, and of nothing else.
  const auto of_tolerance = [&](const std::string& tolerance) -> const Row& {
    for (const Row& row : rows)
      if (row.at("role") == "tolerance" && row.at("tolerance") == tolerance) return row;
    ADD_FAILURE() << tolerance;
    return rows.front();
  };
  EXPECT_GT(number(of_tolerance("0.1"), "arithmetic"), 10 * number(of_tolerance("1e-05"), "arithmetic"));
  EXPECT_EQ(of_tolerance("0.1").at("space"), of_tolerance("1e-05").at("space"));

  const std::string page = read("out/report.md");
  for (const char* plot : {"bar_error_time.svg", "bar_error_h.svg", "bar_error_dt.svg", "bar_budget.svg", "cost.svg"}) {
    EXPECT_NE(page.find(plot), std::string::npos) << plot;
    const std::string svg = read(std::string("out/") + plot);
    EXPECT_EQ(svg.rfind("<svg", 0), 0U) << plot;
    EXPECT_NE(svg.find("</svg>"), std::string::npos) << plot;
    EXPECT_EQ(svg.find("nan"), std::string::npos) << plot;
  }
}

TEST_F(ReportCommand, ARunThatFailsIsARowThatSaysSo) {
  write_bar(R"(, "solver": {"name": "pcg", "preconditioner": "jacobi", "max_iterations": 1})");
  must("report bar.json -o out --quick --minutes 5");
  int failed = 0;
  for (const Row& row : read_csv("out/report.csv")) {
    if (row.at("status") == "ok") continue;
    ++failed;
    EXPECT_EQ(row.at("status").rfind("unconverged in ", 0), 0U) << row.at("status");
    EXPECT_TRUE(row.at("error").empty()) << "an error is not measured on it";
    EXPECT_EQ(row.at("frontier"), "0");
  }
  EXPECT_GT(failed, 5);
  EXPECT_NE(read("out/report.md").find("unconverged in "), std::string::npos);
}

TEST_F(ReportCommand, WhatTakesTooLongIsLeftOutAndSaidSo) {
  write_bar();
  must("report bar.json -o out --quick --minutes 0.0001");
  int left_out = 0;
  for (const Row& row : read_csv("out/report.csv")) left_out += row.at("status").rfind("left out: ", 0) == 0 ? 1 : 0;
  EXPECT_GT(left_out, 0);
}

TEST_F(ReportCommand, ItsOwnCasesReachTheirClosedForms) {
  must("report --case self_weight_nu0 -o out --quick --minutes 0.2");
  double best = 1;
  for (const Row& row : read_csv("out/report.csv"))
    if (row.at("role") == "grid" && row.at("status") == "ok") best = std::min(best, number(row, "closed_form_error"));
  EXPECT_LT(best, 0.02) << "of the drop of a converged 3D solution, by another program";
  EXPECT_NE(read("out/report.md").find("independent program"), std::string::npos);
}

TEST_F(ReportCommand, SaysWhatItCannotDo) {
  write_bar();
  for (const auto& [arguments, expected] :
       {std::pair{"report nothing.json -o out", "nothing.json"}, std::pair{"report bar.json", "--output"},
        std::pair{"report --case swim -o out", "there are: self_weight"},
        std::pair{"report bar.json --case swing -o out", "--case"},
        std::pair{"report bar.json -o out --minutes -1", "--minutes"},
        std::pair{"report bar.json -o bar.msh", "bar.msh"}}) {
    const Outcome outcome = corotet(arguments);
    EXPECT_NE(outcome.exit_code, 0) << arguments;
    EXPECT_NE(outcome.err.find(expected), std::string::npos) << arguments << "\n" << outcome.err;
    EXPECT_FALSE(exists("out")) << arguments;
  }
}

/// Against closed forms: force and sag of a column on a floor, and the momenta of a strike.
TEST_F(ReportCommand, ComparesContactWithClosedForms) {
  must("report --contact --quick --case rest --case strike -o out");
  const std::vector<Row> rows = read_csv("out/contact.csv");
  EXPECT_EQ(rows.size(), 2U * 2 * 8);
  int on_frontier = 0;
  for (const Row& row : rows) {
    ASSERT_EQ(row.at("status"), "ok");
    EXPECT_GT(number(row, "step_ms"), 0);
    EXPECT_GE(number(row, "passes"), 1);
    const bool is_sag = row.at("quantity").find("sag") != std::string::npos;
    EXPECT_LT(number(row, "error"), is_sag ? 0.05 : 1e-3) << row.at("quantity");
    on_frontier += row.at("frontier") == "1" ? 1 : 0;
  }
  EXPECT_GE(on_frontier, 2);
  EXPECT_NE(read("out/contact.md").find("## rest: "), std::string::npos);
  EXPECT_NE(read("out/rest_error_time.svg").find("<svg"), std::string::npos);
  const Outcome unknown = corotet("report --contact --case swing -o out");
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_NE(unknown.err.find("incline_holds"), std::string::npos) << unknown.err;
}

}  // namespace
}  // namespace report_command_test

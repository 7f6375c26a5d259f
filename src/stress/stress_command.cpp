// `corotet stress`: the hard cases, and which ways to run them pass.
#include <fmt/core.h>

#include <algorithm>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <thread>

#include "../command.hpp"
#include "../failure.hpp"
#include "../output_folder.hpp"
#include "suite.hpp"
#include "tables.hpp"

namespace corotet::program {
namespace {

struct StressOptions {
  stress::SuiteOptions suite;
  Tangent tangent = Tangent::stabilized;
  std::string output;
  bool list = false, quick = false, full = false;
};

int stress_bodies(const StressOptions& options) {
  if (options.list) {
    for (const stress::Case& c : stress::all_cases())
      fmt::print("{:16} {}\n{:16} passes if: {}\n", c.name, c.set_up, "", c.criterion);
    return 0;
  }
  if (!options.output.empty()) make_folder(options.output);  // before the work
  const stress::Outcome outcome = stress::run_suite(options.suite);
  fmt::print("{}", stress::format_text(outcome));
  if (!options.output.empty()) {
    const std::filesystem::path folder(options.output);
    require(write_file(folder / "stress.csv", stress::format_csv(outcome)));
    require(write_file(folder / "stress.md", stress::format_markdown(outcome)));
  }
  const bool passed = std::all_of(outcome.runs.begin(), outcome.runs.end(),
                                  [](const stress::Run& run) { return run.verdict.passed(); });
  return passed ? 0 : 1;
}

}  // namespace

Command add_stress_command(CLI::App& app) {
  auto options = std::make_shared<StressOptions>();
  CLI::App* syntax = app.add_subcommand("stress", "Try hard cases in every configuration, and say which pass");
  syntax->add_option("case", options->suite.cases, "Names of cases, or what they begin with: flat, stretch-3 (all)");
  syntax->add_option("-o,--output", options->output, "Folder for stress.csv and stress.md; made if it is not there");
  auto* quick = syntax->add_flag("--quick", options->quick,
                                 "Only float, `auto` and nu = .3, 10 random starts, 300 steps for 10,000");
  auto* full = syntax->add_flag("--full", options->full,
                                "All combinations of element, precision, integrator, solver and Poisson's ratio, not "
                                "only so many that each two meet");
  quick->excludes(full);
  syntax->add_flag("--list", options->list, "Only names the cases, with set-up and criterion");
  syntax->add_option("--only", options->suite.only,
                     "Only these of the elements (tet4 tet10), precisions (float double), integrators (euler newton "
                     "bdf2), solvers (auto cholesky jacobi block_jacobi rigid_aggregates warped_cholesky) or ratios "
                     "(nu=0 nu=.3 nu=.45 nu=.499 nu=.499mean); all of those of which none is named");
  auto* tangent = syntax->add_option("--tangent", options->tangent,
                                     "plain, stretch_stable or exact for all (exact for newton, else stretch_stable)");
  tangent->transform(CLI::CheckedTransformer(std::map<std::string, Tangent>{
      {"plain", Tangent::warped}, {"stretch_stable", Tangent::stabilized}, {"exact", Tangent::consistent}}));
  options->suite.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  syntax->add_option("--threads", options->suite.threads, "Runs at the same time, >= 1 (as many as processors)")
      ->check(CLI::Range(1, 1024));
  syntax->footer(
      "Rows of the table: cases. Columns: element, precision and integrator (euler: one solve a step; newton: until\n"
      "converged; bdf2: second order, one solve), each over the solvers and Poisson's ratios that were tried with it;\n"
      "FAIL1/3: 1 of 3 runs failed. Exit code 1 if one failed.\n\n"
      "Examples:\n"
      "  corotet stress --quick\n"
      "  corotet stress stretch spin --only euler auto --tangent plain\n"
      "  corotet stress -o out");
  return {syntax, [options, tangent] {
            if (options->quick) options->suite.coverage = stress::Coverage::quick;
            if (options->full) options->suite.coverage = stress::Coverage::full;
            if (tangent->count() > 0) options->suite.tangent = options->tangent;
            return stress_bodies(*options);
          }};
}

}  // namespace corotet::program

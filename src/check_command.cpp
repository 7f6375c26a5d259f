// `corotet check`: says how good a mesh is, and whether it can be used.
#include <fmt/core.h>

#include <memory>
#include <string>

#include "check_report.hpp"
#include "command.hpp"
#include "failure.hpp"

namespace corotet::program {
namespace {

struct CheckCommandOptions {
  std::string mesh;
  int worst = 5;
  bool json = false;
};

std::string dump(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace); }

int check(const CheckCommandOptions& options) {
  if (!options.json) {
    const CheckReport report = check_mesh(options.mesh, options.worst);
    fmt::print("{}", format_text(report));
    return report.usable() ? 0 : 1;
  }
  try {
    const CheckReport report = check_mesh(options.mesh, options.worst);
    fmt::print("{}\n", dump(to_json(report)));
    return report.usable() ? 0 : 1;
  } catch (const Failure& failure) {
    const Json json{{"file", options.mesh}, {"usable", false}, {"reason", failure.what()}};
    fmt::print("{}\n", dump(json));
    return 1;
  }
}

}  // namespace

Command add_check_command(CLI::App& app) {
  auto options = std::make_shared<CheckCommandOptions>();
  CLI::App* syntax = app.add_subcommand("check", "Say how good a mesh is, and whether it can be used");
  syntax->add_option("mesh", options->mesh, "gmsh .msh, Medit .mesh, legacy .vtk, Vega .veg, TetGen .node/.ele")
      ->required();
  syntax->add_option("--worst", options->worst, "How many of the worst elements to name (5)")
      ->check(CLI::NonNegativeNumber);
  syntax->add_flag("--json", options->json, "Write JSON, for programs");
  syntax->footer(
      "Exit code 0 only if the mesh can be used.\n\n"
      "Examples:\n"
      "  corotet check beam.msh\n"
      "  corotet check --json --worst 20 bunny.mesh > bunny.json");
  return {syntax, [options] { return check(*options); }};
}

}  // namespace corotet::program

// A subcommand of the program: what the command line offers, and what to do when it was chosen.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace corotet::program {

struct Command {
  CLI::App* syntax;          ///< owned by the app it was added to
  std::function<int()> run;  ///< returns the exit code; throws Failure
};

[[nodiscard]] Command add_mesh_command(CLI::App& app);
[[nodiscard]] Command add_check_command(CLI::App& app);
[[nodiscard]] Command add_run_command(CLI::App& app);
[[nodiscard]] Command add_bench_command(CLI::App& app);
[[nodiscard]] Command add_report_command(CLI::App& app);
[[nodiscard]] Command add_tune_command(CLI::App& app);
[[nodiscard]] Command add_stress_command(CLI::App& app);

}  // namespace corotet::program

// A hard case: set-up, run and criterion under one name.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "case_result.hpp"
#include "configuration.hpp"

namespace corotet::program::stress {

/// How much is asked of a run.
struct Effort {
  int seeds = 100;         ///< of random starts
  int long_steps = 10000;  ///< of the runs for energy and drift
};

struct Case {
  std::string name;       ///< on the command line and in the table
  std::string set_up;     ///< in words
  std::string criterion;  ///< in words
  Solvers solvers = Solvers::all;
  std::vector<Ratio> ratios;

  [[nodiscard]] Factors factors() const { return {.solvers = solver_choices(solvers), .ratios = ratios}; }

  std::function<CaseResult(const Configuration&, const Effort&)> run;
};

/// In the order of the table.
[[nodiscard]] std::vector<Case> all_cases();

void add_start_cases(std::vector<Case>& cases);
void add_held_cases(std::vector<Case>& cases);
void add_free_cases(std::vector<Case>& cases);
void add_material_cases(std::vector<Case>& cases);
void add_scale_cases(std::vector<Case>& cases);
void add_input_cases(std::vector<Case>& cases);
void add_endurance_cases(std::vector<Case>& cases);
void add_contact_cases(std::vector<Case>& cases);

}  // namespace corotet::program::stress

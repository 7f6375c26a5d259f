// What became of the hard cases, as tables.
#pragma once

#include <string>

#include "suite.hpp"

namespace corotet::program::stress {

/// For a terminal: cases by columns of element, precision and integrator, and what failed.
[[nodiscard]] std::string format_text(const Outcome& outcome);

/// The same as Markdown, with tables by solver and by Poisson's ratio, and one line a failing group.
[[nodiscard]] std::string format_markdown(const Outcome& outcome);

/// One line a run.
[[nodiscard]] std::string format_csv(const Outcome& outcome);

}  // namespace corotet::program::stress

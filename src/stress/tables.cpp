#include "tables.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <sstream>
#include <utility>
#include <vector>

namespace corotet::program::stress {
namespace {

using Key = std::function<std::string(const Run&)>;

std::string by_column(const Run& run) { return run.configuration.column(); }
std::string by_solver(const Run& run) { return std::string(run.configuration.solver.name); }
std::string by_ratio(const Run& run) { return std::string(run.configuration.ratio.name); }

/// Whether it runs as a scene that names no integrator and no solver does.
bool is_default(const Run& run) {
  return run.configuration.stepping == Stepping::euler && run.configuration.solver.name == "auto";
}

struct Count {
  int runs = 0, failed = 0;
  [[nodiscard]] std::string text() const {
    if (runs == 0) return "";
    return failed == 0 ? "pass" : fmt::format("FAIL {}/{}", failed, runs);
  }
};

struct Pivot {
  std::vector<std::string> columns;
  std::vector<std::map<std::string, Count>> rows;  // one a case
};

/// `columns`: all that there may be, in order.
Pivot pivot(const Outcome& outcome, const Key& key, std::vector<std::string> columns,
            const std::function<bool(const Run&)>& where = nullptr) {
  Pivot table{std::move(columns), {}};
  table.rows.resize(outcome.cases.size());
  for (const Run& run : outcome.runs) {
    if (where && !where(run)) continue;
    Count& count = table.rows[run.of_case][key(run)];
    ++count.runs;
    if (!run.verdict.passed()) ++count.failed;
  }
  std::erase_if(table.columns, [&](const std::string& column) {
    return std::none_of(table.rows.begin(), table.rows.end(), [&](const auto& row) { return row.contains(column); });
  });
  return table;
}

Pivot pivot_by_column(const Outcome& outcome) {
  const FactorWords words = all_factors(outcome.cases).words();
  std::vector<std::string> columns;
  for (const std::string& element : words[0])
    for (const std::string& scalar : words[1])
      for (const std::string& stepping : words[2])
        columns.push_back(fmt::format("{} {} {}", element, scalar, stepping));
  return pivot(outcome, by_column, std::move(columns));
}

std::string cell(const Pivot& table, std::size_t row, const std::string& column) {
  const auto found = table.rows[row].find(column);
  return found == table.rows[row].end() ? "" : found->second.text();
}

std::string markdown(const Outcome& outcome, const Pivot& table) {
  std::string text = "| case |", rule = "| --- |";
  for (const std::string& column : table.columns) {
    text += fmt::format(" {} |", column);
    rule += " --- |";
  }
  text += "\n" + rule + "\n";
  for (std::size_t i = 0; i < outcome.cases.size(); ++i) {
    text += fmt::format("| {} |", outcome.cases[i].name);
    for (const std::string& column : table.columns) text += fmt::format(" {} |", cell(table, i, column));
    text += "\n";
  }
  return text + "\n";
}

/// How many runs failed, of how many.
std::string summary(const Outcome& outcome) {
  Count all, of_default;
  for (const Run& run : outcome.runs)
    for (Count* count : {&all, is_default(run) ? &of_default : nullptr}) {
      if (count == nullptr) continue;
      ++count->runs;
      if (!run.verdict.passed()) ++count->failed;
    }
  return fmt::format("{} of {} runs failed; of the {} with the default integrator and solver, {}.\n", all.failed,
                     all.runs, of_default.runs, of_default.failed);
}

/// One line for each case and column that fails: how many, and what the first of them said.
std::string failures(const Outcome& outcome) {
  std::string text;
  const Pivot table = pivot_by_column(outcome);
  for (std::size_t i = 0; i < outcome.cases.size(); ++i)
    for (const std::string& column : table.columns) {
      const auto found = table.rows[i].find(column);
      if (found == table.rows[i].end() || found->second.failed == 0) continue;
      const auto first = std::find_if(outcome.runs.begin(), outcome.runs.end(), [&](const Run& run) {
        return run.of_case == i && by_column(run) == column && !run.verdict.passed();
      });
      text += fmt::format("- {}, {}: {} of {}; first {} {}: {}\n", outcome.cases[i].name, column, found->second.failed,
                          found->second.runs, by_solver(*first), by_ratio(*first), first->verdict.text());
    }
  return text;
}

/// The least, mean and largest fraction of random starts that recovered, by column.
std::string recovery(const Outcome& outcome) {
  struct Fractions {
    double least = 1, sum = 0, most = 0;
    int runs = 0;
  };
  std::map<std::string, Fractions> found;
  std::vector<std::string> order;
  for (const Run& run : outcome.runs) {
    const double fraction = run.verdict.recovered;
    if (fraction < 0) continue;
    const std::string name = by_column(run) + " " + by_ratio(run);
    if (!found.contains(name)) order.push_back(name);
    Fractions& f = found[name];
    f = {std::min(f.least, fraction), f.sum + fraction, std::max(f.most, fraction), f.runs + 1};
  }
  std::string text;
  for (const std::string& name : order) {
    const Fractions& f = found[name];
    text += fmt::format("| {} | {:.2f} | {:.2f} | {:.2f} |\n", name, f.least, f.sum / f.runs, f.most);
  }
  return text;
}

}  // namespace

std::string format_text(const Outcome& outcome) {
  const Pivot table = pivot_by_column(outcome);
  std::vector<std::vector<std::string>> heads;
  for (const std::string& column : table.columns) {
    std::istringstream words(column);
    heads.emplace_back(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
  }
  std::string text;
  for (std::size_t line = 0; line < 3; ++line) {
    text += fmt::format("{:16}", line == 0 ? "case" : "");
    for (const auto& head : heads) text += fmt::format("{:>9}", head[line]);
    text += "\n";
  }
  for (std::size_t i = 0; i < outcome.cases.size(); ++i) {
    text += fmt::format("{:16}", outcome.cases[i].name);
    for (const std::string& column : table.columns) {
      std::string entry = cell(table, i, column);
      if (entry.starts_with("FAIL ")) entry.erase(4, 1);
      text += fmt::format("{:>9}", entry);
    }
    text.erase(text.find_last_not_of(' ') + 1);  // of columns in which this case was not tried
    text += "\n";
  }
  text += "\n" + summary(outcome);
  if (const std::string lines = failures(outcome); !lines.empty()) text += "\n" + lines;
  if (const std::string rows = recovery(outcome); !rows.empty())
    text += "\nRandom starts that recovered: least, mean, most over the solvers\n" + rows;
  return text;
}

std::string format_markdown(const Outcome& outcome) {
  const FactorWords words = all_factors(outcome.cases).words();
  std::string text = "# Hard cases\n\n" + summary(outcome) +
                     "\nFAIL n/m: n of m runs, over the solvers and Poisson's ratios that were tried.\n\n";
  text += markdown(outcome, pivot_by_column(outcome));
  text += "## The default integrator and solver, by Poisson's ratio\n\n" +
          markdown(outcome, pivot(outcome, by_ratio, words[4], is_default));
  text += "## By solver\n\n" + markdown(outcome, pivot(outcome, by_solver, words[3]));
  if (const std::string rows = recovery(outcome); !rows.empty())
    text +=
        "## Random starts that recovered\n\nOver the solvers.\n\n| configuration | least | mean | most |\n| --- | --- "
        "| --- | --- |\n" +
        rows + "\n";
  if (const std::string lines = failures(outcome); !lines.empty()) text += "## Failures\n\n" + lines + "\n";
  text += "## Cases\n\n| case | set-up | passes if |\n| --- | --- | --- |\n";
  for (const Case& c : outcome.cases) text += fmt::format("| {} | {} | {} |\n", c.name, c.set_up, c.criterion);
  return text;
}

std::string format_csv(const Outcome& outcome) {
  std::string text =
      "case,element,scalar,integrator,solver,poisson,passed,steps,unconverged,newton_unconverged,most_iterations,"
      "recovered,seconds,found\n";
  for (const Run& run : outcome.runs) {
    std::string column = by_column(run);
    std::replace(column.begin(), column.end(), ' ', ',');
    std::string found = run.verdict.text();
    std::replace(found.begin(), found.end(), '"', '\'');
    const StepCounts& counts = run.verdict.steps;
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{},{},{:.3f},\"{}\"\n", outcome.cases[run.of_case].name, column,
                    by_solver(run), by_ratio(run), run.verdict.passed() ? 1 : 0, counts.accepted, counts.unconverged,
                    counts.newton_unconverged, counts.max_iterations,
                    run.verdict.recovered < 0 ? "" : fmt::format("{:.3f}", run.verdict.recovered), run.seconds, found);
  }
  return text;
}

}  // namespace corotet::program::stress

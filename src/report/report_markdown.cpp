#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <corotet/detail/core/version.hpp>
#include <iterator>

#include "report_files.hpp"

namespace corotet::program {
namespace {

std::string percent(double value) { return std::isfinite(value) ? fmt::format("{:.3g} %", 100 * value) : "—"; }

class Page {
 public:
  template <class... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }
  [[nodiscard]] std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

/// What differs from the first row of the study, in words.
std::string choices(const StudyReport& report, const ReportRow& row) {
  std::string text;
  for (const Setting& setting : settings()) {
    const std::string name = setting.name;
    if (name == "order" || name == "dt" || name == "max_iterations") continue;
    if (setting.value(row.configuration) == setting.value(report.rows.front().configuration)) continue;
    text += (text.empty() ? "" : ", ") + name + " " + setting.value(row.configuration);
  }
  return text.empty() ? "as the scene" : text;
}

void add_rows(Page& page, const StudyReport& report, const std::vector<const ReportRow*>& rows) {
  page.add(
      "| mesh | elements | dt, s | settings | ms a step | ms a frame | in SpMV | error | space | time | arithmetic | "
      "energy | probe |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const ReportRow* row : rows) {
    const ErrorParts& e = row->errors;
    page.add("| {} | {} | {:.4g} | {} | {:.3g} | {:.3g} | {:.0f} | {} | {} | {} | {} | {} | {} |\n",
             mesh_name(report, row->configuration), row->run.facts.elements, row->configuration.scene.dt,
             choices(report, *row), row->run.step_ms, row->frame_ms, 1e3 * row->run.step_ms / row->spmv_us,
             percent(e.total.displacement), percent(e.space.displacement), percent(e.time.displacement),
             percent(e.arithmetic.displacement), percent(e.total.energy), percent(e.total.probe));
  }
  page.add("\n");
}

void add_study(Page& page, const StudyReport& report) {
  page.add(
      "## {}: {}\n\nErrors are against {}, whose own mesh is off by about {}. A frame is {:.4g} s of motion{}.\n\n",
      report.name, report.title, report.reference, percent(report.reference_error), report.frame_s,
      report.at_rest ? "; the body is at rest when errors are measured, and falls when steps are timed" : "");
  if (!report.notes.empty()) page.add("Note: {}.\n\n", report.notes);
  for (const NamedPlot& plot : make_plots(report)) page.add("![{0}]({0})\n", plot.file);

  page.add("\nOn the frontier:\n\n");
  std::vector<const ReportRow*> frontier;
  for (const ReportRow& row : report.rows)
    if (row.frontier) frontier.push_back(&row);
  std::sort(frontier.begin(), frontier.end(),
            [](const ReportRow* a, const ReportRow* b) { return a->frame_ms < b->frame_ms; });
  add_rows(page, report, frontier);

  page.add(
      "Measured orders of convergence:\n\n| from → to | displacement | energy | probe |\n| --- | --- | --- | --- |\n");
  for (const MeasuredOrder& order : report.orders)
    page.add("| {} | {:.2f} | {:.2f} | {:.2f} |\n", order.what, order.displacement, order.energy, order.probe);
  page.add("\n");

  if (!report.checks.empty()) {
    page.add(
        "The reference against closed forms:\n\n| what | known from | known | reference | off by |\n| --- | --- | --- "
        "| --- | --- |\n");
    for (const ClosedFormCheck& check : report.checks)
      page.add("| {} | {} | {:.6g} | {:.6g} | {:+.2f} % |\n", check.what, check.source, check.expected, check.reference,
               100 * (check.reference / check.expected - 1));
    page.add("\n");
  }

  page.add("What the error is made of (displacement / energy / probe):\n\n| configuration |");
  for (const std::string& part : budget_parts()) page.add(" {} |", part);
  page.add(" together |\n| --- |");
  for (std::size_t i = 0; i <= budget_parts().size(); ++i) page.add(" --- |");
  page.add("\n");
  const auto all = [](const Errors& e) {
    return fmt::format("{} / {} / {}", percent(e.displacement), percent(e.energy), percent(e.probe));
  };
  for (const ErrorBudget& budget : report.budgets) {
    page.add("| {} |", budget.label);
    for (const BudgetPart& part : budget.parts) page.add(" {} |", all(part.errors));
    page.add(" {} |\n", all(budget.total));
  }

  bool any = false;
  for (const ReportRow& row : report.rows) {
    if (row.run.ok() && row.run.remarks.empty()) continue;
    if (!any) page.add("\nRuns that failed, or were not all they should be:\n\n");
    any = true;
    page.add("- {}, dt {:.4g} s, {}: {}{}\n", mesh_name(report, row.configuration), row.configuration.scene.dt,
             choices(report, row), row.run.ok() ? "" : row.run.status, row.run.remarks);
  }
  page.add("\n");
}

}  // namespace

std::string format_markdown(const std::vector<StudyReport>& reports, const std::string& command) {
  Page page;
  page.add("# Speed against error\n\nPrinted by `{}`, corotet {}.{}.{}. All rows with all columns: report.csv.\n\n",
           command, COROTET_VERSION_MAJOR, COROTET_VERSION_MINOR, COROTET_VERSION_PATCH);
  page.add(
      "Times are medians on one thread of this machine; *SpMV* is one product of the step's matrix in float with a "
      "vector, plain and\nunvectorised: compare times on different machines by their ratio to it. *Error* is that of "
      "the displacements in the norm of the\nmass, over all times together, relative to the displacements; *space*, "
      "*time* and *arithmetic* (tolerance, rotation, precision)\nare its parts, which add up as vectors. *Energy* is "
      "the "
      "error in the energy norm; *probe* that of the probes where and when it is\nlargest.\n\n");
  for (const StudyReport& report : reports) add_study(page, report);
  page.add("## Cost against size\n\n![cost.svg](cost.svg)\n");
  return std::move(page).text();
}

}  // namespace corotet::program

// `corotet report`: speed against error.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "../command.hpp"
#include "../failure.hpp"
#include "../output_folder.hpp"
#include "../progress.hpp"
#include "../run_input.hpp"
#include "cases.hpp"
#include "contact_report.hpp"
#include "report_files.hpp"
#include "run_study.hpp"
#include "time_budget.hpp"

namespace corotet::program {
namespace {

namespace fs = std::filesystem;

struct ReportOptions {
  std::string scene;
  std::string output;
  std::vector<std::string> cases;
  bool quick = false;
  bool contact = false;
  double minutes = 0;  // 0: 10, or 0.8 if quick
  int threads = 0;     // 0: as many as the machine has, 2 at most
};

/// Leaves only those of `all` that are named; all, if none is.
template <class Named>
void choose(std::vector<Named>& all, const std::vector<std::string>& wanted) {
  if (wanted.empty()) return;
  std::string known;
  for (const Named& each : all) known += (known.empty() ? "" : ", ") + each.name;
  for (const std::string& name : wanted)
    if (std::none_of(all.begin(), all.end(), [&](const Named& each) { return each.name == name; }))
      throw Failure(fmt::format("--case {}: there is no such case; there are: {}", name, known));
  std::erase_if(all,
                [&](const Named& each) { return std::find(wanted.begin(), wanted.end(), each.name) == wanted.end(); });
}

std::vector<Study> studies_of(const ReportOptions& options) {
  if (!options.scene.empty()) {
    const Scene scene = read_scene(options.scene);
    refuse_contact(scene, "report");
    const RunInput input = read_input(scene);
    for (const std::string& note : input.notes) fmt::print(stderr, "corotet: note: {}\n", note);
    return {study_of(scene, input, options.quick)};
  }
  std::vector<Study> studies = default_studies(options.quick);
  choose(studies, options.cases);
  return studies;
}

/// As it was typed.
std::string command_of(const ReportOptions& options) {
  std::string command = "corotet report";
  if (options.contact) command += " --contact";
  if (!options.scene.empty()) command += " " + options.scene;
  for (const std::string& name : options.cases) command += " --case " + name;
  command += " -o " + options.output;
  if (options.quick) command += " --quick";
  return command;
}

void write(const ReportOptions& options, const std::vector<StudyReport>& reports) {
  const fs::path folder = options.output;
  for (const StudyReport& report : reports)
    for (const NamedPlot& plot : make_plots(report)) require(write_file(folder / plot.file, plot.svg));
  const NamedPlot cost = make_cost_plot(reports);
  require(write_file(folder / cost.file, cost.svg));
  require(write_file(folder / "report.csv", format_csv(reports)));
  require(write_file(folder / "report.md", format_markdown(reports, command_of(options))));
}

int report_contact(const ReportOptions& options) {
  std::vector<ContactCase> cases = contact_cases();
  choose(cases, options.cases);
  make_folder(options.output);
  std::vector<ContactCaseReport> reports;
  {
    constexpr int parts = 1000;
    Progress progress(parts);
    for (std::size_t i = 0; i < cases.size(); ++i)
      reports.push_back({cases[i], run_contact_case(cases[i], options.quick, [&](double part) {
                           progress.show(static_cast<int>(parts * (double(i) + part) / double(cases.size())),
                                         cases[i].name);
                         })});
  }
  const fs::path folder = options.output;
  for (const ContactCaseReport& each : reports) {
    if (const std::string svg = plot_contact(each); !svg.empty()) require(write_file(folder / plot_name(each), svg));
    const auto failed =
        std::count_if(each.rows.begin(), each.rows.end(), [](const ContactRow& row) { return row.status != "ok"; });
    fmt::print("{}: {} runs, {} failed\n", each.of.name, each.rows.size(), failed);
  }
  require(write_file(folder / "contact.csv", format_contact_csv(reports)));
  require(write_file(folder / "contact.md", format_contact_markdown(reports, command_of(options))));
  fmt::print("the page is {}\n", (folder / "contact.md").string());
  return 0;
}

int report(const ReportOptions& options) {
  if (options.contact) return report_contact(options);
  const std::vector<Study> studies = studies_of(options);
  make_folder(options.output);  // not before now: a scene that cannot run leaves nothing behind
  const int machine = std::max(1, std::min(2, static_cast<int>(std::thread::hardware_concurrency())));
  ThreadPool threads(options.threads > 0 ? options.threads : machine);
  double seconds = 60 * (options.minutes > 0 ? options.minutes
                         : options.quick     ? 0.8
                                             : 10);  // the last run may end later
  const TimeBudget whole(seconds);
  std::vector<StudyReport> reports;
  constexpr int parts = 1000;
  {
    Progress progress(parts);
    for (std::size_t s = 0; s < studies.size(); ++s) {
      TimeBudget share(whole.left() / double(studies.size() - s));
      reports.push_back(run_study(studies[s], threads, share, [&](const std::string& what, double part) {
        progress.show(static_cast<int>(parts * (double(s) + part) / double(studies.size())), what);
      }));
    }
  }
  write(options, reports);
  for (const StudyReport& study : reports) {
    const auto count = [&](auto&& condition) { return std::count_if(study.rows.begin(), study.rows.end(), condition); };
    fmt::print("{}: {} runs, {} failed, {} left out, {} on the frontier\n", study.name, study.rows.size(),
               count([](const ReportRow& r) { return !r.run.ok() && !r.run.status.starts_with("left out"); }),
               count([](const ReportRow& r) { return r.run.status.starts_with("left out"); }),
               count([](const ReportRow& r) { return r.frontier; }));
  }
  fmt::print("the page is {}\n", (fs::path(options.output) / "report.md").string());
  return 0;
}

}  // namespace

Command add_report_command(CLI::App& app) {
  auto options = std::make_shared<ReportOptions>();
  CLI::App* syntax = app.add_subcommand("report", "Measure speed against error, in tables and plots");
  auto* scene =
      syntax->add_option("scene", options->scene, "The scene to study; without one, the program's own cases are");
  syntax
      ->add_option("-o,--output", options->output,
                   "Folder for report.md, report.csv and the plots; made if it is not there")
      ->required();
  syntax->add_option("--case", options->cases, "Only this one of the program's own cases; may be repeated")
      ->excludes(scene);
  syntax
      ->add_flag("--contact", options->contact,
                 "The program's own cases of contact, against closed forms: contact.md and contact.csv")
      ->excludes(scene);
  syntax->add_flag("--quick", options->quick, "Fewer and coarser meshes, within a minute");
  syntax
      ->add_option("--minutes", options->minutes,
                   "How long it may take, > 0 (10; with --quick 0.8); what would take longer is left out, and said so")
      ->check(CLI::PositiveNumber);
  syntax->add_option("--threads", options->threads, "For the references, >= 1 (2); times are of one thread")
      ->check(CLI::Range(1, 1024));
  syntax->footer(
      "Each row of the report is a run: a mesh, a time step, a solver and so on, with its time and its error against\n"
      "the library's own run at the tightest settings. A run that fails is a row that says so.\n\n"
      "Examples:\n"
      "  corotet report -o report --quick\n"
      "  corotet report scene.json -o report\n"
      "  corotet report --case swing --case block -o report\n"
      "  corotet report --contact --case bar -o report");
  return {syntax, [options] { return report(*options); }};
}

}  // namespace corotet::program

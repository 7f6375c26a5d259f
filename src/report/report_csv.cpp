#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "report_files.hpp"

namespace corotet::program {
namespace {

/// Quoted where the text holds what CSV cares for (RFC 4180).
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + "\"";
}

/// Empty for what is not known.
std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : ""; }

struct Column {
  const char* name;
  std::string (*value)(const StudyReport&, const ReportRow&);
};

template <Errors ErrorParts::*part, double Errors::*measure>
std::string error(const StudyReport&, const ReportRow& row) {
  return number(row.errors.*part.*measure);
}

const Column columns[] = {
    {"case", [](const StudyReport& s, const ReportRow&) { return s.name; }},
    {"role", [](const StudyReport&, const ReportRow& r) { return r.role; }},
    {"status", [](const StudyReport&, const ReportRow& r) { return r.run.status; }},
    {"remarks", [](const StudyReport&, const ReportRow& r) { return r.run.remarks; }},
    {"mesh", [](const StudyReport& s, const ReportRow& r) { return s.level_names[at(r.configuration.level)]; }},
    {"h_m", [](const StudyReport& s, const ReportRow& r) { return number(s.level_sizes[at(r.configuration.level)]); }},
    {"elements", [](const StudyReport&, const ReportRow& r) { return fmt::format("{}", r.run.facts.elements); }},
    {"vertices", [](const StudyReport&, const ReportRow& r) { return fmt::format("{}", r.run.facts.vertices); }},
    {"used_solver",
     [](const StudyReport&, const ReportRow& r) {
       return r.run.facts.preconditioner.empty() ? r.run.facts.solver : r.run.facts.preconditioner;
     }},
    {"steps", [](const StudyReport&, const ReportRow& r) { return fmt::format("{}", r.run.steps); }},
    {"iterations", [](const StudyReport&, const ReportRow& r) { return number(r.run.iterations); }},
    {"setup_ms", [](const StudyReport&, const ReportRow& r) { return number(r.run.setup_ms); }},
    {"step_ms", [](const StudyReport&, const ReportRow& r) { return number(r.run.step_ms); }},
    {"frame_ms", [](const StudyReport&, const ReportRow& r) { return number(r.frame_ms); }},
    {"spmv_us", [](const StudyReport&, const ReportRow& r) { return number(r.spmv_us); }},
    {"step_spmv", [](const StudyReport&, const ReportRow& r) { return number(1e3 * r.run.step_ms / r.spmv_us); }},
    {"error", error<&ErrorParts::total, &Errors::displacement>},
    {"error_energy", error<&ErrorParts::total, &Errors::energy>},
    {"error_probe", error<&ErrorParts::total, &Errors::probe>},
    {"space", error<&ErrorParts::space, &Errors::displacement>},
    {"space_energy", error<&ErrorParts::space, &Errors::energy>},
    {"space_probe", error<&ErrorParts::space, &Errors::probe>},
    {"time", error<&ErrorParts::time, &Errors::displacement>},
    {"time_energy", error<&ErrorParts::time, &Errors::energy>},
    {"time_probe", error<&ErrorParts::time, &Errors::probe>},
    {"arithmetic", error<&ErrorParts::arithmetic, &Errors::displacement>},
    {"arithmetic_energy", error<&ErrorParts::arithmetic, &Errors::energy>},
    {"arithmetic_probe", error<&ErrorParts::arithmetic, &Errors::probe>},
    {"closed_form_error",
     [](const StudyReport&, const ReportRow& r) {
       return r.closed_form_errors.empty() ? "" : number(r.closed_form_errors.front());
     }},
    {"frontier", [](const StudyReport&, const ReportRow& r) -> std::string { return r.frontier ? "1" : "0"; }},
};

}  // namespace

std::string format_csv(const std::vector<StudyReport>& reports) {
  std::string text;
  for (const Column& column : columns) text.append(text.empty() ? "" : ",").append(column.name);
  for (const Setting& setting : settings()) text.append(",").append(setting.name);
  text += "\n";
  for (const StudyReport& report : reports)
    for (const ReportRow& row : report.rows) {
      std::string line;
      for (const Column& column : columns)
        line.append(&column == columns ? "" : ",").append(quoted(column.value(report, row)));
      for (const Setting& setting : settings()) line.append(",").append(quoted(setting.value(row.configuration)));
      text += line + "\n";
    }
  return text;
}

}  // namespace corotet::program

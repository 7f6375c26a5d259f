#include "check_report.hpp"

#include <fmt/format.h>

#include <array>
#include <corotet/detail/mesh/boundary.hpp>
#include <corotet/detail/mesh/io/read_mesh.hpp>
#include <corotet/detail/mesh/tet_mesh.hpp>
#include <iterator>
#include <utility>

#include "failure.hpp"
#include "local_origin.hpp"

namespace corotet::program {
namespace {

/// Why TetMesh::create refuses the mesh, or "".
template <class Scalar, class Element>
std::string refusal_of(const MeshData& mesh, Index& flipped) {
  const auto checked = TetMesh<Scalar, Element>::create(mesh, local_origin<Scalar>(mesh));
  if (checked) flipped = checked->flipped_elements();
  return checked ? "" : checked.error().message();
}

struct Measure {
  const char* key;
  const char* title;
  Spread MeshQuality::*spread;
};

constexpr std::array<Measure, 7> measures{{
    {"volume", "volume (m^3)", &MeshQuality::volume},
    {"shape", "shape (1: regular, 0: flat)", &MeshQuality::shape},
    {"min_dihedral", "least dihedral angle (deg)", &MeshQuality::min_dihedral},
    {"max_dihedral", "greatest dihedral angle (deg)", &MeshQuality::max_dihedral},
    {"radius_ratio", "3 inradius/circumradius", &MeshQuality::radius_ratio},
    {"edge_ratio", "longest/shortest edge", &MeshQuality::edge_ratio},
    {"jacobian_ratio", "least/mean Jacobian", &MeshQuality::jacobian_ratio},
}};

Json to_json(const Vec3<double>& v) { return Json::array({v[0], v[1], v[2]}); }

}  // namespace

CheckReport check_mesh(const std::string& file, Index worst_count) {
  CheckReport report;
  report.file = file;
  report.mesh = require(read_mesh(file));
  report.quality = require(measure_quality(report.mesh));
  report.worst = worst_elements(report.quality, worst_count);
  for (const ElementQuality& element : report.quality.elements)
    if (const ElementDefect defect = classify(element); defect != ElementDefect::none) ++report.defects[defect];
  const bool quadratic = report.mesh.nodes_per_element == 10;
  Index& flipped = report.flipped_elements;
  report.float_refusal =
      quadratic ? refusal_of<float, Tet10>(report.mesh, flipped) : refusal_of<float, Tet4>(report.mesh, flipped);
  report.error =
      quadratic ? refusal_of<double, Tet10>(report.mesh, flipped) : refusal_of<double, Tet4>(report.mesh, flipped);
  if (const auto boundary = extract_boundary(report.mesh); !boundary) report.overlap = boundary.error().message();
  return report;
}

std::string format_text(const CheckReport& report) {
  std::string text;
  const auto say = [&]<class... Values>(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
    text += '\n';
  };
  const auto [least, most] = Bounds::of(report.mesh);
  say("{}", report.file);
  say("  {} vertices, {} elements of {} nodes, volume {:.6g} m^3", report.mesh.vertex_count(),
      report.mesh.element_count(), report.mesh.nodes_per_element, report.quality.total_volume);
  say("  from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}) m", least[0], least[1], least[2], most[0], most[1],
      most[2]);
  for (const std::string& note : report.mesh.notes) say("  note: {}", note);
  if (report.flipped_elements > 0)
    say("  {} elements are wound the other way round; they are turned when the mesh is used", report.flipped_elements);

  say("\n  {:30}{:>11}{:>11}{:>11}{:>11}{:>11}", "quality", "least", "5 %", "median", "95 %", "greatest");
  for (const Measure& measure : measures) {
    if (report.mesh.nodes_per_element == 4 && std::string_view(measure.key) == "jacobian_ratio") continue;
    const Spread& s = report.quality.*measure.spread;
    say("  {:30}{:>11.4g}{:>11.4g}{:>11.4g}{:>11.4g}{:>11.4g}", measure.title, s.least, s.percentile5, s.median,
        s.percentile95, s.most);
  }
  say("");
  if (report.defects.empty()) say("  no element is badly shaped");
  for (const auto& [defect, count] : report.defects) say("  {:7} x {}", count, describe(defect));
  if (!report.defects.empty()) say("  the worst elements:");
  for (const WorstElement& worst : report.worst) {
    if (worst.defect == ElementDefect::none) continue;
    say("    element {:<8} shape {:<9.3g} angles {:.3g} to {:.3g} deg  {}", worst.element, worst.quality.shape,
        worst.quality.min_dihedral, worst.quality.max_dihedral, describe(worst.defect));
  }
  if (!report.overlap.empty()) say("\n  warning: {}", report.overlap);
  if (report.usable() && !report.float_refusal.empty())
    say("\n  warning: in float it cannot be used: {}; a scene needs \"scalar\": \"double\"", report.float_refusal);
  say("\n  {}", report.usable() ? "usable" : "not usable: " + report.error);
  return text;
}

Json to_json(const CheckReport& report) {
  const auto [least, most] = Bounds::of(report.mesh);
  Json json;
  json["file"] = report.file;
  json["usable"] = report.usable();
  if (!report.usable()) json["reason"] = report.error;
  json["usable_in_float"] = report.float_refusal.empty();
  if (!report.float_refusal.empty()) json["reason_in_float"] = report.float_refusal;
  json["vertices"] = report.mesh.vertex_count();
  json["elements"] = report.mesh.element_count();
  json["nodes_per_element"] = report.mesh.nodes_per_element;
  json["flipped_elements"] = report.flipped_elements;
  json["box"] = {to_json(least), to_json(most)};
  json["total_volume"] = report.quality.total_volume;
  json["notes"] = report.mesh.notes;
  if (!report.overlap.empty()) json["overlap"] = report.overlap;
  for (const Measure& measure : measures) {
    const Spread& s = report.quality.*measure.spread;
    json["quality"][measure.key] = {{"least", s.least},
                                    {"percentile5", s.percentile5},
                                    {"median", s.median},
                                    {"percentile95", s.percentile95},
                                    {"most", s.most}};
  }
  json["dihedral_histogram"] = report.quality.dihedral_histogram;
  json["defects"] = Json::object();
  for (const auto& [defect, count] : report.defects) json["defects"][name_of(defect)] = count;
  json["worst"] = Json::array();
  for (const WorstElement& worst : report.worst) {
    json["worst"].push_back({{"element", worst.element},
                             {"defect", name_of(worst.defect)},
                             {"reason", describe(worst.defect)},
                             {"shape", worst.quality.shape},
                             {"volume", worst.quality.volume},
                             {"min_dihedral", worst.quality.min_dihedral},
                             {"max_dihedral", worst.quality.max_dihedral},
                             {"radius_ratio", worst.quality.radius_ratio},
                             {"edge_ratio", worst.quality.edge_ratio},
                             {"jacobian_ratio", worst.quality.jacobian_ratio}});
  }
  return json;
}

}  // namespace corotet::program

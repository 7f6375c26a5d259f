// How well one tetrahedron is shaped, and what is wrong with it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <corotet/detail/core/elementary.hpp>
#include <corotet/detail/core/exactly.hpp>
#include <corotet/detail/core/square_root.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/element/jacobian.hpp>
#include <corotet/detail/element/reference_element.hpp>
#include <corotet/detail/element/tet10.hpp>
#include <corotet/detail/element/tet4.hpp>
#include <limits>
#include <numbers>

namespace corotet::inline v0_1 {

/// Measures of one element. All but `volume` are free of units and unchanged by rotation, scaling and node numbering.
struct ElementQuality {
  /// Signed, m^3. For Tet10 that of the curved element; everything below but `jacobian_ratio` is of its corners.
  double volume = 0;

  /// V/(sum of A^2)^(3/4) over the four face areas A, scaled so that 1 is the regular tetrahedron, the best there is; 0
  /// is flat, negative inverted. Of the usual measures at equal volume it predicts the largest eigenvalue of the
  /// element's stiffness best, because the matrix's trace is (lambda + 4 mu) (sum of A^2)/(9 V). Angles miss needles.
  double shape = 0;

  /// Angles between faces at `tet_edges`, degrees, 0 to 180; 70.53 in a regular tetrahedron. Where two faces are
  /// parallel to rounding 0 or 180; where a face has no area 0.
  std::array<double, 6> dihedrals{};
  double min_dihedral = 0;  ///< smallest angle between two faces, degrees
  double max_dihedral = 0;  ///< largest angle between two faces, degrees

  /// 3 x inradius/circumradius: 1 for the regular tetrahedron, 0 for a flat one. Never negative.
  double radius_ratio = 0;

  /// Longest by shortest edge, >= 1; infinite if two corners coincide.
  double edge_ratio = 1;

  /// Least Jacobian determinant at the quadrature points by its mean: 1 with straight edges and evenly placed mid-edge
  /// nodes, always 1 for Tet4; 0 or less: the element folds over itself.
  double jacobian_ratio = 1;
};

/// What makes an element bad. Names after Cheng, Dey, Edelsbrunner, Facello and Teng, "Sliver exudation" (2000).
enum class ElementDefect {
  none,      ///< well shaped
  inverted,  ///< negative volume
  flat,      ///< no volume to rounding, or thin in a way that has no name below
  curved,    ///< Tet10: its edges bend so far that the Jacobian changes more than the shape would explain
  sliver,    ///< four corners around a circle: two opposite dihedral angles near 180 degrees, the others small
  cap,       ///< a corner near the middle of the opposite face: its three dihedral angles near 180 degrees
  wedge,     ///< two corners close together, and a small dihedral angle at the edge opposite to them
  needle     ///< one face far smaller than the others, though no dihedral angle is small
};

namespace detail {

/// 6 sqrt 2 (3/4)^(3/4): a regular tetrahedron of edge 1 has volume sqrt 2/12 and faces of area sqrt 3/4.
inline constexpr double regular_shape = 6 * std::numbers::sqrt2 * 0.8059274488676564;

/// Degrees. Below and above: small and large dihedral angles. A square sliver with a dihedral of 30 has others of 137,
/// a regular cap with 30 has 129.
inline constexpr double small_dihedral = 30, large_dihedral = 120;

/// Beyond it one edge is short; the tetrahedra of a cubic grid stay below 1.8.
inline constexpr double long_edge_ratio = 3;

/// Volume and mean and least Jacobian of an element whose nodes lie at `x`.
template <TetrahedralElement Element>
void measure_jacobian(const std::array<Vec3<double>, Element::nodes>& x, double& volume, double& ratio) {
  double least = std::numeric_limits<double>::infinity();
  volume = 0;
  const auto visit = [&](const auto& points, bool integrate) {
    for (const QuadraturePoint& point : points) {
      const double det = jacobian(Element::gradient(point.xi), x).determinant();
      least = (std::min)(least, det);
      if (integrate) volume += point.weight * det;
    }
  };
  visit(Element::mass_points, true);  // the determinant is cubic at most: exact
  visit(Element::stiffness_points, false);
  ratio = volume > 0 ? least / (6 * volume) : 0;
}

}  // namespace detail

/// Measures an element whose nodes lie at `x`, m. Coordinates must be finite, of magnitude 1e100 at most.
template <TetrahedralElement Element>
[[nodiscard]] ElementQuality measure_element(std::array<Vec3<double>, Element::nodes> x) {
  ElementQuality quality;
  double longest = 0, shortest = std::numeric_limits<double>::infinity();
  for (const auto& [a, b] : tet_edges) {
    const double length = (x[b] - x[a]).stableNorm();
    longest = (std::max)(longest, length);
    shortest = (std::min)(shortest, length);
  }
  if (!(longest > 0)) {  // all corners in one point
    quality.edge_ratio = std::numeric_limits<double>::infinity();
    quality.jacobian_ratio = has_constant_gradients<Element> ? 1 : 0;
    return quality;
  }
  quality.edge_ratio = longest / shortest;

  // Measured at size 1 and at the origin, so that no power of a length over- or underflows.
  const Vec3<double> origin = x[0];
  for (Vec3<double>& p : x) p = (p - origin) / longest;
  const Vec3<double>&a = x[1], &b = x[2], &c = x[3];
  double six_volumes = a.cross(b).dot(c);
  const double sign = six_volumes < 0 ? -1 : 1;

  std::array<Vec3<double>, 4> normals;  // twice the area, outwards if the element is not inverted
  double squared_areas = 0, areas = 0;
  for (std::size_t f = 0; f < 4; ++f) {
    const auto& [i, j, k] = tet_faces[f];
    normals[f] = (x[j] - x[i]).cross(x[k] - x[i]);
    squared_areas += normals[f].squaredNorm() / 4;
    areas += normals[f].norm() / 2;
  }
  const double area = detail::square_root(squared_areas);
  if (area > 0) quality.shape = detail::regular_shape * six_volumes / 6 / (area * detail::square_root(area));

  constexpr double degrees = 180 / std::numbers::pi;
  for (std::size_t e = 0; e < 6; ++e) {
    // Edge e lies in the two faces opposite the corners that are not its own. Their normals' cross product is the edge
    // times six volumes, which keeps angles near 0 and 180 degrees exact.
    const auto [p, q] = tet_edges[e];
    std::array<std::size_t, 2> faces{};
    for (std::size_t f = 0, n = 0; f < 4; ++f)
      if (f != p && f != q) faces[n++] = f;
    const Vec3<double>&m = normals[faces[0]], &n = normals[faces[1]];
    if (m.squaredNorm() > 0 && n.squaredNorm() > 0)
      quality.dihedrals[e] = degrees * detail::arc_tangent(std::fabs(six_volumes) * (x[q] - x[p]).norm(), -m.dot(n));
  }
  quality.min_dihedral = *std::min_element(quality.dihedrals.begin(), quality.dihedrals.end());
  quality.max_dihedral = *std::max_element(quality.dihedrals.begin(), quality.dihedrals.end());

  // r = 3V/(sum of A), R = |a^2 b x c + b^2 c x a + c^2 a x b|/(12 V).
  const double circum =
      (a.squaredNorm() * b.cross(c) + b.squaredNorm() * c.cross(a) + c.squaredNorm() * a.cross(b)).norm();
  if (!detail::is_zero(six_volumes) && circum > 0)
    quality.radius_ratio = 3 * six_volumes * six_volumes / (areas * circum);

  double scaled_volume = six_volumes / 6;
  if constexpr (!has_constant_gradients<Element>) {
    if (sign < 0)  // an element turned round is as curved as before
      for (Vec3<double>& p : x) p[0] = -p[0];
    detail::measure_jacobian<Element>(x, scaled_volume, quality.jacobian_ratio);
    scaled_volume *= sign;
  }
  quality.volume = scaled_volume * longest * longest * longest;
  return quality;
}

/// What is most wrong with an element, from its measures; `none` if its angles lie within 30 and 120 degrees and its
/// edges within a factor of 3.
[[nodiscard]] inline ElementDefect classify(const ElementQuality& quality) {
  if (quality.shape < -1e-10) return ElementDefect::inverted;
  if (quality.shape < 1e-10) return ElementDefect::flat;
  if (quality.jacobian_ratio < (std::min)(quality.shape, 0.5)) return ElementDefect::curved;

  int large_count = 0, small_count = 0;
  std::array<int, 4> large_at_corner{};
  for (std::size_t e = 0; e < 6; ++e) {
    if (quality.dihedrals[e] < detail::small_dihedral) ++small_count;
    if (quality.dihedrals[e] <= detail::large_dihedral) continue;
    ++large_count;
    ++large_at_corner[tet_edges[e].a];
    ++large_at_corner[tet_edges[e].b];
  }
  const int max_at_corner = *std::max_element(large_at_corner.begin(), large_at_corner.end());
  if (large_count == 3 && max_at_corner == 3) return ElementDefect::cap;
  if (large_count == 2 && max_at_corner == 1) return ElementDefect::sliver;
  if (large_count > 0) return ElementDefect::flat;
  if (small_count > 0) return quality.edge_ratio > detail::long_edge_ratio ? ElementDefect::wedge : ElementDefect::flat;
  return quality.edge_ratio > detail::long_edge_ratio ? ElementDefect::needle : ElementDefect::none;
}

/// As in messages.
[[nodiscard]] constexpr const char* name_of(ElementDefect defect) {
  switch (defect) {
    case ElementDefect::none:
      return "none";
    case ElementDefect::inverted:
      return "inverted";
    case ElementDefect::flat:
      return "flat";
    case ElementDefect::curved:
      return "curved";
    case ElementDefect::sliver:
      return "sliver";
    case ElementDefect::cap:
      return "cap";
    case ElementDefect::wedge:
      return "wedge";
    case ElementDefect::needle:
      return "needle";
  }
  return "unknown";
}

/// A defect in a few words, for people.
[[nodiscard]] constexpr const char* describe(ElementDefect defect) {
  switch (defect) {
    case ElementDefect::none:
      return "no defect: its angles and edges are within bounds";
    case ElementDefect::inverted:
      return "inverted: its volume is negative";
    case ElementDefect::flat:
      return "flat: thin, with dihedral angles far from 70 degrees";
    case ElementDefect::curved:
      return "curved: its mid-edge nodes distort it";
    case ElementDefect::sliver:
      return "sliver: its corners lie almost on a circle";
    case ElementDefect::cap:
      return "cap: a corner lies almost on the opposite face";
    case ElementDefect::wedge:
      return "wedge: two corners lie close together and an angle is small";
    case ElementDefect::needle:
      return "needle: one face is far smaller than the others";
  }
  return "unknown";
}

}  // namespace corotet::inline v0_1

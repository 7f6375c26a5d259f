// Linear elastic material: what a user knows about it, and what the equations need.
#pragma once

#include <cmath>
#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/message.hpp>
#include <corotet/detail/core/result.hpp>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace corotet::inline v0_1 {

/// An isotropic elastic solid, by Young's modulus, Poisson's ratio and density. Rubber: 1e6 Pa, 0.49, 1100 kg/m^3.
///
/// Use one for a whole body, and Materials for one an element. As Poisson's ratio nears 0.5 choose
/// BodyOptions::dilatation.
struct Material {
  double young = 1e6;     ///< Young's modulus E, Pa, > 0 (rubber 1e6 ... 1e8, flesh 1e3 ... 1e5)
  double poisson = 0.3;   ///< Poisson's ratio nu, -1 < nu < 0.5 (rubber near 0.5, cork near 0)
  double density = 1000;  ///< kg/m^3, > 0
};

/// Lamé's parameters, Pa.
struct Lame {
  /// Pa
  double lambda;
  double mu;  ///< shear modulus, Pa
};

/// lambda = E nu / ((1+nu)(1-2nu)), mu = E / (2(1+nu)). The material must be valid: see `validate`.
[[nodiscard]] inline Lame lame(const Material& m) {
  return {m.young * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson)), m.young / (2 * (1 + m.poisson))};
}

namespace detail {

/// As `validate`, and for Lamé parameters and a density beyond `largest`, or below `least`, the smallest normal number:
/// there digits are lost, and then all, which is a body without mass or stiffness.
[[nodiscard]] COROTET_COLD inline Result<void> check_material(const Material& m, std::string_view where, double largest,
                                                              double least) {
  const auto refuse = [&](const char* name, double value, const char* range) {
    return error(ErrorCode::invalid_argument, {where, ".", name}, {"must be ", range, ", is ", value});
  };
  if (!std::isfinite(m.young) || m.young <= 0) return refuse("young", m.young, "positive and finite (Pa)");
  if (!std::isfinite(m.poisson) || m.poisson <= -1 || m.poisson >= 0.5)
    return refuse("poisson", m.poisson, "between -1 and 0.5, both excluded");
  if (!std::isfinite(m.density) || m.density <= 0) return refuse("density", m.density, "positive and finite (kg/m^3)");
  const auto [lambda, mu] = lame(m);
  for (const double parameter : {lambda, mu, m.density})
    if (std::fabs(parameter) > largest)
      return error(ErrorCode::invalid_argument, {where}, {parameter, " is too large for this precision"});
  const bool is_soft = m.young < least;
  if (is_soft || m.density < least)
    return error(ErrorCode::invalid_argument, {where, is_soft ? ".young" : ".density"},
                 {is_soft ? m.young : m.density, " is too small for this precision"});
  return {};
}

}  // namespace detail

/// invalid_argument, naming `where` and the parameter, if one lies outside its range or is not finite.
[[nodiscard]] inline Result<void> validate(const Material& m, const std::string& where = "material") {
  return detail::check_material(m, where, std::numeric_limits<double>::infinity(), 0);
}

/// The material of each element: one for the whole body, or one an element.
///
/// A Material and a vector of them convert to it, so that callers rarely name it.
/// @snippet bodies.cpp materials
class Materials {
 public:
  /// One material for all elements.
  Materials(const Material& whole_body) : materials_{whole_body} {}  // NOLINT(google-explicit-constructor)
  /// One for each element.
  Materials(std::vector<Material> per_element)  // NOLINT(google-explicit-constructor)
      : materials_(std::move(per_element)) {}

  /// The material of element `e`.
  [[nodiscard]] const Material& of_element(std::size_t e) const {
    return materials_.size() == 1 ? materials_.front() : materials_[e];
  }

  /// invalid_argument if there is neither one material nor one for each of `elements`, or if one of them is invalid, or
  /// its Lamé parameters or its density lie outside the range of Scalar.
  template <std::floating_point Scalar>
  [[nodiscard]] Result<void> validate(std::size_t elements) const {
    return validate(elements, static_cast<double>((std::numeric_limits<Scalar>::max)()),
                    static_cast<double>((std::numeric_limits<Scalar>::min)()));
  }

 private:
  [[nodiscard]] COROTET_COLD Result<void> validate(std::size_t elements, double largest, double least) const {
    if (materials_.size() != 1 && materials_.size() != elements)
      return detail::error(
          ErrorCode::invalid_argument, {"materials"},
          {"there are ", materials_.size(), " for ", elements, " elements; give one for all, or one for each"});
    for (std::size_t e = 0; e < materials_.size(); ++e)
      if (Result<void> s = detail::check_material(materials_[e], "material", largest, least); !s)
        return materials_.size() == 1
                   ? s
                   : detail::check_material(materials_[e], detail::message({"material of element ", e}), largest,
                                            least);
    return {};
  }

  std::vector<Material> materials_;
};

}  // namespace corotet::inline v0_1

// The ways to run a body that the hard cases are tried with.
#pragma once

#include <array>
#include <corotet/detail/assembly/mean_dilatation.hpp>
#include <corotet/detail/assembly/twist_modes.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/solve/auto_solver.hpp>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "../scene.hpp"
#include "pairwise.hpp"

namespace corotet::program::stress {

enum class Stepping {
  euler,   ///< backward Euler, one linear solve: the library's default
  newton,  ///< the same, solved by Newton's method with the exact tangent
  bdf2     ///< second order, one linear solve
};

struct SolverChoice {
  std::string_view name;
  SolverMethod method;
  PreconditionerKind preconditioner;
};

struct Ratio {
  std::string_view name;  ///< "nu=.3"
  double poisson;
  VolumetricStrain volumetric_strain;
};

struct Configuration {
  int order = 1;  ///< 1: Tet4, 2: Tet10
  ScalarKind scalar = ScalarKind::single_precision;
  Stepping stepping = Stepping::euler;
  SolverChoice solver{"auto", SolverMethod::automatic, PreconditionerKind::automatic};
  Ratio ratio{"nu=.3", 0.3, VolumetricStrain::pointwise};
  std::optional<Tangent> tangent;  ///< instead of the stepping's own

  /// "tet4 float euler auto nu=.3"
  [[nodiscard]] std::string name() const;

  /// "tet4 float euler": the column of the table that it belongs to.
  [[nodiscard]] std::string column() const;

  [[nodiscard]] bool in_double() const { return scalar == ScalarKind::double_precision; }

  /// E = 5e5 Pa, 1000 kg/m^3, no gravity, no damping, h = 1/60 s; all else as in a scene that does not say.
  [[nodiscard]] Scene scene() const;

  /// The same for bodies that shall come to rest. Backward Euler needs nothing for that; the second order formula keeps
  /// slow motion, and is given the damping 10/s M.
  [[nodiscard]] Scene settling_scene() const;
};

/// What a case depends on.
enum class Solvers { all, iterative, two };  ///< iterative: all but Cholesky; two: auto and Cholesky, for long runs
enum class Ratios { all, three };            ///< three: 0.3 and .499 with and without mean dilatation

[[nodiscard]] std::vector<SolverChoice> solver_choices(Solvers which);
[[nodiscard]] std::vector<Ratio> ratios(Ratios which);

/// For each factor the words that name its values on the command line.
using FactorWords = std::array<std::vector<std::string>, 5>;

/// What configurations are made of: the values of each factor, the default first.
struct Factors {
  std::vector<int> orders{1, 2};
  std::vector<ScalarKind> scalars{ScalarKind::single_precision, ScalarKind::double_precision};
  std::vector<Stepping> steppings{Stepping::euler, Stepping::newton, Stepping::bdf2};
  std::vector<SolverChoice> solvers;
  std::vector<Ratio> ratios;

  [[nodiscard]] FactorWords words() const;
  /// How many values each factor has.
  [[nodiscard]] std::array<std::size_t, 5> levels() const;
  [[nodiscard]] Configuration configuration(const Choice& choice) const;

  /// Removes the values that `wanted` does not name, of each factor of which it names any.
  void keep(const FactorWords& wanted);
};

}  // namespace corotet::program::stress

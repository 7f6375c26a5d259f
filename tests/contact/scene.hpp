// A body among obstacles, whatever its scalar, element and integrator: tests of contact are not templates, and compile
// once.
#pragma once

#include <corotet/contact.hpp>
#include <corotet/detail/core/executor.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/body_model.hpp>
#include <corotet/detail/dynamics/step_report.hpp>
#include <corotet/detail/mesh/make_block.hpp>
#include <corotet/detail/mesh/mesh_data.hpp>
#include <corotet/material.hpp>
#include <corotet/sleep.hpp>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace corotet::contact_scene {

using V = Vec3<double>;
using Map = std::function<V(const V&)>;

/// How a body is computed. Of scalar, element and integrator there are four combinations, which have each pair.
enum class Kind { float_tet4_euler, float_tet10_bdf2, double_tet4_bdf2, double_tet10_euler };
struct Method {
  Kind kind = Kind::float_tet4_euler;
  bool newton = false;  ///< iterates, with the consistent tangent

  [[nodiscard]] bool is_float() const { return kind == Kind::float_tet4_euler || kind == Kind::float_tet10_bdf2; }
  [[nodiscard]] bool is_tet4() const { return kind == Kind::float_tet4_euler || kind == Kind::double_tet4_bdf2; }
  [[nodiscard]] bool is_bdf2() const { return kind == Kind::float_tet10_bdf2 || kind == Kind::double_tet4_bdf2; }
  /// Cells along an edge for as many vertices as `cells` have with Tet4.
  [[nodiscard]] Index cells(Index cells) const { return is_tet4() ? cells : (cells + 1) / 2; }
};

inline std::string name_of(const Method& m) {
  return std::string(m.is_float() ? "float" : "double") + (m.is_tet4() ? "Tet4" : "Tet10") +
         (m.is_bdf2() ? "Bdf2" : "Euler") + (m.newton ? "Newton" : "");
}
inline void PrintTo(const Method& m, std::ostream* out) { *out << name_of(m); }

inline constexpr Method euler{Kind::float_tet4_euler, false}, bdf2{Kind::double_tet4_bdf2, false};
/// All pairs of scalar, element, integrator, and one solve or Newton's method.
inline const auto all_methods =
    ::testing::Values(Method{Kind::float_tet4_euler, false}, Method{Kind::float_tet10_bdf2, true},
                      Method{Kind::double_tet4_bdf2, true}, Method{Kind::double_tet10_euler, false},
                      Method{Kind::float_tet10_bdf2, false}, Method{Kind::double_tet10_euler, true});
/// Parameter names of a suite.
inline constexpr auto by_name = [](const auto& info) { return name_of(info.param); };

/// A suite whose parameter is the method.
class ByMethod : public ::testing::TestWithParam<Method> {
 protected:
  [[nodiscard]] static const Method& method() { return GetParam(); }
};

inline constexpr double g = 9.81, frame_time = 1.0 / 60;

struct SceneOptions {
  BlockOptions block{};  ///< `order` is that of the method
  Map warp = {};         ///< where the block's corners go
  Material material{.young = 5e5, .poisson = 0.3, .density = 1000};
  BodyOptions body = {};
  ContactOptions contact{.friction = 0.5};
  double tolerance = 1e-3;             ///< of the linear solver
  V origin = V::Zero();                ///< of the mesh, to which scalars are relative
  Index skin = 0;                      ///< > 0: the points of contact are those of a grid of so many cells, embedded
  bool keeps_angular_momentum = true;  ///< see StepOptions
  /// More blocks, which do not touch the first.
  std::vector<BlockOptions> pieces = {};
};

/// A cube with edges of 0.4 m that stands on z = 0.
inline SceneOptions cube(const Method& method, Index cells, double young = 5e5) {
  SceneOptions options;
  options.block.size = V::Constant(0.4);
  options.block.cells = {method.cells(cells), method.cells(cells), method.cells(cells)};
  options.material.young = young;
  return options;
}

class Scene {
 public:
  Scene() = default;
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  virtual ~Scene() = default;

  Obstacles obstacles;

  /// A step of the body; then obstacles move.
  StepReport step(double h = frame_time, ExecutorRef executor = {}) {
    const StepReport report = step_body(h, executor);
    obstacles.advance(h);
    return report;
  }
  /// For so many seconds; all steps must be accepted.
  void run(double seconds, double h = frame_time) {
    const int steps = static_cast<int>(seconds / h + 0.5);
    for (int i = 0; i < steps; ++i) {
      const StepReport report = step(h);
      ASSERT_TRUE(report.accepted()) << "step " << i << ": " << report.advice();
    }
  }

  virtual StepReport step_body(double h, ExecutorRef executor) = 0;
  /// Whether the contacts are a term of the steps.
  bool has_contacts = true;
  /// Lets the body sleep, whose number it is given; copied with the scene.
  std::optional<Sleep> sleep;
  Index sleeper = 0;
  void let_sleep(const SleepOptions& options = {}) {
    sleep.emplace(obstacles, options);
    sleeper = sleep->add();
  }
  [[nodiscard]] bool is_asleep() const { return sleep && sleep->is_asleep(sleeper); }
  /// Coefficient against obstacles that have none of their own.
  double friction = 0;

  [[nodiscard]] virtual const ContactReport& report() const = 0;
  [[nodiscard]] virtual std::span<const Touch> touches() const = 0;
  [[nodiscard]] virtual const ContactPoints& points() const = 0;
  virtual void reset_contacts() = 0;
  /// Puts body, integrator, contacts and obstacles aside as copies, and goes on with copies of these.
  virtual void save() = 0;
  virtual void go_back() = 0;
  /// The numbers of the body's state.
  [[nodiscard]] virtual std::string bits() const = 0;

  [[nodiscard]] virtual Index vertex_count() const = 0;
  /// In the world.
  [[nodiscard]] virtual V rest(Index vertex) const = 0;
  [[nodiscard]] virtual V position(Index vertex) const = 0;
  [[nodiscard]] virtual V velocity(Index vertex) const = 0;
  [[nodiscard]] virtual double mass(Index vertex) const = 0;
  [[nodiscard]] virtual double elastic_energy() const = 0;

  /// Moves the vertex that rests at X to map(X).
  virtual void place(const Map& map) = 0;
  /// Gives a vertex at x the velocity map(x).
  virtual void throw_with(const Map& map) = 0;
  virtual void set_gravity(const V& gravity) = 0;
  /// Pins vertices by their places at rest.
  virtual Index pin_where(const std::function<bool(const V&)>& is_pinned) = 0;

  [[nodiscard]] double total_mass() const {
    return sum<double>([&](Index v) { return mass(v); });
  }
  [[nodiscard]] V centre() const {
    return sum<V>([&](Index v) { return V(mass(v) * position(v)); }) / total_mass();
  }
  [[nodiscard]] V mean_velocity() const {
    return sum<V>([&](Index v) { return V(mass(v) * velocity(v)); }) / total_mass();
  }
  [[nodiscard]] double kinetic_energy() const {
    return sum<double>([&](Index v) { return 0.5 * mass(v) * velocity(v).squaredNorm(); });
  }
  /// Kinetic, elastic, and of gravity along -z.
  [[nodiscard]] double mechanical_energy() const {
    return kinetic_energy() + elastic_energy() + total_mass() * g * centre().z();
  }
  /// About the origin of the world.
  [[nodiscard]] V angular_momentum() const {
    return sum<V>([&](Index v) { return V(mass(v) * position(v).cross(velocity(v))); });
  }
  [[nodiscard]] double fastest() const {
    double most = 0;
    for (Index v = 0; v < vertex_count(); ++v) most = std::max(most, velocity(v).norm());
    return most;
  }

 private:
  template <class T, class F>
  [[nodiscard]] T sum(const F& f) const {
    T all = f(0);
    for (Index v = 1; v < vertex_count(); ++v) all += f(v);
    return all;
  }
};

/// Defined in scene_test.cpp.
std::unique_ptr<Scene> make_scene(const Method& method, const SceneOptions& options);

/// A cube at rest on a floor, or above it, with gravity.
inline std::unique_ptr<Scene> on_floor(const Method& method, const SceneOptions& options) {
  auto scene = make_scene(method, options);
  scene->obstacles.add(HalfSpace{});
  scene->obstacles.gravity = {0, 0, -g};
  scene->set_gravity({0, 0, -g});
  return scene;
}

inline Map moved_by(const V& way) {
  return [way](const V& x) -> V { return x + way; };
}
inline Map constant(const V& value) {
  return [value](const V&) { return value; };
}

}  // namespace corotet::contact_scene

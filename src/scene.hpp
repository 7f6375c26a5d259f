// What `corotet run` simulates: the scene file as a struct, with its defaults. docs/scene.md describes the keys.
#pragma once

#include <corotet/detail/assembly/mass.hpp>
#include <corotet/detail/assembly/mean_dilatation.hpp>
#include <corotet/detail/core/types.hpp>
#include <corotet/detail/dynamics/step_options.hpp>
#include <corotet/detail/dynamics/substepping_integrator.hpp>
#include <corotet/detail/material/material.hpp>
#include <corotet/detail/solve/auto_solver.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "contact_scene.hpp"
#include "led_path.hpp"

namespace corotet::program {

enum class ScalarKind { single_precision, double_precision };
enum class RotationKind { identity, gram_schmidt, polar };
enum class RotationSite { point, element };
enum class IntegratorKind { implicit_euler, bdf2 };

/// As in a scene file.
[[nodiscard]] constexpr const char* name_of(IntegratorKind integrator) {
  return integrator == IntegratorKind::bdf2 ? "bdf2" : "implicit_euler";
}

/// Vertices whose rest position lies in a box (its faces included) are held, or led along a path.
struct PinBox {
  Vec3<double> least, most;     ///< m
  std::vector<PathPoint> path;  ///< times ascending; empty: held
};

/// Forces on the vertices whose rest position lies in a box, constant in time and in space: they do not turn along.
struct ForceBox {
  Vec3<double> least, most;                    ///< m
  Vec3<double> total = Vec3<double>::Zero();   ///< N, shared by the volume around each vertex
  Vec3<double> torque = Vec3<double>::Zero();  ///< N m, as forces across to the axis through their centre
};

/// A body, and what it shares with the scene's other bodies.
struct Scene {
  std::filesystem::path file;  ///< where it was read from
  std::string name;            ///< of one of several bodies; empty: the only one
  std::string key_prefix;      ///< what stands before the keys of the body in the file: "bodies[1]."

  // The body.
  std::filesystem::path mesh;
  int order = 0;  ///< 1 or 2; 0: the mesh file's
  ScalarKind scalar = ScalarKind::single_precision;
  Material material{5e5, 0.3, 1000};
  RayleighDamping damping;
  std::vector<PinBox> pins;
  std::vector<ForceBox> forces;
  MassModel mass = MassModel::lumped;
  VolumetricStrain volumetric_strain = VolumetricStrain::pointwise;
  RotationKind rotation = RotationKind::polar;
  RotationSite rotation_site = RotationSite::point;
  std::optional<std::filesystem::path> initial_positions, initial_velocities;
  std::optional<Vec3<double>> initial_velocity;          ///< of all vertices, m/s
  std::optional<Vec3<double>> initial_angular_velocity;  ///< about the centre of mass, rad/s
  std::optional<std::filesystem::path> surface;
  ContactScene contact;
  std::vector<Vec3<double>> probes;  ///< each names the vertex nearest to it at rest

  // The same for all bodies.
  Vec3<double> gravity{0, 0, -9.81};  ///< m/s^2
  IntegratorKind integrator = IntegratorKind::implicit_euler;
  double dt = 1.0 / 60;  ///< s
  StepOptions newton;
  OnUnreliable untrusted = OnUnreliable::accept;
  SolverOptions solver;
  std::vector<ObstacleEntry> obstacles;
  int steps = 60;
  int frames_every = 0;  ///< 0: no frames

  [[nodiscard]] bool touches_obstacles() const { return !obstacles.empty() && contact.points != TouchingPoints::none; }
};

/// Reads and checks a scene; an entry for each body, at least one. Throws a Failure that lists every problem by its
/// key: unknown keys, wrong types, values out of range, files that are not there. Paths come out relative to the
/// working directory.
[[nodiscard]] std::vector<Scene> read_scenes(const std::filesystem::path& path);

/// The same for commands that take one body: throws for a scene with the key "bodies", too.
[[nodiscard]] Scene read_scene(const std::filesystem::path& path);

/// Throws a Failure that names the keys of the scene's obstacles and attachments: `command` does not know them.
void refuse_contact(const Scene& scene, const char* command);

}  // namespace corotet::program

// States saved into bytes, and restored: the steps that follow are the same to the last bit.
#pragma once

#include <corotet/detail/core/compiler.hpp>
#include <corotet/detail/core/message.hpp>
#include <corotet/detail/core/result.hpp>
#include <corotet/detail/core/state_archive.hpp>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace corotet::inline v0_1 {

namespace detail {

/// What an integrator is where there is none.
struct NoIntegrator {
  template <class Body>
  void visit_state(StateArchive& /*archive*/, Body& /*body*/) {}
};

inline constexpr std::uint64_t snapshot_format = 0x31'70'61'6e'73'74'72'63;  // "crtsnap1", to be read in a file
inline constexpr std::size_t snapshot_ends_with = sizeof(std::uint64_t);     // the hash of what is before

/// The state of body and integrator, in any mode.
template <class Body, class Integrator>
COROTET_COLD void visit_snapshot(StateArchive& archive, Body& body, Integrator& integrator) {
  archive.expect(snapshot_format);
  archive.expect(sizeof(typename Body::scalar_type));
  archive.expect(body.model()->fingerprint());
  archive.expect(std::is_same_v<Integrator, NoIntegrator> ? 0 : 1);
  body.visit_state(archive);
  integrator.visit_state(archive, body);
}

}  // namespace detail

/// Bytes that a snapshot of a body and of the integrator that steps it has: the same as long as no vertex is pinned or
/// released.
template <class Body, class Integrator>
[[nodiscard]] COROTET_COLD std::size_t snapshot_size(const Body& body, const Integrator& integrator) {
  detail::StateArchive measure;
  detail::visit_snapshot(measure, const_cast<Body&>(body),
                         const_cast<Integrator&>(integrator));  // measuring only reads
  return measure.size() + detail::snapshot_ends_with;
}
/// Of a body alone.
template <class Body>
[[nodiscard]] COROTET_COLD std::size_t snapshot_size(const Body& body) {
  return snapshot_size(body, detail::NoIntegrator());
}

/// Saves the state of a body and its integrator as bytes, for rollback, replays and late joiners of a game.
///
/// To save a simulation across versions of the library write positions and velocities to a file instead.
/// @snippet steps.cpp snapshot
/// The bytes hold displacements, velocities, forces, gravity and pins of the body; of the integrator all that later
/// steps depend on (history, guesses, factors). The bytes mean the same on every platform; they are read by this
/// version of the library, for the same mesh, materials and options, by an integrator of the same type and options.
/// Errors: invalid_argument (fewer bytes than `snapshot_size`).
template <class Body, class Integrator>
COROTET_COLD Result<void> save_snapshot(const Body& body, const Integrator& integrator, std::span<std::byte> out) {
  detail::StateArchive archive(out);
  detail::visit_snapshot(archive, const_cast<Body&>(body), const_cast<Integrator&>(integrator));  // writing only reads
  archive.expect(archive.hash());
  if (!archive.ok())
    return detail::error(ErrorCode::invalid_argument, {"snapshot"},
                         {"it needs ", snapshot_size(body, integrator), " bytes, there are ", out.size()});
  return {};
}
/// Writes the snapshot of a body alone: as below, without an integrator.
template <class Body>
COROTET_COLD Result<void> save_snapshot(const Body& body, std::span<std::byte> out) {
  return save_snapshot(body, detail::NoIntegrator(), out);
}

/// Replaces the state of a body and of an integrator that was made for it or for a body of the same model: the same
/// calls then give the same bits as after `save_snapshot`. Errors: invalid_argument (not a snapshot of this kind,
/// damaged, or of another mesh, material or integrator); nothing changes then. May allocate.
template <class Body, class Integrator>
COROTET_COLD Result<void> restore_snapshot(std::span<const std::byte> in, Body& body, Integrator& integrator) {
  const auto wrong = [](const char* what) { return detail::error(ErrorCode::invalid_argument, "snapshot", what); };
  detail::StateArchive compare(in, detail::StateArchive::Mode::compare);
  detail::visit_snapshot(compare, body, integrator);
  if (!compare.ok()) return wrong("is of another body, integrator or version of the library, or cut off");
  compare.expect(compare.hash());
  if (!compare.ok() || compare.size() != in.size()) return wrong("is damaged");
  detail::StateArchive read(in, detail::StateArchive::Mode::read);
  detail::visit_snapshot(read, body, integrator);
  return {};
}
/// Of a body alone: an integrator takes its next step as after a change of state by the caller.
template <class Body>
COROTET_COLD Result<void> restore_snapshot(std::span<const std::byte> in, Body& body) {
  detail::NoIntegrator none;
  return restore_snapshot(in, body, none);
}

}  // namespace corotet::inline v0_1

// What a term of a body's steps tells of itself, so that the body may sleep with it.
#pragma once

#include <corotet/detail/contact/contact_options.hpp>
#include <corotet/detail/core/types.hpp>
#include <span>

namespace corotet::inline v0_1 {

class Obstacles;

/// A term between two steps: see StepTerm::describe_rest.
struct TermRest {
  const Obstacles* obstacles = nullptr;  ///< that it acts on; null: none
  std::span<const Touch> touches = {};   ///< forces between body and obstacles in the last step
  double force = 0;                      ///< sum of those that must be steady while the body comes to rest, N
  double force_change = 0;               ///< sum of their changes in the last step, N
  double margin = 0;                     ///< obstacles act from this distance on, m
  /// Whether anything that the force depends on, besides the body and its obstacles, is other than in the last step.
  bool has_changed = false;
};

}  // namespace corotet::inline v0_1

// What the caller chooses of contact, and what a step tells of it.
#pragma once

#include <corotet/detail/core/types.hpp>

namespace corotet::inline v0_1 {

/// How a body touches. No stiffness is among them: springs follow from the body's matrix.
struct ContactOptions {
  double friction = 0;               ///< coefficient >= 0 against obstacles that have none of their own
  double margin = 0;                 ///< distance that is kept from obstacles, m
  int passes = 30;                   ///< >= 1: linear solves in a step at most
  double max_depenetration = 1;      ///< speed at which points that start inside an obstacle are led out, m/s, > 0
  Index max_contacts_per_point = 4;  ///< in the mean over all points: memory for contacts
};

/// How contact was in the last step.
struct ContactReport {
  Index candidates = 0;     ///< points within reach, once for each obstacle
  Index touching = 0;       ///< with a force
  Index sliding = 0;        ///< of these
  int passes = 0;           ///< linear solves; of a body of several pieces, of the one that took most
  bool settled = true;      ///< none of the contacts would have changed in another pass
  double deepest = 0;       ///< of any point inside an obstacle at the end, m
  double normal_force = 0;  ///< sum of all, N
  double force_change = 0;  ///< sum of the changes of normal forces in the step, without signs, N
  Index dropped = 0;        ///< for which there was no memory: see ContactOptions::max_contacts_per_point
};

/// One contact of the last step, in the world.
struct Touch {
  Index point;           ///< of the ContactPoints
  Index obstacle;        ///< of the Obstacles
  Vec3<double> place;    ///< m, at the start of the step
  Vec3<double> normal;   ///< out of the obstacle
  Vec3<double> impulse;  ///< on the body, N s
  bool slides;           ///< it does not stick
};

}  // namespace corotet::inline v0_1

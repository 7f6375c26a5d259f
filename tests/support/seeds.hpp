// Trials with random input, again and again.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace corotet::testing {

/// Calls trial(seed) for the seeds 1 ... count until one fails, which the failure names; or for the seed alone that the
/// environment names in COROTET_TEST_SEED.
template <class Trial>
void for_seeds(unsigned count, const Trial& trial) {
  const char* const wanted = std::getenv("COROTET_TEST_SEED");
  const unsigned first = wanted == nullptr ? 1 : static_cast<unsigned>(std::strtoul(wanted, nullptr, 10));
  const unsigned last = wanted == nullptr ? count : first;
  for (unsigned seed = first; seed <= last; ++seed) {
    SCOPED_TRACE("to replay: COROTET_TEST_SEED=" + std::to_string(seed));
    trial(seed);
    if (::testing::Test::HasFailure()) return;
  }
}

}  // namespace corotet::testing

// The whole library but what is opt-in: <corotet/thread_pool.hpp>, <corotet/eigen.hpp>, <corotet/tbb.hpp> and
// <corotet/cholmod.hpp>. Faster to compile: those of the headers below that you need.
#pragma once

#include <corotet/detail/core/macros_off.hpp>

// Those headers of the standard library that the library uses: libstdc++ does not survive macros named min and max.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <charconv>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>
#include <version>

#include <corotet/detail/core/macros_on.hpp>

#include <corotet/attachment.hpp>
#include <corotet/contact.hpp>
#include <corotet/executor.hpp>
#include <corotet/integrators.hpp>
#include <corotet/io.hpp>
#include <corotet/material.hpp>
#include <corotet/matrices.hpp>
#include <corotet/measures.hpp>
#include <corotet/mesh.hpp>
#include <corotet/meshing.hpp>
#include <corotet/models.hpp>
#include <corotet/points.hpp>
#include <corotet/result.hpp>
#include <corotet/sleep.hpp>
#include <corotet/snapshot.hpp>
#include <corotet/soft_body.hpp>
#include <corotet/soft_contact.hpp>
#include <corotet/solvers.hpp>
#include <corotet/static_solve.hpp>
#include <corotet/surface.hpp>
#include <corotet/terms.hpp>
#include <corotet/types.hpp>
#include <corotet/version.hpp>

// Everything that needs Eigen alone. Opt-in headers (core/tbb_executor.hpp, solve/cholmod.hpp) are included by name.
#pragma once

#include <corotet/core/assert.hpp>
#include <corotet/core/executor.hpp>
#include <corotet/core/lanes.hpp>
#include <corotet/core/result.hpp>
#include <corotet/core/types.hpp>
#include <corotet/core/version.hpp>
#include <corotet/element/reference_element.hpp>
#include <corotet/element/tet10.hpp>
#include <corotet/element/tet4.hpp>
#include <corotet/mesh/boundary.hpp>
#include <corotet/mesh/check_connectivity.hpp>
#include <corotet/mesh/element_quality.hpp>
#include <corotet/mesh/io/byte_reader.hpp>
#include <corotet/mesh/io/file_bytes.hpp>
#include <corotet/mesh/io/sticky_error.hpp>
#include <corotet/mesh/io/text_scanner.hpp>
#include <corotet/mesh/make_block.hpp>
#include <corotet/mesh/mesh_data.hpp>
#include <corotet/mesh/quality.hpp>
#include <corotet/mesh/raise_order.hpp>
#include <corotet/mesh/surface_mesh.hpp>
#include <corotet/mesh/tet_mesh.hpp>
#include <corotet/mesh/validate.hpp>

/// @defgroup group_io Readers and writers
/// Files: volumes, surfaces, time series, and animations that play in a browser.
#pragma once

#include <corotet/detail/core/file_path.hpp>
#include <corotet/detail/mesh/animation.hpp>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <corotet/detail/mesh/io/read_medit.hpp>
#include <corotet/detail/mesh/io/read_mesh.hpp>
#include <corotet/detail/mesh/io/read_msh.hpp>
#include <corotet/detail/mesh/io/read_obj.hpp>
#include <corotet/detail/mesh/io/read_off.hpp>
#include <corotet/detail/mesh/io/read_ply.hpp>
#include <corotet/detail/mesh/io/read_stl.hpp>
#include <corotet/detail/mesh/io/read_surface.hpp>
#include <corotet/detail/mesh/io/read_tetgen.hpp>
#include <corotet/detail/mesh/io/read_vega.hpp>
#include <corotet/detail/mesh/io/read_vtk.hpp>
#include <corotet/detail/mesh/io/vtu_values.hpp>
#include <corotet/detail/mesh/io/write_animation_html.hpp>
#include <corotet/detail/mesh/io/write_filmstrip_svg.hpp>
#include <corotet/detail/mesh/io/write_msh.hpp>
#include <corotet/detail/mesh/io/write_obj.hpp>
#include <corotet/detail/mesh/io/write_pvd.hpp>
#include <corotet/detail/mesh/io/write_vtu.hpp>

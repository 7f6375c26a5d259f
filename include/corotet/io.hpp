/// @defgroup group_io Readers and writers
/// Files: volumes, surfaces, time series, and animations that play in a browser.
#pragma once

#include <corotet/mesh/animation.hpp>
#include <corotet/mesh/io/file_bytes.hpp>
#include <corotet/mesh/io/read_medit.hpp>
#include <corotet/mesh/io/read_mesh.hpp>
#include <corotet/mesh/io/read_msh.hpp>
#include <corotet/mesh/io/read_obj.hpp>
#include <corotet/mesh/io/read_off.hpp>
#include <corotet/mesh/io/read_ply.hpp>
#include <corotet/mesh/io/read_stl.hpp>
#include <corotet/mesh/io/read_surface.hpp>
#include <corotet/mesh/io/read_tetgen.hpp>
#include <corotet/mesh/io/read_vega.hpp>
#include <corotet/mesh/io/read_vtk.hpp>
#include <corotet/mesh/io/write_animation_html.hpp>
#include <corotet/mesh/io/write_filmstrip_svg.hpp>
#include <corotet/mesh/io/write_msh.hpp>
#include <corotet/mesh/io/write_obj.hpp>
#include <corotet/mesh/io/write_pvd.hpp>
#include <corotet/mesh/io/write_vtu.hpp>

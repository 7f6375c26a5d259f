#include "simulation.hpp"

#include "typed_simulation.hpp"

namespace corotet::program {

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const MeshData& mesh) {
  const bool quadratic = mesh.nodes_per_element == 10;
  if (scene.scalar == ScalarKind::single_precision)
    return quadratic ? make_typed_simulation<float, Tet10>(scene, mesh)
                     : make_typed_simulation<float, Tet4>(scene, mesh);
  return quadratic ? make_typed_simulation<double, Tet10>(scene, mesh)
                   : make_typed_simulation<double, Tet4>(scene, mesh);
}

}  // namespace corotet::program

#include "typed_simulation.hpp"

namespace corotet::program {

template std::unique_ptr<Simulation> make_typed_simulation<float, Tet10>(const Scene&, const MeshData&);

}  // namespace corotet::program

// For the ways of getting the library that differ in CMake alone: main.cpp with other.cpp takes a minute to compile.
#include <corotet/mesh.hpp>
#include <corotet/version.hpp>
#include <cstdio>

int main() {
  const corotet::Result<corotet::MeshData> block = corotet::make_block({.cells = {2, 1, 1}});
  if (!block || !corotet::TetMesh<float>::create(*block)) return 1;
  std::printf("corotet %d.%d.%d\n", COROTET_VERSION_MAJOR, COROTET_VERSION_MINOR, COROTET_VERSION_PATCH);
  return 0;
}

#include <corotet/corotet.hpp>
#include <cstdio>

corotet::AssertHandler* handler_seen_by_other();
corotet::Index vertices_counted_by_other();

int main() {
  const corotet::Result<corotet::MeshData> block = corotet::make_block({.cells = {2, 1, 1}, .order = 2});
  if (!block) return 1;
  const auto mesh = corotet::TetMesh<float, corotet::Tet10>::create(*block);
  if (!mesh) return 2;
  // One program has one assertion handler, and both files agree on what the library does.
  if (&corotet::assert_handler != handler_seen_by_other()) return 3;
  if (mesh->vertex_count() != vertices_counted_by_other()) return 4;
  std::printf("corotet %d.%d.%d\n", COROTET_VERSION_MAJOR, COROTET_VERSION_MINOR, COROTET_VERSION_PATCH);
  return 0;
}

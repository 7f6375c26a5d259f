// The second translation unit: a function or variable that a header defines without `inline` fails to link.
#include <corotet/corotet.hpp>

corotet::AssertHandler* handler_seen_by_other();
corotet::Index vertices_counted_by_other();

corotet::AssertHandler* handler_seen_by_other() { return &corotet::assert_handler; }

corotet::Index vertices_counted_by_other() {
  const corotet::Result<corotet::MeshData> block = corotet::make_block({.cells = {2, 1, 1}, .order = 2});
  return block ? corotet::size_of(block->positions) : 0;
}

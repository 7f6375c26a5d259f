#include <corotet/detail/mesh/io/read_medit.hpp>

#include "fuzz/fuzz_mesh.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return corotet::fuzz::check_mesh(corotet::read_medit(corotet::fuzz::as_text(data, size), "input"));
}

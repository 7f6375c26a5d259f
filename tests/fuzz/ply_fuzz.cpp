#include <corotet/detail/mesh/io/read_ply.hpp>

#include "fuzz/fuzz_surface.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return corotet::fuzz::check_surface(corotet::read_ply(corotet::fuzz::as_text(data, size), "input"));
}

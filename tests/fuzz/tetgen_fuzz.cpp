#include <corotet/detail/mesh/io/read_tetgen.hpp>

#include "fuzz/fuzz_mesh.hpp"

// The .node and the .ele file in one input, with a '%' between them.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = corotet::fuzz::as_text(data, size);
  const std::size_t cut = std::min(text.find('%'), text.size());
  const std::string_view ele = cut == text.size() ? std::string_view{} : text.substr(cut + 1);
  return corotet::fuzz::check_mesh(corotet::read_tetgen(text.substr(0, cut), ele, "input.node", "input.ele"));
}

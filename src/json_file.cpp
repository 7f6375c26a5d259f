#include "json_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <corotet/detail/mesh/io/file_bytes.hpp>
#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "failure.hpp"

namespace corotet::program {
namespace {

/// The 1-based line of a byte offset.
std::ptrdiff_t line_of(const std::string& text, std::size_t offset) {
  return 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(offset, text.size())), '\n');
}

/// The parser's message without its own numbering: "... parse error at line 3, column 4: syntax error ..." -> "syntax
/// error ...".
std::string reason_of(const std::string& message) {
  const std::size_t column = message.find("column");
  const std::size_t colon = message.find(": ", column == std::string::npos ? 0 : column);
  return colon == std::string::npos ? message : message.substr(colon + 2);
}

}  // namespace

Json read_json(const std::filesystem::path& path) {
  const std::string text = require(read_file(path));
  std::vector<std::set<std::string>> keys;  // of the objects around the place where the parser is
  std::string repeated;
  const auto find_repeated = [&](int /*depth*/, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second && repeated.empty())
      repeated = parsed.get<std::string>();
    return true;
  };
  try {
    Json json = Json::parse(text, find_repeated);
    if (!repeated.empty())
      throw Failure(fmt::format("{}: the key \"{}\" stands twice in one object", path.string(), repeated));
    return json;
  } catch (const Json::parse_error& error) {
    throw Failure(fmt::format("{}:{}: not JSON: {}", path.string(), line_of(text, error.byte == 0 ? 0 : error.byte - 1),
                              reason_of(error.what())));
  } catch (const Json::exception& error) {  // a number beyond the range of double
    throw Failure(fmt::format("{}: not usable JSON: {}", path.string(), error.what()));
  }
}

}  // namespace corotet::program

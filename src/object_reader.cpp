#include "object_reader.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace corotet::program {

std::string Range::text() const {
  const bool above = std::isfinite(least), below = std::isfinite(most);
  const char* min_sign = min_excluded ? ">" : ">=";
  const char* max_sign = max_excluded ? "<" : "<=";
  if (above && below) return fmt::format("must be {} {} and {} {}", min_sign, least, max_sign, most);
  if (above) return fmt::format("must be {} {}", min_sign, least);
  if (below) return fmt::format("must be {} {}", max_sign, most);
  return "must be finite";
}

std::string describe(const Json& value) {
  switch (value.type()) {
    case Json::value_t::null:
      return "null";
    case Json::value_t::boolean:
      return value.get<bool>() ? "true" : "false";
    case Json::value_t::string:
      return fmt::format("the text \"{}\"", value.get_ref<const std::string&>());
    case Json::value_t::array:
      return fmt::format("a list of {}", value.size());
    case Json::value_t::object:
      return "an object";
    default:
      return fmt::format("the number {}", value.get<double>());
  }
}

std::optional<std::vector<double>> read_numbers(const Json& value, std::size_t count, const std::string& path,
                                                Problems& problems) {
  const bool is_list = value.is_array() && value.size() == count &&
                       std::all_of(value.begin(), value.end(), [](const Json& entry) { return entry.is_number(); });
  if (!is_list) {
    problems.add(path, fmt::format("must be a list of {} numbers, is {}{}", count, describe(value),
                                   value.is_array() && value.size() == count ? ", not all of them numbers" : ""));
    return std::nullopt;
  }
  return value.get<std::vector<double>>();
}

ObjectReader::ObjectReader(const Json& value, std::string path, Problems& problems)
    : value_(value), path_(std::move(path)), problems_(problems) {
  if (!value_.is_object()) problems_.add(path_, "must be an object, is " + describe(value_));
}

std::string ObjectReader::path_of(std::string_view key) const {
  return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
}

const Json* ObjectReader::find(std::string_view key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
  if (!value_.is_object()) return nullptr;
  const auto member = value_.find(std::string(key));
  return member == value_.end() ? nullptr : &*member;
}

bool ObjectReader::has(std::string_view key) { return find(key) != nullptr; }

void ObjectReader::number(std::string_view key, double& value, const Range& range) {
  const Json* member = find(key);
  if (member == nullptr) return;
  if (!member->is_number()) return problems_.add(path_of(key), "must be a number, is " + describe(*member));
  const auto number = member->get<double>();
  if (!range.contains(number)) return problems_.add(path_of(key), fmt::format("{}, is {}", range.text(), number));
  value = number;
}

void ObjectReader::integer(std::string_view key, int& value, int least, int most) {
  const Json* member = find(key);
  if (member == nullptr) return;
  // 60.0 is an integer too, whoever wrote it.
  const double number = member->is_number() ? member->get<double>() : 0.5;
  if (number != std::floor(number)) return problems_.add(path_of(key), "must be an integer, is " + describe(*member));
  const Range range{double(least), most == std::numeric_limits<int>::max() ? Range{}.most : most, false, false};
  if (!range.contains(number)) return problems_.add(path_of(key), fmt::format("{}, is {}", range.text(), number));
  if (number > most) return problems_.add(path_of(key), fmt::format("must be <= {}, is {}", most, number));
  value = static_cast<int>(number);
}

bool ObjectReader::text(std::string_view key, std::string& value) {
  const Json* member = find(key);
  if (member == nullptr) return false;
  if (!member->is_string()) {
    problems_.add(path_of(key), "must be text, is " + describe(*member));
    return false;
  }
  value = member->get<std::string>();
  return true;
}

void ObjectReader::vector(std::string_view key, Vec3<double>& value) {
  const Json* member = find(key);
  if (member == nullptr) return;
  if (const auto numbers = read_numbers(*member, 3, path_of(key), problems_))
    value = Vec3<double>::load(numbers->data());
}

void ObjectReader::quaternion(std::string_view key, Matrix<double, 4, 1>& value) {
  const Json* member = find(key);
  if (member == nullptr) return;
  if (const auto numbers = read_numbers(*member, 4, path_of(key), problems_))
    value = Matrix<double, 4, 1>::load(numbers->data());
}

std::optional<std::size_t> ObjectReader::choice_index(std::string_view key, const std::vector<std::string>& names,
                                                      std::initializer_list<const char*> not_yet) {
  const Json* member = find(key);
  if (member == nullptr) return std::nullopt;
  const auto found =
      member->is_string() ? std::find(names.begin(), names.end(), member->get<std::string>()) : names.end();
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  const bool later = member->is_string() && std::any_of(not_yet.begin(), not_yet.end(), [&](const char* name) {
                       return member->get_ref<const std::string&>() == name;
                     });
  problems_.add(path_of(key),
                later ? fmt::format("\"{}\" is not in this version, which has: {}",
                                    member->get_ref<const std::string&>(), fmt::join(names, ", "))
                      : fmt::format("must be one of: {}; is {}", fmt::join(names, ", "), describe(*member)));
  return std::nullopt;
}

void ObjectReader::object(std::string_view key, const std::function<void(ObjectReader&)>& read) {
  const Json* member = find(key);
  if (member == nullptr) return;
  ObjectReader reader(*member, path_of(key), problems_);
  read(reader);
  reader.refuse_others();
}

void ObjectReader::list(std::string_view key, const std::function<void(const Json&, const std::string&)>& read) {
  const Json* member = find(key);
  if (member == nullptr) return;
  if (!member->is_array()) return problems_.add(path_of(key), "must be a list, is " + describe(*member));
  for (std::size_t i = 0; i < member->size(); ++i) read((*member)[i], fmt::format("{}[{}]", path_of(key), i));
}

void ObjectReader::refuse_others() {
  if (!value_.is_object()) return;
  for (const auto& [key, value] : value_.items())
    if (std::find(known_.begin(), known_.end(), key) == known_.end())
      problems_.add(path_of(key), fmt::format("unknown key; known here: {}", fmt::join(known_, ", ")));
}

}  // namespace corotet::program

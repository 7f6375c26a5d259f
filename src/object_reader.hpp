// Reads the members of a JSON object into values, and notes everything that is wrong with them.
#pragma once

#include <corotet/detail/core/types.hpp>
#include <functional>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "json_file.hpp"
#include "problems.hpp"

namespace corotet::program {

/// Which numbers are allowed; infinities never are.
struct Range {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool min_excluded = false;
  bool max_excluded = false;

  [[nodiscard]] static Range any() { return {}; }
  [[nodiscard]] static Range above(double least) {
    return {least, std::numeric_limits<double>::infinity(), true, false};
  }
  [[nodiscard]] static Range from(double least) {
    return {least, std::numeric_limits<double>::infinity(), false, false};
  }
  [[nodiscard]] static Range between(double least, double most) { return {least, most, true, true}; }

  [[nodiscard]] bool contains(double x) const {
    return (min_excluded ? x > least : x >= least) && (max_excluded ? x < most : x <= most);
  }
  [[nodiscard]] std::string text() const;
};

/// A member that is absent leaves its default alone. Keys are named by their path: "solver.tolerance", "pins[0].box".
class ObjectReader {
 public:
  /// Notes a problem if `value` is not an object; then it has no members. `path` is empty for the whole file.
  ObjectReader(const Json& value, std::string path, Problems& problems);

  [[nodiscard]] bool has(std::string_view key);

  void number(std::string_view key, double& value, const Range& range = {});
  void integer(std::string_view key, int& value, int least, int most = std::numeric_limits<int>::max());
  bool text(std::string_view key, std::string& value);  ///< whether it was there and is text
  void vector(std::string_view key, Vec3<double>& value);
  void quaternion(std::string_view key, Matrix<double, 4, 1>& value);

  /// A name out of `choices`; `not_yet` are names that a scene may hold one day.
  template <class Choice>
  void choice(std::string_view key, Choice& value, std::initializer_list<std::pair<const char*, Choice>> choices,
              std::initializer_list<const char*> not_yet = {}) {
    std::vector<std::string> names;
    for (const auto& [name, meaning] : choices) names.emplace_back(name);
    if (const auto index = choice_index(key, names, not_yet)) value = (choices.begin() + *index)->second;
  }

  /// Calls `read` with a reader of the object under `key`, if it is there.
  void object(std::string_view key, const std::function<void(ObjectReader&)>& read);

  /// Calls `read` with each entry of the list under `key`, if it is there, and with the entry's path.
  void list(std::string_view key, const std::function<void(const Json&, const std::string&)>& read);

  /// Notes the keys that nobody asked for. Call it last.
  void refuse_others();

  [[nodiscard]] std::string path_of(std::string_view key) const;
  [[nodiscard]] Problems& problems() { return problems_; }

 private:
  /// The member, or null if it is absent.
  const Json* find(std::string_view key);
  std::optional<std::size_t> choice_index(std::string_view key, const std::vector<std::string>& names,
                                          std::initializer_list<const char*> not_yet);

  const Json& value_;
  std::string path_;
  Problems& problems_;
  std::vector<std::string> known_;
};

/// `count` finite numbers from a JSON list; nothing, after noting a problem, if `value` is anything else.
[[nodiscard]] std::optional<std::vector<double>> read_numbers(const Json& value, std::size_t count,
                                                              const std::string& path, Problems& problems);

/// What a JSON value is, for people: "a number", "the text "x"", "a list".
[[nodiscard]] std::string describe(const Json& value);

}  // namespace corotet::program

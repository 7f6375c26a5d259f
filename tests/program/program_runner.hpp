// Runs the program in a folder of its own and hands back what it wrote.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace corotet::testing {

struct Outcome {
  int exit_code = -1;  ///< -1: ended by a signal
  std::string out, err;
};

class ProgramTest : public ::testing::Test {
 public:
  using Json = nlohmann::json;

  ProgramTest() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(::testing::TempDir()) /
              ("corotet-" + std::string(test->name()) + "-" + std::to_string(getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~ProgramTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  ProgramTest(const ProgramTest&) = delete;
  ProgramTest& operator=(const ProgramTest&) = delete;

  /// `arguments` are those of a shell, run in the test's folder, after the shell's commands in `before`.
  [[nodiscard]] Outcome corotet(const std::string& arguments, const std::string& before = ":") const {
    const std::string command = "cd '" + folder_.string() + "' && { " + before + "; '" COROTET_PROGRAM "' " +
                                arguments + "; } > stdout.txt 2> stderr.txt < /dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("stdout.txt"), read("stderr.txt")};
  }

  /// The same, for commands that the test needs to succeed.
  void must(const std::string& arguments) const {
    const Outcome outcome = corotet(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << "corotet " << arguments << "\n" << outcome.out << outcome.err;
  }

  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] bool exists(const std::string& name) const { return std::filesystem::exists(file(name)); }

  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream stream(file(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  [[nodiscard]] Json read_json(const std::string& name) const { return Json::parse(read(name)); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(file(name), std::ios::binary) << text;
  }

  /// All numbers in a file of white space and numbers.
  [[nodiscard]] std::vector<double> read_numbers(const std::string& name) const {
    std::ifstream stream(file(name));
    return {std::istream_iterator<double>(stream), {}};
  }

  /// The rows of a table in CSV, by column. Cells in quotes may hold commas.
  [[nodiscard]] std::vector<std::map<std::string, std::string>> read_csv(const std::string& name) const {
    std::istringstream text(read(name));
    std::vector<std::string> columns;
    std::vector<std::map<std::string, std::string>> rows;
    for (std::string line; std::getline(text, line);) {
      std::vector<std::string> cells(1);
      bool quoted = false;
      for (const char c : line) {
        if (c == '"')
          quoted = !quoted;
        else if (c == ',' && !quoted)
          cells.emplace_back();
        else
          cells.back() += c;
      }
      if (columns.empty()) {
        columns = cells;
        continue;
      }
      EXPECT_EQ(cells.size(), columns.size()) << line;
      auto& row = rows.emplace_back();
      for (std::size_t i = 0; i < cells.size() && i < columns.size(); ++i) row[columns[i]] = cells[i];
    }
    return rows;
  }

  /// A row of probes.csv.
  struct ProbeRow {
    double t, probe, x, y, z;
  };
  [[nodiscard]] std::vector<ProbeRow> read_probes(const std::string& name) const {
    std::ifstream stream(file(name));
    std::vector<ProbeRow> rows;
    std::string line;
    std::getline(stream, line);
    EXPECT_EQ(line, "t,probe,x,y,z");
    char comma = 0;
    for (ProbeRow row{}; stream >> row.t >> comma >> row.probe >> comma >> row.x >> comma >> row.y >> comma >> row.z;)
      rows.push_back(row);
    return rows;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace corotet::testing

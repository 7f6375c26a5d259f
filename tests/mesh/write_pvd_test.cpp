#include <gtest/gtest.h>

#include <corotet/detail/mesh/io/write_pvd.hpp>
#include <limits>
#include <vector>

#include "mesh/mesh_files.hpp"

namespace corotet {
namespace {

struct Frame {
  double time;
  std::string file;
  bool operator==(const Frame&) const = default;
};

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t i = 0; (i = text.find(from, i)) != std::string::npos; i += to.size())
    text.replace(i, from.size(), to);
}

/// The frames of a complete file; fails the test if anything but complete entries stands between its head and tail.
std::vector<Frame> frames_in(const std::string& path) {
  std::string text = read_file(path).value();
  const std::string head = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n  <Collection>\n";
  const std::string tail = "  </Collection>\n</VTKFile>\n";
  EXPECT_EQ(text.substr(0, head.size()), head);
  EXPECT_GE(text.size(), head.size() + tail.size());
  EXPECT_EQ(text.substr(text.size() - tail.size()), tail);
  std::vector<Frame> frames;
  std::size_t i = head.size();
  while (i + tail.size() < text.size()) {
    const std::size_t end = text.find('\n', i);
    const std::string line = text.substr(i, end - i);
    const std::string before = "    <DataSet timestep=\"", between = "\" part=\"0\" file=\"", after = "\"/>";
    const std::size_t middle = line.find(between);
    EXPECT_EQ(line.substr(0, before.size()), before);
    EXPECT_NE(middle, std::string::npos);
    EXPECT_EQ(line.substr(line.size() - after.size()), after);
    std::string file = line.substr(middle + between.size());
    file.resize(file.size() - after.size());
    EXPECT_EQ(file.find_first_of("<>\"'"), std::string::npos);
    replace_all(file, "&lt;", "<");
    replace_all(file, "&gt;", ">");
    replace_all(file, "&quot;", "\"");
    replace_all(file, "&apos;", "'");
    replace_all(file, "&amp;", "&");
    frames.push_back({std::strtod(line.c_str() + before.size(), nullptr), file});
    i = end + 1;
  }
  return frames;
}

class WritePvd : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  std::string path_ = (folder_ / "series.pvd").string();
};

TEST_F(WritePvd, IsCompleteAfterEveryFrame) {
  ASSERT_TRUE(write_file(path_, std::string(10000, 'x')).ok());  // an older, longer file gives way
  std::vector<Frame> expected;
  {
    PvdWriter series = PvdWriter::create(path_).value();
    EXPECT_EQ(frames_in(path_), expected);
    for (int i = 0; i < 200; ++i) {
      expected.push_back({i / 60.0, "frames/" + std::to_string(i) + ".vtu"});
      ASSERT_TRUE(series.add_frame(expected.back().time, expected.back().file).ok());
      ASSERT_EQ(frames_in(path_), expected);
      EXPECT_EQ(series.frame_count(), i + 1);
    }
  }  // the writer has nothing left to do at its end
  EXPECT_EQ(frames_in(path_), expected);
}

TEST_F(WritePvd, NamesAreEscaped) {
  PvdWriter series = PvdWriter::create(path_).value();
  const std::string name = "a&b <\"'> \xC3\xA4 &amp;.vtu";
  ASSERT_TRUE(series.add_frame(0, name).ok());
  EXPECT_EQ(frames_in(path_), (std::vector<Frame>{{0, name}}));
}

TEST_F(WritePvd, RefusedFramesLeaveTheSeriesAsItWas) {
  PvdWriter series = PvdWriter::create(path_).value();
  ASSERT_TRUE(series.add_frame(0.5, "0.vtu").ok());
  const std::string before = read_file(path_).value();
  EXPECT_EQ(series.add_frame(std::numeric_limits<double>::quiet_NaN(), "1.vtu").error().code,
            ErrorCode::non_finite_value);
  EXPECT_EQ(series.add_frame(1, "").error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(series.add_frame(1, "a\nb.vtu").error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(series.add_frame(1, std::string_view("a\0b", 3)).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(read_file(path_).value(), before);
  EXPECT_EQ(series.frame_count(), 1);
  ASSERT_TRUE(series.add_frame(1, "1.vtu").ok());
  EXPECT_EQ(frames_in(path_), (std::vector<Frame>{{0.5, "0.vtu"}, {1, "1.vtu"}}));
}

TEST_F(WritePvd, FoldersThatDoNotExistAreNamed) {
  const auto result = PvdWriter::create(folder_ / "no_such_folder/x.pvd");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::file_unreadable);
  PvdWriter series = PvdWriter::create(path_).value();
  std::remove(path_.c_str());
  EXPECT_EQ(series.add_frame(0, "0.vtu").error().code, ErrorCode::file_unreadable);
}

}  // namespace
}  // namespace corotet

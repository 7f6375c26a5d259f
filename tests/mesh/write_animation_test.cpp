#include <gtest/gtest.h>

#include <algorithm>
#include <corotet/detail/mesh/animation.hpp>
#include <corotet/detail/mesh/creases.hpp>
#include <corotet/detail/mesh/element_lines.hpp>
#include <corotet/detail/mesh/io/contours.hpp>
#include <corotet/detail/mesh/io/write_animation_html.hpp>
#include <corotet/detail/mesh/io/write_filmstrip_svg.hpp>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "mesh/mesh_files.hpp"

namespace corotet::write_animation_test {
namespace {

/// A cube that grows along y, and the edge from its first to its last corner.
Animation growing_cube() {
  Animation animation;
  animation.title = "Cube";
  animation.caption = "12 triangles";
  animation.frame_seconds = 0.05;
  for (Index x = 0; x < 2; ++x)  // each side once: x, y, z, and cyclic
    for (Index axis = 0; axis < 3; ++axis) {
      const auto corner = [&](Index a, Index b, Index c) {
        const std::array<Index, 3> bits{a, b, c};
        return bits[at((3 - axis) % 3)] + 2 * bits[at((4 - axis) % 3)] + 4 * bits[at((5 - axis) % 3)];
      };
      const Index a = corner(x, 0, 0), b = corner(x, 1, 0), c = corner(x, 1, 1), d = corner(x, 0, 1);
      for (std::array<Index, 3> t : {std::array<Index, 3>{a, b, c}, {a, c, d}}) {
        if (x == 0) std::swap(t[0], t[1]);
        animation.triangles.push_back(t);
      }
    }
  animation.lines = {{0, 1}};
  for (int k = 0; k < 3; ++k) {
    Field<double> corners;
    for (int v = 0; v < 8; ++v) corners.emplace_back(v & 1, (1 + 0.3 * k) * (v >> 1 & 1), v >> 2);
    animation.surface_frames.push_back(corners);
    animation.line_frames.push_back({corners[0], corners[7]});
  }
  return animation;
}

/// A sphere of 2 x 16 x 32 triangles; z up.
Animation sphere() {
  constexpr Index rings = 16, sides = 32;
  Animation animation;
  animation.title = "Sphere";
  Field<double> x;
  for (Index i = 0; i <= rings; ++i)
    for (Index j = 0; j < sides; ++j) {
      const double a = std::numbers::pi * i / rings, b = 2 * std::numbers::pi * j / sides;
      x.emplace_back(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
    }
  for (Index i = 0; i < rings; ++i)
    for (Index j = 0; j < sides; ++j) {
      const Index a = i * sides + j, b = i * sides + (j + 1) % sides;
      animation.triangles.push_back({a, a + sides, b});
      animation.triangles.push_back({b, a + sides, b + sides});
    }
  animation.surface_frames = {x};
  return animation;
}

/// The bytes of the element with this id, decoded without the library's help.
std::vector<unsigned char> data_of(const std::string& html, const std::string& id) {
  const std::string start = "<script type=\"text/plain\" id=\"" + id + "\">";
  const std::size_t begin = html.find(start) + start.size(), end = html.find("</script>", begin);
  EXPECT_NE(html.find(start), std::string::npos) << id;
  std::vector<unsigned char> bytes;
  unsigned buffer = 0;
  int bits = 0;
  for (std::size_t i = begin; i < end && html[i] != '='; ++i) {
    const char c = html[i];
    const int digit = c >= 'a' ? c - 'a' + 26 : c >= 'A' ? c - 'A' : c == '+' ? 62 : c == '/' ? 63 : c - '0' + 52;
    buffer = buffer << 6 | static_cast<unsigned>(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<unsigned char>(buffer >> bits & 255));
  }
  return bytes;
}

std::vector<std::uint32_t> numbers_of(const std::vector<unsigned char>& bytes, std::size_t size) {
  std::vector<std::uint32_t> numbers(bytes.size() / size, 0);
  for (std::size_t i = 0; i < bytes.size(); ++i) numbers[i / size] |= std::uint32_t{bytes[i]} << (8 * (i % size));
  return numbers;
}

TEST(WriteAnimation, PositionsAreWithinHalfAStepOfTheBox) {
  Animation animation = sphere();
  const Field<double> first = animation.surface_frames[0];
  Field<double> second;
  for (const Vec3<double>& x : first) second.emplace_back(1000 + 3 * x[0], x[1] / 7, 1e-3 * x[2] - 5);
  animation.surface_frames.push_back(second);
  animation.lines = {{1, 0}};
  animation.line_frames = {{first[3], first[40]}, {second[3], second[40]}};
  const Result<std::string> html = format_animation_html(animation);
  ASSERT_TRUE(html.ok());

  Vec3<double> low = first[0], high = first[0];
  for (const Field<double>& frame : animation.surface_frames)
    for (const Vec3<double>& x : frame)
      for (int i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], x[i]);
        high[i] = std::max(high[i], x[i]);
      }
  const auto expect_near = [&](const std::string& id, const std::vector<Field<double>>& frames) {
    const std::vector<std::uint32_t> q = numbers_of(data_of(*html, id), 2);
    ASSERT_EQ(q.size(), frames.size() * frames[0].size() * 3);
    std::size_t n = 0;
    for (const Field<double>& frame : frames)
      for (const Vec3<double>& x : frame)
        for (int i = 0; i < 3; ++i, ++n)
          EXPECT_NEAR(low[i] + q[n] * (high[i] - low[i]) / 65535, x[i], 0.5001 * (high[i] - low[i]) / 65535);
  };
  expect_near("surface-positions", animation.surface_frames);
  expect_near("line-positions", animation.line_frames);
  EXPECT_EQ(numbers_of(data_of(*html, "lines"), 4), (std::vector<std::uint32_t>{1, 0}));

  // Triangles are over divided vertices; through their source they are those that were given.
  const std::vector<std::uint32_t> source = numbers_of(data_of(*html, "source"), 4);
  const std::vector<std::uint32_t> corners = numbers_of(data_of(*html, "triangles"), 4);
  ASSERT_EQ(corners.size(), 3 * animation.triangles.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    ASSERT_LT(corners[i], source.size());
    EXPECT_EQ(source[corners[i]], static_cast<std::uint32_t>(animation.triangles[i / 3][i % 3]));
  }
}

TEST(WriteAnimation, VerticesAreDividedAtSharpEdgesOnly) {
  const Animation cube = growing_cube(), ball = sphere();
  EXPECT_EQ(detail::split_at_creases(cube.surface_frames[0], cube.triangles).source.size(), 24u);  // three a corner
  // Triangles without area, as at the poles, make no edge sharp.
  EXPECT_EQ(detail::split_at_creases(ball.surface_frames[0], ball.triangles).source.size(),
            ball.surface_frames[0].size());
}

TEST(WriteAnimation, EachEdgeOfAMeshIsDrawnOnce) {
  for (const int order : {1, 2}) {
    const MeshData block = make_block({.size = {3, 2, 1}, .cells = {3, 2, 1}, .order = order}).value();
    // Euler: V - E + F - T = 1 for a ball, with F = (4 T + boundary faces) / 2; two triangles a square of the boundary.
    const Index vertices = 4 * 3 * 2, elements = block.element_count(), faces = (4 * elements + 2 * 22) / 2;
    const Index edges = vertices + faces - elements - 1;
    const auto lines = order == 1 ? element_lines(TetMesh<double, Tet4>::create(block).value())
                                  : element_lines(TetMesh<double, Tet10>::create(block).value());
    EXPECT_EQ(size_of(lines), order * edges);
  }
}

TEST(WriteAnimation, BadInputIsRefusedByName) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  struct Case {
    std::string where;
    ErrorCode code;
    std::function<void(Animation&)> spoil;
  };
  const std::vector<Case> cases{
      {"title", ErrorCode::invalid_argument, [](Animation& a) { a.title.clear(); }},
      {"title", ErrorCode::invalid_argument, [](Animation& a) { a.title = "two\nlines"; }},
      {"caption", ErrorCode::invalid_argument, [](Animation& a) { a.caption = "\x1b[2J"; }},
      {"frame_seconds", ErrorCode::invalid_argument, [](Animation& a) { a.frame_seconds = 0; }},
      {"frame_seconds", ErrorCode::invalid_argument, [=](Animation& a) { a.frame_seconds = nan; }},
      {"frame_seconds", ErrorCode::invalid_argument, [=](Animation& a) { a.frame_seconds = inf; }},
      {"up", ErrorCode::invalid_argument, [](Animation& a) { a.up = Vec3<double>(0, 0, 0); }},
      {"up", ErrorCode::invalid_argument, [=](Animation& a) { a.up[1] = nan; }},
      {"surface_frames", ErrorCode::empty_mesh, [](Animation& a) { a.surface_frames.clear(); }},
      {"triangles", ErrorCode::empty_mesh, [](Animation& a) { a.triangles.clear(); }},
      {"surface_frames[2]", ErrorCode::invalid_argument, [](Animation& a) { a.surface_frames[2].pop_back(); }},
      {"surface_frames[1], vertex 3", ErrorCode::non_finite_value,
       [=](Animation& a) { a.surface_frames[1][3][2] = inf; }},
      {"line_frames", ErrorCode::invalid_argument, [](Animation& a) { a.line_frames.pop_back(); }},
      {"line_frames", ErrorCode::invalid_argument, [](Animation& a) { a.lines.clear(); }},
      {"line_frames[1]", ErrorCode::invalid_argument, [](Animation& a) { a.line_frames[1].emplace_back(0, 0, 0); }},
      {"line_frames[0], vertex 1", ErrorCode::non_finite_value, [=](Animation& a) { a.line_frames[0][1][0] = nan; }},
      {"triangle 5", ErrorCode::index_out_of_range, [](Animation& a) { a.triangles[5][1] = 8; }},
      {"triangle 0", ErrorCode::index_out_of_range, [](Animation& a) { a.triangles[0][0] = -1; }},
      {"line 0", ErrorCode::index_out_of_range, [](Animation& a) { a.lines[0][1] = 2; }},
      {"surface_frames", ErrorCode::non_finite_value,
       [](Animation& a) {
         a.surface_frames[0][0][0] = -1.5e308;
         a.surface_frames[0][1][0] = 1.5e308;
       }},
  };
  const TemporaryFolder folder;
  for (const Case& c : cases) {
    Animation animation = growing_cube();
    c.spoil(animation);
    const Result<void> page = write_animation_html(folder / "x.html", animation);
    const Result<void> picture = write_filmstrip_svg(folder / "x.svg", animation);
    ASSERT_FALSE(page.ok()) << c.where;
    ASSERT_FALSE(picture.ok()) << c.where;
    EXPECT_EQ(page.error().where, c.where) << page.error().message();
    EXPECT_EQ(page.error().code, c.code) << page.error().message();
    EXPECT_EQ(picture.error().message(), page.error().message());
  }
  const auto refused = [](FilmstripOptions options) { return format_filmstrip_svg(growing_cube(), options).error(); };
  EXPECT_EQ(refused({.frames = {0, 3}}).where, "frames[1]");
  EXPECT_EQ(refused({.frames = {-1}}).code, ErrorCode::index_out_of_range);
  EXPECT_EQ(refused({.frames = std::vector<Index>(100, 0)}).where, "frames");
  EXPECT_EQ(refused({.width = nan}).where, "width");
  EXPECT_EQ(refused({.width = 1e9}).where, "width");
  EXPECT_FALSE(std::filesystem::exists(folder / "x.html"));
  EXPECT_FALSE(std::filesystem::exists(folder / "x.svg"));
  EXPECT_EQ(write_animation_html(folder / "none/x.html", growing_cube()).error().code, ErrorCode::file_unreadable);
  EXPECT_EQ(write_filmstrip_svg(folder / "none/x.svg", growing_cube()).error().code, ErrorCode::file_unreadable);
}

TEST(WriteAnimation, WordsAreEscaped) {
  Animation animation = growing_cube();
  animation.title = "</title><script>a && b</script> \"q\" M\xc3\xbcller";
  animation.caption = "E < 5 & 'rest'";
  for (const Result<std::string>& text :
       {format_animation_html(animation), format_filmstrip_svg(animation, {.width = 300})}) {
    ASSERT_TRUE(text.ok());
    EXPECT_EQ(text->find("<script>a"), std::string::npos);
    EXPECT_NE(text->find("&lt;/title&gt;&lt;script&gt;a &amp;&amp; b&lt;/script&gt; &quot;q&quot; M\xc3\xbcller"),
              std::string::npos);
    EXPECT_NE(text->find("E &lt; 5 &amp; &apos;rest&apos;"), std::string::npos);
  }
}

TEST(WriteAnimation, ThePageNeedsNothingElse) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_animation_html(folder / "cube.html", growing_cube()).ok());
  const std::string html = read_file(folder / "cube.html").value();
  EXPECT_EQ(html, format_animation_html(growing_cube()).value());
  for (const char* outside : {"http:", "https:", "src=", "@import", "fetch(", "import "})
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
}

TEST(WriteAnimation, NumbersAtTheEndsOfTheRangeAreDrawn) {
  for (const double size : {0.0, 1e-300, 1e300})
    for (const Vec3<double>& up : {Vec3<double>(1e-300, 0, 0), Vec3<double>(0, 1, 0), Vec3<double>(1, -1, 1)}) {
      Animation animation = growing_cube();
      animation.up = up;
      for (auto* frames : {&animation.surface_frames, &animation.line_frames})
        for (Field<double>& frame : *frames)
          for (Vec3<double>& x : frame) x = x * size;
      const Result<std::string> html = format_animation_html(animation),
                                svg = format_filmstrip_svg(animation, {.width = 300});
      ASSERT_TRUE(html.ok() && svg.ok());
      for (const std::string& text : {*html, *svg}) {
        EXPECT_EQ(text.find("nan,"), std::string::npos);
        EXPECT_EQ(text.find("nan]"), std::string::npos);
        EXPECT_EQ(text.find("inf]"), std::string::npos);
      }
      EXPECT_LT(svg->size(), 100000u);
    }
}

TEST(WriteAnimation, TheStripShowsTheChosenFramesWithTheirTimes) {
  const auto times = [](const FilmstripOptions& options) {
    const std::string svg = format_filmstrip_svg(growing_cube(), options).value();
    std::vector<std::string> found;
    for (std::size_t end = 0; (end = svg.find(" s</text>", end + 1)) != std::string::npos;)
      found.push_back(svg.substr(svg.rfind('>', end) + 1, end - svg.rfind('>', end) - 1));
    return found;
  };
  EXPECT_EQ(times({.width = 300}), (std::vector<std::string>{"0.00", "0.05", "0.10"}));  // all three, each once
  EXPECT_EQ(times({.frames = {2, 0}, .width = 300}), (std::vector<std::string>{"0.10", "0.00"}));
}

TEST(WriteAnimation, TheSizeOfAStripDoesNotGrowWithTheTriangles) {
  Animation animation = sphere();
  const std::size_t coarse = format_filmstrip_svg(animation, {.width = 300}).value().size();
  for (int level = 0; level < 3; ++level) {  // each triangle into four, on the sphere
    std::vector<std::array<Index, 3>> finer;
    Field<double>& x = animation.surface_frames[0];
    for (const std::array<Index, 3>& t : animation.triangles) {
      std::array<Index, 3> middle{};
      for (std::size_t i = 0; i < 3; ++i) {
        middle[i] = size_of(x);
        x.push_back(Vec3<double>(x[at(t[i])] + x[at(t[(i + 1) % 3])]).normalized());
      }
      finer.push_back(middle);
      for (std::size_t i = 0; i < 3; ++i) finer.push_back({t[i], middle[i], middle[(i + 2) % 3]});
    }
    animation.triangles = finer;
  }
  EXPECT_LT(format_filmstrip_svg(animation, {.width = 300}).value().size(), 3 * coarse);
}

TEST(Contours, EncloseWhatIsAboveTheLevel) {
  // A cone: the outline at each height is a circle.
  constexpr Index size = 81;
  detail::Grid cone(size, size, 0);
  for (Index row = 0; row < size; ++row)
    for (Index column = 0; column < size; ++column)
      cone(column, row) = static_cast<float>(40 - std::hypot(column - 40, row - 40));
  for (const double radius : {5.0, 17.3, 30.0}) {
    const auto loops = detail::contours_of(cone, static_cast<float>(40 - radius));
    ASSERT_EQ(loops.size(), 1u);
    EXPECT_NEAR(detail::area_of(loops[0]), std::numbers::pi * radius * radius, 1);
    const auto few = detail::simplified(loops[0], 0.1);
    EXPECT_LT(few.size(), loops[0].size());
    for (const detail::GridPoint& p : few) EXPECT_NEAR(std::hypot(p.x - 40, p.y - 40), radius, 0.05);
  }
  // Two squares that touch in a corner: joined or not by their mean, closed in either case.
  for (const float low : {0.0f, 0.9f}) {
    detail::Grid squares(4, 4, 0);
    squares(1, 1) = squares(2, 2) = 1;
    squares(2, 1) = squares(1, 2) = low;
    EXPECT_EQ(detail::contours_of(squares, 0.95f).size(), low > 0.5f ? 1u : 2u);
  }
}

}  // namespace
}  // namespace corotet::write_animation_test

// What the formats allow and the files of tests/data/real do not show.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <clocale>
#include <corotet/detail/mesh/io/read_mesh.hpp>
#include <corotet/detail/mesh/io/write_msh.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "mesh/mesh_files.hpp"

namespace corotet {
namespace {

/// Two tetrahedra that share a face; every format's sample below holds them.
MeshData two_tets() {
  MeshData mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  mesh.connectivity = {0, 1, 2, 3, 1, 2, 3, 4};
  return mesh;
}

/// Numbers in a chosen byte order, behind one another.
class Bytes {
 public:
  explicit Bytes(std::endian order) : order_(order) {}
  template <class T>
  Bytes& add(std::initializer_list<T> values) {
    for (const T value : values) {
      auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
      if (order_ != std::endian::native) std::reverse(raw.begin(), raw.end());
      out_.append(raw.data(), raw.size());
    }
    return *this;
  }
  Bytes& add(std::string_view text) {
    out_ += text;
    return *this;
  }
  Bytes& add_points(const MeshData& mesh) {
    for (const auto& x : mesh.positions) add<double>({x[0], x[1], x[2]});
    return *this;
  }
  const std::string& str() const { return out_; }

 private:
  std::endian order_;
  std::string out_;
};

void expect_two_tets(const Result<MeshData>& result, const std::vector<int>& regions = {}) {
  ASSERT_TRUE(result) << result.error().message();
  MeshData expected = two_tets();
  expected.regions = regions;
  expect_same(expected, *result);
}

TEST(ReadMsh, EitherByteOrder) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    Bytes v2(order), v4(order);
    v2.add("$MeshFormat\n2.2 1 8\n").add<std::int32_t>({1}).add("\n$EndMeshFormat\n$Nodes\n5\n");
    for (std::int32_t i = 0; i < 5; ++i) {
      const auto x = two_tets().positions[at(i)];
      v2.add<std::int32_t>({i + 1}).add<double>({x[0], x[1], x[2]});
    }
    // A triangle, then the tetrahedra in a run of their own.
    v2.add("\n$EndNodes\n$Elements\n3\n").add<std::int32_t>({2, 1, 2, 1, 3, 1, 1, 2, 3});
    v2.add<std::int32_t>({4, 2, 2, 2, 7, 1, 1, 2, 3, 4, 3, 8, 1, 2, 3, 4, 5}).add("\n$EndElements\n");
    expect_two_tets(read_msh(v2.str(), "v2"), {7, 8});

    v4.add("$MeshFormat\n4.1 1 8\n").add<std::int32_t>({1}).add("\n$EndMeshFormat\n");
    v4.add("$Entities\n").add<std::uint64_t>({0, 0, 0, 1}).add<std::int32_t>({6}).add<double>({0, 0, 0, 1, 1, 1});
    v4.add<std::uint64_t>({2}).add<std::int32_t>({7, 9}).add<std::uint64_t>({1}).add<std::int32_t>({-3});
    v4.add("\n$EndEntities\n$Nodes\n").add<std::uint64_t>({1, 5, 1, 5}).add<std::int32_t>({3, 6, 0});
    v4.add<std::uint64_t>({5, 1, 2, 3, 4, 5}).add_points(two_tets()).add("\n$EndNodes\n");
    v4.add("$Elements\n").add<std::uint64_t>({1, 2, 1, 2}).add<std::int32_t>({3, 6, 4});
    v4.add<std::uint64_t>({2, 1, 1, 2, 3, 4, 2, 2, 3, 4, 5}).add("\n$EndElements\n");
    expect_two_tets(read_msh(v4.str(), "v4"), {7, 7});
  }
}

TEST(ReadMsh, SparseTagsParametersAndForeignSections) {
  // Node tags with gaps and out of order, parametric coordinates on a surface, sections that nobody needs, elements of
  // a type from the future, and Windows line ends.
  std::string text =
      "$Comments\nmade by hand $Nodes\n$EndComments\n$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
      "$Nodes\n2 5 10 900\n2 1 1 2\n900\n10\n0 0 0 0.25 0.5\n1 0 0 0.25 0.5\n3 1 0 3\n30\n20\n25\n"
      "0 1 0\n0 0 1\n1 1 1\n$EndNodes\n"
      "$Elements\n3 4 1 4\n3 1 77 1\n1 10 20 30\n3 1 4 2\n2 900 10 30 20\n3 10 30 20 25\n3 1 5 1\n"
      "4 10 20 25 30 900 10 20 30\n$EndElements\n"
      "$NodeData\n1\n\"u\"\n$EndNodeData\n";
  const auto plain = read_msh(text, "memory");
  expect_two_tets(plain);
  ASSERT_EQ(plain->notes.size(), 2u);
  EXPECT_EQ(plain->notes[0], "ignored 1 points, lines and surface elements");
  EXPECT_NE(plain->notes[1].find("ignored 1 volume elements"), std::string::npos) << plain->notes[1];
  std::string crlf;
  for (const char c : text) crlf += c == '\n' ? "\r\n" : std::string(1, c);
  expect_two_tets(read_msh(crlf, "memory"));
}

TEST(ReadMsh, NodeOrderOfOrder2) {
  // gmsh numbers the middles of 23 before those of 13: the writer must exchange them, not only the reader.
  MeshData mesh = raise_order(two_tets());
  const std::string text = format_msh(mesh, {22, false}).value();
  const auto& c = mesh.connectivity;
  const std::string line = "1 11 2 0 1 1 2 3 4 " + std::to_string(c[4] + 1) + " " + std::to_string(c[5] + 1) + " " +
                           std::to_string(c[6] + 1) + " " + std::to_string(c[7] + 1) + " " + std::to_string(c[9] + 1) +
                           " " + std::to_string(c[8] + 1);
  EXPECT_NE(text.find(line), std::string::npos) << text;
}

TEST(ReadMedit, SkipsOtherSectionsAndNotesAMissingEnd) {
  const std::string text =
      "MeshVersionFormatted 1\n# comment\nDimension\n3\nVertices 5\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n1 1 1 1\n"
      "Corners 1\n1\nTriangles\n1\n1 2 3 0\nNormals 1 0 0 1\nHexahedra 0\nTetrahedra 2 1 2 3 4 5\n2 3 4 5 -6\n";
  const auto mesh = read_medit(text, "memory");
  expect_two_tets(mesh, {5, -6});
  ASSERT_EQ(mesh->notes.size(), 2u);
  EXPECT_NE(mesh->notes[0].find("may be incomplete"), std::string::npos);
  EXPECT_EQ(mesh->notes[1], "ignored 1 points, lines and surface elements");
  EXPECT_EQ(read_medit(text + "End", "memory")->notes.size(), 1u);
}

TEST(ReadVtk, LayoutOfVersion51TextAndBinary) {
  const std::string head = "# vtk DataFile Version 5.1\ntitle\n";
  const auto text = read_vtk(head +
                                 "ASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n0 0 0 1 0 0 0 1 0\n0 0 1 1 1 1\n"
                                 "METADATA\nINFORMATION 0\n\nCELLS 4 11\nOFFSETS vtktypeint64\n0 4 7 11\n"
                                 "CONNECTIVITY vtktypeint64\n0 1 2 3 0 1 2 1 2 3 4\nCELL_TYPES 3\n10 5 10\n",
                             "memory");
  expect_two_tets(text);
  EXPECT_EQ(text->notes, std::vector<std::string>{"ignored 1 points, lines and surface elements"});

  Bytes big(std::endian::big);
  big.add(head + "BINARY\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\nTIME 1 1 double\n").add<double>({0.5});
  big.add("\nPOINTS 5 double\n").add_points(two_tets()).add("\nCELLS 3 8\nOFFSETS vtktypeint64\n");
  big.add<std::int64_t>({0, 4, 8}).add("\nCONNECTIVITY vtktypeint32\n").add<std::int32_t>({0, 1, 2, 3, 1, 2, 3, 4});
  big.add("\nCELL_TYPES 2\n").add<std::int32_t>({10, 10}).add("\n");
  expect_two_tets(read_vtk(big.str(), "memory"));
}

TEST(ReadVega, NumbersFrom0And1SetsAndRegions) {
  const auto from1 = read_mesh(data_dir() / "vega/two_tets_from1.veg");
  expect_two_tets(from1, {1, 2});
  const std::vector<std::string> notes{"region 1 is set 'allElements' of material 'soft'",
                                       "region 2 is set 'top' of material 'hard'", "vertex numbers start at 1"};
  EXPECT_EQ(from1->notes, notes);
  expect_two_tets(read_mesh(data_dir() / "vega/two_tets_from0.veg"));
}

// A file of n bytes may name a set of n/4 elements in n/4 regions: the work is n, not its square, if each set is used
// up by the first region that looks at it.
TEST(ReadVega, ASetIsLookedAtOnceHoweverManyRegionsNameIt) {
  detail::VegaFile file;
  const std::size_t elements = 100, regions = 50;
  file.sink.mesh.regions.assign(elements, 0);
  for (std::size_t e = 0; e < elements; ++e) file.sets[e < 60 ? "low" : "high"].push_back(static_cast<int>(e));
  for (std::size_t r = 0; r < regions; ++r) file.regions.push_back({r % 2 == 0 ? "low" : "high", "rubber"});
  file.regions.push_back({"high", "steel"});
  detail::TextScanner in("", "a.veg", {});
  detail::assign_vega_regions(in, file);
  ASSERT_TRUE(in.ok());
  for (std::size_t e = 0; e < elements; ++e) EXPECT_EQ(file.sink.mesh.regions[e], e < 60 ? 49 : 51) << e;
  for (const auto& [name, left] : file.sets) EXPECT_TRUE(left.empty()) << name;
}

TEST(ReadTetGen, CommentsAttributesAndMarkers) {
  const std::string nodes =
      "# header\n5 3 2 1\n0 0 0 0 1.5 -2e3 7\n1 1 0 0 1 1 7 # comment\n\n2 0 1 0 0 0 7\n3 0 0 1 0 0 7\n4 1 1 1 0 0 7\n";
  const auto mesh = read_tetgen(nodes, "2 4 2\n0 0 1 2 3 -4 9\n1 1 2 3 4 0.5 9\n# end", "a.node", "a.ele");
  expect_two_tets(mesh, {-4, 0});
  ASSERT_EQ(mesh->notes.size(), 2u);
  EXPECT_EQ(mesh->notes[0], "attributes that are not whole numbers became region 0");
  EXPECT_EQ(mesh->notes[1], "vertex numbers start at 0");
}

TEST(ReadMesh, TellsTheFormatFromTheContent) {
  const TemporaryFolder folder;
  const auto real = data_dir() / "real";
  const std::vector<std::pair<std::filesystem::path, MeshFormat>> samples{
      {real / "msh/binary41-order2.msh", MeshFormat::msh},
      {real / "medit/order2.mesh", MeshFormat::medit},
      {real / "vtk/binary-order1.vtk", MeshFormat::vtk},
      {data_dir() / "vega/two_tets_from1.veg", MeshFormat::vega}};
  for (const auto& [path, format] : samples) {
    const std::string bytes = read_file(path).value();
    EXPECT_EQ(detect_mesh_format(bytes), format) << path;
    // Neither no extension nor a wrong one matters.
    for (const std::string name : {"copy", "copy.obj", "copy.ele", "copy.msh", "copy.vtk"}) {
      ASSERT_TRUE(write_file(folder / name, bytes));
      const auto mesh = read_mesh(folder / name);
      ASSERT_TRUE(mesh) << mesh.error().message();
      expect_same(*mesh, *read_mesh(path));
    }
  }
}

TEST(ReadMesh, CommaLocaleChangesNothing) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  bool found = false;
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "fr_FR"})
    found = found || std::setlocale(LC_ALL, name) != nullptr;
  if (!found) GTEST_SKIP() << "no locale with a decimal comma is installed";
  MeshData mesh = two_tets();
  mesh.positions[4] = {0.5, 1.25, -1e-3};
  const auto back = read_msh(format_msh(mesh, {22, false}).value(), "memory");
  std::setlocale(LC_ALL, before.c_str());
  ASSERT_TRUE(back);
  expect_same(mesh, *back);
}

}  // namespace
}  // namespace corotet

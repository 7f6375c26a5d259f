// Every malformed file gives the error that it should: no crash, no hang, no mesh.
#include <gtest/gtest.h>

#include <corotet/detail/mesh/io/read_mesh.hpp>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "mesh/mesh_files.hpp"

namespace corotet {
namespace {

using enum ErrorCode;

const std::map<std::string, ErrorCode> expected_codes{
    {"medit/binary.meshb", unsupported},
    {"medit/coordinate-nan.mesh", non_finite_value},
    {"medit/count-huge.mesh", malformed_file},
    {"medit/count-negative.mesh", malformed_file},
    {"medit/count-too-large.mesh", malformed_file},
    {"medit/count-too-small.mesh", malformed_file},
    {"medit/cut-in-tetrahedra.mesh", malformed_file},
    {"medit/cut-in-vertices.mesh", malformed_file},
    {"medit/dimension-2.mesh", unsupported},
    {"medit/keyword-wrong.mesh", malformed_file},
    {"medit/mixed-orders.mesh", unsupported},
    {"medit/reference-overflow.mesh", malformed_file},
    {"medit/tetrahedra-missing.mesh", empty_mesh},
    {"medit/version-missing.mesh", malformed_file},
    {"medit/vertex-number-out-of-range.mesh", index_out_of_range},
    {"medit/vertex-number-overflow.mesh", malformed_file},
    {"medit/vertex-number-zero.mesh", index_out_of_range},
    {"medit/vertices-missing.mesh", malformed_file},
    {"medit/vertices-twice.mesh", malformed_file},
    {"msh/binary22-coordinate-nan.msh", non_finite_value},
    {"msh/binary22-count-of-nodes-huge.msh", malformed_file},
    {"msh/binary22-cut-in-elements.msh", malformed_file},
    {"msh/binary22-cut-in-mark.msh", malformed_file},
    {"msh/binary22-cut-in-nodes.msh", malformed_file},
    {"msh/binary22-mark-of-other-endian.msh", malformed_file},
    {"msh/binary22-mark-wrong.msh", malformed_file},
    {"msh/binary22-run-negative.msh", malformed_file},
    {"msh/binary22-run-too-long.msh", malformed_file},
    {"msh/binary22-run-zero.msh", malformed_file},
    {"msh/binary22-said-to-be-text.msh", malformed_file},
    {"msh/binary22-type-unknown.msh", unsupported},
    {"msh/binary41-count-in-block-huge.msh", malformed_file},
    {"msh/binary41-count-in-block-too-small.msh", malformed_file},
    {"msh/binary41-count-of-blocks-huge.msh", malformed_file},
    {"msh/binary41-count-of-elements-too-large.msh", malformed_file},
    {"msh/binary41-count-of-nodes-huge.msh", malformed_file},
    {"msh/binary41-cut-in-elements.msh", malformed_file},
    {"msh/binary41-dimension-wrong.msh", malformed_file},
    {"msh/binary41-end-shifted.msh", malformed_file},
    {"msh/binary41-mark-of-other-endian.msh", malformed_file},
    {"msh/binary41-type-unknown.msh", unsupported},
    {"msh/coordinate-comma.msh", malformed_file},
    {"msh/coordinate-infinite.msh", non_finite_value},
    {"msh/coordinate-nan.msh", non_finite_value},
    {"msh/coordinate-word.msh", malformed_file},
    {"msh/count-of-elements-huge.msh", malformed_file},
    {"msh/count-of-nodes-fraction.msh", malformed_file},
    {"msh/count-of-nodes-huge.msh", malformed_file},
    {"msh/count-of-nodes-negative.msh", malformed_file},
    {"msh/count-of-nodes-overflow.msh", malformed_file},
    {"msh/count-of-nodes-too-small.msh", malformed_file},
    {"msh/count-of-tags-huge.msh", malformed_file},
    {"msh/count-of-tags-negative.msh", malformed_file},
    {"msh/cut-before-end.msh", malformed_file},
    {"msh/cut-in-elements.msh", malformed_file},
    {"msh/cut-in-nodes.msh", malformed_file},
    {"msh/cut-in-number.msh", malformed_file},
    {"msh/data-size-4.msh", unsupported},
    {"msh/elements-first.msh", malformed_file},
    {"msh/elements-missing.msh", malformed_file},
    {"msh/end-keyword-wrong.msh", malformed_file},
    {"msh/file-type-2.msh", malformed_file},
    {"msh/mixed-orders.msh", unsupported},
    {"msh/no-elements.msh", empty_mesh},
    {"msh/node-number-negative.msh", index_out_of_range},
    {"msh/node-number-overflow.msh", malformed_file},
    {"msh/node-number-twice.msh", malformed_file},
    {"msh/node-number-unknown.msh", index_out_of_range},
    {"msh/node-number-zero.msh", index_out_of_range},
    {"msh/nodes-missing.msh", malformed_file},
    {"msh/nodes-twice.msh", malformed_file},
    {"msh/only-triangles.msh", empty_mesh},
    {"msh/random-after-mark.msh", malformed_file},
    {"msh/section-name-missing.msh", malformed_file},
    {"msh/section-without-end.msh", malformed_file},
    {"msh/version-1.msh", unsupported},
    {"msh/version-missing.msh", malformed_file},
    {"msh/version-unknown.msh", unsupported},
    {"other/blank", unknown_format},
    {"other/empty", unknown_format},
    {"other/prose.msh", unknown_format},
    {"other/random-bytes", unknown_format},
    {"other/surface.obj", unknown_format},
    {"other/zeros", unknown_format},
    {"tetgen/coordinate-nan.ele", non_finite_value},
    {"tetgen/count-of-attributes-huge.ele", malformed_file},
    {"tetgen/count-of-attributes-negative.ele", malformed_file},
    {"tetgen/count-of-points-huge.ele", malformed_file},
    {"tetgen/count-of-points-negative.ele", malformed_file},
    {"tetgen/count-of-points-too-small.ele", malformed_file},
    {"tetgen/count-of-tetrahedra-huge.ele", malformed_file},
    {"tetgen/count-of-tetrahedra-too-small.ele", malformed_file},
    {"tetgen/cut-in-points.ele", malformed_file},
    {"tetgen/cut-in-tetrahedra.ele", malformed_file},
    {"tetgen/dimension-2.ele", unsupported},
    {"tetgen/ele-file-empty.ele", malformed_file},
    {"tetgen/ele-file-missing.node", file_not_found},
    {"tetgen/five-nodes-each.ele", unsupported},
    {"tetgen/no-tetrahedra.ele", empty_mesh},
    {"tetgen/node-file-empty.ele", malformed_file},
    {"tetgen/node-file-missing.ele", file_not_found},
    {"tetgen/number-out-of-order.ele", malformed_file},
    {"tetgen/numbers-from-2.ele", malformed_file},
    {"tetgen/only-comments.ele", malformed_file},
    {"tetgen/point-out-of-range.ele", index_out_of_range},
    {"tetgen/point-zero-of-numbers-from-1.ele", index_out_of_range},
    {"vega/coordinate-nan.veg", non_finite_value},
    {"vega/count-huge.veg", malformed_file},
    {"vega/count-negative.veg", malformed_file},
    {"vega/cubes.veg", unsupported},
    {"vega/cut-in-elements.veg", malformed_file},
    {"vega/element-vertex-out-of-range.veg", index_out_of_range},
    {"vega/elements-missing.veg", malformed_file},
    {"vega/elements-twice.veg", malformed_file},
    {"vega/include-elements.veg", unsupported},
    {"vega/include.veg", unsupported},
    {"vega/region-empty.veg", malformed_file},
    {"vega/set-element-out-of-range.veg", index_out_of_range},
    {"vega/set-unknown.veg", malformed_file},
    {"vega/text-before-section.veg", malformed_file},
    {"vega/vertex-number-gap.veg", malformed_file},
    {"vega/vertex-numbers-from-2.veg", malformed_file},
    {"vega/vertices-missing.veg", malformed_file},
    {"vega/vertices-of-dimension-2.veg", unsupported},
    {"vega/vertices-twice.veg", malformed_file},
    {"vtk/binary-cut-in-cells.vtk", malformed_file},
    {"vtk/binary-cut-in-points.vtk", malformed_file},
    {"vtk/binary-little-endian.vtk", malformed_file},
    {"vtk/binary-nan.vtk", non_finite_value},
    {"vtk/cell-of-three-points.vtk", malformed_file},
    {"vtk/cell-size-negative.vtk", malformed_file},
    {"vtk/cell-size-wrong.vtk", malformed_file},
    {"vtk/cell-types-missing.vtk", malformed_file},
    {"vtk/cell-types-too-few.vtk", malformed_file},
    {"vtk/coordinate-infinite.vtk", non_finite_value},
    {"vtk/count-of-cells-huge.vtk", unsupported},
    {"vtk/count-of-points-huge.vtk", malformed_file},
    {"vtk/cut-in-points.vtk", malformed_file},
    {"vtk/dataset-polydata.vtk", unsupported},
    {"vtk/field-huge.vtk", malformed_file},
    {"vtk/mixed-orders.vtk", unsupported},
    {"vtk/mode-missing.vtk", malformed_file},
    {"vtk/offsets-decreasing.vtk", malformed_file},
    {"vtk/offsets-negative.vtk", malformed_file},
    {"vtk/offsets-none.vtk", malformed_file},
    {"vtk/offsets-out-of-range.vtk", malformed_file},
    {"vtk/point-number-negative.vtk", index_out_of_range},
    {"vtk/point-number-out-of-range.vtk", index_out_of_range},
    {"vtk/points-missing.vtk", malformed_file},
    {"vtk/points-of-type-int.vtk", unsupported},
    {"vtk/section-unknown.vtk", malformed_file},
};

/// The files of tests/data/malformed that hold tetrahedral meshes; of TetGen's pairs the .ele file, where there is one.
std::set<std::string> corpus() {
  namespace fs = std::filesystem;
  const fs::path folder = data_dir() / "malformed";
  std::set<std::string> files;
  for (const std::string format : {"msh", "medit", "vtk", "vega", "tetgen", "other"}) {
    std::error_code code;
    for (fs::directory_iterator entry(folder / format, code), end; !code && entry != end; entry.increment(code)) {
      fs::path ele = entry->path();
      ele.replace_extension(".ele");
      const bool in_pair = entry->path().extension() == ".node" && fs::exists(ele, code);
      if (!in_pair) files.insert(format + "/" + entry->path().filename().string());
    }
    EXPECT_FALSE(code) << format << ": " << code.message();
  }
  return files;
}

TEST(ReadMalformed, EachFileGivesItsError) {
  for (const auto& [file, code] : expected_codes) {
    const auto result = read_mesh(data_dir() / "malformed" / file);
    ASSERT_FALSE(result) << file << " was read as a mesh";
    EXPECT_EQ(result.error().code, code) << file << ": " << result.error().message();
    // The place is in the file itself, or in the other one of a TetGen pair; the reason is more than a word.
    const std::string stem = std::filesystem::path(file).stem().string();
    EXPECT_NE(result.error().where.find(stem), std::string::npos) << result.error().message();
    EXPECT_GT(result.error().reason.size(), 8u) << file;
  }
}

TEST(ReadMalformed, MalformedContentIsPlacedByLineOrByte) {
  for (const auto& [file, code] : expected_codes) {
    if (code == file_not_found || code == unknown_format || code == empty_mesh || file == "medit/binary.meshb")
      continue;
    const std::string where = read_mesh(data_dir() / "malformed" / file).error().where;
    const std::size_t mark = where.find_last_of(":@");
    ASSERT_NE(mark, std::string::npos) << file << ": " << where;
    const std::string place = where.substr(mark + 1);
    EXPECT_TRUE(place.substr(0, 5) == "byte " || place.find_first_not_of("0123456789") == std::string::npos)
        << file << ": " << where;
  }
}

TEST(ReadMalformed, TableAndFolderAgree) {
  std::set<std::string> in_table;
  for (const auto& [file, code] : expected_codes) in_table.insert(file);
  EXPECT_EQ(in_table, corpus());
  EXPECT_GE(in_table.size(), 50u);
}

TEST(ReadMalformed, FolderAndMissingFile) {
  EXPECT_EQ(read_mesh(data_dir()).error().code, file_unreadable);
  EXPECT_EQ(read_mesh(data_dir() / "no-such-file.msh").error().code, file_not_found);
  EXPECT_EQ(read_mesh("/dev/zero").error().code, file_unreadable);
  EXPECT_EQ(read_mesh("").error().code, file_not_found);
  EXPECT_EQ(read_tetgen(data_dir() / "no-such-file.ele").error().code, file_not_found);
}

}  // namespace
}  // namespace corotet

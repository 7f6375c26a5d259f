#!/usr/bin/env python3
"""Makes the malformed meshes of this folder: each is a valid mesh with the one defect that its name tells.

The files are committed, this script says how they came about. Files found by fuzzing are not made here.
"""
import pathlib
import random
import struct

HERE = pathlib.Path(__file__).parent


def save(path, content):
    file = HERE / path
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(content if isinstance(content, bytes) else content.encode())


def swap(text, old, new):
    assert text.count(old) >= 1, (old, text)
    return text.replace(old, new, 1)


POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)]
TETS = [(1, 2, 3, 4), (2, 3, 4, 5)]

# gmsh 2.2, text
MSH2 = ("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n"
        + "".join(f"{i + 1} {x} {y} {z}\n" for i, (x, y, z) in enumerate(POINTS))
        + "$EndNodes\n$Elements\n2\n"
        + "".join(f"{i + 1} 4 2 7 1 {a} {b} {c} {d}\n" for i, (a, b, c, d) in enumerate(TETS))
        + "$EndElements\n")
save("msh/version-unknown.msh", swap(MSH2, "2.2", "9.9"))
save("msh/version-1.msh", "$NOD\n1\n1 0 0 0\n$ENDNOD\n$ELM\n0\n$ENDELM\n")
save("msh/version-missing.msh", MSH2[MSH2.index("$Nodes"):])
save("msh/file-type-2.msh", swap(MSH2, "2.2 0 8", "2.2 2 8"))
save("msh/data-size-4.msh", swap(MSH2, "2.2 0 8", "2.2 0 4"))
save("msh/nodes-missing.msh", MSH2[:MSH2.index("$Nodes")] + MSH2[MSH2.index("$Elements"):])
save("msh/nodes-twice.msh", swap(MSH2, "$Elements", MSH2[MSH2.index("$Nodes"):MSH2.index("$Elements")] + "$Elements"))
save("msh/elements-missing.msh", MSH2[:MSH2.index("$Elements")])
save("msh/elements-first.msh", MSH2[:MSH2.index("$Nodes")] + MSH2[MSH2.index("$Elements"):]
     + MSH2[MSH2.index("$Nodes"):MSH2.index("$Elements")])
save("msh/end-keyword-wrong.msh", swap(MSH2, "$EndNodes", "$EndNode"))
save("msh/section-without-end.msh", swap(MSH2, "$Nodes", "$Comments\n$Nodes"))
save("msh/section-name-missing.msh", swap(MSH2, "$Nodes", "Nodes"))
save("msh/cut-in-nodes.msh", MSH2[:MSH2.index("4 0 0 1")])
save("msh/cut-in-number.msh", MSH2[:MSH2.index("4 0 0 1") + 5])
save("msh/cut-in-elements.msh", MSH2[:MSH2.index("2 4 2 7") + 8])
save("msh/cut-before-end.msh", MSH2[:MSH2.index("$EndElements")])
save("msh/count-of-nodes-huge.msh", swap(MSH2, "$Nodes\n5", "$Nodes\n4000000000"))
save("msh/count-of-nodes-overflow.msh", swap(MSH2, "$Nodes\n5", "$Nodes\n99999999999999999999999"))
save("msh/count-of-nodes-negative.msh", swap(MSH2, "$Nodes\n5", "$Nodes\n-5"))
save("msh/count-of-nodes-fraction.msh", swap(MSH2, "$Nodes\n5", "$Nodes\n5.5"))
save("msh/count-of-nodes-too-small.msh", swap(MSH2, "$Nodes\n5", "$Nodes\n4"))
save("msh/count-of-elements-huge.msh", swap(MSH2, "$Elements\n2", "$Elements\n18446744073709551615"))
save("msh/count-of-tags-negative.msh", swap(MSH2, "1 4 2 7", "1 4 -2 7"))
save("msh/count-of-tags-huge.msh", swap(MSH2, "1 4 2 7", "1 4 2147483647 7"))
save("msh/coordinate-nan.msh", swap(MSH2, "4 0 0 1", "4 0 nan 1"))
save("msh/coordinate-infinite.msh", swap(MSH2, "4 0 0 1", "4 0 1e999 1"))
save("msh/coordinate-word.msh", swap(MSH2, "4 0 0 1", "4 0 zero 1"))
save("msh/coordinate-comma.msh", swap(MSH2, "4 0 0 1", "4 0 0,5 1"))
save("msh/node-number-twice.msh", swap(MSH2, "4 0 0 1", "3 0 0 1"))
save("msh/node-number-unknown.msh", swap(MSH2, "1 2 3 4\n", "1 2 3 44\n"))
save("msh/node-number-zero.msh", swap(MSH2, "1 2 3 4\n", "1 2 3 0\n"))
save("msh/node-number-negative.msh", swap(MSH2, "1 2 3 4\n", "1 2 3 -4\n"))
save("msh/node-number-overflow.msh", swap(MSH2, "1 2 3 4\n", "1 2 3 4294967297\n"))
save("msh/mixed-orders.msh", swap(MSH2, "2 4 2 7 1 2 3 4 5", "2 11 2 7 1 2 3 4 5 1 2 3 4 5 1"))
save("msh/only-triangles.msh", swap(swap(MSH2, "1 4 2 7 1 1 2 3 4", "1 2 2 7 1 1 2 3"),
                                    "2 4 2 7 1 2 3 4 5", "2 2 2 7 1 2 3 4"))
save("msh/no-elements.msh", MSH2[:MSH2.index("$Elements")] + "$Elements\n0\n$EndElements\n")
save("msh/random-after-mark.msh", b"$MeshFormat\n" + random.Random(1).randbytes(300))


# gmsh 2.2 and 4.1, binary
def msh2_binary(order, one=1, nodes=5, run=2, element_type=4, x=1.0):
    out = b"$MeshFormat\n2.2 1 8\n" + struct.pack(order + "i", one) + b"\n$EndMeshFormat\n$Nodes\n%d\n" % nodes
    for i, p in enumerate(POINTS):
        out += struct.pack(order + "i3d", i + 1, *[x * c for c in p])
    out += b"\n$EndNodes\n$Elements\n2\n" + struct.pack(order + "3i", element_type, run, 2)
    for i, tet in enumerate(TETS):
        out += struct.pack(order + "7i", i + 1, 7, 1, *tet)
    return out + b"\n$EndElements\n"


def msh4_binary(order, one=1, blocks=1, nodes=5, in_block=5, elements=2, element_type=4, dimension=3):
    out = b"$MeshFormat\n4.1 1 8\n" + struct.pack(order + "i", one) + b"\n$EndMeshFormat\n$Nodes\n"
    out += struct.pack(order + "4Q3iQ", blocks, nodes, 1, 5, dimension, 1, 0, in_block)
    out += struct.pack(order + "5Q", 1, 2, 3, 4, 5)
    for p in POINTS:
        out += struct.pack(order + "3d", *p)
    out += b"\n$EndNodes\n$Elements\n" + struct.pack(order + "4Q3iQ", 1, elements, 1, 2, 3, 1, element_type, 2)
    for i, tet in enumerate(TETS):
        out += struct.pack(order + "5Q", i + 1, *tet)
    return out + b"\n$EndElements\n"


BIN2, BIN4 = msh2_binary("<"), msh4_binary("<")
save("msh/binary22-mark-wrong.msh", msh2_binary("<", one=2))
save("msh/binary22-mark-of-other-endian.msh", msh2_binary("<", one=0x01000000))
save("msh/binary22-count-of-nodes-huge.msh", msh2_binary("<", nodes=4000000000))
save("msh/binary22-run-too-long.msh", msh2_binary("<", run=2147483647))
save("msh/binary22-run-negative.msh", msh2_binary("<", run=-1))
save("msh/binary22-run-zero.msh", msh2_binary("<", run=0))
save("msh/binary22-type-unknown.msh", msh2_binary("<", element_type=1234))
save("msh/binary22-coordinate-nan.msh", msh2_binary("<", x=float("nan")))
save("msh/binary22-cut-in-mark.msh", BIN2[:BIN2.index(b"8\n") + 4])
save("msh/binary22-cut-in-nodes.msh", BIN2[:BIN2.index(b"$Nodes") + 60])
save("msh/binary22-cut-in-elements.msh", BIN2[:-30])
save("msh/binary22-said-to-be-text.msh", BIN2.replace(b"2.2 1 8", b"2.2 0 8"))
save("msh/binary41-mark-of-other-endian.msh", msh4_binary("<", one=0x01000000))
save("msh/binary41-count-of-blocks-huge.msh", msh4_binary("<", blocks=2**63))
save("msh/binary41-count-of-nodes-huge.msh", msh4_binary("<", nodes=2**64 - 1))
save("msh/binary41-count-in-block-huge.msh", msh4_binary("<", in_block=2**61))
save("msh/binary41-count-in-block-too-small.msh", msh4_binary("<", in_block=4))
save("msh/binary41-count-of-elements-too-large.msh", msh4_binary("<", elements=3))
save("msh/binary41-type-unknown.msh", msh4_binary("<", element_type=-4))
save("msh/binary41-dimension-wrong.msh", msh4_binary("<", dimension=7))
save("msh/binary41-cut-in-elements.msh", BIN4[:-50])
save("msh/binary41-end-shifted.msh", BIN4.replace(b"\n$EndNodes", b"\0\0\n$EndNodes"))

# Medit
MEDIT = ("MeshVersionFormatted 2\nDimension 3\nVertices\n5\n" + "".join("%g %g %g 0\n" % p for p in POINTS)
         + "Tetrahedra\n2\n1 2 3 4 7\n2 3 4 5 7\nEnd\n")
save("medit/version-missing.mesh", "MeshVersionFormatted\n")
save("medit/dimension-2.mesh", swap(MEDIT, "Dimension 3", "Dimension 2"))
save("medit/vertices-missing.mesh", MEDIT[:MEDIT.index("Vertices")] + MEDIT[MEDIT.index("Tetra"):])
save("medit/vertices-twice.mesh", swap(MEDIT, "Tetra", "Vertices\n0\nTetra"))
save("medit/tetrahedra-missing.mesh", MEDIT[:MEDIT.index("Tetra")] + "End\n")
save("medit/count-huge.mesh", swap(MEDIT, "Vertices\n5", "Vertices\n4294967295"))
save("medit/count-negative.mesh", swap(MEDIT, "Tetrahedra\n2", "Tetrahedra\n-2"))
save("medit/count-too-small.mesh", swap(MEDIT, "Tetrahedra\n2", "Tetrahedra\n1"))
save("medit/count-too-large.mesh", swap(MEDIT, "Tetrahedra\n2", "Tetrahedra\n3"))
save("medit/cut-in-vertices.mesh", MEDIT[:MEDIT.index("0 0 1")])
save("medit/cut-in-tetrahedra.mesh", MEDIT[:MEDIT.index("2 3 4 5")])
save("medit/vertex-number-zero.mesh", swap(MEDIT, "1 2 3 4 7", "0 2 3 4 7"))
save("medit/vertex-number-out-of-range.mesh", swap(MEDIT, "1 2 3 4 7", "1 2 3 6 7"))
save("medit/vertex-number-overflow.mesh", swap(MEDIT, "1 2 3 4 7", "1 2 3 9223372036854775808 7"))
save("medit/reference-overflow.mesh", swap(MEDIT, "1 2 3 4 7", "1 2 3 4 3000000000"))
save("medit/coordinate-nan.mesh", swap(MEDIT, "0 0 1 0", "0 NaN 1 0"))
save("medit/mixed-orders.mesh", swap(MEDIT, "End", "TetrahedraP2\n1\n1 2 3 4 5 1 2 3 4 5 0\nEnd"))
save("medit/keyword-wrong.mesh", swap(MEDIT, "Vertices", "@Vertices"))
save("medit/binary.meshb", struct.pack("<4i", 1, 3, 3, 20))

# VTK
VTK = ("# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
       + "".join("%g %g %g\n" % p for p in POINTS)
       + "CELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\n")
VTK5 = swap(VTK[:VTK.index("CELLS")], "3.0", "5.1") + (
    "CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3 1 2 3 4\nCELL_TYPES 2\n10\n10\n")
VTKB = (b"# vtk DataFile Version 3.0\nx\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
        + b"".join(struct.pack(">3d", *p) for p in POINTS)
        + b"\nCELLS 2 10\n" + struct.pack(">10i", 4, 0, 1, 2, 3, 4, 1, 2, 3, 4)
        + b"\nCELL_TYPES 2\n" + struct.pack(">2i", 10, 10) + b"\n")
save("vtk/mode-missing.vtk", swap(VTK, "ASCII\n", ""))
save("vtk/dataset-polydata.vtk", swap(VTK, "UNSTRUCTURED_GRID", "POLYDATA"))
save("vtk/points-missing.vtk", VTK[:VTK.index("POINTS")] + VTK[VTK.index("CELLS"):])
save("vtk/points-of-type-int.vtk", swap(VTK, "double", "int"))
save("vtk/cell-types-missing.vtk", VTK[:VTK.index("CELL_TYPES")])
save("vtk/cell-types-too-few.vtk", swap(VTK, "CELL_TYPES 2\n10\n10\n", "CELL_TYPES 1\n10\n"))
save("vtk/cell-size-wrong.vtk", swap(VTK, "4 0 1 2 3", "3 0 1 2 3"))
save("vtk/cell-size-negative.vtk", swap(VTK, "4 0 1 2 3", "-4 0 1 2 3"))
save("vtk/cell-of-three-points.vtk", swap(VTK, "CELLS 2 10\n4 0 1 2 3", "CELLS 2 9\n3 0 1 2"))
save("vtk/point-number-out-of-range.vtk", swap(VTK, "4 0 1 2 3", "4 0 1 2 5"))
save("vtk/point-number-negative.vtk", swap(VTK, "4 0 1 2 3", "4 0 1 2 -1"))
save("vtk/count-of-points-huge.vtk", swap(VTK, "POINTS 5", "POINTS 3000000000"))
save("vtk/count-of-cells-huge.vtk", swap(VTK, "CELLS 2 10", "CELLS 2 4000000000"))
save("vtk/coordinate-infinite.vtk", swap(VTK, "1 1 1", "1 inf 1"))
save("vtk/mixed-orders.vtk", swap(swap(VTK, "CELLS 2 10\n4 0 1 2 3", "CELLS 2 16\n10 0 1 2 3 4 0 1 2 3 4"),
                                  "CELL_TYPES 2\n10", "CELL_TYPES 2\n24"))
save("vtk/section-unknown.vtk", swap(VTK, "CELLS 2", "SCALE 2"))
save("vtk/cut-in-points.vtk", VTK[:VTK.index("0 0 1")])
save("vtk/offsets-decreasing.vtk", swap(VTK5, "0 4 8", "0 8 4"))
save("vtk/offsets-out-of-range.vtk", swap(VTK5, "0 4 8", "0 4 9"))
save("vtk/offsets-negative.vtk", swap(VTK5, "0 4 8", "-4 0 4"))
save("vtk/offsets-none.vtk", swap(VTK5, "CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8", "CELLS 0 8\nOFFSETS vtktypeint64\n"))
save("vtk/field-huge.vtk", swap(VTK, "POINTS", "FIELD f 1\na 2147483647 2147483647 double\n1\nPOINTS"))
save("vtk/binary-cut-in-points.vtk", VTKB[:VTKB.index(b"double") + 50])
save("vtk/binary-cut-in-cells.vtk", VTKB[:VTKB.index(b"CELLS") + 30])
save("vtk/binary-little-endian.vtk", VTKB.replace(struct.pack(">10i", 4, 0, 1, 2, 3, 4, 1, 2, 3, 4),
                                                  struct.pack("<10i", 4, 0, 1, 2, 3, 4, 1, 2, 3, 4)))
save("vtk/binary-nan.vtk", VTKB.replace(struct.pack(">3d", 1, 1, 1), struct.pack(">3d", 1, float("nan"), 1)))

# Vega
VEGA = ("*VERTICES\n5 3 0 0\n" + "".join("%d %g %g %g\n" % (i + 1, *p) for i, p in enumerate(POINTS))
        + "*ELEMENTS\nTET\n2 4 0\n1 1 2 3 4\n2 2 3 4 5\n*SET s\n2\n*REGION\ns, soft\n")
save("vega/include.veg", "*VERTICES\n*INCLUDE points.node\n" + VEGA[VEGA.index("*ELEMENTS"):])
save("vega/include-elements.veg", swap(VEGA, "TET\n2 4 0", "TET\n*INCLUDE tets.ele\n2 4 0"))
save("vega/cubes.veg", swap(VEGA, "TET\n2 4", "CUBIC\n2 8"))
save("vega/vertices-missing.veg", VEGA[VEGA.index("*ELEMENTS"):])
save("vega/vertices-twice.veg", VEGA + VEGA)
save("vega/elements-missing.veg", VEGA[:VEGA.index("*ELEMENTS")])
save("vega/elements-twice.veg", VEGA + VEGA[VEGA.index("*ELEMENTS"):])
save("vega/vertices-of-dimension-2.veg", swap(VEGA, "5 3 0 0", "5 2 0 0"))
save("vega/count-huge.veg", swap(VEGA, "2 4 0", "4000000000 4 0"))
save("vega/count-negative.veg", swap(VEGA, "5 3 0 0", "-5 3 0 0"))
save("vega/vertex-number-gap.veg", swap(VEGA, "\n3 0 1 0", "\n7 0 1 0"))
save("vega/vertex-numbers-from-2.veg", swap(VEGA, "\n1 0 0 0", "\n2 0 0 0"))
save("vega/element-vertex-out-of-range.veg", swap(VEGA, "1 1 2 3 4", "1 1 2 3 9"))
save("vega/coordinate-nan.veg", swap(VEGA, "3 0 1 0", "3 0 nan 0"))
save("vega/set-unknown.veg", swap(VEGA, "s, soft", "t, soft"))
save("vega/set-element-out-of-range.veg", swap(VEGA, "*SET s\n2", "*SET s\n3"))
save("vega/region-empty.veg", swap(VEGA, "s, soft\n", ""))
save("vega/cut-in-elements.veg", VEGA[:VEGA.index("2 2 3 4 5") + 5])
save("vega/text-before-section.veg", swap(VEGA, "TET\n2 4 0\n1 1 2 3 4\n2 2 3 4 5\n", "TET\n1 4 0\n1 1 2 3 4\n2 2 3 4 5\n"))

# TetGen: pairs
NODE = "5 3 0 0\n" + "".join("%d %g %g %g\n" % (i + 1, *p) for i, p in enumerate(POINTS))
ELE = "2 4 1\n1 1 2 3 4 42\n2 2 3 4 5 42\n"


def pair(name, node, ele):
    if node is not None:
        save(f"tetgen/{name}.node", node)
    if ele is not None:
        save(f"tetgen/{name}.ele", ele)


pair("node-file-missing", None, ELE)
pair("ele-file-missing", NODE, None)
pair("node-file-empty", "", ELE)
pair("ele-file-empty", NODE, "")
pair("only-comments", "# nothing\n", ELE)
pair("dimension-2", swap(NODE, "5 3", "5 2"), ELE)
pair("count-of-points-huge", swap(NODE, "5 3", "4000000000 3"), ELE)
pair("count-of-points-negative", swap(NODE, "5 3", "-1 3"), ELE)
pair("count-of-points-too-small", swap(NODE, "5 3", "4 3"), ELE)
pair("count-of-tetrahedra-huge", NODE, swap(ELE, "2 4 1", "4000000000 4 1"))
pair("count-of-tetrahedra-too-small", NODE, swap(ELE, "2 4 1", "1 4 1"))
pair("count-of-attributes-huge", swap(NODE, "3 0 0", "3 2147483647 0"), ELE)
pair("count-of-attributes-negative", NODE, swap(ELE, "2 4 1", "2 4 -1"))
pair("numbers-from-2", NODE.replace("\n1 0", "\n2 0", 1), ELE)
pair("number-out-of-order", swap(NODE, "3 0 1 0", "5 0 1 0"), ELE)
pair("five-nodes-each", NODE, swap(ELE, "2 4 1", "2 5 1"))
pair("point-out-of-range", NODE, swap(ELE, "1 2 3 4 42", "1 2 3 6 42"))
pair("point-zero-of-numbers-from-1", NODE, swap(ELE, "1 2 3 4 42", "0 2 3 4 42"))
pair("cut-in-points", NODE[:-8], ELE)
pair("cut-in-tetrahedra", NODE, ELE[:-8])
pair("coordinate-nan", swap(NODE, "3 0 1 0", "3 0 nan 0"), ELE)
pair("no-tetrahedra", NODE, "0 4 0\n")

# No format at all
save("other/empty", b"")
save("other/blank", b" \n\t\n")
save("other/random-bytes", random.Random(2).randbytes(512))
save("other/zeros", bytes(256))
save("other/prose.msh", "This is a letter, not a mesh.\n")
save("other/surface.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")

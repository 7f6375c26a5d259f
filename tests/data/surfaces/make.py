#!/usr/bin/env python3
"""Writes the surface files in this folder and in ../malformed/surfaces: run it after a change, and commit the result.

Good files all hold the same box, 1 x 2 x 0.5, in the variants of each format. Bad ones are named for their defect.
"""
import math
import pathlib
import struct

here = pathlib.Path(__file__).resolve().parent
bad_folder = here.parent / "malformed" / "surfaces"

size = (1.0, 2.0, 0.5)
corners = [tuple(size[a] * (i >> a & 1) for a in range(3)) for i in range(8)]
quads = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
triangles = [t for q in quads for t in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))]


def outward(i):
    d = [corners[i][a] - size[a] / 2 for a in range(3)]
    length = math.sqrt(sum(x * x for x in d))
    return tuple(x / length for x in d)


def row(values):
    return " ".join(f"{v:.17g}" for v in values)


def save(folder, name, content):
    path = folder / name.split(".")[-1] / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content if isinstance(content, bytes) else content.encode())


def good(name, content):
    save(here, name, content)


def bad(name, content):
    save(bad_folder, name, content)


def faces(pattern, shift=1):
    return "".join("f " + " ".join(pattern.format(v=v + shift) for v in q) + "\n" for q in quads)


vertices = "".join(f"v {row(p)}\n" for p in corners)

# --- obj
good("plain.obj", vertices + faces("{v}"))
good("negative.obj", vertices + faces("{v}", -8))
good("forward.obj", faces("{v}") + vertices)
good("crlf.obj", (vertices + faces("{v}")).replace("\n", "\r\n"))
good("continued.obj", vertices.replace(" 2 ", " \\\n 2 ") + "g a \\\n b\n" + faces("{v}").replace(" ", " \\\n"))
good("agreeing_normals.obj", vertices + "".join(f"vn {row(outward(i))}\n" for i in range(8)) + faces("{v}//{v}"))
good("rich.obj",
     "# a comment\nmtllib box.mtl\no box\n" + vertices.replace("\n", " 1.0\n") + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
     + "vn 1 0 0\nvn 0 1 0\n\ng sides\nusemtl red\ns off\n"
     + "".join(f"f {' '.join(f'{v + 1}/{k + 1}/{n % 2 + 1}' for k, v in enumerate(q))} # face\n"
               for n, q in enumerate(quads)) + "l 1 2\np 3\n")
good("texture_only.obj", vertices + "vt 0 0\n" + faces("{v}/1"))

bad("index_zero.obj", vertices + "f 1 2 0\n")
bad("index_beyond.obj", vertices + "f 1 2 3\nf 1 2 9\nf 2 3 4\n")
bad("index_negative_beyond.obj", vertices + "f -1 -2 -9\n")
bad("index_overflow.obj", vertices + "f 1 2 99999999999999999999\n")
bad("index_not_an_integer.obj", vertices + "f 1 2 3.5\n")
bad("corner_with_three_slashes.obj", vertices + "f 1/1/1/1 2 3\n")
bad("normal_beyond.obj", vertices + "vn 0 0 1\nf 1//1 2//1 3//2\n")
bad("two_corners.obj", vertices + "f 1 2\n")
bad("not_a_number.obj", "v 0 zero 0\n")
bad("nan.obj", "v 0 nan 0\n")
bad("infinite.obj", "v 0 0 1e999\n")
bad("missing_coordinate.obj", "v 0 0\nv 1 0 0\n")
bad("unknown_keyword.obj", vertices + "face 1 2 3\n")
bad("no_faces.obj", vertices)
bad("only_degenerate_faces.obj", vertices + "f 1 1 2\n")

# --- stl


def ascii_stl(tris, name="box"):
    text = f"solid {name}\n"
    for t in tris:
        text += "  facet normal 0 0 0\n    outer loop\n"
        text += "".join(f"      vertex {row(corners[v])}\n" for v in t)
        text += "    endloop\n  endfacet\n"
    return text + f"endsolid {name}\n"


def binary_stl(header, tris, attribute=0):
    data = header.ljust(80, b"\0") + struct.pack("<I", len(tris))
    for t in tris:
        data += struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *corners[v]) for v in t)
        data += struct.pack("<H", attribute)
    return data


good("text.stl", ascii_stl(triangles))
good("text_upper_case.stl", ascii_stl(triangles, "facet").upper())
good("text_two_solids.stl", ascii_stl(triangles[:5]) + ascii_stl(triangles[5:], ""))
good("binary.stl", binary_stl(b"made by a test", triangles))
good("binary_called_solid.stl", binary_stl(b"solid box", triangles, 0x7C00))
good("binary_blank_header.stl", binary_stl(b"solid".ljust(80), triangles))
good("binary_with_trailer.stl", binary_stl(b"", triangles) + b"trailer")

bad("binary_truncated.stl", binary_stl(b"", triangles)[:-20])
bad("binary_called_solid_truncated.stl", binary_stl(b"solid", triangles)[:-1])
bad("binary_announces_too_many.stl", b"x".ljust(80, b"\0") + struct.pack("<I", 0xFFFFFFFF) + bytes(50))
bad("binary_header_only.stl", bytes(60))
bad("binary_nan.stl", binary_stl(b"", triangles[:1])[:96] + struct.pack("<f", math.nan)
    + binary_stl(b"", triangles[:1])[100:])
bad("binary_no_triangles.stl", binary_stl(b"", []))
bad("text_truncated.stl", ascii_stl(triangles)[:400])
bad("text_four_vertices.stl", ascii_stl(triangles).replace("endloop", "vertex 1 1 1\nendloop"))
bad("text_two_coordinates.stl", ascii_stl([]).replace(
    "endsolid", "facet normal 0 0 1\nouter loop\nvertex 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid"))
bad("text_infinite.stl", ascii_stl(triangles).replace("vertex 1 ", "vertex inf ", 1))
bad("text_no_triangles.stl", ascii_stl([]))
bad("text_two_solids_garbage_between.stl", ascii_stl(triangles) + "liquid\n" + ascii_stl(triangles))

# --- ply


def ply_head(form, *elements):
    return f"ply\nformat {form} 1.0\ncomment made by a test\n" + "".join(e + "\n" for e in elements) + "end_header\n"


float_vertex = "element vertex 8\nproperty float x\nproperty float y\nproperty float z"
quad_face = "element face 6\nproperty list uchar int vertex_indices"
text_vertices = "".join(row(p) + "\n" for p in corners)
text_faces = "".join("4 " + " ".join(map(str, q)) + "\n" for q in quads)
good("text.ply", ply_head("ascii", float_vertex, quad_face) + text_vertices + text_faces)
good("text_crlf.ply", (ply_head("ascii", float_vertex, quad_face) + text_vertices + text_faces).replace("\n", "\r\n"))
good("text_faces_first.ply", ply_head("ascii", quad_face, float_vertex) + text_faces + text_vertices)
good("text_normals.ply",
     ply_head("ascii", "element vertex 8\nproperty double nx\nproperty double x\nproperty double ny\n"
              "property double y\nproperty double z\nproperty double nz", quad_face)
     + "".join(row((outward(i)[0], p[0], outward(i)[1], p[1], p[2], outward(i)[2])) + "\n"
               for i, p in enumerate(corners)) + text_faces)
for name, form, mark in (("binary_little.ply", "binary_little_endian", "<"), ("binary_big.ply", "binary_big_endian", ">")):
    body = b"".join(struct.pack(mark + "3f", *p) for p in corners)
    body += b"".join(struct.pack(mark + "B4i", 4, *q) for q in quads)
    good(name, ply_head(form, float_vertex, quad_face).encode() + body)
    # Other types, other order, and properties and elements that must be skipped.
    rich = ply_head(form, "element material 2\nproperty list ushort float spectrum\nproperty char kind",
                    "element vertex 8\nproperty uchar red\nproperty float64 z\nproperty list uint8 int16 tags\n"
                    "property int8 x\nproperty float32 confidence\nproperty uint32 y",
                    "element face 12\nproperty short flags\nproperty list uint uint16 vertex_index\nproperty list char "
                    "double weights", "element edge 0").encode()
    rich += struct.pack(mark + "H2fb", 2, 0.5, math.nan, -1) + struct.pack(mark + "Hb", 0, 3)
    for i, p in enumerate(corners):
        rich += struct.pack(mark + "Bd", 200, p[2]) + struct.pack(mark + f"B{i % 3}h", i % 3, *range(i % 3))
        rich += struct.pack(mark + "bfI", int(p[0]), math.nan, int(p[1]))
    for t in triangles:
        rich += struct.pack(mark + "hI3H", -5, 3, *t) + struct.pack(mark + "bd", 1, 0.25)
    good("rich_" + name, rich)

bad("no_end_header.ply", ply_head("ascii", float_vertex, quad_face).replace("end_header\n", ""))
bad("no_format.ply", ply_head("ascii", float_vertex, quad_face).replace("format ascii 1.0\n", ""))
bad("unknown_format.ply", ply_head("utf8", float_vertex, quad_face))
bad("future_version.ply", ply_head("ascii", float_vertex, quad_face).replace("1.0", "2.0"))
bad("unknown_type.ply", ply_head("ascii", float_vertex.replace("float y", "quad y"), quad_face))
bad("unknown_header_keyword.ply", ply_head("ascii", float_vertex, quad_face, "colour red"))
bad("real_list_length.ply", ply_head("ascii", float_vertex, quad_face.replace("uchar", "float")) + text_vertices)
bad("real_indices.ply", ply_head("ascii", float_vertex, quad_face.replace("int", "float")) + text_vertices + text_faces)
bad("property_before_element.ply", ply_head("ascii", "property float x", float_vertex, quad_face))
bad("second_vertex_element.ply", ply_head("ascii", float_vertex, float_vertex, quad_face))
bad("announces_too_many.ply", ply_head("ascii", float_vertex.replace("8", "2000000000"), quad_face) + text_vertices)
bad("announces_more_than_64_bits.ply", ply_head("ascii", float_vertex.replace("8", "9" * 30), quad_face))
bad("announces_minus_one.ply", ply_head("ascii", float_vertex.replace("8", "-1"), quad_face))
bad("binary_announces_too_many.ply",
    ply_head("binary_little_endian", float_vertex.replace("8", "9000000000000000000"), quad_face).encode() + bytes(99))
bad("element_without_properties.ply", ply_head("ascii", "element void 9000000000000000000", float_vertex, quad_face)
    + text_vertices + text_faces)
bad("no_vertex_element.ply", ply_head("ascii", quad_face) + text_faces)
bad("vertices_without_z.ply", ply_head("ascii", float_vertex.replace(" z", " w"), quad_face) + text_vertices)
bad("z_is_a_list.ply", ply_head("ascii", float_vertex.replace("float z", "list uchar float z"), quad_face)
    + text_vertices)
bad("faces_without_indices.ply", ply_head("ascii", float_vertex, quad_face.replace("vertex_indices", "v"))
    + text_vertices + text_faces)
bad("index_beyond.ply", ply_head("ascii", float_vertex, quad_face) + text_vertices + text_faces.replace("7", "8"))
bad("index_negative.ply", ply_head("ascii", float_vertex, quad_face) + text_vertices + text_faces.replace("7", "-1"))
bad("list_length_negative.ply", ply_head("ascii", float_vertex, quad_face.replace("uchar", "char")) + text_vertices
    + "-4 0 1 2 3\n" * 6)
bad("list_longer_than_file.ply",
    ply_head("binary_little_endian", float_vertex, quad_face.replace("6", "1").replace("uchar", "uint")).encode()
    + struct.pack("<24f", *[x for p in corners for x in p]) + struct.pack("<I3i", 0xFFFFFFFF, 0, 1, 2))
bad("two_corners.ply", ply_head("ascii", float_vertex, quad_face) + text_vertices + "2 0 1\n" * 6)
bad("nan.ply", ply_head("binary_big_endian", float_vertex, quad_face).encode() + struct.pack(">24f", *[math.nan] * 24)
    + bytes(102))
bad("truncated.ply", (ply_head("ascii", float_vertex, quad_face) + text_vertices + text_faces)[:-8])
bad("binary_truncated.ply", ply_head("binary_little_endian", float_vertex, quad_face).encode()
    + struct.pack("<24f", *[x for p in corners for x in p]) + struct.pack("<B4i", 4, 0, 4, 6, 2) * 5 + b"\4\0\0\0" * 4)
bad("triangle_strips.ply", ply_head("ascii", float_vertex, "element tristrips 1\nproperty list int int vertex_indices")
    + text_vertices + "4 0 1 2 3\n")
bad("point_cloud.ply", ply_head("ascii", float_vertex) + text_vertices)

# --- off
off_body = "8 6 12\n" + text_vertices + text_faces
good("plain.off", "OFF\n" + off_body)
good("counts_on_first_line.off", "OFF " + off_body)
good("comments.off", "# before\nOFF # behind\n\n# between\n8 6 0 # counts\n" + text_vertices.replace("\n", " # v\n")
     + "\n" + text_faces.replace("\n", " 255 0 0\n"))
good("colours.off", "COFF\n8 6 12\n" + text_vertices.replace("\n", " 255 128 0 255\n") + text_faces)
good("normals.off", "NOFF\n8 6 12\n" + "".join(row(p + outward(i)) + "\n" for i, p in enumerate(corners)) + text_faces)

bad("counts_missing.off", "OFF\n")
bad("announces_too_many_vertices.off", "OFF\n" + off_body.replace("8 6", "2000000000 6", 1))
bad("announces_too_many_faces.off", "OFF\n" + off_body.replace("8 6", "8 2000000000", 1))
bad("announces_minus_one.off", "OFF\n" + off_body.replace("8 6", "-1 6", 1))
bad("index_beyond.off", "OFF\n" + off_body.replace(" 7", " 8"))
bad("face_longer_than_file.off", "OFF\n" + off_body.replace("4 0 4 6 2", "1000000000 0 4 6 2"))
bad("one_corner.off", "OFF\n" + off_body.replace("4 0 4 6 2", "1 0 4 6 2"))
bad("truncated.off", "OFF\n" + off_body[:-6])
bad("infinite.off", "OFF\n" + off_body.replace("0.5", "inf"))
bad("four_dimensions.off", "4OFF\n" + off_body)
bad("binary.off", b"OFF BINARY\n" + bytes(40))
bad("no_vertices.off", "OFF\n0 0 0\n")

# --- none of them
bad("empty.txt", "")
bad("prose.txt", "Dear reader,\nthis is not a surface.\n")
bad("zeros.txt", bytes(200))
bad("tetrahedra.txt", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n")

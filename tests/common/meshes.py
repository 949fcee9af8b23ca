"""meshes.py - written meshes read back, by code of the tests' own

Readers give the points, the triangles as numbers of points, and the three types of a point's coordinates, as struct
names them.
"""
import ast
import base64
import json
import math
import re
import struct
import zipfile
from typing import NamedTuple


class Ply(NamedTuple):
    names: list  # of the properties of vertices
    layout: str  # their types, as struct names them
    rows: list  # of each vertex, its values
    triangles: list
    labels: list  # of each triangle, two; empty where the file has none


def ply_read(path):
    """A binary PLY file, which ends where its last triangle does."""
    with open(path, "rb") as f:
        head, body = f.read().split(b"end_header\n", 1)
    lines = [line.split() for line in head.decode().splitlines()]
    vertices, faces = (int(words[2]) for words in lines if words[0] == "element")
    elements = [n for n, words in enumerate(lines) if words[0] == "element"]
    properties = [words[1:] for words in lines[:elements[1]] if words[0] == "property"]
    of_faces = [words[1:] for words in lines[elements[1]:] if words[0] == "property"]
    assert of_faces[0] == ["list", "uchar", "uint", "vertex_indices"]
    assert of_faces[1:] in ([], [["uint", "boundary_labels_0"], ["uint", "boundary_labels_1"]])
    step = 13 + 4 * len(of_faces[1:])
    layout = "".join({"float": "f", "double": "d"}[kind] for kind, _ in properties)
    size = struct.calcsize("<" + layout)
    rows = [struct.unpack_from("<" + layout, body, n * size) for n in range(vertices)]
    triangles = [struct.unpack_from("<3I", body, vertices * size + step * n + 1) for n in range(faces)]
    labels = [struct.unpack_from("<2I", body, vertices * size + step * n + 13) for n in range(faces) if step > 13]
    assert len(body) == vertices * size + step * faces
    return Ply([name for _, name in properties], layout, rows, triangles, labels)


def ply_vertices(path):
    """(the values of each vertex by their names, triangles)"""
    ply = ply_read(path)
    return [dict(zip(ply.names, row)) for row in ply.rows], ply.triangles


def read_ply(path):
    ply = ply_read(path)
    return [row[:3] for row in ply.rows], ply.triangles, ply.layout[:3]


def read_vtp(path):
    with open(path, "rb") as f:
        content = f.read()
    appended = content.index(b"_", content.index(b"<AppendedData")) + 1
    header = content[:appended].decode("latin-1")

    def array(name):
        element = next(e for e in re.findall(r"<DataArray[^>]*>", header) if f'Name="{name}"' in e)
        at = appended + int(re.search(r'offset="(\d+)"', element)[1])
        kind = re.search(r'type="(\w+)"', element)[1]
        code = {"Float32": "f", "Float64": "d", "Int32": "i", "Int64": "q"}[kind]
        size = struct.unpack_from("<Q", content, at)[0]
        return struct.unpack_from(f"<{size // struct.calcsize(code)}{code}", content, at + 8), code
    flat, code = array("Points")
    corners = array("connectivity")[0]
    return list(zip(*[iter(flat)] * 3)), list(zip(*[iter(corners)] * 3)), code * 3


def read_obj(path):
    points, faces = [], []
    with open(path, encoding="ascii") as f:
        for line in f:
            word, *rest = line.split()
            if word == "v":
                points.append(tuple(map(float, rest)))
            elif word == "f":
                faces.append(tuple(int(corner.split("/")[0]) - 1 for corner in rest))
    return points, faces, "ddd"


def read_stl(path):
    with open(path, "rb") as f:
        content = f.read()
    count = struct.unpack_from("<I", content, 80)[0]
    points = []
    for n in range(count):
        values = struct.unpack_from("<12f", content, 84 + 50 * n)
        points += [values[3:6], values[6:9], values[9:12]]
    return points, [(3 * n, 3 * n + 1, 3 * n + 2) for n in range(count)], "fff"


def read_off(path):
    with open(path, encoding="ascii") as f:
        words = f.read().split()
    vertices, faces = int(words[1]), int(words[2])
    numbers, corners = words[4:4 + 3 * vertices], words[4 + 3 * vertices:]
    assert words[0] == "OFF" and len(corners) == 4 * faces and set(corners[::4]) <= {"3"}
    return (list(zip(*[iter(map(float, numbers))] * 3)),
            [tuple(map(int, corners[n + 1:n + 4])) for n in range(0, len(corners), 4)], "ddd")


def glb_parts(path):
    """(what its JSON describes, its binary chunk)"""
    with open(path, "rb") as f:
        content = f.read()
    magic, version, length, json_bytes, json_kind = struct.unpack_from("<4sIII4s", content)
    assert (magic, version, length, json_kind, json_bytes % 4) == (b"glTF", 2, len(content), b"JSON", 0)
    rest = content[20 + json_bytes:]
    if rest:
        assert struct.unpack_from("<I4s", rest) == (len(rest) - 8, b"BIN\0") and len(rest) % 4 == 0
    return json.loads(content[20:20 + json_bytes]), rest[8:]


def read_glb(path):
    description, binary = glb_parts(path)
    if not binary:
        return [], [], "fff"
    primitives = description["meshes"][0]["primitives"]

    def numbers(accessor, code, width):
        a = description["accessors"][accessor]
        start = description["bufferViews"][a["bufferView"]]["byteOffset"] + a.get("byteOffset", 0)
        return struct.unpack_from(f"<{width * a['count']}{code}", binary, start)
    [points] = {numbers(primitive["attributes"]["POSITION"], "f", 3) for primitive in primitives}
    corners = [corner for primitive in primitives for corner in numbers(primitive["indices"], "I", 1)]
    return list(zip(*[iter(points)] * 3)), list(zip(*[iter(corners)] * 3)), "fff"


def npz_arrays(path):
    """Type, shape and values of each array, in the order of the file; zipfile looks at their check sums."""
    arrays = {}
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        for name in archive.namelist():
            content = archive.read(name)
            length = struct.unpack_from("<H", content, 8)[0]
            header = ast.literal_eval(content[10:10 + length].decode())
            assert name.endswith(".npy") and content[:8] == b"\x93NUMPY\1\0" and (10 + length) % 64 == 0
            assert not header["fortran_order"]
            code = {"<f4": "f", "<f8": "d", "<u4": "I"}[header["descr"]]
            values = struct.unpack_from(f"<{math.prod(header['shape'])}{code}", content, 10 + length)
            assert len(content) == 10 + length + struct.calcsize(code) * len(values)
            arrays[name[:-4]] = (header["descr"], header["shape"], values)
    return arrays


def read_npz(path):
    arrays = npz_arrays(path)
    return (list(zip(*[iter(arrays["vertices"][2])] * 3)), list(zip(*[iter(arrays["faces"][2])] * 3)),
            {"<f4": "fff", "<f8": "ddd"}[arrays["vertices"][0]])


def html_scripts(path):
    """What the page's scripts hold that have names: the object about the mesh, and arrays as bytes."""
    with open(path, encoding="utf-8") as f:
        found = re.findall(r'<script type="([a-z/]+)" id="(\w+)">([^<]*)</script>\n', f.read())
    return {name: json.loads(text) if kind == "application/json" else base64.b64decode(text, validate=True)
            for kind, name, text in found}


def read_html(path):
    scripts = html_scripts(path)
    points, corners = (struct.unpack(f"<{len(scripts[name]) // 4}{code}", scripts[name])
                       for name, code in (("positions", "f"), ("triangles", "I")))
    assert (len(points), len(corners)) == (3 * scripts["mesh"]["vertices"], 3 * scripts["mesh"]["triangles"])
    assert scripts["mesh"]["normals"] == ("normals" in scripts)
    return list(zip(*[iter(points)] * 3)), list(zip(*[iter(corners)] * 3)), "fff"


def read_labels(path):
    """The two labels of each triangle, of PLY, VTP, NPZ or HTML."""
    if path.endswith(".html"):
        return [(inner, outer) for inner, outer, count in html_scripts(path)["mesh"]["pairs"] for _ in range(count)]
    if path.endswith(".ply"):
        return ply_read(path).labels
    if path.endswith(".npz"):
        return list(zip(*[iter(npz_arrays(path)["boundary_labels"][2])] * 2))
    with open(path, "rb") as f:
        content = f.read()
    appended = content.index(b"_", content.index(b"<AppendedData")) + 1
    element = re.search(rb'<CellData Scalars="BoundaryLabels">\s*<DataArray type="UInt32" Name="BoundaryLabels" '
                        rb'NumberOfComponents="2" format="appended" offset="(\d+)"', content)
    at = appended + int(element[1])
    count = struct.unpack_from("<Q", content, at)[0] // 4
    return list(zip(*[iter(struct.unpack_from(f"<{count}I", content, at + 8))] * 2))


READERS = {"ply": read_ply, "vtp": read_vtp, "obj": read_obj, "stl": read_stl, "off": read_off, "glb": read_glb,
           "npz": read_npz, "html": read_html}


def measures(points, faces, at=(0, 0, 0)):
    """Area, and volume of the cone to `at`."""
    area = volume = 0
    for face in faces:
        a, b, c = ([points[v][axis] - at[axis] for axis in range(3)] for v in face)
        u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
        n = [u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3] for k in range(3)]
        area += math.hypot(*n) / 2
        volume += sum(n[k] * a[k] for k in range(3)) / 6
    return area, volume

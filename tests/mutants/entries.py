"""entries.py - a mutant for every entry of the tables of cases and splits

An entry becomes the next of the values that it could have: a corner of a cube the next corner, after the last the
first.
"""
import re

from mutant import Mutant

EDGE_TYPES = ["EDGE_X", "EDGE_Y", "EDGE_Z", "EDGE_XY", "EDGE_XZ", "EDGE_YZ"]
CORNER_COUNT = 2  # of a cell_type, its third member
SHAPES = ["CELL_FLAT", "CELL_OTHER", "CELL_TETRAHEDRON", "CELL_HEXAHEDRON", "CELL_WEDGE", "CELL_PYRAMID",
          "CELL_PENTAGONAL_PRISM", "CELL_HEXAGONAL_PRISM", "CELL_POLYHEDRON"]
UNREAD = ("CELL_FLAT", "CELL_OTHER", "CELL_POLYHEDRON")  # of which a row has nothing else that is read


def counting(limit):
    return lambda path, entry: str((int(entry) + 1) % limit)


def case_entry(path, entry):
    """A number of triangles, or an edge of a tetrahedron."""
    return str((int(entry) + 1) % (3 if len(path) == 2 else 6))


def owned_edge_entry(path, entry):
    names = EDGE_TYPES if entry in EDGE_TYPES else ["0", "1"]
    return names[(names.index(entry) + 1) % len(names)]


def cell_type_entry(path, entry):
    """A shape, a flag, a corner, or a number of corners or points."""
    if entry in SHAPES:
        return SHAPES[(SHAPES.index(entry) + 1) % len(SHAPES)]
    if entry in ("true", "false"):
        return "false" if entry == "true" else "true"
    if len(path) == 2:  # with one more, the first would be looked at again
        return str(int(entry) - 1 if path[1] == CORNER_COUNT else int(entry) + 1)
    return str((int(entry) + 1) % 8)


# Of a file: how a table begins, how its entries are changed.
TABLES = {
    "host/lib/tables/tables.c": [("tetrahedron_corners[2][TETRAHEDRA_PER_CUBE][4] = ", counting(8)),
                          ("tetrahedron_edges[6][2] = ", counting(4)),
                          ("tetrahedron_cases[16] = ", case_entry),
                          ("cube_edges[CUBE_EDGES] = ", owned_edge_entry),
                          ("type_of_axes[8] = ", owned_edge_entry)],
    "host/lib/reference/reference.c": [("edge_axes[EDGES_PER_SAMPLE] = ", counting(8))],
    "host/lib/tables/cell_split.c": [("#define HEXAHEDRON ", counting(8)), ("#define VOXEL      ", counting(8)),
                              ("#define WEDGE      ", counting(6)), ("#define WEDGE_UP   ", counting(6)),
                              ("#define PRISM_5    ", counting(10)), ("#define PRISM_6    ", counting(12)),
                              ("hexahedron_faces[6][4] = ", counting(8)), ("wedge_faces[3][4] = ", counting(6)),
                              ("wedge_ends[2][3] = ", counting(6)), ("hexahedron_opposite[8] = ", counting(8)),
                              ("pyramid_base[4] = ", counting(4)), ("cell_type types[] = ", cell_type_entry)],
    "host/check/complex_check.c": [("face_corners[4][3] = ", counting(4))],
}

# Entries that nothing reads, or that mean the same, by their names: why.
SAME = {}

# For the quick run.
SAMPLE = ("tetrahedron_cases[5][1][1][2]",)

# A string, a comment, a designator, a brace, a comma; else an entry.
TOKEN = re.compile(r'"[^"]*"|/\*.*?\*/|\[(\w+)\] = |[{},]|\w+|\s+|.', re.S)


def entries_of(text, start):
    """Place, path and text of every entry of the initialiser that begins at start."""
    path, at = [], start
    while at < len(text):
        token = TOKEN.match(text, at)
        word = token.group()
        if word == "{":
            path.append(0)
        elif word == "}":
            path.pop()
            if not path:
                return
        elif word == ",":
            path[-1] += 1
        elif token.group(1) is not None:
            path[-1] = int(token.group(1))
        elif re.fullmatch(r"\w+", word):
            yield at, tuple(path), word
        at = token.end()


def mutants(file, text, tables):
    for beginning, change in tables:
        start = text.find(beginning)
        if start < 0 or text.count(beginning) != 1:
            raise ValueError(f"{file}: no table begins with {beginning!r}")
        name = re.sub(r"#define |cell_type |\[.*| *= *$", "", beginning).strip()
        shape = None  # of the row of types[]
        for at, path, entry in entries_of(text, start + len(beginning)):
            shape = entry if entry in SHAPES else shape
            if entry.startswith(("HEXAHEDRON", "VOXEL", "WEDGE", "PRISM")) or (entry != shape and shape in UNREAD):
                continue
            what = name + "".join(f"[{n}]" for n in path)
            yield Mutant(file, entry, change(path, entry), what, at=at, same=SAME.get(what), sample=what in SAMPLE)

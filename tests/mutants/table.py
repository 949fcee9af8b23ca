"""table.py - tests, and by whom each file's faults are looked for"""
import collections
import subprocess

import table_check_files
import table_faults
import table_host
import table_kernels

# A program of tests/ with arguments; only: what it chooses of its cases (expect.h); libraries: below tests/, which stand
# behind the tool in the arguments of a test in Python. Without a device it makes use of the reference alone.


class TableError(Exception):
    """The table of mutants does not fit the source."""


Test = collections.namedtuple("Test", "program arguments only device libraries")


def test(program, only="", arguments=(), device=False, libraries=()):
    return Test(program, arguments, only, device, libraries)


TESTS = {
    "test_tables": test("test_tables"),
    "test_hybrid_tables": test("test_hybrid_tables"),
    "test_inside": test("test_inside"),
    "test_tetrahedralize": test("test_tetrahedralize"),
    "test_polyhedra": test("test_polyhedra"),
    "test_check": test("test_check"),
    "test_check_blocks": test("test_check_blocks"),
    "test_complex_check": test("test_complex_check"),
    "test_repair": test("test_repair"),
    "test_write_vtk": test("test_write_vtk"),
    "test_write_vtk_wide": test("test_write_vtk_wide"),
    "test_write": test("test_write"),
    "test_dataset": test("test_dataset"),
    "test_read": test("test_read"),
    "test_read_lenient": test("test_read_lenient"),
    "test_vtk_xml": test("test_vtk_xml"),
    "test_vtk_legacy": test("test_vtk_legacy"),
    "test_plot3d": test("test_plot3d"),
    "test_vtk_xml_hostile": test("test_vtk_xml_hostile"),
    "test_read_hostile": test("test_read_hostile"),
    "test_limits": test("fuzz/test_limits"),
    "test_api, reference": test("test_api"),
    "test_patterns, reference": test("test_patterns"),
    "test_random, reference": test("test_random"),
    "test_rare, reference": test("test_rare"),
    "test_curvilinear, reference": test("test_curvilinear"),
    "test_complex, reference": test("test_complex"),
    "test_far, reference": test("test_far"),
    "test_hybrid, reference": test("test_hybrid"),
    "test_patterns": test("test_patterns", device=True),
    "test_random, u8": test("test_random", "* u8, *nodata 0 *normals 0", device=True),
    "test_rare, alternating": test("test_rare", "alternating*", device=True),
    "test_rare, one sample": test("test_rare", "one sample*", device=True),
    "test_rare, slopes": test("test_rare", "slope*", device=True),
    "test_rare, zeros": test("test_rare", "*zeros missing", device=True),
    "test_rare, not finite": test("test_rare", "not finite*", device=True),
    "test_again, u8": test("test_again", "u8, 1 work-items", device=True),
    "test_again, u8 in slabs": test("test_again", "u8, 1 work-items, slabs", device=True),
    "test_again, f32 with missing": test("test_again", "f32 with missing, 1 work-items", device=True),
    "test_device, tiles": test("test_device", "1 work-items*division 0", device=True),
    "test_device, slabs": test("test_device", "gentle waves", device=True),
    "test_device, copied slabs": test("test_device", "gentle waves", ("always_copy",), device=True),
    "test_device, slabs with missing": test("test_device", "gentle waves with missing samples", device=True),
    "test_device, world space": test("test_device", "world space", device=True),
    "test_random, u8 with missing": test("test_random", "* u8, *nodata 1*", device=True),
    "test_random, f32 with normals": test("test_random", "* f32, *normals 1", device=True),
    "test_random, f32": test("test_random", "* f32, *normals 0", device=True),
    "test_random, f64": test("test_random", "* f64, *", device=True),
    "test_random, i32": test("test_random", "* i32, *nodata 0 *", device=True),
    "test_random, i8": test("test_random", "* i8, *nodata 0 *", device=True),
    "test_device, division 3": test("test_device", "*division 3", device=True),
    "test_device, division 2": test("test_device", "*division 2", device=True),
    "test_curvilinear, points": test("test_curvilinear", "f32 points*, one work-item", device=True),
    "test_curvilinear, u8 points": test("test_curvilinear", "u8 points*, one work-item", device=True),
    "test_curvilinear, axes": test("test_curvilinear", "f32 axes*, one work-item", device=True),
    "test_hybrid, u8": test("test_hybrid", "* u8, *complete", device=True),
    "test_complex_slabs": test("test_complex_slabs", device=True),
    "test_complex, u8": test("test_complex", "*u8*, context [12]", device=True),
    "test_complex, scattered": test("test_complex", "scattered*, context 1", device=True),
    "test_complex, refusals": test("test_complex", "refusals", device=True),
    "test_complex, f32": test("test_complex", "*f32*, context 1", device=True),
    "test_memory, missing in slabs": test("layer/test_memory", "slabs, missing samples", device=True),
    "test_memory, starved groups": test("layer/test_memory", "starved groups", device=True),
    "test_memory, counted again": test("layer/test_memory", "clusters counted again", device=True),
    "test_device, 64 work-items": test("test_device", "64 work-items*", device=True),
    "test_complex, 64 work-items": test("test_complex", "*u8*, context 4", device=True),

    "test_cli_grids, carry": test("test_cli_grids.py", "*test_carry*", ("reference",)),
    "test_cli": test("test_cli.py", "", ("reference",)),
    "test_results": test("test_results.py", "", ("reference",)),
    "test_nodata": test("test_nodata"),
    "test_cli_images": test("test_cli_images.py"),
}

TABLES = ["test_tables", "test_hybrid_tables", "test_patterns, reference"]
REFERENCE = ["test_patterns, reference", "test_random, reference", "test_curvilinear, reference",
             "test_hybrid, reference", "test_random, u8", "test_random, f32 with normals"]
DEVICE = ["test_random, u8", "test_rare, one sample"]
READERS = ["test_read", "test_read_lenient", "test_dataset", "test_read_hostile"]

# Tests for the faults of a file, or of all in a folder, in the order in which they are run.
FILES = {
    "host/lib/grid/tables.c": TABLES,
    "host/lib/grid/hybrid_tables.c": ["test_hybrid_tables", "test_hybrid, reference"],
    "host/lib/grid/inside.c": ["test_inside"],
    "host/lib/reference/reference.c": REFERENCE,
    "host/lib/reference/reference_crossing.inc": REFERENCE,
    "host/lib/reference/reference_vertex.inc": REFERENCE,
    "host/lib/reference/reference_complex.c": ["test_complex, reference", "test_complex, u8"],
    "host/lib/convert/cell_split.c": ["test_tetrahedralize", "test_polyhedra"],
    "host/lib/convert/polyhedron.c": ["test_polyhedra"],
    "host/lib/convert/tetrahedralize.c": ["test_tetrahedralize", "test_polyhedra"],
    "host/lib/convert/complex_make.c": ["test_tetrahedralize", "test_polyhedra"],
    "host/lib/convert/tetrahedralize_grid.c": ["test_tetrahedralize", "test_complex, reference"],
    "host/lib/grid/coordinates.c": ["test_curvilinear, reference"],
    "host/lib/grid/grid.c": ["test_api, reference", "test_random, reference", "test_curvilinear, reference"],
    "host/lib/grid/origin.c": ["test_far, reference"],
    "host/lib/grid/complex.c": ["test_far, reference"],
    "host/lib/reference/carry_vertex.c": ["test_cli_grids, carry"],
    "host/lib/grid/mesh.c": ["test_api, reference"],
    "host/lib/structured/slab_plan.c": ["test_device, slabs", "test_device, copied slabs"],
    "host/lib/structured/structured.c": DEVICE + ["test_device, slabs", "test_device, copied slabs"],
    "host/lib/structured/structured_slab.c": DEVICE + ["test_device, slabs", "test_device, copied slabs"],
    "host/lib/structured/structured_emit.c": DEVICE + ["test_device, slabs", "test_device, copied slabs"],
    "host/lib/tetrahedra/complex_surface.c": ["test_complex, u8"],
    "host/lib/tetrahedra/complex_plan.c": ["test_complex, u8", "test_complex_slabs"],
    "host/lib/tetrahedra/complex_part.c": ["test_complex, u8"],
    "host/lib/tetrahedra/complex_slabs.c": ["test_complex_slabs"],
    "host/check/complex_check.c": ["test_complex_check"],
    "host/check/": ["test_check", "test_check_blocks"],
    "host/repair/": ["test_repair"],
    "host/write/": ["test_write_vtk", "test_write"],
    "host/read/number_text.c": ["test_vtk_xml_hostile", "test_vtk_legacy"],
    "host/read/cell_faces.c": ["test_vtk_xml_hostile", "test_vtk_legacy"],
    "host/read/unpack_block.c": ["test_vtk_xml_hostile", "test_vtk_xml"],
    "host/read/unpack_lz": ["test_vtk_xml_hostile", "test_vtk_xml"],
    "host/read/vtk_xml": ["test_vtk_xml", "test_vtk_xml_hostile"],
    "host/read/vtk_legacy": ["test_vtk_legacy"],
    "host/read/plot3d": ["test_plot3d"],
    "host/read/average.c": ["test_dataset", "test_vtk_legacy"],
    "host/read/": READERS,
    "host/common/far.h": ["test_far, reference"],
    "host/common/stored_types.c": READERS,
    "kernels/complex": ["test_complex, u8", "test_complex, f32"],
    "kernels/cells.cl": ["test_random, u8 with missing"],
    "kernels/": DEVICE,
}

TESTS.update({name: test(*how) for name, how in table_faults.TESTS.items()})

MUTANTS = table_host.MUTANTS + table_kernels.MUTANTS + table_check_files.MUTANTS + table_faults.MUTANTS


def tests_of(mutant):
    """Names of the tests that are to catch it, the first first."""
    longest = max((f for f in FILES if mutant.file.startswith(f)), key=len, default=None)
    others = [] if mutant.point or longest is None else FILES[longest]
    names = list(dict.fromkeys([*mutant.tests, *others]))
    if not names or not set(names) <= set(TESTS):
        raise TableError(f"{mutant.file}: {mutant.what}: no tests, or unknown ones: {names}")
    return names


def versions():
    """What the faults were looked for with."""
    done = subprocess.run(["dpkg-query", "-W", "-f=${Version}", "pocl-opencl-icd"], capture_output=True, text=True)
    return {"PoCL": done.stdout} if done.returncode == 0 and done.stdout else {}

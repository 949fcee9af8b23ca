"""table.py - tests, and by whom each file's faults are looked for"""
import collections
import subprocess

import table_check_files
import table_faults
import table_host
import table_kernels

# A program of tests/ with arguments; only: what it chooses of its cases (common/expect.h); libraries: below tests/, which
# stand behind the tool in the arguments of a test in Python. Without a device it makes use of the reference alone.


class TableError(Exception):
    """The table of mutants does not fit the source."""


Test = collections.namedtuple("Test", "program arguments only device libraries")


def test(program, only="", arguments=(), device=False, libraries=()):
    return Test(program, arguments, only, device, libraries)


TESTS = {
    "test_tables": test("surface/test_tables"),
    "test_hybrid_tables": test("surface/test_hybrid_tables"),
    "test_closed": test("surface/test_closed"),
    "test_labels": test("surface/test_labels"),
    "test_labels, alone": test("surface/test_labels", "", ("alone",), device=True),
    "test_labels, groups": test("surface/test_labels", "", ("groups",), device=True),
    "test_cli_labels": test("tool/test_cli_labels.py", "", ("reference",)),
    "test_closed_cells": test("surface/test_closed_cells"),
    "test_interval": test("surface/test_interval"),
    "test_interval, u8": test("surface/test_interval_device", "u8", ("alone",), device=True),
    "test_interval, f32": test("surface/test_interval_device", "f32", ("alone",), device=True),
    "test_interval, groups": test("surface/test_interval_device", "f32", ("groups",), device=True),
    "test_interval, slabs": test("surface/test_interval_device", "slabs", ("alone",), device=True),
    "test_interval_complex, u8": test("surface/test_interval_complex", "u8", ("alone",), device=True),
    "test_interval_complex, f32": test("surface/test_interval_complex", "f32", ("alone",), device=True),
    "test_interval_complex, groups": test("surface/test_interval_complex", "f32", ("groups",), device=True),
    "test_interval_complex, slabs": test("surface/test_interval_complex", "slabs", ("alone",), device=True),
    "test_changing, device": test("library/test_changing", "", ("device",), device=True),
    "test_measure": test("write/test_measure"),
    "test_grid_pieces, reference": test("surface/test_grid_pieces", arguments=("1", "40")),
    "test_grid_pieces, u8": test("surface/test_grid_pieces", arguments=("1", "40"), device=True),
    "test_mesh_pieces": test("write/test_mesh_pieces"),
    "test_cell_cases": test("surface/test_cell_cases"),
    "test_cells": test("surface/test_cells"),
    "test_cells, reference": test("surface/test_cells", arguments=("1", "2000")),
    "test_inside": test("surface/test_inside"),
    "test_tetrahedralize": test("surface/test_tetrahedralize"),
    "test_polyhedra": test("surface/test_polyhedra"),
    "test_check": test("write/test_check"),
    "test_check_blocks": test("write/test_check_blocks"),
    "test_complex_check": test("write/test_complex_check"),
    "test_repair": test("write/test_repair"),
    "test_simplify": test("write/test_simplify"),
    "test_simplified": test("tool/test_simplified.py", "", ("reference",)),
    "test_simplified, faults": test("tool/test_simplified.py", "*library*", ("reference",),
                                    libraries=("faults=tool/simplify_fault",)),
    "test_write_vtk": test("write/test_write_vtk"),
    "test_write_vtk_wide": test("write/test_write_vtk_wide"),
    "test_write": test("write/test_write"),
    "test_write_vtkhdf": test("write/test_write_vtkhdf"),
    "test_write_vtkhdf_wide": test("write/test_write_vtkhdf_wide"),
    "test_cli_pieces": test("tool/test_cli_pieces.py", arguments=("reference",)),
    "test_cli_vtkhdf": test("tool/test_cli_vtkhdf.py", arguments=("reference",)),
    "test_dataset": test("read/test_dataset"),
    "test_read": test("read/test_read"),
    "test_read_lenient": test("read/test_read_lenient"),
    "test_nrrd_lenient": test("read/test_nrrd_lenient"),
    "test_npy": test("read/test_npy"),
    "test_gzip": test("read/test_gzip"),
    "test_tiff": test("read/test_tiff"),
    "test_hdf5": test("read/test_hdf5"),
    "test_vtk_xml": test("read/test_vtk_xml"),
    "test_vtk_legacy": test("read/test_vtk_legacy"),
    "test_vtk_legacy_odd": test("read/test_vtk_legacy_odd"),
    "test_vtk_legacy_hostile": test("read/test_vtk_legacy_hostile"),
    "test_plot3d": test("read/test_plot3d"),
    "test_vtk_xml_hostile": test("read/test_vtk_xml_hostile"),
    "test_read_hostile": test("read/test_read_hostile"),
    "test_limits": test("fuzz/test_limits"),
    "test_api, reference": test("library/test_api"),
    "test_patterns, reference": test("surface/test_patterns"),
    "test_random, reference": test("surface/test_random"),
    "test_curvilinear, reference": test("surface/test_curvilinear"),
    "test_complex, reference": test("surface/test_complex"),
    "test_far, reference": test("surface/test_far"),
    "test_hybrid, reference": test("surface/test_hybrid"),
    "test_snap": test("surface/test_snap"),
    "test_snap_links": test("surface/test_snap_links"),
    "test_snap, u8": test("surface/test_snap", "*u8, *complete", device=True),
    "test_closed, u8": test("surface/test_closed_device", "u8, tetra", ("alone",), device=True),
    "test_closed, u8 hybrid": test("surface/test_closed_device", "u8, hybrid", ("alone",), device=True),
    "test_closed, u8 snap": test("surface/test_closed_device", "u8, snap", ("alone",), device=True),
    "test_closed, f32": test("surface/test_closed_device", "f32, tetra", ("alone",), device=True),
    "test_closed, bricks": test("surface/test_closed_device", "bricks inside", ("alone",), device=True),
    "test_closed, gaps": test("surface/test_closed_device", "gaps inside", ("alone",), device=True),
    "test_closed, groups": test("surface/test_closed_device", "u8, tetra", ("groups",), device=True),
    "test_device, snap": test("surface/test_device", "1 work-items*", ("snap",), device=True),
    "test_device, snap in groups": test("surface/test_device", "32 work-items*", ("snap",), device=True),
    "test_device, snap in slabs": test("surface/test_device", "gentle waves", ("snap",), device=True),
    "test_device, snap in slabs with missing": test("surface/test_device", "gentle waves with missing samples", ("snap",),
                                                    device=True),
    "test_patterns": test("surface/test_patterns", device=True),
    "test_random, u8": test("surface/test_random", "* u8, *nodata 0 *normals 0", device=True),
    "test_rare, alternating": test("surface/test_rare", "alternating*", device=True),
    "test_rare, one sample": test("surface/test_rare", "one sample*", device=True),
    "test_rare, slopes": test("surface/test_rare", "slope*", device=True),
    "test_rare, zeros": test("surface/test_rare", "*zeros missing", device=True),
    "test_rare, not finite": test("surface/test_rare", "not finite*", device=True),
    "test_again, u8": test("surface/test_again", "u8, 1 work-items", device=True),
    "test_again, u8 in slabs": test("surface/test_again", "u8, 1 work-items, slabs", device=True),
    "test_device, tiles": test("surface/test_device", "1 work-items*division 0", device=True),
    "test_device, slabs": test("surface/test_device", "gentle waves", device=True),
    "test_device, copied slabs": test("surface/test_device", "gentle waves", ("always_copy",), device=True),
    "test_device, slabs with missing": test("surface/test_device", "gentle waves with missing samples", device=True),
    "test_device, world space": test("surface/test_device", "world space", device=True),
    "test_random, u8 with missing": test("surface/test_random", "* u8, *nodata 1*", device=True),
    "test_random, f32 with normals": test("surface/test_random", "* f32, *normals 1", device=True),
    "test_random, f32": test("surface/test_random", "* f32, *normals 0", device=True),
    "test_random, f64": test("surface/test_random", "* f64, *", device=True),
    "test_random, i32": test("surface/test_random", "* i32, *nodata 0 *", device=True),
    "test_device, division 3": test("surface/test_device", "*division 3", device=True),
    "test_device, division 2": test("surface/test_device", "*division 2", device=True),
    "test_curvilinear, points": test("surface/test_curvilinear", "f32 points*, one work-item", device=True),
    "test_curvilinear, u8 points": test("surface/test_curvilinear", "u8 points*, one work-item", device=True),
    "test_hybrid, u8": test("surface/test_hybrid", "* u8, *complete", device=True),
    "test_complex_slabs": test("surface/test_complex_slabs", device=True),
    "test_complex, u8": test("surface/test_complex", "*u8*, context [12]", device=True),
    "test_complex, scattered": test("surface/test_complex", "scattered*, context 1", device=True),
    "test_complex, refusals": test("surface/test_complex", "refusals", device=True),
    "test_whole, alone": test("surface/test_whole", "alone", device=True),
    "test_whole, refusals": test("surface/test_whole", "refusals", device=True),
    "test_whole, orders": test("surface/test_whole", "orders", device=True),
    "test_whole, slabs": test("surface/test_whole", "slabs", device=True),
    "test_complex, f32": test("surface/test_complex", "*f32*, context 1", device=True),
    "test_memory, missing in slabs": test("layer/test_memory", "slabs, missing samples", device=True),
    "test_memory, interval": test("layer/test_memory", "interval", device=True),
    "test_memory, starved groups": test("layer/test_memory", "starved groups", device=True),
    "test_memory, counted again": test("layer/test_memory", "clusters counted again", device=True),
    "test_device, 64 work-items": test("surface/test_device", "64 work-items*", device=True),
    "test_complex, 64 work-items": test("surface/test_complex", "*u8*, context 4", device=True),

    "test_carry, snap": test("surface/test_carry", "*snap", device=True),
    "test_cli_blocks, carry": test("tool/test_cli_blocks.py", "*test_carry*", ("reference",)),
    "test_cli_cells, carry": test("tool/test_cli_cells.py", "*test_carry*", ("reference",)),
    "test_results": test("tool/test_results.py", "", ("reference",)),
    "test_dropped": test("tool/test_dropped.py", "", ("reference",)),
    "test_nodata": test("surface/test_nodata"),
    "test_cli_images": test("tool/test_cli_images.py"),
    "test_cli_written": test("tool/test_cli_written.py", "", ("reference",)),
    "test_cli_preview": test("tool/test_cli_preview.py", "", ("reference",)),
    "test_picture": test("write/test_picture"),
}

TABLES = ["test_tables", "test_hybrid_tables", "test_patterns, reference"]
REFERENCE = ["test_patterns, reference", "test_random, reference", "test_curvilinear, reference",
             "test_hybrid, reference", "test_random, u8", "test_random, f32 with normals"]
DEVICE = ["test_random, u8", "test_rare, one sample"]
SNAPPED = ["test_snap, u8"]
WHOLE = ["test_whole, alone", "test_whole, refusals", "test_whole, orders", "test_whole, slabs"]
CAPS = ["test_whole, alone", "test_whole, slabs"]
INTERVAL = ["test_interval_complex, u8", "test_interval_complex, f32", "test_interval_complex, slabs"]
READERS = ["test_read", "test_read_lenient", "test_nrrd_lenient", "test_dataset", "test_read_hostile"]
LEGACY = ["test_vtk_legacy", "test_vtk_legacy_odd", "test_vtk_legacy_hostile"]

# Tests for the faults of a file, or of all in a folder, in the order in which they are run.
FILES = {
    "host/lib/tables/tables.c": TABLES,
    "host/lib/tables/hybrid_tables.c": ["test_hybrid_tables", "test_hybrid, reference"],
    "host/lib/tables/loop.c": ["test_hybrid_tables", "test_hybrid, reference"],
    "host/lib/tables/cap_tables.c": ["test_closed"],
    "host/lib/grid/label_volume.c": ["test_labels"],
    "host/lib/tables/label_tables.c": ["test_labels"],
    "host/lib/reference/reference_labels.c": ["test_labels"],
    "host/lib/labels/": ["test_labels", "test_labels, alone"],
    "kernels/labels/": ["test_labels, alone"],
    "kernels/base/tiles.cl": ["test_complex, u8", "test_labels, alone"],
    "host/lib/reference/complex_border.c": ["test_closed", "test_closed_cells"],
    "host/lib/grid/interval.c": ["test_interval"],
    "host/lib/tables/interval_cases.c": ["test_interval"],
    "host/lib/reference/reference_interval.c": ["test_interval"],
    "host/lib/reference/reference_complex_interval.c": ["test_interval"],
    "host/lib/structured/structured_interval": ["test_interval, u8", "test_interval, f32", "test_interval, slabs"],
    "host/lib/tables/cell_cases.c": ["test_cell_cases", "test_cells, reference"],
    "host/lib/grid/complex_cells.c": ["test_cells"],
    "host/lib/grid/inside.c": ["test_inside"],
    "host/lib/reference/reference.c": REFERENCE,
    "host/lib/reference/reference_run.h": REFERENCE,
    "host/lib/reference/reference_snap.c": ["test_snap_links", "test_snap"],
    "host/lib/reference/reference_nearest.inc": ["test_snap"],
    "host/lib/reference/reference_crossing.inc": REFERENCE,
    "host/lib/reference/reference_vertex.inc": REFERENCE,
    "host/lib/reference/reference_complex.c": ["test_complex, reference", "test_complex, u8"],
    "host/lib/tables/cell_split.c": ["test_tetrahedralize", "test_polyhedra"],
    "host/lib/convert/polyhedron.c": ["test_polyhedra"],
    "host/lib/convert/tetrahedralize.c": ["test_tetrahedralize", "test_polyhedra"],
    "host/lib/convert/tetrahedralize_passes.c": ["test_tetrahedralize", "test_polyhedra"],
    "host/lib/convert/tetrahedralize_grid.c": ["test_tetrahedralize", "test_complex, reference"],
    "host/lib/grid/coordinates.c": ["test_curvilinear, reference"],
    "host/lib/grid/grid.c": ["test_api, reference", "test_random, reference", "test_curvilinear, reference"],
    "host/lib/grid/origin.c": ["test_far, reference"],
    "host/lib/grid/complex.c": ["test_far, reference"],
    "host/lib/reference/carry_vertex.c": ["test_cli_blocks, carry", "test_cli_cells, carry"],
    "host/lib/grid/mesh.c": ["test_api, reference"],
    "host/lib/stream": ["test_grid_pieces, reference"],
    "host/lib/structured/slab_plan.c": ["test_device, slabs", "test_device, copied slabs"],
    "host/lib/structured/structured.c": DEVICE + ["test_device, slabs", "test_device, copied slabs"],
    "host/lib/structured/structured_slab.c": DEVICE + ["test_device, slabs", "test_device, copied slabs"],
    "host/lib/structured/structured_snap.c": SNAPPED,
    "host/lib/structured/crossed_rows.c": ["test_carry, snap"],
    "host/lib/structured/structured_carry.c": ["test_carry, snap"],
    "host/lib/structured/snapped_edge.c": ["test_carry, snap"],
    "host/lib/structured/structured_emit.c": DEVICE + ["test_device, slabs", "test_device, copied slabs"],
    "host/lib/tetrahedra/complex_surface.c": ["test_complex, u8"],
    "host/lib/tetrahedra/complex_plan.c": ["test_complex, u8", "test_complex_slabs"],
    "host/lib/opencl/buffers.c": ["test_complex, u8", "test_device, slabs", "test_device, copied slabs"],
    "host/lib/tetrahedra/complex_slab": ["test_complex_slabs"],
    "host/lib/tetrahedra/complex_interval": INTERVAL,
    "host/lib/tetrahedra/used_points": INTERVAL,
    "host/check/complex_check.c": ["test_complex_check"],
    "host/check/tetrahedra_measure.c": ["test_measure"],
    "host/check/mesh_edges.c": ["test_simplify"],
    "host/check/mesh_distance.c": ["test_simplify", "test_simplified"],
    "host/check/": ["test_check", "test_check_blocks"],
    "host/repair/mesh_labels.c": ["test_cli_labels"],
    "host/write/label_order.c": ["test_cli_labels"],
    "host/common/label_colour.h": ["test_cli_preview", "test_cli_labels"],
    "host/repair/surface_faults.c": ["test_simplify", "test_simplified, faults"],
    "host/repair/mesh_simplify.c": ["test_simplified, faults", "test_simplified"],
    "host/repair/edge_contraction.c": ["test_simplified"],
    "host/repair/": ["test_repair"],
    "host/write/vtkhdf": ["test_write_vtkhdf", "test_write_vtkhdf_wide"],
    "host/write/held_triangles.c": ["test_mesh_pieces"],
    "host/write/": ["test_write_vtk", "test_write"],
    "host/picture/picture": ["test_cli_preview"],
    "host/picture/": ["test_picture"],
    "host/tool/labels/": ["test_cli_labels"],
    "host/tool/labels.c": ["test_cli_labels"],
    "host/tool/command_line/name_pattern.c": ["test_cli_labels"],
    "host/tool/extract/surface_simplify.c": ["test_simplified"],
    "host/tool/extract/surface_preview.c": ["test_cli_preview"],
    "host/tool/info/slice_preview.c": ["test_cli_preview"],
    "host/read/file/number_text.c": ["test_vtk_xml_hostile", *LEGACY],
    "host/read/dataset/cell_faces.c": ["test_vtk_xml_hostile", *LEGACY],
    "host/read/file/unpack_block.c": ["test_vtk_xml_hostile", "test_vtk_xml"],
    "host/read/file/unpack_lz": ["test_vtk_xml_hostile", "test_vtk_xml"],
    "host/read/vtk_xml/": ["test_vtk_xml", "test_vtk_xml_hostile"],
    "host/read/vtk_parallel/": ["test_cli_pieces", "test_cli_vtkhdf"],
    "host/read/vtk_hdf/": ["test_cli_vtkhdf"],
    "host/common/hdf5_memory": ["test_write_vtkhdf"],
    "host/read/vtk_legacy/": LEGACY,
    "host/read/plot3d/": ["test_plot3d"],
    "host/read/file/gunzip.c": ["test_gzip"],
    "host/read/file/unpack_deflate.c": ["test_gzip"],
    "host/read/image/npy.c": ["test_npy"],
    "host/read/image/array_axes.c": ["test_npy"],
    "host/read/image/tiff": ["test_tiff"],
    "host/read/image/slices.c": ["test_tiff"],
    "host/read/image/hdf5": ["test_hdf5"],
    "host/read/field/average.c": ["test_dataset", "test_vtk_legacy"],
    "host/read/": READERS,
    "host/common/far.h": ["test_far, reference"],
    "host/common/stored_types.c": READERS,
    "host/lib/tetrahedra/whole": WHOLE,
    "kernels/tetrahedra/whole": WHOLE,
    "host/lib/tetrahedra/border_list.c": CAPS,
    "host/lib/tetrahedra/caps_host.c": CAPS,
    "host/lib/tetrahedra/complex_caps.c": CAPS,
    "kernels/tetrahedra/complex_caps.cl": CAPS,
    "kernels/interval/": ["test_interval, u8", "test_interval, f32"],
    "kernels/tetrahedra/complex": ["test_complex, u8", "test_complex, f32"],
    "kernels/tetrahedra/complex_interval": ["test_interval_complex, u8", "test_interval_complex, f32"],
    "kernels/snap/": SNAPPED,
    "kernels/structured/cells.cl": ["test_random, u8 with missing"],
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

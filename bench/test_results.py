#!/usr/bin/env python3
"""test_results.py - the committed tables are those that the committed results make; scripts cope with partial results

    test_results.py SOURCE
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(sys.argv[1]).resolve()
RESULTS = SOURCE / "bench" / "results"
failures = 0


def expect(condition, text):
    global failures
    if not condition:
        failures += 1
        print(f"FAILED: {text}")


def run(*command):
    return subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          timeout=60, check=False)


def make_tables(results, readme, page):
    return run(sys.executable, SOURCE / "bench" / "table.py", "--results", results, "--readme", readme, "--page", page)


def test_committed(folder):
    results, readme, page = folder / "results", folder / "README.md", folder / "page.md"
    shutil.copytree(RESULTS, results)
    shutil.copy(SOURCE / "README.md", readme)
    shutil.copy(SOURCE / "bench" / "README.md", page)
    expect("VTK, its writer asks for" in page.read_text(), "no table of volumes in pieces")
    (results / "README.md").unlink()
    done = make_tables(results, readme, page)
    expect(done.returncode == 0, f"table.py: {done.returncode} {done.stderr}")
    for made, committed in ((readme, SOURCE / "README.md"), (page, SOURCE / "bench" / "README.md"),
                            (results / "README.md", RESULTS / "README.md")):
        expect(made.read_text() == committed.read_text(), f"{committed} is not what bench/table.py makes of the results")
    for path in RESULTS.glob("*.json"):
        name = json.loads(path.read_text())["name"]
        expect(name == path.stem, f"{path.name} is named {name}")
        expect((SOURCE / "bench" / "pictures" / f"{name}.svg").exists(), f"{path.name}: no plot; run bench/plot.py")


def test_python(folder):
    """The table of the Python package."""
    committed = SOURCE / "host" / "python" / "README.md"
    page = folder / "python.md"
    shutil.copy(committed, page)
    done = run(sys.executable, SOURCE / "bench" / "python_table.py", "--page", page)
    expect(done.returncode == 0, f"python_table.py: {done.returncode} {done.stderr}")
    expect(page.read_text() == committed.read_text(), f"{committed} is not what bench/python_table.py makes of the results")
    expect("scikit-image" in page.read_text().split("<!-- bench:begin -->")[1], f"{committed}: no table")


def test_partial(folder):
    """A machine without peers, as bench/gpu leaves it, with a case left out."""
    path = sorted(RESULTS.glob("*.json"))[0]
    result = json.loads(path.read_text())
    for key in "peers", "vtk", "startup_ms", "peak_extra_mb":
        result.pop(key, None)
    result["cases"] = result["cases"][:1]
    result["carry"] = [{"field": "sphere", "dims": [256, 256, 256], "type": "f32", "vertices": 328907, "repeats": 3,
                        "emit_ms": {"median": 2.0, "min": 1.0, "max": 3.0},
                        "carry_ms": {"median": 5.0, "min": 4.0, "max": 6.0}, "reference_ms": 200.0}]
    way = {"ms": {"median": 200.0, "min": 100.0, "max": 300.0}, "peak_mb": 50.0}
    result["stream"] = {"files": [{"field": "sphere", "dims": [512] * 3, "type": "u8", "mesh_mb": 40.0, "memory": way,
                                   "stream": way, "stream_128m": way}],
                        "large": {"dims": [2048, 2048, 4096], "type": "u8", "vertices": 7, "peak_mb": 300.0,
                                  "warm": {"dd_s": 6.0, "extract_s": 8.0}}}
    result["left_out"] = [{"field": "sphere", "dims": [1024, 1024, 1024], "type": "f32", "reason": "too large"}]
    partial = folder / "partial"
    partial.mkdir()
    (partial / path.name).write_text(json.dumps(result))
    readme, page = folder / "partial.md", folder / "partial-page.md"
    shutil.copy(SOURCE / "README.md", readme)
    shutil.copy(SOURCE / "bench" / "README.md", page)
    done = make_tables(partial, readme, page)
    expect(done.returncode == 0, f"partial results: {done.returncode} {done.stderr}")
    text = (partial / "README.md").read_text()
    expect("Left out: sphere 1024³ f32; too large." in text, "the case left out is not told of")
    expect("| sphere 256³ f32 | 328,907 | 2.00 (1.00-3.00) | 5.00 (4.00-6.00) | 2.50 | 200 |" in text, "no row of carry")
    expect("| sphere 512³ u8 | 40 | 200.0 (100.0-300.0) | 200.0 (100.0-300.0) | 1.00 | 200.0 (100.0-300.0) | 50 | 50 | 50 |" in text,
           "no row of streams")
    expect("it takes 8.0 s, and `dd` 6.0 s to read it: 0.75 of its speed" in text, "nothing of the large volume")
    expect("Beside other filters" not in text, "a table of peers without peers")


def test_grid_methods(folder):
    """An unstructured case that a method beside tetra was measured on has a row for it."""
    path = sorted(RESULTS.glob("*.json"))[0]
    result = json.loads(path.read_text())
    for peer in result["peers"]:
        if peer.get("grid") == "hexahedra":
            peer.update({"hybrid_ms": {"median": 10.0, "min": 9.0, "max": 11.0}, "hybrid_triangles": 66296,
                         "hybrid_second_ms": {"median": 2.0, "min": 1.0, "max": 3.0},
                         "vtk_linear_ms": {"median": 25.0, "min": 24.0, "max": 26.0},
                         "vtk_linear_second_ms": {"median": 20.0, "min": 19.0, "max": 21.0}})
    methods = folder / "methods"
    methods.mkdir()
    (methods / path.name).write_text(json.dumps(result))
    readme, page = folder / "methods.md", folder / "methods-page.md"
    shutil.copy(SOURCE / "README.md", readme)
    shutil.copy(SOURCE / "bench" / "README.md", page)
    done = make_tables(methods, readme, page)
    expect(done.returncode == 0, f"methods: {done.returncode} {done.stderr}")
    row = ("| sphere 127³ f32, hexahedra, hybrid | 10.0 (9.0-11.0) | vtkContour3DLinearGrid | 25.0 (**2.50**) | 2.00 | "
           "20.0 (**10.00**) | 66,296 | 66,296 |")
    expect(row in page.read_text(), "no row of hexahedra kept whole")


def test_failures(folder):
    empty = folder / "empty"
    empty.mkdir()
    readme = folder / "none.md"
    readme.write_text("no place for tables\n")
    for results, words in (empty, "no results"), (RESULTS, "has to hold"):
        done = make_tables(results, readme, readme)
        expect(done.returncode == 1 and words in done.stderr, f"table.py, {words}: {done.returncode} {done.stderr!r}")
    expect(readme.read_text() == "no place for tables\n", "table.py wrote where it has no place")
    for script in "run", "gpu":
        done = run("bash", SOURCE / "bench" / script, "--no-such-option")
        expect(done.returncode == 2 and "--no-such-option" in done.stderr, f"bench/{script}: {done.returncode}")


TOOL = """#!/bin/sh
[ "$1" = generate ] && exit 0
for word; do last=$word; [ "$before" = -o ] && file=$word; before=$word; done
echo mesh >"$file"
[ "$last" = FAULT ] && echo more >>"$file"
echo '{"surfaces": [{"vertices": 3, "triangles": 1}]}'
"""


def test_out_of_core(folder):
    """Ways that make the same file are measured; one that makes another ends the run. The tool is one that writes a
    line."""
    build = folder / "build"
    tool = build / "host" / "tool" / "tetracubes"
    tool.parent.mkdir(parents=True)
    for fault, status in (("none", 0), ("--stream", 1)):
        tool.write_text(TOOL.replace("FAULT", fault))
        tool.chmod(0o755)
        done = run(sys.executable, SOURCE / "bench" / "out_of_core.py", "--build", build, "--python", "/none", "--ways",
                   "stream", "--sizes", "32", "--fields", "sphere", "--repeat", "2", "--results", folder / f"ways{status}")
        expect(done.returncode == status, f"out_of_core.py: {done.returncode} {done.stdout} {done.stderr}")
        expect(not status or "stream makes another file" in done.stderr, f"out_of_core.py: {done.stderr}")
    made = list((folder / "ways0").glob("*.json"))
    expect(len(made) == 1 and not (folder / "ways1").exists(), f"results of out_of_core.py: {made}")
    way = json.loads(made[0].read_text())["cases"][0]["ways"]["stream"] if made else {}
    expect((way.get("vertices"), way.get("triangles"), way.get("turns")) == (3, 1, 2), f"results of out_of_core.py: {way}")


def test_plot(folder):
    if run("/usr/bin/python3", "-c", "import matplotlib").returncode:
        print("matplotlib is missing: without plot.py")
        return
    done = run("/usr/bin/python3", SOURCE / "bench" / "plot.py", "--results", folder / "partial", "--pictures", folder)
    made = list(folder.glob("*.svg"))
    expect(done.returncode == 0 and len(made) == 1, f"plot.py: {done.returncode} {done.stderr}")
    expect(made and "<svg" in made[0].read_text(), "plot.py made no SVG")


def main():
    with tempfile.TemporaryDirectory(prefix="tetracubes-results-test-") as name:
        os.environ["MPLCONFIGDIR"] = name
        folder = Path(name)
        test_committed(folder)
        test_python(folder)
        test_partial(folder)
        test_grid_methods(folder)
        test_failures(folder)
        test_out_of_core(folder)
        test_plot(folder)
    print(f"{failures} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""table.py - bench/results/*.json as Markdown

A small table goes into the project's README, the largest cases into bench/README.md, each between the page's bench:begin
and bench:end comments; all cases go into README.md beside the results. What a results file does not hold is left out.
Standard library only.
"""

import argparse
import glob
import json
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
README = os.path.join(os.path.dirname(HERE), "README.md")
PAGE = os.path.join(HERE, "README.md")
BEGIN, END = "<!-- bench:begin -->", "<!-- bench:end -->"
METHODS = ["hybrid", "snap"]  # beside tetra
PEERS = [("vtk", "vtkFlyingEdges3D, ms"), ("vtk_mc", "vtkMarchingCubes, ms"), ("skimage", "scikit-image, ms"),
         ("meshlib", "MeshLib, ms")]
FASTEST = "vtk"  # the one that takes turns with all of ours
GRID_PEERS = [("vtk_contour", "vtkContourFilter"), ("vtk_linear", "vtkContour3DLinearGrid")]  # of grids not uniform
HEADLINES = {"sphere", "gyroid", "marschner-lobb"}  # fields of the tables in bench/README.md
HEADLINE_SIZE = 512
SAMPLE_BYTES = {"u8": 1, "i8": 1, "u16": 2, "i16": 2, "u32": 4, "i32": 4, "f32": 4, "f64": 8}


def number(value):
    """As many digits as it deserves."""
    return f"{value:.{0 if value >= 100 else 1 if value >= 10 else 2}f}"


def ms(times):
    """The median, with its spread."""
    digits = 1 if times["median"] >= 10 else 2
    return f"{times['median']:.{digits}f} ({times['min']:.{digits}f}-{times['max']:.{digits}f})"


def size(dims):
    return f"{dims[0]}³" if len(set(dims)) == 1 else "×".join(map(str, dims))


def table(head, rows):
    """The first column is text, the others are numbers."""
    lines = [head, ["---"] + ["--:"] * (len(head) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


# --------------------------------------------------------------------------------------------------------------- peers

def peer_cell(peer, key):
    """Its median, and how many times ours that is."""
    if f"{key}_ms" not in peer:
        return ""
    median = peer[f"{key}_ms"]["median"]
    ours = peer.get("beside_ms", peer["extract_ms"]) if key != FASTEST else peer["extract_ms"]
    return f"{number(median)} (**{median / ours['median']:.2f}**)"


def peer_name(peer):
    grid = peer.get("grid", "uniform")
    return f"{peer['case'].split()[0]} {size(peer['dims'])} {peer['type']}{'' if grid == 'uniform' else ', ' + grid}"


def method_cell(peer, method):
    """A method's median, and how many times that Flying Edges takes."""
    if f"{method}_ms" not in peer:
        return ""
    median = peer[f"{method}_ms"]["median"]
    return f"{number(median)} (**{peer['vtk_ms']['median'] / median:.2f}**)"


def method_triangles(peer, method):
    return f"{peer[f'{method}_triangles']:,}" if f"{method}_triangles" in peer else ""


def peers_table(peers):
    """With a column for each peer that any of them has."""
    present = [(key, title) for key, title in PEERS if any(f"{key}_ms" in peer for peer in peers)]
    methods = methods_of(peers)
    head = ["samples", "Tetracubes, ms", *(title for _, title in present), *(f"{method}, ms" for method in methods),
            "triangles", "VTK's triangles", *(f"{method}'s triangles" for method in methods), "× memory limit"]
    rows = [[peer_name(peer), ms(peer["extract_ms"]), *(peer_cell(peer, key) for key, _ in present),
             *(method_cell(peer, method) for method in methods), f"{peer['triangles']:,}", f"{peer['vtk_triangles']:,}",
             *(method_triangles(peer, method) for method in methods), f"{peer['limit_ratio']:.1f}"] for peer in peers]
    return table(head, rows)


def grid_peer_row(peer, method=None):
    """Ours by the method, tetra where none is named."""
    key, title = next((key, title) for key, title in GRID_PEERS if f"{key}_ms" in peer)
    start = f"{method}_" if method else ""
    times, theirs = peer[f"{method}_ms" if method else "extract_ms"], peer[f"{key}_ms"]["median"]
    second = ["", ""]
    if f"{start}second_ms" in peer:
        median, their_second = peer[f"{start}second_ms"]["median"], peer[f"{key}_second_ms"]["median"]
        second = [number(median), f"{number(their_second)} (**{their_second / median:.2f}**)"]
    return [peer_name(peer) + (f", {method}" if method else ""), ms(times), title,
            f"{number(theirs)} (**{theirs / times['median']:.2f}**)", *second, f"{peer[f'{start}triangles']:,}",
            f"{peer[f'{key}_triangles']:,}"]


def grid_peers_table(peers):
    head = ["samples", "Tetracubes, ms", "other", "its, ms", "second isovalue, ms", "other's, ms", "triangles",
            "other's triangles"]
    return table(head, [grid_peer_row(peer, method) for peer in peers for method in (None, *methods_of([peer]))])


def growth_text(peers):
    return "".join(f" {size(peer['dims'])} {peer['type']} took {number(peer['half_ms']['median'])} ms at half the size, "
                   f"in the same turns: {peer['extract_ms']['median'] / peer['half_ms']['median']:.1f} times as long for "
                   "8 times the samples." for peer in peers if "half_ms" in peer)


def is_headline_peer(peer):
    """Large, of a real volume, or not uniform."""
    return max(peer["dims"]) >= HEADLINE_SIZE or peer.get("grid", "uniform") != "uniform" or "^" not in peer["case"]


def peers_text(result, peers):
    if not peers:
        return []
    vtk = result["vtk"]
    uniform = [peer for peer in peers if peer.get("grid", "uniform") == "uniform"]
    others = [peer for peer in peers if peer not in uniform]
    text = [f"Beside other filters: VTK {vtk['version']} without normals. They have {vtk['threads']} threads, but "
            "vtkMarchingCubes and scikit-image one. Each side makes a new mesh on every repeat, and all take turns in "
            "one run; the slow ones take turns with a second series of ours. Times are medians, ours with "
            "the least and the greatest. In bold: its time divided by ours; in the columns of other methods: "
            "Flying Edges' time divided by the method's." + growth_text(peers), peers_table(uniform)]
    if others:
        text += ["Grids that are not uniform. The other filter uses as many threads as it can, merges points, and has "
                 "its scalar tree for the second isovalue:", grid_peers_table(others)]
    return text


# --------------------------------------------------------------------------------------------------------------- cases

def read_share(result, case, times):
    """Percentage of the device's read bandwidth at which classification goes through the samples."""
    samples = case["dims"][0] * case["dims"][1] * case["dims"][2] * SAMPLE_BYTES[case["type"]]
    return f"{100 * samples / times['median'] * 1e-6 / result['read_gbps']:.0f}%"


def second_cells(case):
    if "second_warm_ms" not in case:
        return ["", ""]
    return [ms(case["second_warm_ms"]), number(case["second_classify_ms"]["median"])]


def case_row(result, case):
    return [f"{case['field']} {size(case['dims'])} {case['type']}", f"{case['triangles']:,}", ms(case["extract_ms"]),
            ms(case["extract_warm_ms"]), number(case["classify_ms"]["median"]),
            read_share(result, case, case["classify_ms"]), *second_cells(case), f"{case['limit_ms']:.2f}",
            f"{case['limit_ratio']:.1f}", f"{case['reference_ms']['median']:.0f}"]


def cases_table(result, cases):
    head = ["samples", "triangles", "new mesh, ms", "kept mesh, ms", "of it classify", "of read bandwidth",
            "second isovalue, ms", "of it classify", "limit, ms", "× limit", "scalar C, ms"]
    return table(head, [case_row(result, case) for case in cases])


def is_headline_case(case):
    return case["field"] in HEADLINES and case["type"] in ("u8", "f32") and max(case["dims"]) >= HEADLINE_SIZE


def cases_text(result, cases):
    if not cases:
        return []
    return ["Alone. The limit is reading every sample and writing the mesh once, at the bandwidths above; its ratio is "
            "that of the kept mesh:", cases_table(result, cases)]


def left_out_text(result):
    return [f"Left out: {case['field']} {size(case['dims'])} {case['type']}; {case['reason']}."
            for case in result.get("left_out", [])]


# --------------------------------------------------------------------------------------------------------------- carry

def carry_row(case):
    emit, carry = case["emit_ms"], case["carry_ms"]
    return [f"{case['field']} {size(case['dims'])} {case['type']}", f"{case['vertices']:,}", ms(emit), ms(carry),
            f"{carry['median'] / emit['median']:.2f}", f"{case['reference_ms']:.0f}"]


def carry_text(result):
    """The cases of tetracubes-bench-carry."""
    if "carry" not in result:
        return []
    head = ["samples", "vertices", "emit, ms", "carry, ms", "carry / emit", "carry by scalar C, ms"]
    return ["Carrying a field of one float32 to the vertices, beside the emission of the surface into a kept mesh; both "
            "take turns:", table(head, [carry_row(case) for case in result["carry"]])]


# ------------------------------------------------------------------------------------- interval volumes, label maps

def interval_row(case):
    low, high = case["range"].split(",")
    return [f"{case['field']} {size(case['dims'])} f32, {case['grid']}", f"{low or '-∞'} to {high or '∞'}",
            f"{case['tetrahedra']:,}", ms(case["ms"]), f"{case['first_ms']['median']:.1f}", f"{case['limit_ratio']:.1f}",
            f"{case['vtk_table_ms']['median']:.0f} (**{case['times_ours']:.1f}**)"]


def interval_text(result):
    """The cases of interval.py."""
    if "interval" not in result:
        return []
    vtk, date = result["interval"]["vtk"], result["interval"]["date"]
    head = ["samples", "interval", "tetrahedra", "isovolume, ms", "first, ms", "× limit", "VTK, two clips, ms"]
    return [f"Interval volumes beside two passes of vtkTableBasedClipDataSet (VTK {vtk['version']}, {vtk['threads']} "
            f"threads), in turns, {date}. VTK keeps voxels that lie within whole. In bold: its time divided by ours:",
            table(head, [interval_row(case) for case in result["interval"]["cases"]])]


LABEL_SIDES = [("tetracubes", "labels, ms"), ("smoothed", "smoothed, ms"), ("vtk", "vtkSurfaceNets3D, ms"),
               ("vtk_smoothed", "its smoothed, ms"), ("zmesh", "zmesh, ms")]


def label_cell(case, side):
    if side not in case["sides"]:
        return ""
    own = {"vtk": "tetracubes", "vtk_smoothed": "smoothed", "zmesh": "tetracubes"}.get(side)
    median = case["sides"][side]["ms"]["median"]
    return f"{median:.0f} (**{median / case['sides'][own]['ms']['median']:.1f}**)" if own else f"{median:.0f}"


def labels_text(result):
    """The cases of label_peers.py."""
    if "labels" not in result:
        return []
    cases, versions, date = (result["labels"][key] for key in ("cases", "versions", "date"))
    rows = [[f"{case['name']}, {size(case['dims'])}", f"{case['labels']}",
             f"{case['sides']['tetracubes']['triangles']:,}", *(label_cell(case, side) for side, _ in LABEL_SIDES)]
            for case in cases if "tetracubes" in case["sides"]]
    binary = next(case["sides"] for case in cases if "binary" in case["sides"])
    ratio = binary["binary_labels"]["ms"]["median"] / binary["binary"]["ms"]["median"]
    return [f"Label maps from a numpy array to arrays, by the Python package, VTK {versions['vtk']} with all threads and "
            f"zmesh {versions['zmesh']}, in turns, {date}. In bold: the other's time divided by ours. Of a map with one label, "
            f"`labels` takes {ratio:.1f} times as long as a surface:",
            table(["segmentation", "labels", "triangles", *(title for _, title in LABEL_SIDES)], rows)]


# -------------------------------------------------------------------------------------------------------------- stream

def stream_row(case):
    memory, stream, small = case["memory"], case["stream"], case["stream_128m"]
    ratio = stream["ms"]["median"] / memory["ms"]["median"]
    return [f"{case['field']} {size(case['dims'])} {case['type']}", f"{case['mesh_mb']:,.0f}", ms(memory["ms"]),
            ms(stream["ms"]), f"{ratio:.2f}", ms(small["ms"]), *(f"{way['peak_mb']:,.0f}" for way in (memory, stream, small))]


def large_text(large):
    text = (f"A raw volume of {size(large['dims'])} {large['type']}, 16 GiB and most of it a hole, under a limit of 1 GiB "
            f"on the memory that the process may take: {large['vertices']:,} vertices, with {large['peak_mb']:.0f} MB at most.")
    for kind, words in (("warm", "From the system's cache of files"), ("cold", "From the disk")):
        if kind in large:
            case = large[kind]
            text += (f" {words} it takes {case['extract_s']:.1f} s, and `dd` {case['dd_s']:.1f} s to read it: "
                     f"{case['dd_s'] / case['extract_s']:.2f} of its speed.")
    return text


def stream_text(result):
    """The cases of bench/stream.py."""
    if "stream" not in result:
        return []
    head = ["samples", "mesh, MB", "in memory, ms", "`--stream`, ms", "ratio", "`--max-memory 128M`, ms",
            "peak in memory, MB", "of the stream", "of 128M"]
    stream = result["stream"]
    return ["The whole tool, raw file to PLY, in memory and as a stream, in turns; the files are the same, byte for byte:",
            table(head, [stream_row(case) for case in stream["files"]]),
            *([large_text(stream["large"])] if "large" in stream else [])]


# -------------------------------------------------------------------------------------------------------------- table 1

def table1_row(row):
    paper = f"{row['paper_polygons']:,}" if row["paper_polygons"] else ""
    return [row["name"], size(row["dims"]), f"{row['paper_tetrahedra']:,}", f"{row['tetrahedra']:,}", paper,
            f"{row['polygons']:,}", number(row["extract_ms"]), number(row["process_ms"])]


def table1_text(result):
    """The rows of bench/table1."""
    if "table1" not in result:
        return []
    head = ["the paper's Table 1", "points", "tetrahedra, paper", "ours", "polygons, paper", "ours", "extraction, ms",
            "whole process, ms"]
    return ["Table 1 of the paper (`bench/table1`): the sphere's radius is the one that comes closest; the blunt fin is "
            "the paper's own data, at density 2.585, which is \"128\" of its range in bytes; stand-ins are grids of as "
            "many tetrahedra, as the paper's data are not published:",
            table(head, [table1_row(row) for row in result["table1"]])]


# -------------------------------------------------------------------------------------------------------- out of core

WAYS = {"memory": "Tetracubes, in memory", "stream": "Tetracubes, `--stream`",
        "stream_128m": "Tetracubes, `--stream --max-memory 128M`", "hybrid_128m": "the same, `--method hybrid`",
        "ranks": "Tetracubes, {ranks} ranks of MPI, one file", "vtk_memory": "VTK, in memory",
        "vtk_pieces": "VTK, its writer asks for {pieces} pieces", "vtk_slabs": "VTK, {pieces} slabs appended",
        "skimage": "scikit-image, {pieces} slabs of a memmap", "paraview": "ParaView, {ranks} ranks of MPI, a file each"}
BUSY = 0.25  # load per core, from which on the text tells of it


def way_row(result, name, way):
    return [WAYS[name].format(**result), f"{way['ms']['median']:,.0f}", f"{way['cpu_ms']['median']:,.0f}",
            f"{way['peak_mb']:,.0f}", f"{way['file_mb']:,.0f}", f"{way['triangles']:,}", f"{way['vertices']:,}"]


def out_of_core_text(result):
    """What bench/out_of_core.py measured on a machine."""
    load = max(result["load_before_and_after"])
    busy = f" The machine had other work meanwhile (load up to {load:.0f}), which all shared: wall times say little there, " \
           "processor times more." if load > BUSY * result["cores"] else ""
    known = ", ".join(f"{name} {version}" for name, version in result["versions"].items())
    head = ["way", "wall, ms", "processors, ms", "peak, MB", "files, MB", "triangles", "vertices"]
    tables = []
    for case in result["cases"]:
        rows = [way_row(result, name, case["ways"][name]) for name in WAYS if name in case["ways"]]
        tables.append(table([f"{case['field']} {case['side']}³ u8, {head[0]}", *head[1:]], rows))
    return [f"File to file, with memory bounded and without, on {result['cpu']}, {result['cores']} cores, {result['date']} "
            f"({known}): raw samples to VTP, scikit-image to raw arrays. Ours are whole processes, of the others their work "
            "alone; ParaView's processor time is that of all, waiting included, as ranks of Open MPI spin. Peaks are resident memory, mapped files included; of ranks "
            "that of the largest. Pieces of the others are not joined: vertices at seams are there twice." + busy, *tables]


# ------------------------------------------------------------------------------------------------------------ sections

def machine_text(result):
    text = (f"**{result['cpu']}, {result['cores']} cores**, OpenCL device {result['device']} (driver "
            f"{result['driver']}), {result['date']}. The device reads {result['read_gbps']:.1f} GB/s and writes "
            f"{result['write_gbps']:.1f} GB/s.")
    if "startup_ms" in result:
        text += (f" A whole process on a 64³ file takes {result['startup_ms']['median']:.0f} ms; on a 512³ u8 file its "
                 f"memory peaks at {result['peak_extra_mb']:.0f} MB beyond file and mesh.")
    return text


def picture(result, folder):
    return f"![Time against size on {result['device']}]({folder}/{result['name']}.svg)"


def headlines(result):
    """The section of a machine in bench/README.md."""
    return [machine_text(result), picture(result, "pictures"),
            *peers_text(result, list(filter(is_headline_peer, result.get("peers", [])))),
            *cases_text(result, list(filter(is_headline_case, result["cases"]))), *carry_text(result),
            *interval_text(result), *labels_text(result), *table1_text(result)]


def methods_of(peers):
    """Those that any of the peers was measured with."""
    return [method for method in METHODS if any(f"{method}_ms" in peer for peer in peers)]


def brief_cell(peer):
    """Our time, and how many times that the other takes: the first of the programs is the fastest of them."""
    theirs = next(peer[f"{key}_ms"] for key, _ in PEERS + GRID_PEERS if f"{key}_ms" in peer)["median"]
    ours = peer["extract_ms"]["median"]
    return f"{number(ours)} (**{theirs / ours:.1f}**)"


def brief(results):
    """The section in the project's README: a column for each machine that has peers."""
    results = [result for result in results if result.get("peers")]
    letters = "ABCDEFGH"[:len(results)]
    peers = [{peer_name(peer): peer for peer in filter(is_headline_peer, result["peers"])} for result in results]
    names = list(dict.fromkeys(name for of_machine in peers for name in of_machine))
    rows = []
    for name in names:
        peer = next(of_machine[name] for of_machine in peers if name in of_machine)
        key, title = next((key, title.removesuffix(", ms")) for key, title in PEERS + GRID_PEERS if f"{key}_ms" in peer)
        count = peer.get("vtk_triangles", peer.get(f"{key}_triangles"))
        rows.append([name, title, *(brief_cell(of_machine[name]) if name in of_machine else "" for of_machine in peers),
                     f"{peer['triangles']:,}", f"{count:,}", method_triangles(peer, "snap")])
    machines = [f"{letter}: {result['cpu']}, {result['cores']} cores, {result['device'].split('-' + result['cpu'])[0]}, "
                f"VTK {result['vtk']['version']}, {result['date']}" for letter, result in zip(letters, results)]
    head = ["samples", "VTK's filter", *(f"{letter}: ours, ms" for letter in letters), "our triangles", "VTK's", "snap's"]
    return [table(head, rows), "In bold: VTK's time divided by ours. " + ". ".join(machines) + "."] if results else []


def everything(result):
    return [f"## {result['name']}", machine_text(result), picture(result, "../pictures"),
            *peers_text(result, result.get("peers", [])), *cases_text(result, result["cases"]), *left_out_text(result),
            *carry_text(result), *interval_text(result), *labels_text(result), *stream_text(result),
            *table1_text(result)]


def paragraphs(parts):
    return "\n\n".join(parts)


def readme_with(readme, section):
    """The README's text with its generated section replaced; None where it has no place for it."""
    if readme.count(BEGIN) != 1 or readme.count(END) != 1 or readme.index(BEGIN) > readme.index(END):
        return None
    return f"{readme.split(BEGIN)[0]}{BEGIN}\n{section}\n{END}{readme.split(END)[1]}"


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def replace(path, parts):
    """The section of a page that is made here."""
    with open(path, encoding="utf-8") as file:
        text = readme_with(file.read(), paragraphs(parts))
    if text is None:
        sys.exit(f"table.py: {path} has to hold {BEGIN} and, after it, {END}, once each")
    write(path, text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", default=os.path.join(HERE, "results"), metavar="DIR", help="default bench/results")
    parser.add_argument("--readme", default=README, metavar="FILE", help="default README.md")
    parser.add_argument("--page", default=PAGE, metavar="FILE", help="default bench/README.md")
    arguments = parser.parse_args()
    results = []
    for path in sorted(glob.glob(os.path.join(arguments.results, "*.json"))):
        with open(path, encoding="utf-8") as file:
            results.append(json.load(file))
    if not results:
        sys.exit(f"table.py: no results in {arguments.results}; run bench/run first")
    replace(arguments.readme, brief(results))
    out_of_core = []
    for path in sorted(glob.glob(os.path.join(arguments.results, "out_of_core", "*.json"))):
        with open(path, encoding="utf-8") as file:
            out_of_core += out_of_core_text(json.load(file))
    replace(arguments.page, [*(part for result in results for part in headlines(result)), *out_of_core,
                             "All cases: [results](results/README.md)."])
    title = "# Results\n\nMade by bench/table.py from the files beside this one; what the columns mean: ../README.md."
    write(os.path.join(arguments.results, "README.md"),
          paragraphs([title, *(part for result in results for part in everything(result))]) + "\n")


if __name__ == "__main__":
    main()

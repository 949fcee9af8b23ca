#!/usr/bin/env python3
"""test_data.py TOOL - real volumes against counts made without this program, on both engines

The folder named by TETRACUBES_DATA holds expected.json: vertices, triangles, boundary edges and Euler characteristic
per file and isovalue. Every uniform entry is extracted with --check --verify, and by the reference engine. Files that
the tool does not read (VTK's) are decoded here, with the standard library, and passed as raw samples. Skips (status
77) where TETRACUBES_DATA is unset.
"""
import base64
import json
import os
import re
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree
import zlib

COMPARED = ("vertices", "triangles", "boundary_edges", "euler_characteristic")
VTK_TYPES = {"unsigned_char": "u8", "char": "i8", "unsigned_short": "u16", "short": "i16", "float": "f32",
             "double": "f64", "UInt8": "u8", "Int8": "i8", "UInt16": "u16", "Int16": "i16", "Float32": "f32",
             "Float64": "f64"}
SAMPLE_BYTES = {"u8": 1, "i8": 1, "u16": 2, "i16": 2, "f32": 4, "f64": 8}


def legacy_vtk(path):
    """(dims, type, endian, samples) of a binary STRUCTURED_POINTS file; its samples are big-endian."""
    with open(path, "rb") as f:
        content = f.read()
    dims = [int(n) for n in re.search(rb"\nDIMENSIONS\s+(\d+)\s+(\d+)\s+(\d+)", content).groups()]
    kind = VTK_TYPES[re.search(rb"\nSCALARS\s+\S+\s+(\w+)", content).group(1).decode()]
    start = re.search(rb"\nLOOKUP_TABLE[^\n]*\n", content).end()
    size = dims[0] * dims[1] * dims[2] * SAMPLE_BYTES[kind]
    assert b"\nBINARY" in content[:start] and len(content) >= start + size, path
    return dims, kind, "big", content[start:start + size]


def inline_blocks(text):
    """Decodes base64 of [count, block size, last size, compressed sizes...] as uint32, then base64 of the blocks."""
    text = "".join(text.split())
    count = struct.unpack("<I", base64.b64decode(text[:8])[:4])[0]
    header_length = 4 * (((3 + count) * 4 + 2) // 3)
    sizes = struct.unpack(f"<{3 + count}I", base64.b64decode(text[:header_length])[:(3 + count) * 4])[3:]
    data, blocks, at = base64.b64decode(text[header_length:]), [], 0
    for size in sizes:
        blocks.append(zlib.decompress(data[at:at + size]))
        at += size
    return b"".join(blocks)


def xml_vti(path):
    """(dims, type, endian, samples) of an XML image with one inline, zlib-compressed array."""
    root = xml.etree.ElementTree.parse(path).getroot()
    assert root.get("compressor") == "vtkZLibDataCompressor" and root.get("header_type", "UInt32") == "UInt32", path
    extent = [int(n) for n in root.find("ImageData").get("WholeExtent").split()]
    array = root.find(".//PointData/DataArray")
    assert array.get("format") == "binary", path
    dims = [extent[2 * axis + 1] - extent[2 * axis] + 1 for axis in range(3)]
    kind, samples = VTK_TYPES[array.get("type")], inline_blocks(array.text)
    assert len(samples) == dims[0] * dims[1] * dims[2] * SAMPLE_BYTES[kind], path
    return dims, kind, "little" if root.get("byte_order") == "LittleEndian" else "big", samples


def input_arguments(path, folder):
    """What names the file on the tool's command line: itself, or raw samples made of it."""
    decoders = {".vtk": legacy_vtk, ".vti": xml_vti}
    ending = os.path.splitext(path)[1]
    if ending not in decoders:
        return [path]
    dims, kind, endian, samples = decoders[ending](path)
    raw = os.path.join(folder, os.path.basename(path) + ".raw")
    with open(raw, "wb") as f:
        f.write(samples)
    return [raw, "--dims", ",".join(map(str, dims)), "--type", kind, "--endian", endian]


def surface_of(tool, source, iso, *more):
    """The one surface of a report, or a text that says why there is none."""
    command = [tool, "extract", *source, "--iso", repr(iso), "--check", "--json", *more]
    result = subprocess.run(command, capture_output=True, text=True, timeout=600)
    if result.returncode:
        return f"status {result.returncode}: {result.stderr.strip()}"
    return json.loads(result.stdout)["surfaces"][0]


def faults_of(tool, entry, source):
    faults, hashes = [], set()
    for engine, more in (("opencl", ["--verify"]), ("reference", [])):
        surface = surface_of(tool, source, entry["iso"], "--engine", engine, *more)
        if isinstance(surface, str):
            faults.append(f"{engine}: {surface}")
            continue
        hashes.add(surface["hash"])
        faults += [f"{engine}: {key} {surface[key]}, should be {entry[key]}" for key in COMPARED
                   if surface[key] != entry[key]]
        if more and surface["verified"] is not True:
            faults.append(f"{engine}: not verified")
    if len(hashes) > 1:
        faults.append("the engines' hashes differ")
    return faults


def main():
    data = os.environ.get("TETRACUBES_DATA")
    if not data:
        print("SKIP: TETRACUBES_DATA is unset; it names the folder of real volumes and their expected counts")
        return 77
    tool = os.path.abspath(sys.argv[1])
    formats = subprocess.run([tool, "--version"], capture_output=True, text=True).stdout
    with open(os.path.join(data, "expected.json")) as f:
        entries = [entry for entry in json.load(f) if entry["file"].startswith("uniform/")]
    failed = 0
    with tempfile.TemporaryDirectory(prefix="tetracubes-data-") as folder:
        for entry in entries:
            name = f"{entry['file']} at {entry['iso']}"
            if ".nii" in name and "NIfTI" not in formats:
                print(f"SKIP  {name}: built without NIfTI")
                continue
            faults = faults_of(tool, entry, input_arguments(os.path.join(data, entry["file"]), folder))
            failed += bool(faults)
            print(f"{'FAIL' if faults else 'ok'}  {name}", *faults, sep="\n      ", flush=True)
    print(f"{len(entries)} surfaces, {failed} failed")
    return 1 if failed or not entries else 0


if __name__ == "__main__":
    sys.exit(main())

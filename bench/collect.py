#!/usr/bin/env python3
"""collect.py - one results file of the parts that bench/run measured, named after CPU and device

Names of hosts, users and folders are left out: the file is meant to be committed.
"""

import argparse
import json
import os
import platform
import re
import subprocess


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def first_line(command):
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()[0].strip()


def cpu_model():
    """As Linux names it, or the architecture where it has no name."""
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        named = re.search(r"^model name\s*:\s*(.+)$", file.read(), re.MULTILINE)
    return " ".join(named.group(1).split()) if named else platform.machine()


def cache_value(build, key):
    with open(os.path.join(build, "CMakeCache.txt"), encoding="utf-8") as file:
        return re.search(rf"^{key}:\w+=(.*)$", file.read(), re.MULTILINE).group(1)


def compiler(build):
    """`cc (Debian 12.2.0-14) 12.2.0`, without the folder that it lies in."""
    return first_line([cache_value(build, "CMAKE_C_COMPILER"), "--version"])


def file_name(cpu, device):
    """CPU and device in small letters; a device that carries the CPU's name does not repeat it."""
    text = f"{cpu} {device.replace(cpu, '')}".lower()
    return re.sub(r"[^a-z0-9]+", "-", text).strip("-")


def optional(folder, part):
    """A part that need not be there, as peers on a machine without them."""
    path = os.path.join(folder, part + ".json")
    return read(path) if os.path.exists(path) else {}


def versions(tool, peers):
    told = {
        "tetracubes": first_line([tool, "--version"]).split()[-1],
        "cmake": first_line(["cmake", "--version"]).split()[-1],
        "linux": platform.release().split("-")[0],
    }
    if peers:
        told.update(vtk=peers["vtk"]["version"], **peers["versions"])
    return told


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True, metavar="DIR", help="the build folder")
    parser.add_argument("--parts", required=True, metavar="DIR",
                        help="bench.json and, where they were measured, carry.json, interval.json, labels.json, "
                             "peers.json, process.json, stream.json, table1.json")
    parser.add_argument("--results", required=True, metavar="DIR", help="where the file goes")
    arguments = parser.parse_args()
    bench = read(os.path.join(arguments.parts, "bench.json"))
    peers, process = optional(arguments.parts, "peers"), optional(arguments.parts, "process")
    carry, table1 = optional(arguments.parts, "carry"), optional(arguments.parts, "table1")
    stream, interval = optional(arguments.parts, "stream"), optional(arguments.parts, "interval")
    labels = optional(arguments.parts, "labels")
    cpu = cpu_model()
    name = file_name(cpu, bench["device"])
    result = {
        "name": name,
        "date": first_line(["date", "-u", "+%F"]),
        "cpu": cpu,
        "cores": len(os.sched_getaffinity(0)),
        "device": bench["device"],
        "driver": bench["driver"],
        "compiler": compiler(arguments.build),
        "versions": versions(os.path.join(arguments.build, "host", "tool", "tetracubes"), peers),
        "read_gbps": bench["read_gbps"],
        "write_gbps": bench["write_gbps"],
        **process,
        "cases": bench["cases"],
        "left_out": bench["left_out"],
    }
    if peers:
        result.update(peers=peers["cases"], vtk=peers["vtk"])
    if carry:
        result["carry"] = carry["cases"]
    if stream:
        result["stream"] = stream
    if table1:
        result["table1"] = table1["rows"]
    if interval:
        result["interval"] = interval
    if labels:
        result["labels"] = labels
    path = os.path.join(arguments.results, name + ".json")
    os.makedirs(arguments.results, exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        json.dump(result, file, indent=1)
        file.write("\n")
    print(f"written: {os.path.relpath(path)}")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""offline.py - the kernels as compilers for GPUs take them, on machines without a GPU

    offline.py quick nvidia|amd|spirv    a sample of programs, for one kind of device
    offline.py long                      all programs, for all; renews the table
    offline.py renew                     the sample, for all; renews the table with what the kernels need now
    offline.py show [nvidia|amd]         what the sample's kernels need, judging nothing

Of all: --texts PROGRAM (kernel_texts), --tools FOLDER (made by the script tools), --table FILE. The table has what
every kernel needs (targets.Need) on every GPU. A kernel that needs more than it says, or has fewer warps or waves, is a
failure where the compilers are those of the table; a kernel that breaks a rule below is one with any compiler.
"""
import argparse
import concurrent.futures
import json
import os
import re
import subprocess
import sys
import tempfile
import time

from targets import KINDS, Lacks, Need, Program, Refused, options_read

# Kernels of a sample go every way that the texts have.
SAMPLE = ["classify-u8-tetra", "classify-f32-tetra-missing", "classify-f64-hybrid", "classify-f32-snap-missing",
          "emit-u8-tetra-uniform", "emit-f32-snap-uniform", "snap-u8", "snap-f64-missing",
          "emit-f32-tetra-uniform", "emit-f32-tetra-uniform-normals", "emit-f32-hybrid-rectilinear-missing-normals",
          "emit-f64-tetra-curvilinear-missing-normals", "emit-i32-hybrid-uniform", "complex-f32", "complex-f64",
          "classify-u8-tetra-closed", "classify-f32-snap-missing-closed", "classify-u8-hybrid-missing-closed",
          "emit-u8-hybrid-uniform-closed", "emit-f32-tetra-uniform-closed",
          "emit-f32-snap-curvilinear-missing-normals-closed", "emit-f64-tetra-rectilinear-missing-normals-closed",
          "whole-u8", "whole-f32", "complex-u8-interval", "complex-f64-interval", "complex-f32-closed",
          "whole-f32-closed", "interval-u8-uniform", "interval-f32-curvilinear-missing",
          "interval-f64-rectilinear-missing",
          "labels-u8", "labels-u32"]

# All work-items of a group: other sizes are compiled in the long tier, as samples.
OTHER_SIZES = [32, 64, 256]

# Texts with faults, which show that each is found: what is planted, for which target, what is said.
PLANTED = [
    ("none", "sm_90", "out[n] = in[n] * 2.0f;", None),
    ("fused", "sm_90", "out[n] = fma(in[n], in[n + 1], 1.0f);", "fused multiply-add"),
    ("approximate", "sm_90", '__asm__("rcp.approx.f32 %0, %1;" : "=f"(out[n]) : "f"(in[n]));', "approximate operation"),
    ("stack", "sm_90", "float a[99]; for (int m = 0; m < 99; m++) a[(int)in[m] % 99] = m; out[n] = a[n];", "stack"),
    ("none", "gfx90a", "out[n] = in[n] * 2.0f;", None),
    ("fused", "gfx90a", "out[n] = fma(in[n], in[n + 1], 1.0f);", "fused multiply-add"),
    ("approximate", "gfx90a", "out[n] = 1.0f / in[n];", "division that need not be rounded correctly"),
    ("stack", "gfx90a", "float a[99]; for (int m = 0; m < 99; m++) a[(int)in[m] % 99] = m; out[n] = a[n];", "stack"),
    ("none", "spirv", "out[n] = in[n] * 2.0f;", None),
    ("fused", "spirv", "out[n] = fma(in[n], in[n + 1], 1.0f);", "fused or approximate operation"),
    ("double", "spirv", "out[n] = (float)((double)in[n] * 0.1);", "wants Float64"),
    ("division", "spirv", "out[n] = 1.0f / in[n];", "division or root"),
]


# Registers of kernel 2 on GPUs of NVIDIA; where normals of rectilinear grids are made in double. Local memory for every
# 32 work-items, as kernels/base/slab.h has it.
EMIT_REGISTERS, EMIT_REGISTERS_DOUBLE, LOCAL_BYTES_PER_BRICK = 96, 112, 3072


def rules_broken(target, kernel, need, program):
    """What no kernel may have, by any compiler."""
    if need.stack:
        yield f"{need.stack} bytes of stack"
    if need.spills:
        yield f"{need.spills} spilled"
    double = {"-DREAL=double", "-DNORMALS=1", "-DGRID=1"} <= set(program.options)
    most = EMIT_REGISTERS_DOUBLE if double else EMIT_REGISTERS
    if kernel == "emit" and target.vendor == "nvidia" and need.registers > most:
        yield f"{need.registers} registers"
    if need.local > LOCAL_BYTES_PER_BRICK * program.work_items // 32:
        yield f"{need.local} bytes of local memory"


def rises(need, known):
    for field, now, before in zip(Need._fields, need, known):
        if now < before if field == "resident" else now > before:
            yield f"{field} {before} before, now {now}"


def table_read(path):
    if not os.path.exists(path):
        return {"versions": {}, "programs": {}}
    with open(path, encoding="utf-8") as file:
        return json.load(file)


class Judge:
    """Compiles programs for targets, and keeps what is wrong with them."""

    def __init__(self, targets, table, work):
        self.targets, self.table, self.work = targets, table, work
        self.needs, self.failures, self.compiled = {}, [], 0

    def comparable(self, target):
        return all(self.table["versions"].get(name) == version for name, version in target.versions().items())

    def program(self, target, program):
        """(needs, findings) of one program for one target; a compiler's refusal is a finding."""
        try:
            return target.compile(program, self.work)
        except Refused as refused:
            return {}, [f"does not compile: {refused}"]

    def all(self, programs, compare):
        """compare: with the table's figures, which are those of groups of the size that the library takes."""
        jobs = [(target, program) for program in programs for target in self.targets
                if program.text.split(os.sep)[-2].split("-")[0] == target.device]
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            results = list(pool.map(lambda job: self.program(*job), jobs))
        for (target, program), (needs, findings) in zip(jobs, results):
            self.compiled += 1
            where = f"{program.name}, {program.work_items} work-items, {target.arch}"
            self.failures += [f"{where}: {finding}" for finding in findings]
            for kernel, need in needs.items():
                self.failures += [f"{where}: {kernel}: {broken}"
                                  for broken in rules_broken(target, kernel, need, program)]
                known = self.table["programs"].get(program.name, {}).get(kernel, {}).get(target.arch)
                if compare and known and self.comparable(target):
                    self.failures += [f"{where}: {kernel}: {rise}" for rise in rises(need, known)]
                if compare and not known:
                    self.failures.append(f"{where}: {kernel}: not in the table: run offline.py renew")
                self.needs.setdefault(program.name, {}).setdefault(kernel, {})[target.arch] = need


def programs_write(texts, device, work_items, work):
    """The library's programs for a device; work_items 0: groups of the size that it takes."""
    folder = os.path.join(work, f"{device}-{work_items}")
    os.mkdir(folder)
    done = subprocess.run([texts, device, str(work_items), folder], stdout=subprocess.PIPE, text=True, check=True)
    size = int(done.stdout.split(" programs, ")[1].split()[0])
    names = sorted(name[:-3] for name in os.listdir(folder) if name.endswith(".cl"))
    return [Program(name, os.path.join(folder, f"{name}.cl"), options_read(os.path.join(folder, f"{name}.options")),
                    size) for name in names]


def planted_check(targets, work):
    """Every fault is found, and nothing where there is none."""
    found = 0
    for fault, arch, body, wanted in PLANTED:
        for target in (target for target in targets if target.arch == arch):
            if wanted == "stack" and target.advice:  # nothing here tells what machine code needs
                continue
            folder = os.path.join(work, f"{target.device}-planted")
            os.makedirs(folder, exist_ok=True)
            path = os.path.join(folder, f"{fault}-{arch}.cl")
            with open(path, "w", encoding="utf-8") as file:
                file.write("#pragma OPENCL FP_CONTRACT OFF\n#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n"
                           "kernel void work(global const float *in, global float *out) {\n"
                           f"    size_t n = get_global_id(0);\n    {body}\n}}\n")
            judge = Judge([target], {"versions": {}, "programs": {}}, work)
            judge.all([Program(f"{fault}-{arch}", path, ["-cl-std=CL1.2"], 64)], False)
            if bool(wanted) != bool(judge.failures) or (wanted and wanted not in judge.failures[0]):
                sys.exit(f"planted fault '{fault}' on {arch}: wanted {wanted!r}, found {judge.failures}")
            found += wanted is not None
    return found


def targets_make(vendors, tools):
    """The targets of these vendors; those that something is lacking for are told."""
    targets, lacking = [], []
    for arch, kind in KINDS.items():
        if kind.vendor in vendors:
            try:
                targets.append(kind(arch, tools))
                lacking += [targets[-1].advice] if targets[-1].advice else []
            except Lacks as lacks:
                lacking.append(str(lacks))
    return targets, sorted(set(lacking))


def worst_of(needs, kernel, arch):
    """Of all programs' kernels of this name."""
    found = [kernels[kernel][arch] for kernels in needs.values() if kernel in kernels and arch in kernels[kernel]]
    return [max(values) for values in list(zip(*found))[:-1]] + [min(need.resident for need in found)]


def table_write(path, judge, planted, seconds):
    versions = {}
    for target in judge.targets:
        versions.update(target.versions())
    programs = judge.needs
    kernels = sorted({kernel for kernels in programs.values() for kernel in kernels})
    arches = [target.arch for target in judge.targets if target.vendor != "spirv"]
    worst = {kernel: {arch: worst_of(programs, kernel, arch) for arch in arches} for kernel in kernels}
    all_worst = [need for of in worst.values() for need in of.values()]
    figures = [("programs compiled for GPUs of NVIDIA and AMD and to SPIR-V, without a device", judge.compiled),
               ("kernels of these on GPUs", sum(len(of) for kernels in programs.values() for of in kernels.values())),
               ("bytes of stack, at most", max(need[1] for need in all_worst)),
               ("registers spilled to it, at most", max(need[2] for need in all_worst)),
               ("scalar registers of AMD's waves kept in vector registers, at most", max(need[3] for need in all_worst)),
               ("registers of emit on NVIDIA's, at most", max(worst["emit"][arch][0] for arch in arches
                                                              if KINDS[arch].vendor == "nvidia")),
               ("fused, approximate or flushing operations", 0), ("planted faults found", planted)]
    head = {"part": "offline", "date": time.strftime("%Y-%m-%d"), "versions": versions, "seconds": round(seconds),
            "figures": [{"what": what, "value": value} for what, value in figures],
            "fields": list(Need._fields), "most": {target.arch: f"{target.most} {target.resident_name}"
                                                   for target in judge.targets if target.most}, "worst": worst}
    lines = [f'  {json.dumps(name)}: {json.dumps(programs[name])}' for name in sorted(programs)]
    shown = re.sub(r"\[\s+((?:\d+,\s+)*\d+)\s+\]", lambda found: f"[{' '.join(found[1].split())}]",
                   json.dumps(head, indent=1))  # numbers of a kernel on one line
    text = shown[:-2] + ',\n "programs": {\n' + ",\n".join(lines) + "\n }\n}\n"
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def needs_show(judge):
    print("\n".join(failure for failure in judge.failures if "does not compile" in failure))
    print("program, kernel, target:", ", ".join(Need._fields))
    for name, kernels in judge.needs.items():
        for kernel, targets in kernels.items():
            for arch, need in targets.items():
                print(f"{name:44} {kernel:16} {arch:8}", *(f"{value:5}" for value in need))
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("tier", choices=["quick", "long", "renew", "show"])
    parser.add_argument("vendor", nargs="?", choices=["nvidia", "amd", "spirv"])
    for name in ("texts", "tools", "table"):
        parser.add_argument(f"--{name}", required=True)
    options = parser.parse_args()
    vendors = [options.vendor] if options.vendor else ["nvidia", "amd", "spirv"]
    start, whole = time.monotonic(), options.tier == "long"
    targets, lacking = targets_make(vendors, options.tools)
    renews = options.tier == "renew"
    if lacking and (whole or renews or not targets):
        print("\n".join(["skipped:"] + lacking))
        return 77
    table = table_read(options.table)
    with tempfile.TemporaryDirectory() as work:
        planted = planted_check(targets, work) if options.tier != "show" else 0
        judge = Judge(targets, table, work)
        for device in sorted({target.device for target in targets}):
            programs = programs_write(options.texts, device, 0, work)
            judge.all([program for program in programs if whole or program.name in SAMPLE],
                      options.tier == "quick")
            for size in OTHER_SIZES if whole else []:
                judge.all([program for program in programs_write(options.texts, device, size, work)
                           if program.name in SAMPLE], False)
    if options.tier == "show":
        return needs_show(judge)
    print(f"{judge.compiled} programs compiled for {', '.join(target.arch for target in targets)}; "
          f"{planted} planted faults found")
    if judge.failures:
        print("\n".join(judge.failures))
        print(f"{len(judge.failures)} failed")
        return 1
    folder = os.environ.get("TETRACUBES_RESULTS") if whole else None
    path = options.table if renews else os.path.join(folder, "offline.json") if folder else None
    if path:
        table_write(path, judge, planted, time.monotonic() - start)
    if lacking:
        print("\n".join(["skipped in part:"] + lacking))
        return 77
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""targets.py - compiles one program's text for a kind of device that is not there, and tells what its kernels need

NVIDIA: clang to PTX, ptxas to machine code. AMD: clang to LLVM's intermediate text, then to assembly. SPIR-V: clang,
unoptimised as Mesa takes it, and LLVM's translator, then Khronos's validator.

Findings are sentences; the bits of results depend on what they say: no fused multiply-add, no approximate operation, no
subnormal number flushed. Occupancy is computed from the vendors' published limits: CUDA C++ Programming Guide, table of
compute capabilities; AMD's instruction set documents of CDNA 2, CDNA 3 and RDNA 3.
"""
import glob
import os
import re
import shlex
import shutil
import subprocess
from typing import NamedTuple


class Need(NamedTuple):
    """What a work-item of a kernel needs: registers; bytes on a stack; bytes or registers that were spilled to it; AMD:
    a wave's scalar registers that did not fit and are kept in vector registers, which are counted there; bytes of local
    memory of a group; warps or waves that are resident at once."""
    registers: int
    stack: int
    spills: int
    scalars: int
    local: int
    resident: int


class Program(NamedTuple):
    name: str
    text: str  # file
    options: list
    work_items: int


class Lacks(Exception):
    """A tool that is not there; says how to get it."""


class Refused(Exception):
    """What a compiler said."""


def run(command):
    done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", check=False)
    if done.returncode:
        raise Refused(f"{' '.join(map(str, command))}\n{done.stdout[-3000:]}")
    return done.stdout


def version_of(program):
    return re.search(r"\d+\.\d+(?:\.\d+)?", run([program, "--version"]).split("release")[-1])[0]


def program_find(name, advice, *more):
    for place in more + (name,):
        found = shutil.which(place)
        if found:
            return found
    raise Lacks(f"no {name}: {advice}")


def clang_find():
    """The one whose tables are committed: earlier ones do not know all of these GPUs."""
    return program_find("clang-19", "apt install clang-19")


def file_find(folder, name):
    path = os.path.join(folder, name)
    if not os.path.exists(path):
        raise Lacks(f"no {path}: bash tests/offline/tools {folder}")
    return path


def clang_options(program, builtins=None):
    options = ["-x", "cl", "-D__OPENCL_VERSION__=120", "-fno-builtin", "-Xclang", "-finclude-default-header", "-Werror",
               "-Wno-linker-warnings"] + program.options
    if builtins:
        options += ["-Xclang", "-mlink-builtin-bitcode", "-Xclang", builtins]
    return options + [program.text]


def up(number, unit):
    return -(-number // unit) * unit


def text_findings(text, patterns):
    """A sentence for each pattern that a line holds."""
    found = []
    for pattern, what in patterns:
        match = re.search(rf"^.*(?:{pattern}).*$", text, re.M)
        if match:
            found.append(f"{what}: {match[0].strip()[:160]}")
    return found


class Nvidia:
    vendor, device, resident_name = "nvidia", "nvidia", "warps"

    # Of a multiprocessor: warps, groups, bytes of shared memory.
    LIMITS = {"sm_80": (64, 32, 164 << 10), "sm_90": (64, 32, 228 << 10)}

    FORBIDDEN = [(r"\b(?:fma|mad)(?:\.\w+)*\.f(?:32|64)", "fused multiply-add"), (r"\.ftz", "subnormals flushed"),
                 (r"\.approx", "approximate operation"), (r"div\.full", "approximate division")]

    def __init__(self, arch, tools):
        self.arch, self.most = arch, self.LIMITS[arch][0]
        self.clang = clang_find()
        self.builtins = file_find(tools, "nvptx64--nvidiacl.bc")
        self.ptxas = None
        self.advice = ""
        try:
            self.ptxas = program_find("ptxas", f"bash tests/offline/tools {tools}, or NVIDIA's CUDA toolkit",
                                      os.path.join(tools, "ptxas"), "/usr/local/cuda/bin/ptxas")
        except Lacks as lacks:
            self.advice = str(lacks)

    def versions(self):
        versions = {"clang": version_of(self.clang)}
        return dict(versions, ptxas=version_of(self.ptxas)) if self.ptxas else versions

    def resident(self, registers, local, work_items):
        warps, groups, shared = self.LIMITS[self.arch]
        per_group = up(work_items, 32) // 32
        by_registers = 65536 // (up(max(registers, 1), 8) * 32) // per_group
        by_memory = shared // (up(local, 128) + 1024)
        return per_group * min(groups, warps // per_group, by_registers, by_memory)

    def compile(self, program, work):
        ptx = os.path.join(work, f"{program.name}.{self.arch}.ptx")
        run([self.clang, "--target=nvptx64-nvidia-cuda", f"-march={self.arch}", "-O3", "-S", "-o", ptx,
             *clang_options(program, self.builtins)])
        with open(ptx, encoding="utf-8") as file:
            text = file.read()
        findings = text_findings(text, self.FORBIDDEN)
        divides = "-DREAL=float" in program.options and any(o.startswith("-DDIVISION") for o in program.options)
        if divides and "div.rn.f32" not in text:
            findings.append("no division in PTX")
        if not self.ptxas:
            return {}, findings
        said = run([self.ptxas, "-v", f"-arch={self.arch}", ptx, "-o", "/dev/null"])
        needs = {}
        for part in said.split("Compiling entry function ")[1:]:
            stack, stores, loads = map(int, re.search(
                r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads", part).groups())
            registers = int(re.search(r"Used (\d+) registers", part)[1])
            local = int((re.search(r"(\d+) bytes smem", part) or [0, 0])[1])
            needs[re.match(r"'(\w+)'", part)[1]] = Need(registers, stack, stores + loads, 0, local,
                                                       self.resident(registers, local, program.work_items))
        return needs, findings


IR_FORBIDDEN = [(r"call .*@llvm\.(?:fma|fmuladd)\.", "fused multiply-add"),
                (r"= f(?:add|sub|mul|div|neg) (?:fast|reassoc|nnan|ninf|nsz|arcp|contract|afn)\b",
                 "relaxed arithmetic"),
                (r"= fdiv .*!fpmath", "division that need not be rounded correctly"),
                (r"call .*@llvm\.sqrt\..*!fpmath", "root that need not be rounded correctly"),
                (r'"denormal-fp-math(?:-f32)?"="(?!ieee)', "subnormals flushed")]


class Amd:
    vendor, device, resident_name = "amd", "amd", "waves"

    # Work-items of a wave; of a SIMD waves and vector registers, and the unit that these are given in; of a unit of
    # computation SIMDs, groups with barriers, bytes of local memory.
    LIMITS = {"gfx90a": (64, 8, 512, 8, 4, 16, 64 << 10), "gfx942": (64, 8, 512, 8, 4, 16, 64 << 10),
              "gfx1100": (32, 16, 1536, 24, 2, 16, 64 << 10)}

    def __init__(self, arch, tools):
        self.arch, self.most = arch, self.LIMITS[arch][1]
        self.clang = clang_find()
        self.builtins = file_find(tools, f"{arch}-amdgcn-mesa-mesa3d.bc")
        self.advice = ""

    def versions(self):
        return {"clang": version_of(self.clang)}

    def resident(self, registers, local, work_items):
        wave, waves, total, unit, simds, groups, memory = self.LIMITS[self.arch]
        per_group = up(work_items, wave) // wave
        if per_group > 1:
            groups = min(groups, memory // max(local, 1))
            waves = min(waves, groups * per_group // simds)
        return min(waves, total // up(max(registers, 1), unit))

    def compile(self, program, work):
        base = os.path.join(work, f"{program.name}.{self.arch}")
        target = ["--target=amdgcn-mesa-mesa3d", f"-mcpu={self.arch}", "-O3", "-S"]
        run([self.clang, *target, "-nogpulib", "-emit-llvm", "-o", f"{base}.ll",
             *clang_options(program, self.builtins)])
        with open(f"{base}.ll", encoding="utf-8") as file:
            text = file.read()
        if "-DNORMALS=1" in program.options:
            text = re.sub(r".*@llvm\.fma\.f64.*\n", "", text)  # libclc's root of a double is made of them
        findings = text_findings(text, IR_FORBIDDEN)
        said = run([self.clang, *target, "-x", "ir", "-Rpass-analysis=kernel-resource-usage", "-o", f"{base}.s",
                    f"{base}.ll"])
        needs = {}
        for part in said.split("Function Name: ")[1:]:
            value = {key: int(number) for key, number in
                     re.findall(r"remark: <unknown>:0:0: +([A-Z][\w ]*?)(?: \[[^]]+\])?: (\d+)", part)}
            registers = value["VGPRs"] + value.get("AGPRs", 0)
            local = value["LDS Size"]
            needs[part.split()[0]] = Need(registers, value["ScratchSize"], value["VGPRs Spill"], value["SGPRs Spill"],
                                          local, self.resident(registers, local, program.work_items))
        return needs, findings


class SpirV:
    vendor, device, resident_name = "spirv", "plain", ""

    CAPABILITIES = {"Addresses", "Linkage", "Kernel", "Vector16", "Int64", "Int16", "Int8"}

    def __init__(self, arch, tools):
        del tools
        self.arch, self.most, self.advice = arch, 0, ""
        pairs = [(int(path.rsplit("-", 1)[1]), path) for folder in os.environ["PATH"].split(":")
                 for path in glob.glob(f"{folder}/llvm-spirv-[0-9]*")]
        both = [(number, path) for number, path in sorted(pairs) if shutil.which(f"clang-{number}")]
        if not both:
            raise Lacks("no clang with LLVM's translator of the same version: apt install clang-15 llvm-spirv-15 "
                        "(Debian 13: 19)")
        self.clang, self.translator = f"clang-{both[-1][0]}", both[-1][1]
        self.validator = program_find("spirv-val", "apt install spirv-tools")
        self.disassembler = program_find("spirv-dis", "apt install spirv-tools")

    def versions(self):
        return {"llvm-spirv": version_of(self.translator),
                "spirv-val": re.search(r"v\d[\d.]*", run([self.validator, "--version"]))[0]}

    def compile(self, program, work):
        base = os.path.join(work, program.name)
        run([self.clang, "--target=spir64-unknown-unknown", "-O0", "-Xclang", "-disable-llvm-passes", "-emit-llvm",
             "-c", "-o", f"{base}.bc", *clang_options(program)])
        run([self.translator, "--spirv-max-version=1.0", f"{base}.bc", "-o", f"{base}.spv"])
        run([self.validator, "--target-env", "opencl1.2", f"{base}.spv"])
        text = run([self.disassembler, f"{base}.spv"])
        findings = [f"wants {name} of the device" for name in
                    sorted(set(re.findall(r"OpCapability (\w+)", text)) - self.CAPABILITIES)]
        return {}, findings + text_findings(text, [
            (r"OpExtInst .* (?:fma|mad|(?:native|half)_\w+) ", "fused or approximate operation"),
            (r"OpFDiv|OpExtInst .* sqrt ", "division or root where the device rounds neither correctly")])


KINDS = {"sm_80": Nvidia, "sm_90": Nvidia, "gfx90a": Amd, "gfx942": Amd, "gfx1100": Amd, "spirv": SpirV}


def options_read(path):
    with open(path, encoding="utf-8") as file:
        return shlex.split(file.read().replace("(", "\\(").replace(")", "\\)"))

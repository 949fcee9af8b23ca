#!/usr/bin/env python3
"""systems.py demo|whole [SUITE...] - README's commands on bare systems: fresh chroots of Debian's releases

demo: the first command, by a user with sudo, which installs what is missing.
whole: that, then the second command by root, then the same bytes from every driver of OpenCL that the release has
(drivers.py). With TEST_BYTES in the environment, that program, Intel's runtime is tried on this machine: it comes by
pip. With TETRACUBES_RESULTS in it, a folder, what was seen goes to systems.json there, after each system; what the file
tells of systems that are not tried this time stays.

SUITE: bookworm (Debian 12), trixie (13), sid; without any all three. Of sid, an outlook, failures are told and are none
of this run. Needs root, debootstrap and a mirror of Debian: the one that apt uses here, else debootstrap's own. Exit
status 77 where that is missing. Chroots are made in TETRACUBES_CHROOTS, left out the folder for temporary files, about
4 GB each, and removed.
"""
import datetime
import glob
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
from part import part_write

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SUITES = {"bookworm": "Debian 12", "trixie": "Debian 13", "sid": "Debian unstable"}
OUTLOOK = {SUITES["sid"]}
HERE = "this machine"
ORDER = [*SUITES.values(), HERE]
USER = "tester"
DRIVERS = ["mesa-opencl-icd"]  # beside what tests/setup installs
PACKAGES = ["gcc", "cmake", "libexpat1", "pocl-opencl-icd", "mesa-opencl-icd", "oclgrind", "python3"]

# Namespaces of its own: no mount and no process outlives the command.
IN_CHROOT = ('mount -t proc proc "$1/proc" && mount --rbind /dev "$1/dev" && mount --rbind /sys "$1/sys" && '
             'exec chroot "$1" /bin/sh -c "$2"')


class Failed(Exception):
    pass


def today():
    return datetime.date.today().isoformat()


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(77)


def needs_check():
    if os.geteuid() != 0:
        skip("chroots are made by root")
    for program in ("debootstrap", "unshare"):
        if not shutil.which(program):
            skip(f"no {program} (Debian: apt install debootstrap util-linux)")


def mirror():
    """Of Debian, as apt uses it here; None: debootstrap knows one."""
    done = subprocess.run(["apt-get", "indextargets", "--format", "$(REPO_URI) $(ORIGIN) $(LABEL)",
                           "Created-By: Packages"], stdout=subprocess.PIPE, text=True, check=False)
    found = re.search(r"^(http\S+) Debian Debian$", done.stdout, re.M)
    return found[1] if found else None


def run(command, log, **how):
    """Appends what it says to the log; what it said last where it fails."""
    with open(log, "a", encoding="utf-8") as out:
        status = subprocess.run(command, stdout=out, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, check=False,
                                **how).returncode
    if status:
        with open(log, encoding="utf-8", errors="replace") as said:
            raise Failed(f"status {status}\n" + said.read()[-2000:])


def within(chroot, command, log):
    ours = [word for name in os.environ if name.startswith(("TETRACUBES_", "TEST_")) for word in ("-u", name)]
    run(["env", *ours,
         "unshare", "--mount", "--pid", "--fork", "--kill-child", "sh", "-c", IN_CHROOT, "sh", chroot, command], log)


def chroot_make(suite, chroot, log):
    where = mirror()
    run(["debootstrap", "--variant=minbase", suite, chroot] + ([where] if where else []), log)
    for path in glob.glob("/etc/apt/apt.conf.d/*"):  # a proxy, how dates are checked
        with open(path, encoding="utf-8", errors="replace") as file:
            if re.search(r"^Acquire::(http|https|Check)", file.read(), re.M):
                shutil.copy(path, f"{chroot}/etc/apt/apt.conf.d/")
    within(chroot, "apt-get update && apt-get install -y --no-install-recommends sudo ca-certificates && "
           f"useradd -m {USER} && echo '{USER} ALL=(ALL) NOPASSWD: ALL' > /etc/sudoers.d/{USER}", log)


def sources_copy(folder):
    """What git tracks, as it is here."""
    os.makedirs(folder)
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], stdout=subprocess.PIPE, check=True).stdout
    subprocess.run(["tar", "-C", ROOT, "--null", "-T", "-", "-c", "-f", f"{folder}.tar"], input=listed, check=True)
    subprocess.run(["tar", "-C", folder, "-x", "-f", f"{folder}.tar"], check=True)
    os.unlink(f"{folder}.tar")


def versions(chroot):
    names = " ".join(PACKAGES)
    done = subprocess.run(["chroot", chroot, "dpkg-query", "-W", "-f=${Package} ${Version}\n", *names.split()],
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=False)
    return dict(line.split() for line in done.stdout.splitlines() if len(line.split()) == 2)


def command_try(name, chroot, command, log):
    """One line of what was seen."""
    start, outcome = time.time(), "passed"
    place = os.path.getsize(log) if os.path.exists(log) else 0
    try:
        within(chroot, command, log)
    except Failed as failed:
        outcome = str(failed)
    with open(log, encoding="utf-8", errors="replace") as said:
        said.seek(place)
        tests = re.search(r"(\d+)% tests passed, (\d+) tests failed out of (\d+)", said.read())
    line = {"command": name, "outcome": outcome, "seconds": round(time.time() - start)}
    if tests:
        line["tests"], line["failed"] = int(tests[3]), int(tests[2])
    print(f"  {name}: {outcome}, {line['seconds']} s{', ' + tests[0] if tests else ''}", flush=True)
    return line


def suite_try(tier, suite, folder):
    chroot, log = os.path.join(folder, suite), os.path.join(folder, f"{suite}.log")
    print(f"{SUITES.get(suite, suite)}:", flush=True)
    chroot_make(suite, chroot, log)
    sources_copy(f"{chroot}/home/{USER}/tetracubes")
    seen = {"system": SUITES.get(suite, suite), "date": today(), "commands": [], "drivers": []}

    def try_it(name, command):
        seen["commands"].append(command_try(name, chroot, command, log))

    try_it("bash tests/demo, by a user with sudo",
           f"chown -R {USER} /home/{USER} && su {USER} -c 'cd ~/tetracubes && bash tests/demo'")
    if tier == "whole":
        sources_copy(f"{chroot}/root/tetracubes")
        try_it("bash tests/all, by root", "cd /root/tetracubes && bash tests/all")
        try_it("bash tests/analysis, by root", "cd /root/tetracubes && bash tests/analysis")
        try_it("drivers", f"apt-get install -y --no-install-recommends {' '.join(DRIVERS)} && cd /root/tetracubes && "
               f"python3 tests/systems/drivers.py build/tests/bytes/test_bytes --out /drivers.json")
        if os.path.exists(f"{chroot}/drivers.json"):
            with open(f"{chroot}/drivers.json", encoding="utf-8") as file:
                seen["drivers"] = json.load(file)
    seen["versions"] = versions(chroot)
    shutil.rmtree(chroot, ignore_errors=True)
    return seen


def machine_try(program, folder):
    """Drivers that no release has as a package, tried on this machine."""
    out = os.path.join(folder, "drivers.json")
    subprocess.run([sys.executable, os.path.join(ROOT, "tests", "systems", "drivers.py"), program, "--out", out,
                    "--folder", os.path.join(folder, "second"), "--only", "Intel"], check=False)
    with open(out, encoding="utf-8") as file:
        return {"system": HERE, "date": today(), "commands": [], "drivers": json.load(file), "versions": {}}


def differences(seen):
    """Drivers of any system whose hash is another one."""
    lines = [(one["system"], line) for one in seen for line in one["drivers"]]
    return [f"{system}: {line['driver']}, {line['text']}: {line['outcome']}, {line['hash']}" for system, line in lines
            if line["hash"] != lines[0][1]["hash"] or line["outcome"] != "same bytes"]


def told_before(folder, tried):
    """What systems.json tells of other systems than those tried."""
    try:
        with open(os.path.join(folder, "systems.json"), encoding="utf-8") as file:
            told = json.load(file)
    except FileNotFoundError:
        return []
    return [dict(one, drivers=[line for line in told["drivers"] if line["system"] == one["system"]])
            for one in told["systems"] if one["system"] not in tried]


def results_write(seen):
    folder = os.environ.get("TETRACUBES_RESULTS")
    if not folder:
        return
    seen = sorted(seen + told_before(folder, [one["system"] for one in seen]), key=lambda one: ORDER.index(one["system"]))
    lines = [{key: value for key, value in dict(line, system=one["system"]).items() if key != "hashes"}
             for one in seen for line in one["drivers"]]
    bare = [one for one in seen if one["commands"]]
    figures = [("bare systems on which both commands pass",
                sum(all(line["outcome"] == "passed" for line in one["commands"][:2]) for one in bare)),
               ("of them tried", len(bare)), ("drivers and texts with the same bytes in every case",
                                              sum(line["outcome"] == "same bytes" for line in lines)),
               ("of them tried", len(lines))]
    versions_of = {f"{one['system']}, {name}": version for one in seen for name, version in one["versions"].items()
                   if name in ("gcc", "libexpat1")}
    part_write("systems", versions_of, figures, sum(line["seconds"] for one in seen for line in one["commands"]),
               date=max(one["date"] for one in seen), drivers=lines,
               systems=[{key: one[key] for key in ("system", "date", "commands", "versions")} for one in seen])


def main():
    tier, suites = sys.argv[1], sys.argv[2:] or list(SUITES)
    needs_check()
    seen = []
    with tempfile.TemporaryDirectory(dir=os.environ.get("TETRACUBES_CHROOTS"), ignore_cleanup_errors=True) as folder:
        for suite in suites:
            try:
                seen.append(suite_try(tier, suite, folder))
                if tier == "whole":
                    results_write(seen)
            except Failed as failed:
                print(f"  no chroot of {suite}: {failed}")
                if tier == "demo" and "debootstrap" in str(failed):
                    sys.exit(77)
                sys.exit(1)
        if tier == "whole" and os.environ.get("TEST_BYTES"):
            seen.append(machine_try(os.environ["TEST_BYTES"], folder))
            results_write(seen)
    wrong = [f"{one['system']}: {line['command']}: {line['outcome']}" for one in seen if one["system"] not in OUTLOOK
             for line in one["commands"] if line["outcome"] != "passed"] + differences(seen)
    print("\n".join(wrong))
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()

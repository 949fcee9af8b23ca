"""results.py - what the long tests of this folder share: commands run, and figures kept"""
import json
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
from part import part_write


def run(command, check=True, **more):
    """A finished process with both streams as one text."""
    done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          encoding="utf-8", errors="replace", check=False, **more)
    if check and done.returncode:
        sys.exit(f"{' '.join(map(str, command))}: exit status {done.returncode}\n{done.stdout[-4000:]}")
    return done


def tool_version(name):
    """(name, version) of a program that may not be there."""
    if not shutil.which(name):
        return (name, "not installed")
    found = re.search(r"\d+\.\d+(?:\.\d+)?", run([name, "--version"], check=False).stdout)
    return (name, found[0] if found else "unknown")


class Part:
    """PART.json in the folder that TETRACUBES_RESULTS names, if it names one."""

    def __init__(self, name, versions):
        self.name, self.versions, self.figures, self.start = name, dict(versions), [], time.monotonic()

    def figure(self, what, value):
        print(f"{what}: {value}", flush=True)
        self.figures.append((what, value))

    def renew(self):
        """Replaces its figures in the file of an earlier whole run, and leaves the others."""
        path = Path(os.environ.get("TETRACUBES_RESULTS", ".")) / f"{self.name}.json"
        if not os.environ.get("TETRACUBES_RESULTS") or not path.exists():
            return
        text = json.loads(path.read_text(encoding="utf-8"))
        fresh = dict(self.figures)
        for figure in text["figures"]:
            figure["value"] = fresh.get(figure["what"], figure["value"])
        path.write_text(json.dumps(text, indent=1) + "\n", encoding="utf-8")

    def write(self, **details):
        part_write(self.name, self.versions, self.figures, time.monotonic() - self.start, **details)

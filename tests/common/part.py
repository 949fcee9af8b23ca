"""part.py - figures of a part of the long tier: PART.json in the folder that TETRACUBES_RESULTS names, if it does"""
import json
import os
import time
from pathlib import Path


def part_write(name, versions, figures, seconds, **details):
    """figures: pairs of what was counted and the value, as tests/figures.py shows them. details may have a date."""
    folder = os.environ.get("TETRACUBES_RESULTS")
    if not folder:
        return
    text = {"part": name, "date": time.strftime("%Y-%m-%d"), "versions": versions, "seconds": round(seconds),
            "figures": [{"what": what, "value": value} for what, value in figures], **details}
    Path(folder).mkdir(parents=True, exist_ok=True)
    (Path(folder) / f"{name}.json").write_text(json.dumps(text, indent=1) + "\n", encoding="utf-8")

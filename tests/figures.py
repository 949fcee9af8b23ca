#!/usr/bin/env python3
"""figures.py - tables of what the long tier tried and found, in tests/README.md, from tests/results

    figures.py [--results FOLDER] [--page FILE]

Each file PART.json has `part`, `date`, `versions`, `seconds` and `figures`, a list of {`what`, `value`}. The table goes
between the page's trust:begin and trust:end comments, behind it one of `drivers`, where a part has such a list (those of
tests/systems/drivers.py, each with its system); what kernels need on GPUs, from offline.json, between offline:begin and
offline:end. tests/package/test_readme.py compares both with the results.
"""

import argparse
import json
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def shown(value):
    if isinstance(value, float):
        return f"{value:,.4g}"
    return f"{value:,}" if isinstance(value, int) else str(value)


def rows(result):
    lines = [f"{figure['what']}: **{shown(figure['value'])}**" for figure in result["figures"]]
    return f"| {result['part'].replace('_', ' ')} | {'; '.join(lines)} | {result['date']} |"


def versions(results):
    """All programs that the parts name, each once with its versions."""
    known = {}
    for result in results:
        for name, version in result["versions"].items():
            known.setdefault(name, set()).add(str(version) if name in str(version) else f"{name} {version}")
    texts = [" and ".join(sorted(known[name])) for name in sorted(known, key=str.lower)]
    return ", ".join(dict.fromkeys(texts))


def drivers(results):
    """A line for every driver and variant of the kernels; none where nothing has been tried."""
    found = [line for result in results for line in result.get("drivers", [])]
    if not found:
        return []
    lines = ["", "Every driver, in each variant of the kernels that it takes. The hash is that of all cases' hashes: it "
             "is the same where the cases are, which have grown since some systems were tried; cases that a device "
             "without fp64 refuses count as the reference's.", "",
             "| driver | version | system | text | cases | hash |", "| --- | --- | --- | --- | --: | --- |"]
    return lines + [f"| {line['driver']} | {line['version']} | {line['system']} | {line['text']} | {line['cases']} | "
                    f"{line['hash'] if line['outcome'] == 'same bytes' else 'failed'} |" for line in found]


def table(results):
    lines = ["| part | tried and found | on |", "| --- | --- | --- |"]
    lines += [rows(result) for result in results]
    return "\n".join(lines + ["", f"With {versions(results)}."] + drivers(results))


def needs(offline):
    """What each kernel needs on each GPU, in the program of all that needs most."""
    if not offline:
        return ""
    targets = list(offline["most"])
    lines = ["| kernel | " + " | ".join(f"{target}, {offline['most'][target]}" for target in targets) + " |",
             "| --- |" + " --: |" * len(targets)]
    for kernel, of in offline["worst"].items():
        cells = []
        for target in targets:
            need = dict(zip(offline["fields"], of[target]))
            cells.append(f"{need['registers']} / {need['local']:,} / **{need['resident']}**")
        lines.append(f"| {kernel} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def replaced(text, name, inner):
    begin, end = f"<!-- {name}:begin -->", f"<!-- {name}:end -->"
    before, rest = text.split(begin)
    return f"{before}{begin}\n{inner}\n{end}{rest.split(end)[1]}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--results", type=Path, default=ROOT / "tests" / "results", metavar="FOLDER")
    parser.add_argument("--page", type=Path, default=ROOT / "tests" / "README.md", metavar="FILE")
    options = parser.parse_args()
    results = [json.loads(path.read_text()) for path in sorted(options.results.glob("*.json"))]
    offline = next((result for result in results if result["part"] == "offline"), None)
    text = replaced(options.page.read_text(), "trust", table(results))
    options.page.write_text(replaced(text, "offline", needs(offline)))


if __name__ == "__main__":
    main()

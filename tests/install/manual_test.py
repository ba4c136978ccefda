"""The manual renders without a complaint, and names every option and every key that there is, and no other.

Usage: manual_test.py TREE SOURCE      TREE: where bin, lib and share are installed
"""

import pathlib
import re
import shutil
import subprocess
import sys

from configuration_keys import keys_by_table
from programs import commands


def complaints(page):
    if shutil.which("mandoc"):
        lint = subprocess.run(["mandoc", "-T", "lint", "-W", "warning", page], capture_output=True, text=True)
        return lint.stdout
    if shutil.which("groff"):
        lint = subprocess.run(["groff", "-mdoc", "-Tutf8", "-Kutf8", "-ww", "-z", page], capture_output=True, text=True)
        return lint.stderr
    return ""


def command_faults(page, program):
    """Of the commands that have no others below them, and of all options."""
    known, text = commands(program), page.read_text()
    parents = {path[:-1] for path in known if path}
    for path in known.keys() - parents:
        if path and not re.search(rf"^[.]Ss {' '.join(path)}\b", text, flags=re.MULTILINE):
            yield f"{page.name} does not tell of {' '.join(path)}"
    told = set(re.findall(r"\bFl (-?[\w-]+)", text))
    for path, options in known.items():
        for names in options:
            for name in names:
                if name[1:] not in told:
                    yield f"{page.name} does not tell of {' '.join(path)} {name}"


def told_keys(page):
    """By the table that a section is headed with, or that an item introduces."""
    tables, table = {}, None
    for line in page.read_text().splitlines():
        if heading := re.match(r"[.]Ss \[(\w+)\]|[.]It Cm \[\[(\w+)\]\]", line):
            table = tables.setdefault(heading[1] or heading[2], set())
        elif line.startswith((".Ss", ".Sh")):
            table = None
        elif line.startswith(".It Cm ") and table is not None:
            table |= set(re.findall(r"\w+", line.removeprefix(".It Cm ")))
    return tables


def key_faults(page, source):
    known, told = keys_by_table(source), told_keys(page)
    for table in sorted(known | told):
        here, there = known.get(table, set()), told.get(table, set())
        yield from (f"{page.name} does not tell of {table}.{key}" for key in sorted(here - there))
        yield from (f"{page.name} tells of {table}.{key}, which there is not" for key in sorted(there - here))


def main():
    tree, source = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    manual = tree / "share/man"
    faults = [text for page in sorted(manual.glob("man*/*")) if (text := complaints(page))]
    faults += command_faults(manual / "man1/gimbalctl.1", tree / "bin/gimbalctl")
    faults += command_faults(manual / "man8/gimbald.8", tree / "bin/gimbald")
    faults += key_faults(manual / "man5/gimbald.toml.5", source)
    sys.exit("\n".join(faults) or 0)


main()

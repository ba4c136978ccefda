"""systemd takes the units without a complaint, and finds them well shut in.

Usage: units_test.py TREE SOURCE      TREE: where bin, lib and share are installed
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

UNITS = ["gimbald.service", "gimbald@.service"]
MOST_EXPOSURE = 2.5


def in_reach(unit, tree):
    """The unit with its program where it is now, which is not where it will be."""
    return re.sub(r"^ExecStart=\S+/gimbald", f"ExecStart={tree}/bin/gimbald", unit.read_text(),
                  flags=re.MULTILINE)


def run(*command, tree):
    manual = f"{tree}/share/man"
    done = subprocess.run(["systemd-analyze", *command], capture_output=True, text=True,
                          env={**os.environ, "MANPATH": manual, "SYSTEMD_COLORS": "0", "LC_ALL": "C.UTF-8"})
    return done.returncode, done.stdout + done.stderr


def faults_of(unit, tree):
    status, said = run("verify", "--man=yes" if shutil.which("man") else "--man=no", unit, tree=tree)
    about_ours = [line for line in said.splitlines() if "gimbald" in line]
    if status != 0 or about_ours:
        yield f"{unit.name} does not verify: {said}"

    status, said = run("security", "--offline=true", "--threshold=100", unit, tree=tree)
    found = re.search(r"Overall exposure level for \S+: ([0-9.]+)", said)
    if not found:
        yield f"{unit.name}: no exposure level: {said}"
    elif float(found[1]) > MOST_EXPOSURE:
        yield f"{unit.name}: exposure {found[1]} is more than {MOST_EXPOSURE}"


def main():
    tree = pathlib.Path(sys.argv[1])
    if not shutil.which("systemd-analyze"):
        print("skipped: no systemd-analyze on this machine")
        sys.exit(77)
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        for name in UNITS:
            unit = pathlib.Path(folder) / name
            unit.write_text(in_reach(tree / "lib/systemd/system" / name, tree))
            faults += faults_of(unit, tree)
    sys.exit("\n".join(faults) or 0)


main()

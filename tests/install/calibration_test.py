"""gimbalctl runs the program with the commands on OpenCV and Ceres where it is installed, and says so where it is not;
neither it nor the daemon loads these libraries itself.

Usage: calibration_test.py TREE      TREE: where bin, lib and share are installed
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

COMMANDS = (["sync"], ["calibrate", "intrinsics"])


def run(*words):
    return subprocess.run(words, capture_output=True, text=True)


def faults_where_installed(gimbalctl):
    for command in COMMANDS:
        if "--write" not in run(gimbalctl, *command, "--help").stdout:
            yield f"{' '.join(command)} --help is not that of the program in libexec"
        done = run(gimbalctl, *command, "/nowhere", "--json")
        if done.returncode != 2 or not done.stderr.startswith("gimbalctl: "):
            yield f"{' '.join(command)} of nothing: exit status {done.returncode}, {done.stderr}"


def faults_where_missing(gimbalctl):
    for command in COMMANDS:
        done = run(gimbalctl, *command, "/nowhere", "--json")
        if done.returncode != 2 or "gimbald-calibration" not in done.stderr or done.stderr.count("\n") != 1:
            yield f"{' '.join(command)} alone: exit status {done.returncode}, {done.stderr}"
        if (helped := run(gimbalctl, *command, "--help")).returncode != 0:
            yield f"{' '.join(command)} --help alone: exit status {helped.returncode}"


def libraries_of(program):
    return set(re.findall(r"libopencv_\w+|libceres", run("ldd", program).stdout))


def main():
    tree = pathlib.Path(sys.argv[1])
    gimbalctl = tree / "bin/gimbalctl"
    faults = list(faults_where_installed(gimbalctl))
    with tempfile.TemporaryDirectory() as folder:
        alone = shutil.copy(gimbalctl, folder)
        faults += faults_where_missing(alone)
    for program in (gimbalctl, tree / "bin/gimbald"):
        faults += [f"{name} is loaded by {program.name}" for name in libraries_of(program)]
    for file in ("gimbalctl-calibrate", "gimbald-corners.so"):
        if not libraries_of(tree / "libexec/gimbald" / file):
            faults.append(f"ldd does not show OpenCV where it must be: in {file}")
    sys.exit("\n".join(faults) or 0)


main()

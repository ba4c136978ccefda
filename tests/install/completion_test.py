"""bash completes every command and every option that --help names.

Usage: completion_test.py TREE SOURCE      TREE: where bin, lib and share are installed
"""

import pathlib
import shutil
import subprocess
import sys

from programs import commands

# As bash calls a completion: the words so far, the last of which is being written.
COMPLETE = """
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
_gimbald "$1" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
printf '%s\\n' "${COMPREPLY[@]}"
"""


def offered(script, *words):
    done = subprocess.run(["bash", "-c", COMPLETE, "bash", script, *words], check=True, capture_output=True, text=True)
    return set(done.stdout.split())


def faults_of(script, program):
    known = commands(program)
    for path, options in known.items():
        wanted = {name for names in options for name in names}
        if (found := offered(script, program, *path, "-")) != wanted:
            yield f"{program} {' '.join(path)} -: {found} instead of {wanted}"
        wanted = {other[-1] for other in known if other and other[:-1] == path}
        if (found := offered(script, program, *path, "")) != wanted:
            yield f"{program} {' '.join(path)}: {found} instead of {wanted}"


def main():
    tree = pathlib.Path(sys.argv[1])
    if not shutil.which("bash"):
        print("skipped: no bash on this machine")
        sys.exit(77)
    faults = []
    for name in ("gimbald", "gimbalctl"):
        script = tree / "share/bash-completion/completions" / name
        faults += faults_of(script, str(tree / "bin" / name))
    gimbalctl = str(tree / "bin/gimbalctl")
    script = tree / "share/bash-completion/completions/gimbalctl"
    if (found := offered(script, gimbalctl, "stabilize", "--warper", "")) != {"gles", "cpu"}:
        faults.append(f"--warper is completed with {found}")
    if (found := offered(script, gimbalctl, "stat")) != {"status"}:
        faults.append(f"stat is completed with {found}")
    sys.exit("\n".join(faults) or 0)


main()

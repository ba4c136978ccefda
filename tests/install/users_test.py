"""systemd-sysusers makes the service's user, in the groups that own the devices.

Usage: users_test.py TREE SOURCE      TREE: where bin, lib and share are installed
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile


def groups_of(user, etc):
    lines = [line.split(":") for line in (etc / "group").read_text().splitlines()]
    return {name for name, _, _, members in lines if user in members.split(",")}


def groups_of_rules(rules):
    return set(re.findall(r'GROUP="(\w+)"', rules.read_text()))


def main():
    tree = pathlib.Path(sys.argv[1])
    if not shutil.which("systemd-sysusers"):
        print("skipped: no systemd-sysusers on this machine")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        etc = pathlib.Path(folder) / "etc"
        etc.mkdir()
        users = tree / "lib/sysusers.d/gimbald.conf"
        made = subprocess.run(["systemd-sysusers", f"--root={folder}", users], capture_output=True, text=True)
        if made.returncode != 0:
            sys.exit(made.stderr)
        needed = {"video", "render"} | groups_of_rules(tree / "lib/udev/rules.d/60-gimbald.rules")
        lacking = needed - groups_of("gimbald", etc)
        sys.exit(f"gimbald is not in {', '.join(sorted(lacking))}" if lacking else 0)


main()

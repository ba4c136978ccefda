"""udev takes the rules, where it can be asked (udevadm verify, since systemd 254).

Usage: udev_rules_test.py TREE SOURCE      TREE: where bin, lib and share are installed
"""

import shutil
import subprocess
import sys


def main():
    udevadm = shutil.which("udevadm") or shutil.which("udevadm", path="/usr/bin:/usr/sbin:/bin:/sbin")
    if not udevadm or subprocess.run([udevadm, "verify", "--help"], capture_output=True).returncode != 0:
        print("skipped: no udevadm that verifies rules on this machine")
        sys.exit(77)
    rules = f"{sys.argv[1]}/lib/udev/rules.d/60-gimbald.rules"
    verified = subprocess.run([udevadm, "verify", "--resolve-names=never", rules], capture_output=True, text=True)
    sys.exit(verified.stdout + verified.stderr if verified.returncode != 0 else 0)


main()

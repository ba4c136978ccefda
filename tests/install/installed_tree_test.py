"""All that belongs to gimbald is installed, whole, and what somebody has configured stays.

Usage: installed_tree_test.py CMAKE BUILD ROOT PREFIX SYSCONF
Leaves it installed in ROOT, with the programs below PREFIX and the configuration in SYSCONF there.
"""

import os
import pathlib
import shutil
import subprocess
import sys

EXPECTED = """
bin/gimbald
bin/gimbalctl
lib/systemd/system/gimbald.service
lib/systemd/system/gimbald@.service
lib/sysusers.d/gimbald.conf
lib/udev/rules.d/60-gimbald.rules
share/bash-completion/completions/gimbald
share/bash-completion/completions/gimbalctl
share/gimbald/cameras/ipod-touch-4-720p.toml
share/gimbald/conf.d.examples/outputs.toml
share/gimbald/examples/replay.toml
share/gimbald/motions/iphone-handheld/gyro.csv
share/man/man1/gimbalctl.1
share/man/man5/gimbald.toml.5
share/man/man8/gimbald.8
""".split()


def install(cmake, build, root):
    subprocess.run([cmake, "--install", build], check=True,
                   stdout=subprocess.DEVNULL, env={**os.environ, "DESTDIR": str(root)})


def overwrites(configuration, install_again):
    shipped = configuration.read_text()
    configuration.write_text("# mine\n")
    install_again()
    kept = configuration.read_text()
    configuration.write_text(shipped)
    return kept != "# mine\n"


def main():
    cmake, build, root, prefix, sysconf = sys.argv[1:]
    shutil.rmtree(root, ignore_errors=True)
    install(cmake, build, root)
    tree, configuration = pathlib.Path(root + prefix), pathlib.Path(root + sysconf, "gimbald.toml")
    faults = [f"{name} is missing" for name in EXPECTED if not (tree / name).is_file()]

    if overwrites(configuration, lambda: install(cmake, build, root)):
        faults.append(f"{configuration}, which somebody wrote, was overwritten")
    check = subprocess.run([tree / "bin/gimbald", "--config", configuration, "--check-config"],
                           capture_output=True, text=True)
    if check.returncode != 0 or check.stderr:
        faults.append(f"the installed configuration is not sound: {check.stderr}")
    sys.exit("\n".join(faults) or 0)


main()

"""What the programs say of themselves in --help."""

import re
import subprocess


def _section(text, name):
    inside = re.search(rf"^{name}:\n((?:[ ].*\n|\n(?=  ))*)", text, flags=re.MULTILINE)
    return re.findall(r"^  (\S+)", inside[1], flags=re.MULTILINE) if inside else []


def commands(program, path=()):
    """Of each command, named by its path such as ("sessions", "list"): the options, each with all its names."""
    text = subprocess.run([program, *path, "--help"], check=True, capture_output=True, text=True).stdout
    found = {path: [option.split(",") for option in _section(text, "Options") if option.startswith("-")]}
    for name in _section(text, "Subcommands"):
        found |= commands(program, (*path, name))
    return found

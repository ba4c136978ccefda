#!/usr/bin/env python3
"""Every command that a message or a document tells the user to run is one that gimbalctl has.

Usage: named_commands_test.py GIMBALCTL ROOT
"""

import re
import subprocess
import sys
from pathlib import Path

# In C++ only what stands in string literals, neighbours joined; in Markdown only what is marked as code.
LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
CODE = re.compile(r"`([^`\n]*)`|^    (.*)$", re.MULTILINE)
COMMAND = re.compile(r"\bgimbalctl ([a-z]+)(?: ([a-z]+))?")


def shown_texts(path: Path) -> str:
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".md":
        return "\n".join("".join(match) for match in CODE.findall(text))
    return "\n".join(LITERAL.findall(re.sub(r'"\s*\n\s*"', "", text)))


def named_commands(root: Path) -> dict[tuple[str, ...], Path]:
    files = [f for folder in ("daemon", "drivers", "pipeline") for f in sorted((root / folder).rglob("*"))]
    commands = {}
    for path in files + sorted(root.glob("*.md")):
        if path.suffix in (".cpp", ".hpp", ".md"):
            for words in COMMAND.findall(shown_texts(path)):
                commands[tuple(word for word in words if word)] = path
    return commands


def has_command(gimbalctl: str, words: tuple[str, ...]) -> bool:
    run = subprocess.run([gimbalctl, words[0], "--help"], capture_output=True, text=True, timeout=60)
    if f"Usage: gimbalctl {words[0]}" not in run.stdout:
        return False
    takes_second = "SUBCOMMAND" in run.stdout  # else a second word is an argument
    return not takes_second or len(words) == 1 or f"\n  {words[1]} " in run.stdout


def main(gimbalctl: str, root: str) -> int:
    commands = named_commands(Path(root))
    unknown = [(words, path) for words, path in commands.items() if not has_command(gimbalctl, words)]
    for words, path in unknown:
        print(f"{path}: there is no gimbalctl {' '.join(words)}")
    if not commands:
        print(f"{root}: no commands found in it")
    return 1 if unknown or not commands else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))

"""The keys that the daemon reads, as its source has them: a table's name (or "output", "") to the keys."""

import pathlib
import re

SOURCES = ["daemon/configuration.cpp", "daemon/*_keys.cpp", "drivers/replay/calibration_keys.cpp"]
# A reader asks a table for a key, or a function that is given the table and the key does.
ASKS = re.compile(r'[.](?:text|texts|number|numbers|integer|whole_number|boolean|matrix3|choice<[^()]*>|has|table|tables)'
                  r'\(\s*"(\w+)"|\w+(?:<[^()]*>)?\(table,\s*"(\w+)"')
FUNCTION = re.compile(r"^(?!namespace|struct|class|enum)\w[^;{}=]*?\b(\w+)\([^;{}]*\) \{\n(.*?)^\}", re.MULTILINE | re.DOTALL)
READ_TABLE = re.compile(r'read\("(\w+)",.*?\b(read_\w+)\(t,', re.DOTALL)


def _functions(source):
    files = [file for pattern in SOURCES for file in sorted(pathlib.Path(source).glob(pattern))]
    return {name: body for file in files for name, body in FUNCTION.findall(file.read_text())}


def _keys_of(name, functions):
    body = functions[name]
    keys = {first or second for first, second in ASKS.findall(body)}
    for called in set(re.findall(r"\b(\w+)\(table\b", body)) - {name}:
        if called in functions:
            keys |= _keys_of(called, functions)
    return keys


def keys_by_table(source):
    functions = _functions(source)
    tables = {table: _keys_of(reader, functions) for table, reader in READ_TABLE.findall(functions["read_file"])}
    # Each preset of an output has a reader of its own.
    presets = (pathlib.Path(source) / "daemon/output_keys.cpp").read_text()
    readers = [name for name, _ in FUNCTION.findall(presets) if name.startswith("read_")]
    tables["output"] = set().union(*(_keys_of(reader, functions) for reader in readers))
    return tables

#!/usr/bin/env python3
"""Checks every #include of the tree against the rules of CONTRIBUTING.md.

Usage: include_rules.py ROOT. Prints one line a violation; exit status 1 if there is any.
Targets that link against each other share one include root, so the linker alone does not see a header
that is included across a forbidden border.
"""

import re
import sys
from pathlib import Path

# What a stage stands on, beside itself, `sample` and `queue`.
STAGE_STANDS_ON = {
    "fill": {"warp"},
    "intrinsics": {"lens"},
    "smoother": {"estimator"},
    "sink": {"gstreamer"},
    "sync": {"lens", "timing"},
    "warp": {"dma_buf", "lens", "pixels"},
}
STAGES_THAT_ALL_MAY_USE = {"sample", "queue"}
# What a driver stands on, beside `sample`, `queue` and `lens`: cameras on the conversion of pixels.
DRIVER_STANDS_ON = {
    "libcamera": {"pixels"},
    "replay": {"gstreamer", "pixels"},
    "v4l2": {"pixels"},
}
STAGES_THAT_DRIVERS_MAY_USE = {"sample", "queue", "lens"}
# What drivers share: the clock, and those on an I²C bus the bus.
SHARED_BY_DRIVERS = {
    "clock": r".*",
    "i2c": r"i2c_.*",
}

# Where a system header is at home: its name, and the units (see `unit_of`) that may include it.
# The first match counts. Tests may include any.
ANYWHERE = r".*"
OUTSIDE_SAMPLE = r"(?!pipeline/sample$).*"
OUTSIDE_PIPELINE = r"drivers.*|daemon"
SYSTEM_HEADER_HOMES = [
    (r"(Eigen|tl)/.*", ANYWHERE),
    (r"(EGL|GLES\d?|GL|KHR)/.*|gbm\.h|drm.*", r"pipeline/warp"),
    (r"hwy/.*", r"pipeline/warp"),
    (r"gst/.*|glib.*", r"pipeline/(gstreamer|sink)|drivers/replay"),
    (r"opencv2/.*", r"pipeline/(sync|intrinsics)"),
    (r"ceres/.*", r"pipeline/sync"),
    (r"linux/(videodev2|v4l2-.*|media.*)\.h", r"drivers/v4l2"),
    (r"libcamera/.*", r"drivers/libcamera"),
    (r"iio\.h|iio/.*|linux/iio/.*", r"drivers/iio"),
    (r"gpiod\.h(pp)?|linux/gpio\.h", r"drivers/gpio"),
    (r"linux/i2c.*", r"drivers/i2c"),
    (r"systemd/.*", r"daemon"),
    (r"toml\+\+/.*|nlohmann/.*|yaml-cpp/.*", r"drivers/replay|daemon"),
    (r"(CLI|spdlog)/.*|httplib\.h", r"daemon"),
    (r"fmt/.*", OUTSIDE_SAMPLE),
    (r"thread|stop_token|future", r"pipeline/(queue|sink|warp)|" + OUTSIDE_PIPELINE),  # others own none
    (r"linux/(dma-buf|dma-heap|udmabuf)\.h", r"pipeline/dma_buf|drivers/libcamera"),
    (r"linux/.*|sys/ioctl\.h", r"pipeline/dma_buf|" + OUTSIDE_PIPELINE),
    (r"(sys/)?[a-z0-9_]+\.h", OUTSIDE_SAMPLE),  # POSIX
    (r"[a-z0-9_]+", ANYWHERE),  # the standard library
]

INCLUDE = re.compile(r'^\s*#\s*include\s*(?:<([^>]+)>|"([^"]+)")')
SOURCE_SUFFIXES = {".hpp", ".cpp", ".h"}
TOP_FOLDERS = ("pipeline", "drivers", "daemon", "tests")


def unit_of(path):
    """The part of the project that a file belongs to: `pipeline/STAGE`, `pipeline` (the stabilizer),
    `drivers/NAME`, `drivers/interface`, `drivers` (the table of drivers), `daemon` or `tests`.
    Nothing for a path outside these."""
    folders = path.split("/")[:-1]
    if not folders or folders[0] not in TOP_FOLDERS:
        return None
    if folders[0] in ("daemon", "tests"):
        return folders[0]
    if re.fullmatch(r"drivers/(\w+_source|device_report|stop_event|live_camera_settings)\.[ch]pp", path):
        return "drivers/interface"
    return "/".join(folders[:2])


def may_include_unit(unit, target):
    if unit == target or unit == "tests":
        return True
    if target in ("daemon", "tests"):
        return False
    if unit == "daemon":
        return True
    unit_top, _, unit_name = unit.partition("/")
    target_top, _, target_name = target.partition("/")
    if unit_top == "pipeline":
        return target_top == "pipeline" and may_include_stage(unit_name, target_name)
    if target_top == "pipeline":
        return target_name in STAGES_THAT_DRIVERS_MAY_USE | DRIVER_STANDS_ON.get(unit_name, set())
    if re.fullmatch(SHARED_BY_DRIVERS.get(target_name, r"$"), unit_name):
        return True
    return unit == "drivers" or target == "drivers/interface"


def may_include_stage(stage, target):
    if stage == "":  # the stabilizer wires the stages
        return True
    if stage == "sample" or target == "":
        return False
    return target in STAGES_THAT_ALL_MAY_USE | STAGE_STANDS_ON.get(stage, set())


def may_include_system(unit, header):
    if unit == "tests":
        return True
    for pattern, homes in SYSTEM_HEADER_HOMES:
        if re.fullmatch(pattern, header):
            return re.fullmatch(homes, unit) is not None
    return False


def includes_of(text):
    """(line number, system header or None, project header or None) of each #include."""
    for number, line in enumerate(text.splitlines(), start=1):
        match = INCLUDE.match(line)
        if match:
            yield number, match.group(1), match.group(2)


def problem_with(unit, system_header, project_header):
    if system_header is not None:
        if may_include_system(unit, system_header):
            return None
        return f"<{system_header}> is not at home in {unit}; see SYSTEM_HEADER_HOMES"
    target = unit_of(project_header)
    if target is None:
        return f'"{project_header}" is not a path from the root of the tree'
    if not may_include_unit(unit, target):
        return f"{unit} may not include {target} ({project_header}); see CONTRIBUTING.md"
    return None


def cycle_in(graph):
    """The nodes of some cycle, first one repeated at the end; nothing if there is none."""
    done = set()

    def walk(node, trail):
        if node in trail:
            return trail[trail.index(node):] + [node]
        if node in done:
            return None
        for target in sorted(graph.get(node, ())):
            found = walk(target, trail + [node])
            if found:
                return found
        done.add(node)
        return None

    return next((cycle for node in sorted(graph) if (cycle := walk(node, []))), None)


def violations(files):
    """One line for each violation in `files`, pairs of a path from the root and its text."""
    graph = {}
    for path, text in files:
        unit = unit_of(path)
        for number, system_header, project_header in includes_of(text):
            problem = problem_with(unit, system_header, project_header)
            if problem:
                yield f"{path}:{number}: {problem}"
            target = unit_of(project_header) if project_header else None
            if target and target != unit:
                graph.setdefault(unit, set()).add(target)
    cycle = cycle_in(graph)
    if cycle:
        yield "folders include each other in a circle: " + " -> ".join(cycle)


def files_of(root):
    for top in TOP_FOLDERS:
        for path in sorted((root / top).rglob("*")):
            if path.suffix in SOURCE_SUFFIXES:
                yield path.relative_to(root).as_posix(), path.read_text(encoding="utf-8")


def main():
    if len(sys.argv) != 2 or not (Path(sys.argv[1]) / "pipeline").is_dir():
        print("usage: include_rules.py ROOT, the folder that holds pipeline/", file=sys.stderr)
        return 2
    found = list(violations(files_of(Path(sys.argv[1]))))
    print("\n".join(found) if found else "include rules hold")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

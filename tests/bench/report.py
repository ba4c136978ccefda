#!/usr/bin/env python3
"""Prints a table from the JSON of the benchmarks: the median CPU time of each, and how many copies of a
720p frame that is worth. The copy is measured in the same run, so the ratio carries over to other
machines better than the time does.

Usage: report.py BENCH.json
"""

import json
import sys

UNIT_S = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
REFERENCE = "frame_copy_720p"


def median_cpu_s(path):
    """Median CPU time of each benchmark, in seconds, in the order that they ran in."""
    with open(path, encoding="utf-8") as file:
        rows = json.load(file)["benchmarks"]
    return {row["run_name"]: row["cpu_time"] * UNIT_S[row["time_unit"]]
            for row in rows if row.get("aggregate_name") == "median"}


def main():
    medians_s = median_cpu_s(sys.argv[1])
    copy_s = medians_s.get(REFERENCE)
    print(f"{'median of CPU time':40} {'µs':>12} {'frame copies':>14}")
    for name, cpu_s in medians_s.items():
        ratio = f"{cpu_s / copy_s:14.4f}" if copy_s else f"{'not measured':>14}"
        print(f"{name:40} {cpu_s * 1e6:12.3f} {ratio}")


if __name__ == "__main__":
    main()

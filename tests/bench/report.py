#!/usr/bin/env python3
"""Prints a table from the JSON of the benchmarks: the median CPU time of each, how many copies of a frame of
its size that is worth, and what share of OpenCV's remap of the same picture. Both are measured in the same
run, so the ratios carry over to other machines better than the time does.

Usage: report.py BENCH.json
"""

import json
import re
import sys

UNIT_S = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
USUAL_SIZE = "1280/720"  # of what has no size of its own


def median_cpu_s(path):
    """Median CPU time of each benchmark, in seconds, in the order that they ran in."""
    with open(path, encoding="utf-8") as file:
        rows = json.load(file)["benchmarks"]
    return {row["run_name"].replace("/process_time", ""): row["cpu_time"] * UNIT_S[row["time_unit"]]
            for row in rows if row.get("aggregate_name") == "median"}


def ratio_to(peer, name, medians_s):
    """The benchmark's time by that of the peer, for a picture of the same size; or a dash."""
    size = re.search(r"\d+/\d+$", name)
    peer_s = medians_s.get(f"{peer}/{size.group() if size else USUAL_SIZE}")
    return f"{medians_s[name] / peer_s:.4f}" if peer_s else "-"


def main():
    medians_s = median_cpu_s(sys.argv[1])
    print(f"{'median of CPU time':40} {'µs':>12} {'frame copies':>14} {'OpenCV remaps':>14}")
    for name, cpu_s in medians_s.items():
        print(f"{name:40} {cpu_s * 1e6:12.3f} {ratio_to('frame_copy', name, medians_s):>14} "
              f"{ratio_to('opencv_remap', name, medians_s):>14}")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Prints a table from the JSON of the benchmarks: the median CPU time of each, the median of wall time, how many
copies of a frame of its size its CPU time is worth, and what share of OpenCV's remap of the same picture; then
what is to be told from two benchmarks. All are measured in the same run, so the ratios carry over to other
machines better than the time does.

Usage: report.py BENCH.json
"""

import json
import re
import sys

UNIT_S = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
USUAL_SIZE = "1280/720"  # of what has no size of its own
HOW_MEASURED = re.compile(r"/(process_time|real_time|iterations:\d+)")


def medians(path, time):
    """Median of "cpu_time" or "real_time" of each benchmark, in seconds, in the order that they ran in."""
    with open(path, encoding="utf-8") as file:
        rows = json.load(file)["benchmarks"]
    return {HOW_MEASURED.sub("", row["run_name"]): row[time] * UNIT_S[row["time_unit"]]
            for row in rows if row.get("aggregate_name") == "median"}


def ratio_to(peer, name, medians_s):
    """The benchmark's time by that of the peer, for a picture of the same size; or a dash."""
    size = re.search(r"\d+/\d+$", name)
    peer_s = medians_s.get(f"{peer}/{size.group() if size else USUAL_SIZE}")
    return f"{medians_s[name] / peer_s:.4f}" if peer_s else "-"


def for_each_size(part, whole, medians_s, text):
    """Prints `text` with the size and the part's share of the whole, for all sizes that both benchmarks have."""
    for name, part_s in medians_s.items():
        whole_s = medians_s.get(name.replace(part, whole))
        if name.startswith(part) and whole_s:
            size = name.removeprefix(part + "/").replace("/", "x")
            print(text.format(size=size, share=part_s / whole_s, times=whole_s / part_s))


def main():
    cpu_s = medians(sys.argv[1], "cpu_time")
    wall_s = medians(sys.argv[1], "real_time")
    print(f"{'medians':40} {'CPU µs':>12} {'wall µs':>12} {'frame copies':>14} {'OpenCV remaps':>14}")
    for name in cpu_s:
        print(f"{name:40} {cpu_s[name] * 1e6:12.3f} {wall_s[name] * 1e6:12.3f} "
              f"{ratio_to('frame_copy', name, cpu_s):>14} {ratio_to('opencv_remap', name, cpu_s):>14}")
    for_each_size("warp_cpu/two_threads", "warp_cpu/one_thread", wall_s,
                  "warp_cpu {size}: two threads are {times:.2f} times as fast as one, by wall time")
    for_each_size("warp_gles_in_flight/best", "warp_gles/best", wall_s,
                  "warp_gles {size}: frames in flight are {times:.2f} times as fast as one by one, by wall time")
    for_each_size("gles_transfers", "warp_gles/best", cpu_s,
                  "warp_gles {size}: {share:.1%} of its CPU time is upload and read-back")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Prints how well orientation is known beside what others reach on the same recordings, and the filter's
time for a sample beside the thesis' filter in the same run.

Usage: orientation_table.py GIMBALCTL SHARED BENCH.json
"""

import collections
import csv
import pathlib
import statistics
import sys

import report

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
import orientation_judge  # noqa: E402

FIGURES = ("incl", "rel33ms", "rel100ms", "rel300ms", "rel1000ms", "rel3000ms", "drift")
OURS = {
    "attitude EKF, causal": ["--causal"],
    "attitude EKF, lag 1 s": ["--lag", "1"],
    "attitude EKF, lag 3 s": ["--lag", "3"],
    "attitude EKF, whole recording": [],
    "thesis EKF, causal": ["--estimator", "thesis"],
}


def peers(shared):
    """Rows of peers.csv by set and estimator: one list of figures a trial."""
    rows = collections.defaultdict(list)
    with open(shared / "eval" / "peers.csv", encoding="utf-8", newline="") as file:
        for trial, estimator, *figures in list(csv.reader(file))[1:]:
            rows[trial.split("-")[0], estimator].append([float(figure) for figure in figures])
    return rows


def print_row(name, figures):
    print(f"  {name:74} " + " ".join(f"{figure:9.3f}" for figure in figures), flush=True)


def print_times(medians_s):
    ekf, thesis = (medians_s.get(name) for name in ("attitude_ekf_sample", "thesis_ekf_sample"))
    if ekf and thesis:
        print(f"a sample: attitude EKF {ekf * 1e9:.0f} ns, thesis EKF {thesis * 1e9:.0f} ns")
    for name, time_s in medians_s.items():
        if name.startswith("smoother_"):
            print(f"{name}: with 1 s of lag {time_s * 1e6:.1f} µs")


def main():
    gimbalctl, shared, bench = sys.argv[1:4]
    print_times(report.median_cpu_s(bench))
    shared = orientation_judge.needed(shared)
    theirs = peers(shared)
    print(f"means, degrees, drift deg/min{'':47} " + " ".join(f"{name:>9}" for name in FIGURES))
    for name in ("broad", "phone"):
        print(name)
        for (of_set, estimator), rows in theirs.items():
            if of_set == name:
                print_row(f"{estimator} ({len(rows)} trials)", map(statistics.mean, zip(*rows)))
        for estimator, options in OURS.items():
            means = orientation_judge.judge_set(gimbalctl, shared, name, options)
            print_row(estimator, (means[figure] for figure in FIGURES))


if __name__ == "__main__":
    main()

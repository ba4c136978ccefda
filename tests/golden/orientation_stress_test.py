#!/usr/bin/env python3
"""The attitude EKF on the spoilt recordings of a laboratory: a large bias, a start in mid motion, holes,
a gyroscope that clips.

Usage: orientation_stress_test.py GIMBALCTL SHARED
"""

import functools
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support"))
import orientation_judge  # noqa: E402

DEGREE = math.pi / 180
FIGURES = ("incl", "rel33ms", "rel100ms", "rel300ms", "rel1000ms", "rel3000ms", "drift")


def rows(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    return lines[0], [[float(field) for field in line.split(",")] for line in lines[1:]]


def rewrite(trial, folder, name, change):
    """Copies a log with its rows changed; `change` gives None for a row to be left out."""
    header, old = rows(trial / name)
    new = [row for row in map(change, old) if row is not None]
    text = "\n".join([header, *(",".join(repr(value) for value in row) for row in new)])
    (folder / name).write_text(text + "\n", encoding="utf-8")


def large_bias(trial, folder):
    bias = [4 * DEGREE, 1 * DEGREE, -3 * DEGREE]
    rewrite(trial, folder, "gyro.csv", lambda row: [row[0], *map(sum, zip(row[1:], bias))])
    rewrite(trial, folder, "accel.csv", lambda row: row)
    return trial


def clipped(trial, folder):
    limit = 250 * DEGREE
    rewrite(trial, folder, "gyro.csv",
            lambda row: [row[0], *(min(max(rate, -limit), limit) for rate in row[1:])])
    rewrite(trial, folder, "accel.csv", lambda row: row)
    return trial


def holes(trial, folder, *, length_s, every_s):
    for name in ("gyro.csv", "accel.csv"):
        rewrite(trial, folder, name, lambda row: row if row[0] % every_s >= length_s else None)
    return trial


def mid_motion(trial, folder):
    """Begins 20 s after the movement does, at an instant in it."""
    _, truth = rows(trial / "truth.csv")
    moving_s = [row[0] for row in truth if row[5] == 1]
    start_s = next(t for t in moving_s if t >= moving_s[0] + 20)
    for name in ("gyro.csv", "accel.csv", "truth.csv"):
        rewrite(trial, folder, name, lambda row: row if row[0] >= start_s else None)
    return folder


def main():
    gimbalctl = sys.argv[1]
    shared = orientation_judge.needed(sys.argv[2] if len(sys.argv) > 2 else "")
    failed = []

    def judged(title, disturb, from_s=0.0, **most):
        row = orientation_judge.judge_set(gimbalctl, shared, "broad", ["--causal"], disturb, from_s)
        print(f"{title:26} " + " ".join(f"{row[figure]:9.3f}" for figure in FIGURES), flush=True)
        failed.extend(f"{title}: {figure} is {row[figure]:.3f}, not {limit}"
                      for figure, limit in most.items() if row[figure] > limit)
        return row

    print(f"{'broad, causal':26} " + " ".join(f"{figure:>9}" for figure in FIGURES))
    plain = judged("after 20 s", None, 20.0)
    judged("large bias, after 20 s", large_bias, 20.0,
           **{figure: 1.05 * plain[figure] for figure in FIGURES})
    judged("in mid motion, after 20 s", mid_motion, 20.0, incl=0.78, rel1000ms=0.62)
    # Whole, for people: the judge's search for a time offset fails where motion is there at once, so
    # that the inclination alone means something.
    judged("in mid motion, all", mid_motion)
    judged("holes of 0.1 s in 5 s", functools.partial(holes, length_s=0.1, every_s=5), incl=3)
    judged("holes of 0.5 s in 10 s", functools.partial(holes, length_s=0.5, every_s=10), incl=12)
    judged("clipped at 250 deg/s", clipped, incl=12)
    print("\n".join(failed) if failed else "all within their limits")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

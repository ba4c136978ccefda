#!/usr/bin/env python3
"""Stabilizes recordings with gimbalctl and with its peers, all showing the same field of view, has each video judged
by its pictures alone (tests/judge), prints the tables and writes a page with the videos side by side.

Usage: compare.py BUILD_FOLDER OUTPUT_FOLDER [--sessions NAME..] [--stabilizers NAME..] [--size WIDTHxHEIGHT]
                  [--duration S] [--zoom RATIO] [--shared FOLDER] [--json FILE]

Peers that are not installed are left out, and so is the recording phone-car where --shared has none. Figures go to
OUTPUT_FOLDER/comparison.json; with --json they are added to that file too. All videos are H.264 at one quantizer.
"""

import argparse
import dataclasses
import json
import pathlib
import sys

import page
import sessions
import stabilizers

try:
    import best_path
except ModuleNotFoundError:  # numpy, which it needs
    best_path = None


def number(value):
    return "-" if value is None else f"{value:.3f}"


COLUMNS = (  # heading, width, and how a row tells it
    ("rate deg/s", 10, lambda j: f"{j['rate_above_1hz_deg_s']:.3f}"),
    ("inside", 7, lambda j: number(j["rate_inside_above_1hz_deg_s"])),
    ("shift px", 8, lambda j: f"{j['shift_above_1hz_px']:.3f}"),
    ("wobble px", 9, lambda j: f"{j['wobble_px']:.3f}"),
    ("residual px", 11, lambda j: f"{j['residual_px']:.3f}"),
    ("ITF dB", 7, lambda j: f"{j['itf_db']:.2f}"),
    ("view %", 7, lambda j: f"{100 * j['against_original']['retained_view']:.1f}"),
    ("distortion %", 12, lambda j: f"{100 * j['against_original']['distortion']:.2f}"),
    ("border %", 8, lambda j: f"{100 * j['border_share']:.3f}"),
)
EXPLANATION = """\
rate: camera's angular rate above 1 Hz, rms; inside: the same without the first and last 2 s; shift: of the picture's
middle above 1 Hz, rms a frame; wobble: of rows against each other above 1 Hz, rms a frame; residual: tracks' distance
from the frames' homography, rms; ITF: mean PSNR from frame to frame; view: share of the original's area; distortion: of
the shape against the original, which a rolling shutter may have bent; border: black pixels at the edge."""


@dataclasses.dataclass
class Row:
    """One stabilizer's video of one session, and what the judge found."""
    name: str
    video: pathlib.Path
    judgement: dict


@dataclasses.dataclass
class Comparison:
    session: sessions.Session
    zoom: float
    rows: list[Row]
    least_rate_deg_s: float | None  # above 1 Hz, of all paths that keep inside of the frames; None where nobody knows

    @property
    def bound(self):
        if self.least_rate_deg_s is None:
            return ""
        return (f"No path whose views keep inside of the frames leaves less than {self.least_rate_deg_s:.3f} deg/s"
                " (quadratic program over the true motion of the whole recording).")


def cells(judgement):
    if "against_original" not in judgement:
        judgement = {**judgement, "against_original": {"retained_view": float("nan"), "distortion": float("nan")}}
    return [tell(judgement) for _, _, tell in COLUMNS]


def print_table(comparison):
    session = comparison.session
    print(f"\n{session.name}: {session.description}, zoom {comparison.zoom:g}")
    print(f"{'':34}" + "".join(f" {heading:>{width}}" for heading, width, _ in COLUMNS))
    for row in comparison.rows:
        print(f"  {row.name:32}" + "".join(f" {cell:>{width}}" for (_, width, _), cell
                                           in zip(COLUMNS, cells(row.judgement))), flush=True)
    if comparison.bound:
        print(f"  {comparison.bound}", flush=True)


def compare(session, tools, wanted, zoom):
    """Rows come in the order of the table; of a stabilizer with a setting to choose, the best one."""
    rows = []
    for name in wanted:
        stabilizer = stabilizers.ALL[name]
        if stabilizer.can_run(tools, session):
            attempts = [Row(stabilizer.title + setting, video, tools.judge(video, session))
                        for setting, video in stabilizer.run(tools, session, zoom)]
            rows.append(best_of(attempts))
    has_truth = best_path is not None and session.has_perfect_sensors
    return Comparison(session, zoom, rows, best_path.least_rate_deg_s(session.recording, zoom) if has_truth else None)


def best_of(attempts, most_border=0.001):
    """The steadiest of those that show next to no border; if there is none, the one that shows the least."""
    clean = [row for row in attempts if row.judgement["border_share"] <= most_border]
    if clean:
        return min(clean, key=lambda row: row.judgement["rate_above_1hz_deg_s"])
    return min(attempts, key=lambda row: row.judgement["border_share"])


def figures_of(comparison):
    return {"zoom": comparison.zoom, "least_rate_above_1hz_deg_s": comparison.least_rate_deg_s, "rows": {
        row.name: {key: value for key, value in row.judgement.items() if key != "path_deg"}
        for row in comparison.rows}}


def write_figures(results, files):
    figures = {comparison.session.name: figures_of(comparison) for comparison in results}
    for file in files:
        everything = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
        everything["comparison"] = figures
        file.write_text(json.dumps(everything, indent=1), encoding="utf-8")


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--sessions", nargs="+", choices=sessions.NAMES, default=sessions.NAMES)
    parser.add_argument("--stabilizers", nargs="+", choices=stabilizers.ALL, default=list(stabilizers.ALL))
    parser.add_argument("--size", help="of all simulated sessions, such as 640x360")
    parser.add_argument("--duration", type=float, default=8, help="of a simulated session, s")
    parser.add_argument("--zoom", type=float, default=1.15, help="of all stabilizers")
    parser.add_argument("--shared", type=pathlib.Path, default=pathlib.Path("../shared"))
    parser.add_argument("--json", type=pathlib.Path, nargs="*", default=[])
    return parser.parse_args()


def main():
    args = arguments()
    args.output.mkdir(parents=True, exist_ok=True)
    tools = stabilizers.Tools(args.build.resolve())
    print(EXPLANATION)
    results = []
    for name in args.sessions:
        session = sessions.make(name, tools.gimbalctl, args.output.resolve() / name, args.size, args.duration,
                                args.shared.resolve())
        if session is None:
            continue
        results.append(compare(session, tools, args.stabilizers, args.zoom))
        print_table(results[-1])
    if not results:
        sys.exit("compare: nothing to compare")
    write_figures(results, [args.output / "comparison.json", *args.json])
    page.write(args.output / "index.html", results, [heading for heading, _, _ in COLUMNS], cells, EXPLANATION)
    print(f"\ncompare: videos, paths and tables are in {args.output / 'index.html'}")


if __name__ == "__main__":
    main()

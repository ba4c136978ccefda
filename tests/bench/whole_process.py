#!/usr/bin/env python3
"""Prints what whole runs cost: `gimbalctl stabilize` on a recording in H.264 whose pictures are thrown away, beside
ffmpeg's vidstabdetect and vidstabtransform on the same video. Processes are measured from their start to their
end, decoding included, all threads together; the median of several runs counts. Adds the figures to the JSON.

Usage: whole_process.py GIMBALCTL BENCH.json
"""

import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

BITRATES = {"1280x720": "8M", "1920x1080": "16M"}  # as cameras write them
DURATION_S = 6
RUNS = 3
NOWHERE = "queue ! fakesink"
FFMPEG = ("ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error", "-y")


def cost(command, folder):
    """CPU and wall time in seconds, and peak memory in bytes, of one run that must succeed."""
    began_s = time.monotonic()
    child = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    wall_s = time.monotonic() - began_s
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode:
        sys.exit(f"whole_process: {' '.join(map(str, command))} ended with {child.returncode}")
    return {"cpu_s": usage.ru_utime + usage.ru_stime, "wall_s": wall_s, "peak_bytes": usage.ru_maxrss * 1024}


def median_cost(commands, folder):
    """Of running all commands, one after the other, RUNS times."""
    runs = [[cost(command, folder) for command in commands] for _ in range(RUNS)]
    return {"cpu_s": statistics.median(sum(c["cpu_s"] for c in run) for run in runs),
            "wall_s": statistics.median(sum(c["wall_s"] for c in run) for run in runs),
            "peak_bytes": statistics.median(max(c["peak_bytes"] for c in run) for run in runs)}


def write_at(bitrate, video):
    """Writes the video again at a camera's bitrate: a simulated one is sharper than that, and costs more to decode."""
    if not shutil.which("ffmpeg"):
        return
    smaller = video.with_stem("smaller")
    subprocess.run([*FFMPEG, "-i", video, "-c:v", "libx264", "-preset", "veryfast", "-bf", "0", "-b:v", bitrate,
                    "-fps_mode", "passthrough", smaller], check=True)
    smaller.replace(video)


def commands_of(gimbalctl, video):
    stabilize = [gimbalctl, "stabilize", "session", "--warper", "cpu", "--quiet"]
    commands = {
        "stabilize": [stabilize + ["-o", NOWHERE]],
        "stabilize, one thread": [stabilize + ["-o", NOWHERE, "--threads", "1"]],
        "stabilize, bicubic": [stabilize + ["-o", NOWHERE, "--interpolation", "bicubic"]],
        "stabilize, 15 frames of lag": [stabilize + ["-o", NOWHERE, "--latency", "15"]],
        "stabilize to x264 ultrafast": [
            stabilize + ["-o", "x264enc speed-preset=ultrafast ! fakesink"]],
    }
    if shutil.which("ffmpeg"):
        ffmpeg = [*FFMPEG, "-i", video]
        commands["ffmpeg, decoding alone"] = [ffmpeg + ["-f", "null", "-"]]
        commands["ffmpeg, vidstab's two passes"] = [
            ffmpeg + ["-vf", "vidstabdetect", "-f", "null", "-"],
            ffmpeg + ["-vf", "vidstabtransform", "-f", "null", "-"]]
    return commands


def print_table(size, frames, costs):
    peer_s = costs.get("ffmpeg, vidstab's two passes", {}).get("cpu_s")
    print(f"{size}, {frames} frames{'':23} {'CPU ms':>9} {'wall ms':>9} {'peak MB':>9} {'of vidstab':>11}")
    for name, c in costs.items():
        share = f"1/{peer_s / c['cpu_s']:.1f}" if peer_s else "-"
        print(f"  {name:38} {c['cpu_s'] * 1e3 / frames:9.2f} {c['wall_s'] * 1e3 / frames:9.2f} "
              f"{c['peak_bytes'] / 1e6:9.1f} {share:>11}", flush=True)


def main():
    gimbalctl, bench = (str(pathlib.Path(path).resolve()) for path in sys.argv[1:3])
    figures = {}
    print("a frame's share of whole runs")
    for size, bitrate in BITRATES.items():
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([gimbalctl, "simulate", "-o", "session", "--size", size, "--motion", "walk",
                            "--duration", str(DURATION_S), "--quiet"], cwd=folder, check=True)
            video = next(pathlib.Path(folder, "session").glob("video.*"))
            write_at(bitrate, video)
            frames = len((pathlib.Path(folder) / "session" / "frames.csv").read_text().splitlines()) - 1
            costs = {name: median_cost(commands, folder)
                     for name, commands in commands_of(gimbalctl, str(video)).items()}
        print_table(size, frames, costs)
        figures[size] = {"frames": frames, "runs": costs}
    with open(bench, encoding="utf-8") as file:
        everything = json.load(file)
    everything["whole_process"] = figures
    with open(bench, "w", encoding="utf-8") as file:
        json.dump(everything, file, indent=1)


if __name__ == "__main__":
    main()

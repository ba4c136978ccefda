"""Has recordings with known orientation judged: `gimbalctl orient` over each, then the recordings' own
judge (eval/orientation.py beside them) over what comes out.

Needs numpy. A trial is a session folder with gyro.csv, accel.csv and truth.csv.
"""

import concurrent.futures
import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77  # an exit status that ctest takes for "skipped"


def needed(shared):
    """The folder of recordings, or an exit that says what is missing."""
    if not shared or not (pathlib.Path(shared) / "data" / "orientation").is_dir():
        print("skipped: no recordings (GIMBALD_SHARED_DIR has no data/orientation)")
        sys.exit(SKIPPED)
    if importlib.util.find_spec("numpy") is None:
        print(f"skipped: {sys.executable} has no numpy (install python3-numpy)")
        sys.exit(SKIPPED)
    return pathlib.Path(shared)


def load_judge(shared):
    spec = importlib.util.spec_from_file_location("orientation", shared / "eval" / "orientation.py")
    judge = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(judge)
    return judge


def orient(gimbalctl, session, log, options):
    command = [gimbalctl, "orient", str(session), "-o", str(log), *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}: exit status {done.returncode}: {done.stderr.strip()}")


def judge_trial(gimbalctl, shared, trial, options, disturb, from_s):
    """What the judge says of one trial: figures by name, degrees (drift: deg/min).

    `disturb(trial, folder)`, if given, writes a changed copy of the trial into the empty folder and
    returns the folder whose truth counts.
    """
    with tempfile.TemporaryDirectory() as temporary:
        session = truth = trial
        if disturb:
            session = pathlib.Path(temporary) / "session"
            session.mkdir()
            shutil.copy(trial / "session.toml", session)
            truth = disturb(trial, session)
        log = pathlib.Path(temporary) / "log.csv"
        orient(gimbalctl, session, log, options)
        return load_judge(shared).evaluate(str(truth), str(log), frm=from_s)


def judge_set(gimbalctl, shared, name, options=(), disturb=None, from_s=0.0):
    """Means over all trials of a set ("broad" or "phone"), as the judge's own --batch has them."""
    import numpy  # not at the top: `needed` says it if it is missing

    trials = sorted((shared / "data" / "orientation").glob(f"{name}-*"))
    with concurrent.futures.ProcessPoolExecutor(os.cpu_count()) as pool:
        runs = [pool.submit(judge_trial, gimbalctl, shared, trial, options, disturb, from_s)
                for trial in trials]
        results = [run.result() for run in runs]
    figures = [key for key in results[0] if key not in ("trial", "n")]
    return {key: float(numpy.nanmean([result[key] for result in results])) for key in figures}

"""What is compared: gimbalctl's paths, and its peers with their best settings.

A stabilizer yields videos of a session, all with the zoom asked for: (what is special about it, file).
"""

import dataclasses
import json
import shutil
import subprocess
from collections.abc import Callable

QUANTIZER = 16
FFMPEG = ("ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error", "-y")
TO_H264 = ("-c:v", "libx264", "-qp", str(QUANTIZER), "-preset", "veryfast", "-bf", "0", "-fps_mode", "passthrough")
VIDSTAB_SMOOTHINGS = (15, 30, 60, 100)  # frames to either side
VIDEOSTAB_RADII = (30, 100)             # the same


class Tools:
    """The programs that are used, from the build and from the system."""

    def __init__(self, build):
        self.gimbalctl = build / "daemon" / "gimbalctl" / "gimbalctl"
        self.video_judge = build / "tests" / "judge" / "video_judge"
        self.opencv_videostab = build / "tests" / "compare" / "opencv_videostab"

    def judge(self, video, session):
        done = subprocess.run([self.video_judge, video, "--original", session.video, "--focal", str(session.focal_px),
                               "--fps", str(session.fps)], check=True, capture_output=True)
        return json.loads(done.stdout)


def gst_h264_to(file):
    return (f"x264enc pass=quant quantizer={QUANTIZER} speed-preset=veryfast bframes=0 ! mp4mux ! "
            f"filesink location={file}")


def raw(_tools, session, _zoom):
    video = session.folder / "raw.mp4"
    subprocess.run(["gst-launch-1.0", "-q", *f"filesrc location={session.video} ! decodebin ! videoconvert ! "
                    f"{gst_h264_to(video)}".split()], check=True)
    yield "", video


def gimbalctl(recording, file_name, *options):
    """A run on `recording` of the session's folder."""
    def run(tools, session, zoom):
        video = session.folder / file_name
        subprocess.run([tools.gimbalctl, "stabilize", session.folder / recording, "-o", gst_h264_to(video),
                        "--zoom", str(zoom), "--quiet", *options], check=True)
        yield "", video
    return run


def vidstab(_tools, session, zoom):
    """Two passes. Its zoom takes so many per cent of the original off: 13.04 for a ratio of 1.15."""
    tracks = session.folder / "vidstab.trf"
    source = [*FFMPEG, "-i", session.video]
    subprocess.run([*source, "-vf", f"vidstabdetect=shakiness=10:accuracy=15:result={tracks}", "-f", "null", "-"],
                   check=True)
    for smoothing in VIDSTAB_SMOOTHINGS:
        video = session.folder / f"vidstab-{smoothing}.mp4"
        subprocess.run([*source, "-vf", f"vidstabtransform=input={tracks}:smoothing={smoothing}:crop=black:"
                        f"optzoom=0:zoom={100 * (1 - 1 / zoom)}:interpol=bicubic", *TO_H264, video], check=True)
        yield f", {smoothing} frames", video


def enlarged(session, zoom):
    width, height = session.size.split("x")
    return f"crop={width}/{zoom}:{height}/{zoom}:exact=1,scale={width}:{height}:flags=bicubic"


def deshake(_tools, session, zoom):
    """One pass. Of its settings those that follow best: a wide search, large blocks, nearly all of them used. It does
    not zoom, so its middle is enlarged."""
    video = session.folder / "deshake.mp4"
    subprocess.run([*FFMPEG, "-i", session.video, "-vf",
                    f"deshake=rx=64:ry=64:blocksize=16:contrast=10:edge=blank,{enlarged(session, zoom)}", *TO_H264, video], check=True)
    yield "", video


def videostab(tools, session, zoom):
    """Two passes, wobble suppressed. It does not zoom either."""
    margin = (1 - 1 / zoom) / 2
    for radius in VIDEOSTAB_RADII:
        video = session.folder / f"videostab-{radius}.mp4"
        with subprocess.Popen([tools.opencv_videostab, session.video, str(radius), str(margin)],
                              stdout=subprocess.PIPE) as process:
            subprocess.run([*FFMPEG, "-f", "yuv4mpegpipe", "-i", "-", "-vf", enlarged(session, zoom), *TO_H264, video],
                           check=True, stdin=process.stdout)
        if process.returncode:
            raise RuntimeError(f"opencv_videostab ended with {process.returncode}")
        yield f", {radius} frames", video


def has_ffmpeg(_tools, _session):
    return shutil.which("ffmpeg") is not None


def has_videostab(tools, session):
    return tools.opencv_videostab.exists() and has_ffmpeg(tools, session)


def has_perfect_sensors(_tools, session):
    return session.has_perfect_sensors


def always(_tools, _session):
    return True


@dataclasses.dataclass
class Stabilizer:
    title: str
    run: Callable  # of tools, session and zoom
    can_run: Callable = always  # of tools and session


ALL = {
    "raw": Stabilizer("as recorded", raw),
    "deshake": Stabilizer("ffmpeg deshake, one pass", deshake, has_ffmpeg),
    "videostab": Stabilizer("OpenCV videostab", videostab, has_videostab),
    "vidstab": Stabilizer("vid.stab, two passes", vidstab, has_ffmpeg),
    "hann": Stabilizer("Hann", gimbalctl("session", "hann.mp4", "--path", "hann")),
    "adaptive-hann": Stabilizer("adaptive Hann",
                                gimbalctl("session", "adaptive-hann.mp4", "--path", "adaptive-hann")),
    "gimbalctl": Stabilizer("gimbalctl", gimbalctl("session", "gimbalctl.mp4")),
    "gimbalctl-fill": Stabilizer("gimbalctl, borders filled",
                                 gimbalctl("session", "gimbalctl-fill.mp4", "--border", "fill")),
    "gimbalctl-15": Stabilizer("gimbalctl, 15 frames ahead",
                               gimbalctl("session", "gimbalctl-15.mp4", "--latency", "15")),
    "gimbalctl-5": Stabilizer("gimbalctl, 5 frames ahead",
                              gimbalctl("session", "gimbalctl-5.mp4", "--latency", "5")),
    "gimbalctl-0": Stabilizer("gimbalctl, causal", gimbalctl("session", "gimbalctl-0.mp4", "--latency", "0")),
    "perfect": Stabilizer("gimbalctl, perfect sensors", gimbalctl("perfect", "perfect.mp4"), has_perfect_sensors),
}

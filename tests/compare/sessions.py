"""The recordings that stabilizers are compared on."""

import dataclasses
import pathlib
import shutil
import subprocess
import tomllib

SIMULATED = {  # name: what moves, size
    "walk": ("a walker's hand: steps at 1.9 Hz, swing at half of it, tremor", "1280x720"),
    "pan": ("a hand that looks 90° aside and back, 2.5 s a turn", "1280x720"),
    "run": ("a runner's hand", "640x360"),
    "tripod": ("nothing moves", "640x360"),
    "vehicle": ("a mount on a vehicle: body motion at 1-2 Hz, vibration to 34 Hz", "640x360"),
}
PHONE_CAR = "phone-car"
NAMES = (*SIMULATED, PHONE_CAR)


@dataclasses.dataclass
class Session:
    name: str
    description: str
    folder: pathlib.Path       # with the session in `session`
    size: str                  # WIDTHxHEIGHT
    focal_px: float
    fps: float
    has_perfect_sensors: bool  # `perfect` is the same recording, its IMU without noise or bias

    @property
    def recording(self):
        return self.folder / "session"

    @property
    def video(self):
        return next(self.recording.glob("video.*"))


def opened(name, description, folder, has_perfect_sensors):
    with open(folder / "session" / "session.toml", "rb") as file:
        camera = tomllib.load(file)["camera"]
    K = camera["K"]
    return Session(name, description, folder, f"{camera['width']}x{camera['height']}", (K[0][0] + K[1][1]) / 2,
                   camera["fps"], has_perfect_sensors)


def simulate(gimbalctl, folder, motion, duration_s, *more):
    subprocess.run([gimbalctl, "simulate", "-o", folder, "--motion", motion, "--duration", str(duration_s), "--quiet",
                    *more], check=True)


def make_simulated(name, gimbalctl, folder, size, duration_s):
    """The perfect sensors come from a recording of the same motion, whose pictures are small since they are not used."""
    description, usual_size = SIMULATED[name]
    size = size or usual_size
    simulate(gimbalctl, folder / "session", name, duration_s, "--size", size)
    simulate(gimbalctl, folder / "perfect", name, duration_s, "--size", "64x36", "--gyro-noise", "0",
             "--accel-noise", "0", "--gyro-bias", "0,0,0", "--gyro-rate", "1000")
    for file in ("session.toml", "video.mkv", "frames.csv"):
        shutil.copy(folder / "session" / file, folder / "perfect" / file)
    return opened(name, f"{description}; simulated, {size}, {duration_s:g} s", folder, True)


def make_phone_car(gimbalctl, folder, shared):
    recording = shared / "data" / "sessions" / PHONE_CAR
    if not recording.is_dir():
        return None
    subprocess.run([gimbalctl, "sessions", "import", recording, "-o", folder / "session"], check=True,
                   stdout=subprocess.DEVNULL)
    return opened(PHONE_CAR, "a phone behind a windscreen, recorded", folder, False)


def make(name, gimbalctl, folder, size, duration_s, shared):
    """Makes the session anew, or gives None where its recording is missing."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    if name == PHONE_CAR:
        return make_phone_car(gimbalctl, folder, shared)
    return make_simulated(name, gimbalctl, folder, size, duration_s)

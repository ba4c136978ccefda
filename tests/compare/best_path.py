"""How steady any path can be whose views keep inside of a simulated session's frames: the one that leaves the least
rate above 1 Hz, knowing the whole recording and its true motion. No stabilizer; what the others are measured against.

A view moves by small turns d of each frame, in world axes. The rate above 1 Hz is linear in them, and that a corner of
the picture stays inside of the frame is, too: a quadratic program, solved by an interior point method (Nocedal and
Wright, "Numerical Optimization", 2006, ch. 16.6) and set up again about its solution."""

import csv
import math
import tomllib

import numpy as np

CUTOFF_HZ = 1
ROUNDS = 3          # the first starts from the camera itself, degrees away
MOST_FRAMES = 450   # the program's matrices are dense


def cross_matrix(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def rotation(vector):
    angle = np.linalg.norm(vector)
    if angle < 1e-9:
        return np.eye(3) + cross_matrix(vector)
    axis = cross_matrix(vector / angle)
    return np.eye(3) + math.sin(angle) * axis + (1 - math.cos(angle)) * axis @ axis


def vector_of(R):
    angle = math.acos(np.clip((np.trace(R) - 1) / 2, -1, 1))
    twice = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return twice / 2 if angle < 1e-7 else twice * angle / (2 * math.sin(angle))


def matrix_of(q):
    w, x, y, z = q / np.linalg.norm(q)
    return np.eye(3) + 2 * w * cross_matrix((x, y, z)) + 2 * cross_matrix((x, y, z)) @ cross_matrix((x, y, z))


class Recording:
    """A simulated session's camera and its true motion."""

    def __init__(self, folder):
        with open(folder / "session.toml", "rb") as file:
            session = tomllib.load(file)
        camera = session["camera"]
        self.K = np.array(camera["K"])
        self.width, self.height = camera["width"], camera["height"]
        self.readout_s, self.offset_s = camera["readout_s"], camera["time_offset_s"]
        self.R_imu_camera = np.array(session["imu"]["R_camera_imu"]).T
        with open(folder / "frames.csv", encoding="utf-8") as file:
            self.stamps_s = np.array([float(row["t_s"]) for row in csv.DictReader(file)])
        truth = np.genfromtxt(folder / "truth.csv", delimiter=",", names=True)
        self.truth_s = truth["t_s"]
        self.truth = np.stack([truth[name] for name in ("qw", "qx", "qy", "qz")], axis=1)
        for i in range(1, len(self.truth)):  # q and -q are one rotation
            if self.truth[i] @ self.truth[i - 1] < 0:
                self.truth[i] *= -1

    def R_world_camera(self, frame, row):
        t_s = self.stamps_s[frame] + self.offset_s + self.readout_s * row / self.height
        q = np.array([np.interp(t_s, self.truth_s, part) for part in self.truth.T])
        return matrix_of(q) @ self.R_imu_camera

    def corner_rays(self, zoom):
        """Of the picture, camera axes."""
        for x in (-0.5, self.width - 0.5):
            for y in (-0.5, self.height - 0.5):
                center = np.array([(self.width - 1) / 2, (self.height - 1) / 2])
                pixel = center + (np.array([x, y]) - center) / zoom
                yield np.array([(pixel[0] - self.K[0, 2]) / self.K[0, 0], (pixel[1] - self.K[1, 2]) / self.K[1, 1], 1])


def seen_at(recording, frame, ray_world):
    """The pixel of a direction, when its own row was exposed, and how it moves as the direction turns about world axes."""
    row = recording.height / 2
    for _ in range(4):
        R_camera_world = recording.R_world_camera(frame, row).T
        ray = R_camera_world @ ray_world
        pixel = (recording.K @ (ray / ray[2]))[:2]
        row = np.clip(pixel[1], 0, recording.height)
    by_ray = np.array([[1, 0, -ray[0] / ray[2]], [0, 1, -ray[1] / ray[2]]]) / ray[2]
    return pixel, recording.K[:2, :2] @ by_ray @ R_camera_world @ -cross_matrix(ray_world)


def limits(recording, frame, view, zoom):
    """Rows A and limits b of A d <= b."""
    A, b = [], []
    for ray in recording.corner_rays(zoom):
        pixel, by_turn = seen_at(recording, frame, view @ ray)
        for axis, size in ((0, recording.width), (1, recording.height)):
            outward = 1 if ray[axis] > 0 else -1
            side = size - 0.5 if outward > 0 else -0.5
            A.append(outward * by_turn[axis])
            b.append(outward * (side - pixel[axis]))
    return np.array(A), np.array(b)


def fast_part(times_s):
    """The matrix that takes from a series what a Hann window of two periods of the cutoff smooths away."""
    apart = (times_s[None, :] - times_s[:, None]) * CUTOFF_HZ
    weights = np.where(np.abs(apart) < 1, 0.5 * (1 + np.cos(np.pi * apart)), 0)
    return np.eye(len(times_s)) - weights / weights.sum(axis=1, keepdims=True)


def solve(H, g, A, b):
    """Least x' H x / 2 + g' x with A_i x_i <= b_i, x_i three at a time."""
    frames, rows, _ = A.shape
    x, slack, force = np.zeros((frames, 3)), np.maximum(b, 1e-3), np.ones((frames, rows))
    for _ in range(60):
        gap = (slack * force).mean()
        off = np.einsum("ijk,ik->ij", A, x) + slack - b
        if gap < 1e-10 and np.abs(off).max() < 1e-8:
            break
        center = slack * force - 0.1 * gap
        M = H.copy()
        blocks = np.einsum("ijk,ij,ijl->ikl", A, force / slack, A)
        for i in range(frames):
            M[3 * i:3 * i + 3, 3 * i:3 * i + 3] += blocks[i]
        rhs = -(H @ x.ravel() + g) - np.einsum("ijk,ij->ik", A, force + (force * off - center) / slack).ravel()
        dx = np.linalg.solve(M, rhs).reshape(frames, 3)
        dslack = -off - np.einsum("ijk,ik->ij", A, dx)
        dforce = (-center - force * dslack) / slack
        step = min(1, *(0.99 * np.min(np.where(d < 0, -value / np.where(d < 0, d, -1), np.inf))
                        for value, d in ((slack, dslack), (force, dforce))))
        x, slack, force = x + step * dx, slack + step * dslack, force + step * dforce
    return x


def rates(times_s, views):
    return np.array([vector_of(after @ before.T) / dt
                     for before, after, dt in zip(views, views[1:], np.diff(times_s))])


def least_rate_deg_s(folder, zoom):
    """Of the session in `folder`, rms above 1 Hz; None of one that is too long."""
    recording = Recording(folder)
    times_s = recording.stamps_s
    if len(times_s) > MOST_FRAMES:
        return None
    fast = fast_part((times_s[1:] + times_s[:-1]) / 2)
    difference = np.diff(np.eye(len(times_s)), axis=0) / np.diff(times_s)[:, None]
    roughness = difference.T @ fast.T @ fast
    H = np.kron(roughness @ difference + 1e-9 * np.eye(len(times_s)), np.eye(3))
    views = [recording.R_world_camera(frame, recording.height / 2) for frame in range(len(times_s))]
    for _ in range(ROUNDS):
        A, b = (np.array(part) for part in zip(*(limits(recording, frame, view, zoom)
                                                 for frame, view in enumerate(views))))
        turns = solve(H, (roughness @ rates(times_s, views)).ravel(), A, b)
        views = [rotation(turn) @ view for turn, view in zip(turns, views)]
    fast_rates = fast @ rates(times_s, views)
    return math.degrees(math.sqrt((fast_rates ** 2).sum(axis=1).mean()))

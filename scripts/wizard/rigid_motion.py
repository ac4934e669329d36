"""The best rigid motion between two trajectories: a map has a frame of its own."""
import bisect
import cmath


def matched(estimate, truth):
    """[(stamp, place, heading, true place, true heading)] of poses within 20 ms of each other; places are complex numbers."""
    truth = sorted(truth)
    stamps = [pose[0] for pose in truth]
    pairs = []
    for pose in estimate:
        at = bisect.bisect_left(stamps, pose[0])
        near = min(truth[max(at - 1, 0):at + 1], key=lambda other: abs(other[0] - pose[0]))
        if abs(near[0] - pose[0]) < 0.02:
            pairs.append((pose[0], complex(*pose[1:3]), pose[3], complex(*near[1:3]), near[3]))
    return pairs


class Motion:
    def __init__(self, rotation, mean, true_mean):
        self.rotation, self.mean, self.true_mean = rotation, mean, true_mean

    @property
    def turn(self):
        return cmath.phase(self.rotation)

    def apply(self, place):
        return self.rotation * (place - self.mean) + self.true_mean


def best_motion(pairs):
    """Least squares of the places of matched()."""
    mean = sum(pair[1] for pair in pairs) / len(pairs)
    true_mean = sum(pair[3] for pair in pairs) / len(pairs)
    rotation = sum((pair[3] - true_mean) * (pair[1] - mean).conjugate() for pair in pairs)
    return Motion(rotation / abs(rotation), mean, true_mean)

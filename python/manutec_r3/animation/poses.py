"""Where the arms are: positions and quaternions, between which pictures can be interpolated."""

import numpy as np
from scipy.spatial.transform import Rotation

from ..robot import Robot


def arm_names(robot: Robot) -> list[str]:
    """Names of the arms that are drawn: ``arm_1`` to ``arm_6``, of one axis ``arm_1``."""
    return [f"arm_{arm}" for arm in range(1, 2 if robot.n_axes == 1 else 7)]


def arm_poses(robot: Robot, angle: np.ndarray) -> np.ndarray:
    """Frames of these arms in the world for angles (n, n_axes) [rad], from `Robot.link_poses`.

    Returns
    -------
    ndarray (n, n_arms, 7)
        Positions x, y, z [m] and unit quaternions x, y, z, w.
    """
    frames = robot.link_poses(angle)[:, 1 : 1 + len(arm_names(robot))]
    turned = Rotation.from_matrix(frames[..., :3, :3].reshape(-1, 3, 3)).as_quat()
    return np.concatenate((frames[..., :3, 3], turned.reshape(*frames.shape[:2], 4)), axis=-1)

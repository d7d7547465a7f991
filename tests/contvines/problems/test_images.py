"""Groups of images from their generators."""

import numpy as np
import pytest

from contvines.problems.symmetries import images_of, smallest_image


def test_a_quarter_turn_and_a_reflection_generate_the_square():
    turn, flip = np.array([[0.0, -1.0], [1.0, 0.0]]), np.diag([1.0, -1.0])
    images = images_of([lambda u: turn @ u, lambda u: flip @ u], 2)
    assert len(images) == 7
    u = np.array([0.3, 0.7])
    for image in images:
        assert smallest_image(image(u), images, np.ones(2)) == pytest.approx([-0.7, -0.3])

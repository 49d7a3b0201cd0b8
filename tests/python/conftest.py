# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the package begin with."""
import pytest

import conus
from support import AFFINE, NAMES, plates


@pytest.fixture(name="atlas")
def make_atlas():
    return conus.load(plates(), AFFINE, labels=NAMES)

# SPDX-License-Identifier: BSD-3-Clause
"""What an oracle compares: all that it has with CONUS_TEST_LONG (scripts/test --long), else a part."""
import os

LONG = bool(os.environ.get("CONUS_TEST_LONG"))


def every(step, cases):
    """All cases, or each step-th of them, from the first on."""
    return list(cases)[::1 if LONG else step]

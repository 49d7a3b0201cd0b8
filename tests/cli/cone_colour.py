# SPDX-License-Identifier: BSD-3-Clause
"""cone_colour.py PICTURE orange|grey: whether the cone has that colour in a picture of the window, 1280 x 800, in 3-D and
in the cuts. A picture that is not there has no cone."""
import sys
import OpenImageIO as oiio


def oranges(pixels, left, right):
    """How many pixels there are as saturated as the cone, and as no area, above the words in 3-D."""
    part = pixels[40:680, left:right, :3].astype(int)
    return (part[:, :, 0] - part[:, :, 2] > 140).sum()


pixels = oiio.ImageBuf(sys.argv[1]).get_pixels(oiio.UINT8)
if pixels is None or len(pixels) != 800:
    sys.exit(1)
counts = [oranges(pixels, *pane) for pane in ((60, 720), (730, 890))]
print(sys.argv[1], counts)
sys.exit(not (max(counts) == 0 if sys.argv[2] == "grey" else min(counts) > 30))

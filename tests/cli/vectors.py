#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""vectors.py: what fig.svg and fig.pdf have, beside fig.png, the same picture in pixels.

The three show blocks.nii.gz, of which write() makes a box of 40 x 60 x 20 mm with an odd name, in an axial cut through
its middle with the cone that hits it, 120 x 80 mm at 200 dpi.
"""
import base64
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import nibabel
import numpy
import OpenImageIO as oiio

SVG = "{http://www.w3.org/2000/svg}"
NAME = "Box <1> & \"Süd\""
WORDS = {NAME, "L", "R", "A", "P", "z = 0 mm", "First hits of the cone"}


def write():
    labels = numpy.zeros((60, 80, 40), numpy.uint8)
    labels[10:50, 10:70, 10:30] = 1
    affine = numpy.eye(4)
    affine[:3, 3] = -29.5, -39.5, -19.5
    nibabel.save(nibabel.Nifti1Image(labels, affine), "blocks.nii.gz")
    with open("blocks.txt", "w", encoding="utf-8") as table:
        print("index\tname\tred\tgreen\tblue", f"1\t{NAME}\t30\t90\t200", sep="\n", file=table)


def numbers(path):
    """The points of a path of M, L and Z, as pairs."""
    return numpy.array([float(n) for n in re.findall(r"-?[\d.]+", path)]).reshape(-1, 2)


def words_of_pdf():
    return subprocess.run(("pdftotext", "-layout", "fig.pdf", "-"), check=True, capture_output=True,
                          text=True).stdout


def check_svg():
    root = ElementTree.parse("fig.svg").getroot()
    assert [float(root.get(n).removesuffix("mm")) for n in ("width", "height")] == \
        [round(px * 25.4 / 200, 6) for px in map(float, root.get("viewBox").split()[2:])]
    assert abs(float(root.get("width").removesuffix("mm")) - 120) < 0.1
    texts = {text.text: text for text in root.iter(SVG + "text")}
    assert WORDS <= set(texts), texts.keys()
    assert float(texts["L"].get("x")) < float(texts["R"].get("x"))
    assert float(texts["A"].get("y")) < float(texts["P"].get("y"))
    image, = root.iter(SVG + "image")
    # The outline of 40 x 60 mm gives the length of a mm; the bar is as long as its text says.
    box, = [numbers(path.get("d")) for path in root.iter(SVG + "path") if path.get("stroke") == "#69737d"]  # one grey
    # Its corners are round within half a voxel of 1 mm.
    half = 0.5 * numpy.ptp(box[:, 0]) / 40 + 1
    beside = numpy.minimum(box - box.min(axis=0), box.max(axis=0) - box)
    assert ((beside.min(axis=1) == 0) | (beside.max(axis=1) <= half)).all(), box
    # The outline is not in the pixels: a row near the box's edge, where no cone is, has one colour.
    with open("inside.png", "wb") as inside:
        inside.write(base64.b64decode(image.get("{http://www.w3.org/1999/xlink}href").partition(",")[2]))
    row = oiio.ImageBuf("inside.png").get_pixels(oiio.UINT8)[int(box[:, 1].max()) - 4]
    row = row[int(box[:, 0].min()) : int(box[:, 0].max()) + 1, :3]
    assert len(row) > 100 and (row == row[0]).all(), row
    pixels_per_mm = (numpy.ptp(box, axis=0) + 1) / (40, 60)
    assert abs(pixels_per_mm[0] / pixels_per_mm[1] - 1) < 0.01, pixels_per_mm
    length, = [float(text[:-3]) for text in texts if re.fullmatch(r"\d+ mm", text)]
    lines = [numbers(path.get("d")) for path in root.iter(SVG + "path") if path.get("d").count("L") == 1]
    bar = max(numpy.ptp(line[:, 0]) for line in lines)
    assert abs(bar - length * pixels_per_mm.mean()) < 0.01 * bar, (bar, length, pixels_per_mm)
    # The cone's wall in the cut: apex at (-90, 0), half of 20 degrees, so its lines diverge from the axis by that.
    cone = numpy.concatenate([numbers(path.get("d")) for path in root.iter(SVG + "path")
                              if path.get("stroke") == "#ffb000"])
    middle = (box.min(axis=0) + box.max(axis=0)) / 2
    x, y = ((cone - middle) / pixels_per_mm).T
    assert abs(x.max() + 20) < 0.3, x.max()  # it ends at its deepest hit, the side of the box
    wall = x < x.max() - 0.5
    assert numpy.abs(numpy.abs(y) - (x + 90) * numpy.tan(numpy.radians(10)))[wall].max() < 0.3
    return length


def check_pdf(length):
    about = subprocess.run(("pdfinfo", "fig.pdf"), check=True, capture_output=True, text=True).stdout
    width, height = map(float, re.search(r"Page size: +([\d.]+) x ([\d.]+)", about).groups())
    assert abs(width - 120 / 25.4 * 72) < 0.3 and abs(height - 80 / 25.4 * 72) < 0.3, (width, height)
    assert "Date" not in about, about
    words = words_of_pdf()
    missing = [word for word in WORDS | {f"{length:g} mm"} if word not in words]
    assert not missing, (missing, words)
    fonts = subprocess.run(("pdffonts", "fig.pdf"), check=True, capture_output=True, text=True).stdout
    assert all(row.split()[-5:-2] == ["yes"] * 3 for row in fonts.splitlines()[2:]) and fonts.count("\n") > 2, fonts


def check_sizes(name, mm):
    """Each text of the SVG and of the PDF has 6 to 8 points, and the PNG is as wide. Poppler's box of a word is as high
    as Liberation Sans goes above and below the baseline: 0.905 + 0.212 of an em (its hhea table)."""
    root = ElementTree.parse(f"{name}.svg").getroot()
    wide, _, _ = root.get("width").partition("mm")
    points = float(wide) / 25.4 * 72 / float(root.get("viewBox").split()[2])
    sizes = [float(text.get("font-size")) * points for text in root.iter(SVG + "text")]
    page = subprocess.run(("pdftotext", "-bbox", f"{name}.pdf", "-"), check=True, capture_output=True, text=True).stdout
    words = [float(low) - float(high) for high, low in re.findall(r'<word .*yMin="([\d.]+)".*yMax="([\d.]+)"', page)]
    assert len(sizes) > 8 and len(words) >= len(sizes), (len(sizes), len(words))
    for size in sizes + [height / 1.117 for height in words]:
        assert 6 - 0.01 <= size <= 8 + 0.01, (name, size)
    png = oiio.ImageBuf(f"{name}.png").spec()
    assert abs(float(wide) - float(mm)) < 0.1 and abs(25.4 * png.width / png["XResolution"] - float(mm)) < 0.1, \
        (wide, png.width, png["XResolution"])


def pixels(name, size):
    picture = oiio.ImageBuf(name)
    assert (picture.spec().width, picture.spec().height) == size, (picture.spec().width, picture.spec().height)
    return picture.get_pixels(oiio.FLOAT)[..., :3]


def check_pictures():
    """Two programs draw the files as conus draws the PNG: letters and lines differ by how their edges are smoothed."""
    drawn = oiio.ImageBuf("fig.png").spec()
    size = drawn.width, drawn.height
    subprocess.run(("rsvg-convert", "-w", str(size[0]), "-h", str(size[1]), "fig.svg", "-o", "svg.png"), check=True)
    subprocess.run(("pdftoppm", "-r", "200", "-png", "-singlefile", "fig.pdf", "pdf"), check=True)
    wanted = pixels("fig.png", size)
    for name in ("svg.png", "pdf.png"):
        differences = numpy.abs(pixels(name, size) - wanted).max(axis=2)
        assert differences.mean() < 0.01, (name, differences.mean())
        assert (differences > 0.5).mean() < 0.01, (name, (differences > 0.5).mean())


if sys.argv[1] == "write":
    write()
elif sys.argv[1] == "white":
    assert (oiio.ImageBuf(sys.argv[2]).get_pixels(oiio.UINT8)[-1, 0] == 255).all()
elif sys.argv[1] == "sizes":
    check_sizes(*sys.argv[2:])
else:
    check_pdf(check_svg())
    check_pictures()

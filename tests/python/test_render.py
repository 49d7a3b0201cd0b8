# SPDX-License-Identifier: BSD-3-Clause
"""Pictures in space, and what else uses OpenGL. $CONUS is the program conus."""
import gc
import io
import multiprocessing
import os
import shutil
import subprocess
import sys
import threading

import matplotlib.image
import nibabel
import numpy as np
import pytest

import conus
from support import AAL, AFFINE, NAMES, call_conus, needs_aal, page_blocks, plates, same

NAMES_OF_AAL = AAL.replace(".gz", ".txt")
CONTEXT = "/usr/share/mricron/templates/ch2bet.nii.gz"
CONE = {"origin": (-90, 20, 20), "toward": (0, -10, 10), "angle": 20}
SMALL = (200, 150)
HANG = 120  # s; only a hanging process takes so long


@pytest.fixture(name="_gl", scope="module", autouse=True)
def needs_gl():
    """A driver that is there and refuses a shader is an error, too: only without OpenGL 4.5 nothing is tested."""
    has_gl = subprocess.run([os.environ["CONUS_HAS_GL"]], capture_output=True, text=True, check=False)
    if has_gl.returncode == 77:
        pytest.skip(f"no OpenGL: {has_gl.stdout}")
    assert has_gl.returncode == 0


@pytest.fixture(name="halved", scope="module")
def write_halved(tmp_path_factory):
    """AAL, with its names, and the image for its context, both at 2 mm."""
    paths = {}
    for path in (AAL, CONTEXT):
        image = nibabel.load(path)
        voxels = np.asanyarray(image.dataobj)[::2, ::2, ::2]
        paths[path] = tmp_path_factory.getbasetemp() / os.path.basename(path)
        nibabel.save(nibabel.Nifti1Image(voxels, image.affine @ np.diag([2, 2, 2, 1])), paths[path])
    shutil.copy(NAMES_OF_AAL, paths[AAL].parent)
    return paths


@pytest.fixture(name="aal", scope="module")
def load_aal(halved):
    return conus.load(halved[AAL], context=halved[CONTEXT])


def pixels_of(png):
    return np.rint(matplotlib.image.imread(io.BytesIO(png), "png") * 255).astype(np.uint8)


# The picture of the program

CAMERA = {"camera_origin": (0, 0, 500), "camera_toward": (0, -20, 0), "camera_up": (0, 1, 0)}

# The arguments of the library, and the same for the program: options of the cone, of the picture, and further words.
CASES = {
    "atlas": (None, {}, ()),
    "cone": ({}, {}, ()),
    "all layers": ({"layers": "all", "resolution": 32}, {}, ()),
    "cylinder": ({"radius": 4}, {}, ()),
    "camera": ({}, {**CAMERA, "field_of_view": 20}, ()),
    "frustum": (None, {**CAMERA, "frustum": (-0.1, 0.3, -0.2, 0.2)}, ()),
    "slices": (None, {"slices": 40}, ()),
    "no legend": ({}, {"legend": False}, ("--no-legend",)),
    "transfer": (None, {"transfer": "surface"}, ()),
    "legend below": ({}, {"view": "left", "background": "white", "legend": "below", "dpi": 100}, ()),
    "legend right": ({}, {"view": "back", "background": "transparent", "legend": "right"}, ()),
    "colour": ({}, {"view": "top", "background": "#804020", "legend": "none"}, ()),
    "unselected": ({}, {"unselected": "#c0c0c0"}, ()),
    "own colours": ({}, {"own_colours": True}, ("--palette=file",)),
    "legend rows": ({}, {"legend_rows": 1}, ()),
    "legend areas": ({}, {"legend_areas": ("Thalamus_L",)}, ("--legend-area=Thalamus_L",)),
    "only hits": ({}, {"opacity": 0}, ()),
    "cuts": ({}, {"cuts": ("axial", "coronal:-10", "sagittal"), "at": (-40, 5, 10), "fill": 0.3}, ()),
    "mosaic": ({}, {"cuts": ("mosaic:7", "coronal:0")}, ()),
    "radiological": ({}, {"cuts": ("3d", "axial"), "at": (-40, 5, 10), "radiological": True}, ("--radiological",)),
}
ONLY_OURS = ("legend_areas",)  # the program has it under another name


@needs_aal
@pytest.mark.parametrize("case", CASES)
def test_picture_is_the_file_of_the_program(aal, halved, tmp_path, case):
    """To the byte: one library draws both, and the driver is the same."""
    cone, view, words = CASES[case]
    hits = None
    size = (400, 300) if "cuts" in view else SMALL
    words = [*words, f"--context={halved[CONTEXT]}", "--size={}x{}".format(*size), "-q", "-o", tmp_path / "theirs.png"]
    given = {name: value for name, value in view.items() if not isinstance(value, bool) and name not in ONLY_OURS}
    if cone is not None:
        aim = {name: value for name, value in CONE.items() if name != "angle" or "radius" not in cone}
        hits = aal.select(**aim, **cone)
        given.update(**aim, **cone)
    for name, value in given.items():
        text = ",".join(map(str, value)) if isinstance(value, tuple) else value
        words.append(f"--{name.replace('_', '-')}={text}")
    call_conus("render", halved[AAL], *words)
    picture = aal.render(hits, size=size, **view)
    theirs = (tmp_path / "theirs.png").read_bytes()
    assert picture._repr_png_() == theirs
    assert np.array_equal(picture.array, pixels_of(theirs))
    picture.save(tmp_path / "ours.png")
    assert (tmp_path / "ours.png").read_bytes() == theirs
    assert len(np.unique(picture.array.reshape(-1, 4), axis=0)) > 300  # more than the 56 greys of a background


@needs_aal
def test_probes_are_the_strips_of_the_program(aal, halved, tmp_path):
    """With the same words as text in the file of shapes."""
    (tmp_path / "two.tsv").write_text("name\tx\ty\tz\ttx\tty\ttz\nA\t-45\t-20\t85\t-20\t-20\t0\nB\t30\t10\t75\t28\t-25\t-12\n")
    call_conus("render", halved[AAL], f"--context={halved[CONTEXT]}", "--poses", tmp_path / "two.tsv", "--range=0,85", "--strips",
               "--opacity=0", "--size=400x200", "-q", "-o", tmp_path / "theirs.svg")
    probes = {"A": ((-45, -20, 85), (-20, -20, 0)), "B": ((30, 10, 75), (28, -25, -12))}
    view = {"probes": probes, "probe_range": (0, 85), "opacity": 0, "size": (400, 200)}
    aal.render(vectors=True, **view).save(tmp_path / "ours.svg")
    assert (tmp_path / "ours.svg").read_bytes() == (tmp_path / "theirs.svg").read_bytes()
    with pytest.raises(conus.ArgumentError):  # text is in its pixels
        aal.render(**view).save(tmp_path / "pixels.svg")


@needs_aal
def test_points_are_the_balls_of_the_program(aal, halved, tmp_path):
    places = {f"{side}{n}": (x * (20 + 5 * n), -18, -15) for side, x in (("LA", -1), ("RA", 1)) for n in (1, 2, 3)}
    (tmp_path / "six.csv").write_text("name,x,y,z\n" + "".join(f"{name},{x},{y},{z}\n" for name, (x, y, z) in places.items()))
    view = {"points": places, "point_groups": [name[:2] for name in places], "point_radius": 3, "size": (400, 300)}
    for cuts in (), ("coronal",):
        words = ["--cuts=" + ",".join(cuts), "--at=0,-18,-15"] if cuts else ["--opacity=0"]
        call_conus("render", halved[AAL], f"--context={halved[CONTEXT]}", "--pose", tmp_path / "six.csv", "--radius=3", "--size=400x300",
                    "-q", "-o", tmp_path / "theirs.svg", *words)
        where = {"cuts": cuts, "at": (0, -18, -15)} if cuts else {"opacity": 0}
        aal.render(vectors=True, **view, **where).save(tmp_path / "ours.svg")
        assert (tmp_path / "ours.svg").read_bytes() == (tmp_path / "theirs.svg").read_bytes()
    for wrong in {"point_radius": -1}, {"point_groups": ["LA"]}, {"probes": {"A": ((0, 0, 90), (0, 0, 0))}}:
        with pytest.raises(conus.ArgumentError):
            aal.render(**{**view, **wrong})


def test_measured_distance_is_written(tmp_path):
    atlas = conus.load(plates(), AFFINE)
    low, high = np.zeros(3), np.array([3, 4, 0])
    atlas.render(measured=[low, high], vectors=True, size=(300, 200)).save(tmp_path / "measured.svg")
    assert ">5.00 mm</text>" in (tmp_path / "measured.svg").read_text()


@pytest.mark.parametrize("palette", [["#102030", "#ffffff"], "#102030,#ffffff", "#102030 #FFFFFF"])
def test_palette_gives_its_colours(palette):
    atlas = conus.load(plates(), AFFINE, palette=palette)
    colours = {tuple(map(int, rgb)) for rgb in atlas.objects.colours[1:]}
    assert colours == {(16, 32, 48), (255, 255, 255)}


@pytest.mark.parametrize("view, why", [
    ({"unselected": "pink"}, "unselected: 'pink', allowed is white, black, #rrggbb"),
    ({"legend_areas": "Thalamus_L"}, "legend_areas"),
    ({"measured": [1, 2, 3]}, r"measured: an array of shape \(3,\), wanted is \(2, 3\)"),
    ({"cuts": ["axial"]}, "at: 'axial' needs a point"),
    ({"cuts": "axial:0"}, "cuts: 'axial:0', wanted is a list of cuts"),
    ({"cuts": ["3d"]}, "cuts: 3d alone is the picture without cuts"),
    ({"cuts": ["axial:0"], "probes": {"A": np.eye(4)}}, "probes and cuts exclude each other"),
    ({"at": (0, 0, 0)}, "at: has no effect without cuts"),
    ({"fill": 0}, "fill: has no effect without cuts"),
    ({"radiological": True}, "radiological: has no effect without cuts"),
    ({"cuts": ["axial:0"], "view": "left"}, "view: has no effect on cuts"),
    ({"cuts": ["axial:0"], "unselected": "white"}, "unselected: has no effect on cuts"),
    ({"cuts": ["oblique"]}, "cuts: 'oblique', allowed is axial, coronal, sagittal"),
    ({"cuts": ["axial:up"]}, "cuts: 'axial:up', wanted is axial or axial:NUMBER"),
    ({"probe_range": (0, 9)}, "probe_range: there are no probes"),
    ({"legend_rows": 0}, "legend_rows"),
    ({"legend_rows": 2, "probes": {"A": np.eye(4)}}, "legend_rows, legend_areas: have no effect with probes"),
    ({"legend_areas": [1], "probes": {"A": np.eye(4)}}, "legend_rows, legend_areas: have no effect with probes"),
    ({"cuts": ["mosaic:0"]}, "cuts: 'mosaic:0', wanted is mosaic or mosaic:N"),
    ({"cuts": ["mosaics"]}, "cuts: 'mosaics', wanted is mosaic or mosaic:N"),
])
def test_new_options_refuse_what_they_are_not(view, why):
    with pytest.raises(conus.ArgumentError, match=why):
        conus.load(plates(), AFFINE).render(size=(60, 40), **view)


@needs_aal
def test_transfer_of_points_is_that_of_its_name(aal):
    with aal.renderer(transfer="surface") as surface, aal.renderer() as other:
        assert surface.transfer.shape[1] == 5 and (np.diff(surface.transfer[:, 0]) >= 0).all()
        wanted = surface.render(size=SMALL).array
        assert not np.array_equal(other.render(size=SMALL).array, wanted)
        other.transfer = surface.transfer
        assert np.array_equal(other.render(size=SMALL).array, wanted)
        assert np.array_equal(aal.render(size=SMALL, transfer=surface.transfer).array, wanted)
    assert {"brain", "surface"} <= {*conus.transfer_presets()}


def test_figure_has_its_width_in_mm(atlas):
    """85 mm at 300 pixels per 25.4 mm are 1003.94 pixels, three quarters of it 752.95; 11811 = 0x2e23 per metre."""
    picture = atlas.render(width_mm=85, background="transparent", legend=False)
    assert picture.size == (1004, 753)
    assert b"pHYs" + bytes([0, 0, 0x2E, 0x23] * 2) in picture._repr_png_()
    assert picture.array[0, 0].tolist() == [0, 0, 0, 0] and picture.array[..., 3].max() == 255
    assert np.array_equal(picture.array, pixels_of(picture._repr_png_()))


def test_print_is_that_of_the_program(tmp_path):
    """To the byte: by a width in mm, by its name, and not where the screen's is asked for."""
    call_conus("phantom", "slabs", "-o", tmp_path, "--size", "16")
    atlas = conus.load(tmp_path / "slabs.nii.gz")
    hits = atlas.select((20, 60, 10), toward=(0, 0, 0), angle=20)
    for option, given in ((["--width-mm=20"], {"width_mm": 20}), (["--style=print", "--size=60x40"], {"style": "print", "size": (60, 40)}),
                          (["--width-mm=20", "--style=screen"], {"width_mm": 20, "style": "screen"})):
        call_conus("render", tmp_path / "slabs.nii.gz", "--origin=20,60,10", "--toward=0,0,0", "--angle=20", *option, "-q",
                   "-o", tmp_path / "a.png")
        assert atlas.render(hits, **given)._repr_png_() == (tmp_path / "a.png").read_bytes(), given
    assert atlas.render(hits, style="print", legend=False, dpi=50).size == (354, 266)  # 180 / 25.4 * 50, three quarters


def test_opacity_and_haze_are_those_of_the_program(tmp_path):
    """To the byte, with an area, all others, and a pathway."""
    call_conus("phantom", "slabs", "-o", tmp_path, "--size", "16")
    slabs, tract = tmp_path / "slabs.nii.gz", tmp_path / "tract.nii"
    nibabel.save(nibabel.Nifti1Image((nibabel.load(slabs).get_fdata() == 1).astype("f4"),
                                     nibabel.load(slabs).affine), tract)
    atlas = conus.load(slabs, pathways=[(tract, 0.5)])
    name = atlas.info()["name"].iloc[1]
    call_conus("render", slabs, f"--pathway={tract},threshold=0.5", "--size=60x40", "--opacity=0.4",
               f"--opacity={name}=0.8", "--pathway-transfer=heat", "-q", "-o", tmp_path / "a.png")
    ours = atlas.render(size=(60, 40), opacity={None: 0.4, name: 0.8}, pathway_transfers="heat")
    assert ours._repr_png_() == (tmp_path / "a.png").read_bytes()
    plain = atlas.render(size=(60, 40))
    for other in (atlas.render(size=(60, 40), opacity=0.4), atlas.render(size=(60, 40), pathway_transfers={"tract": "own"})):
        assert not np.array_equal(other.array, plain.array)


def test_shell_is_that_of_the_program(tmp_path):
    """To the byte; it is no head in which the areas could lie."""
    call_conus("phantom", "slabs", "-o", tmp_path, "--size", "16")
    slabs = tmp_path / "slabs.nii.gz"
    call_conus("render", slabs, "--shell", "--size=60x40", "-q", "-o", tmp_path / "a.png")
    atlas = conus.load(slabs, shell=True)
    assert atlas.render(size=(60, 40), opacity=0)._repr_png_() == (tmp_path / "a.png").read_bytes()
    assert atlas.placement().in_head is None


def test_streamlines_have_the_colours_of_the_program(tmp_path):
    call_conus("phantom", "slabs", "-o", tmp_path, "--size", "16")
    slabs, lines = tmp_path / "slabs.nii.gz", tmp_path / "lines.tck"
    bundle = [np.array([[0, y, 30], [0, 20, 30 - y]], "f4") for y in (-20, 0, 10)]
    nibabel.streamlines.save(nibabel.streamlines.Tractogram(bundle, affine_to_rasmm=np.eye(4)), str(lines))
    call_conus("render", slabs, "--streamlines", lines, "--streamline-colour=direction", "--size=60x40", "-q",
               "-o", tmp_path / "a.png")
    atlas = conus.load(slabs, streamlines=[lines])
    ours = atlas.render(size=(60, 40), streamline_colour="direction")
    assert ours._repr_png_() == (tmp_path / "a.png").read_bytes()
    assert not np.array_equal(ours.array, atlas.render(size=(60, 40)).array)


def test_safe_colours_are_other_colours():
    own, safe = (conus.load(plates(), AFFINE, labels=NAMES, safe_colours=safe) for safe in (False, True))
    pictures = [atlas.render(size=(60, 40), legend=False).array for atlas in (own, safe)]
    assert not np.array_equal(*pictures)


@needs_aal
def test_context_fades_and_a_draft_is_rough(aal, halved):
    """Without its context, the atlas is the picture, as it is where areas cover it and no transfer function is given; a
    draft has fewer shades at edges."""
    bare = conus.load(halved[AAL]).render(size=SMALL, legend=False, **CAMERA).array
    with aal.renderer() as renderer:
        assert np.array_equal(renderer.render(size=SMALL, legend=False, **CAMERA).array, bare)
    with aal.renderer(transfer="brain") as renderer:
        assert np.array_equal(renderer.render(size=SMALL, legend=False, fade=1, **CAMERA).array, bare)
        whole = renderer.render(size=SMALL, legend=False, **CAMERA).array
        draft = renderer.render(size=SMALL, legend=False, draft=True, **CAMERA).array
    assert not np.array_equal(whole, bare) and not np.array_equal(whole, draft)


@needs_aal
def test_lines_of_the_documents_draw_pictures(aal, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (block,) = [block for block in page_blocks() if "render(" in block]
    os.symlink(AAL, "aal.nii.gz")
    given = {"conus": conus, "atlas": aal, "hits": aal.select(**CONE)}
    if not os.environ.get("CONUS_TEST_LONG"):  # smaller pictures of the same lines
        for size, small in (("size=(700, 525)", "size=(140, 105)"), ("width_mm=85", "width_mm=17"), ("0, 0), t", "0, 0), size=(140, 105), t"),
                            ("opacity=0.3)", "opacity=0.3, size=(140, 105))"), ("rows=3)", "rows=3, size=(140, 105))"),
                            ("5, 10))", "5, 10), size=(300, 200))"), ("(0, 85))", "(0, 85), size=(300, 200))"), ("vectors=True)", "vectors=True, size=(140, 105))")):
            assert size in block
            block = block.replace(size, small)
    exec(block, given)
    assert given["picture"].array.shape[1] in (140, 700) and sorted(os.listdir()) == ["aal.nii.gz", "cone.png", "figure.svg"]


# The drawn scene


def test_camera_sees_the_plates_where_they_are(atlas):
    """From z = 200 down: x = 29, the middle of the right plate, is at 29 / (200 tan 15) of half the width, 50 px."""
    camera = np.eye(4)
    camera[:3, 3] = (0, 0, 200)
    picture = atlas.render(size=(100, 100), legend=False, camera=camera)
    side = 29 / (200 * np.tan(np.radians(15)))
    columns = [round(50 + 50 * x) for x in (-side, 0, side)]
    left, middle, right = (picture.array[50, column, :3].astype(int) for column in columns)
    info = atlas.objects.colours[1:].astype(int)
    assert np.ptp(middle) == 0  # the background is grey
    for seen, colour in ((left, info[0]), (right, info[1])):
        assert np.abs(seen / seen.max() - colour / colour.max()).max() < 0.2


def test_channels_are_linear_light(atlas):
    picture = atlas.render(size=(40, 30), legend=False)
    assert picture.size == (40, 30) and picture.channels == ["R", "G", "B", "A"]
    assert (picture.channel("A") == 1).all()
    red = picture.channel("R")
    assert red.shape == (30, 40) and red.dtype == np.float32
    srgb = np.where(red <= 0.0031308, 12.92 * red, 1.055 * np.maximum(red, 0) ** (1 / 2.4) - 0.055).clip(0, 1)
    assert np.abs(255 * srgb - picture.array[..., 0]).max() <= 0.501
    assert picture.array.dtype == np.uint8 and picture.array.shape == (30, 40, 4)
    with pytest.raises(KeyError):
        picture.channel("Z")
    assert repr(picture).startswith("<conus.Picture of 40 x 30 pixels, by ") and picture.device in repr(picture)


def test_picture_is_saved_where_the_path_says(atlas, tmp_path):
    picture = atlas.render(size=(40, 30))
    folder = os.fsencode(tmp_path) + b"/a b\xff"
    os.mkdir(folder)
    for path in (folder + b"/x.exr", tmp_path / "x.exr", str(tmp_path / "y.png")):
        picture.save(path)
        assert open(path, "rb").read(4) in (b"\x76\x2f\x31\x01", b"\x89PNG")
    for path, error in (("x.jpg", conus.ArgumentError), (tmp_path / "no" / "x.png", conus.FileError)):
        with pytest.raises(error):
            picture.save(path)


def test_chosen_object_is_not_pale(atlas):
    hits = atlas.select((0, 0, 0), direction=(1, 0, 0))
    pale, full = (atlas.render(hits, size=(60, 40), chosen=name, own_colours=True).array for name in (None, "left"))
    assert not np.array_equal(pale, full)


def test_a_renderer_is_used_again_and_closed(atlas):
    once = atlas.render(size=(60, 40)).array
    with atlas.renderer() as renderer:
        assert all(np.array_equal(renderer.render(size=(60, 40)).array, once) for _ in range(3))
        assert renderer.device and repr(renderer) == "<conus.Renderer of <conus.Atlas of 2 objects>>"
    renderer.close()  # again
    for ask in (renderer.render, lambda: renderer.device, lambda: renderer.transfer):
        with pytest.raises(conus.ArgumentError, match="closed"):
            ask()


# Refused arguments


@pytest.mark.parametrize(
    "view",
    [
        {"size": (0, 10)},
        {"size": (10, -1)},
        {"size": (10, 1.5)},
        {"size": (10, 20000)},
        {"field_of_view": 0},
        {"field_of_view": 180},
        {"field_of_view": np.nan},
        {"frustum": (-1, 1, -1, 1)},
        {"frustum": (0, 0, 0, 0), "camera": np.eye(4)},
        {"frustum": (1, -1, -1, 1), "camera": np.eye(4)},
        {"frustum": (-1, 1, -1), "camera": np.eye(4)},
        {"frustum": (-1, 1, -1, 1), "camera": np.eye(4), "field_of_view": 30},
        {"camera": np.eye(3)},
        {"camera": 2 * np.eye(4)},
        {"camera": np.full((4, 4), np.nan)},
        {"camera": np.eye(4), "camera_origin": (0, 0, 0)},
        {"camera_origin": (0, 0, 0)},
        {"camera_up": (0, 0, 1)},
        {"slices": 0},
        {"slices": 70000},
        {"fade": 1.1},
        {"fade": np.nan},
        {"chosen": "riht"},
        {"transfer": "surface"},
        {"transfer": [[0, 0, 0, 0, 0]]},
        {"transfer": np.zeros((2, 4))},
        {"max_memory": -1},
        {"view": "above"},
        {"view": "top", "camera": np.eye(4)},
        {"legend": "top"},
        {"background": "green"},
        {"background": "#12345"},
        {"background": "#rrggbb"},
        {"background": ""},
        {"view": ""},
        {"style": "paper"},
        {"dpi": 0},
        {"dpi": np.nan},
        {"height_mm": 20},
        {"width_mm": 85},
        {"opacity": 1.5},
        {"opacity": {"left": -0.1}},
        {"opacity": {"left": np.nan}},
        {"opacity": {"riht": 0.5}},
        {"pathway_transfers": "heat"},
        {"streamline_colour": "fa"},
        {"size": None, "width_mm": 0},
        {"size": None, "width_mm": np.nan},
        {"size": None, "width_mm": 85, "dpi": 1e5},
        {"size": None, "width_mm": 85, "height_mm": 1e6},
    ],
)
def test_bad_view_is_an_error(atlas, view):
    with pytest.raises(conus.ArgumentError) as caught:
        atlas.render(**{"size": (10, 10), **view})
    assert "\n" not in str(caught.value)


def test_selection_of_another_atlas_or_of_a_ball_is_an_error(atlas):
    other = conus.load(plates(), AFFINE, labels=NAMES)
    for hits in (other.select((0, 0, 0), direction=(1, 0, 0)), atlas.near((21, 1, 1), 5)):
        with pytest.raises(conus.ArgumentError, match="selection"):
            atlas.render(hits, size=(10, 10))


def test_bad_transfer_is_an_error(atlas, tmp_path):
    context = conus.load(plates(), AFFINE, context=nibabel.Nifti1Image(plates("f4"), AFFINE))
    for transfer, error in (
        ("nonsense", conus.Error),
        (tmp_path / "no.json", conus.Error),
        ([[2, 0, 0, 0, 0], [1, 0, 0, 0, 0]], conus.ArgumentError),
        ([[0, np.nan, 0, 0, 0]], conus.ArgumentError),
        (np.empty((0, 5)), conus.ArgumentError),
    ):
        with pytest.raises(error):
            context.render(size=(10, 10), transfer=transfer)


def test_textures_above_max_memory_are_an_error(atlas):
    with pytest.raises(conus.OutOfMemoryError):
        atlas.render(size=(10, 10), max_memory=1000)


def test_closed_atlas_is_not_drawn(atlas):
    with atlas.renderer() as renderer:
        picture = renderer.render(size=(10, 10))
        atlas.close()
        for ask in (atlas.render, renderer.render):
            with pytest.raises(conus.ArgumentError, match="closed"):
                ask()
    assert picture.array.any()


# Threads and processes


def in_thread(function):
    """What the function returns or raises in another thread."""
    found = []

    def run():
        try:
            found.append(function())
        except conus.Error as error:
            found.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    return found[0]


def test_each_thread_draws_with_a_renderer_of_its_own(atlas):
    wanted = atlas.render(size=(60, 40)).array
    assert np.array_equal(in_thread(lambda: atlas.render(size=(60, 40)).array), wanted)
    with atlas.renderer() as renderer:
        error = in_thread(renderer.render)
        assert isinstance(error, conus.ArgumentError) and "thread" in str(error)


def test_each_thread_has_a_gl_selector_of_its_own(atlas):
    aim = {"origin": (0, 0, 0), "direction": (1, 0, 0)}
    wanted = atlas.select(**aim, engine="rays").results
    selector = atlas.selector(engine="gl")
    for ask in (lambda: atlas.select(**aim, engine="gl").results, lambda: selector.select(**aim).results):
        assert same(ask(), wanted)
    assert same(in_thread(lambda: atlas.select(**aim, engine="gl").results), wanted)
    error = in_thread(lambda: selector.select(**aim))
    assert isinstance(error, conus.ArgumentError) and "thread" in str(error)


def test_what_is_dropped_elsewhere_is_left_alone(atlas):
    held = [atlas.renderer(), atlas.selector(engine="gl")]
    in_thread(lambda: (held.clear(), gc.collect()))
    assert atlas.render(size=(10, 10)).array.any()


def draw(atlas):
    return atlas.render(size=(60, 40)).array


def select_by_gl(atlas):
    return atlas.select((0, 0, 0), direction=(1, 0, 0), engine="gl").results


def test_opengl_crosses_no_fork_but_spawn(atlas):
    drawn, selected = draw(atlas), select_by_gl(atlas)
    with multiprocessing.get_context("fork").Pool(1) as pool:
        for function in (draw, select_by_gl):
            with pytest.raises(conus.GLError, match="fork"):
                pool.apply_async(function, (atlas,)).get(HANG)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert np.array_equal(pool.apply_async(draw, (atlas,)).get(HANG), drawn)
        assert same(pool.apply_async(select_by_gl, (atlas,)).get(HANG), selected)


def draw_by_rays(atlas):
    return atlas.render(size=(60, 40), engine="rays").array


def test_rays_draw_what_opengl_draws_also_behind_a_fork(atlas):
    drawn, picture = draw(atlas), atlas.render(size=(60, 40), engine="rays")
    assert picture.device == "rays"
    assert np.abs(picture.array - drawn).mean() < 2e-3 * np.abs(drawn).max()
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert np.array_equal(pool.apply_async(draw_by_rays, (atlas,)).get(HANG), picture.array)
    with pytest.raises(conus.ArgumentError, match="engine"):
        atlas.render(engine="paper")


def test_a_gl_selector_crosses_no_fork():
    """The rays engine answers in the child, and what uses OpenGL is an error there, also where it is dropped."""
    script = """
import gc, os
import numpy, conus
atlas = conus.load(numpy.ones((4, 4, 4), "u1"), numpy.eye(4))
gl, renderer = atlas.selector(engine="gl"), atlas.renderer()
aim = {"origin": (1.5, 1.5, 50), "toward": (1.5, 1.5, 1.5)}
def refused(ask):
    try:
        ask()
    except conus.GLError as error:
        return "fork" in str(error)
child = os.fork()
if not child:
    good = len(atlas.select(**aim)) == 2 and refused(lambda: gl.select(**aim)) and refused(renderer.render)
    good = good and refused(renderer.close) and refused(atlas.render) and refused(lambda: atlas.selector(engine="gl"))
    del gl, renderer
    gc.collect()
    os._exit(0 if good else 1)
assert os.waitpid(child, 0)[1] == 0
assert len(gl.select(**aim)) == 2 and renderer.render(size=(8, 8)).array.any()
"""
    subprocess.run([sys.executable, "-c", script], check=True, timeout=HANG)


def test_a_child_may_be_the_first_to_draw():
    script = """
import os
import numpy, conus
atlas = conus.load(numpy.ones((4, 4, 4), "u1"), numpy.eye(4))
child = os.fork()
picture = atlas.render(size=(8, 8))
if not child:
    os._exit(0 if picture.array.any() else 1)
assert os.waitpid(child, 0)[1] == 0
"""
    subprocess.run([sys.executable, "-c", script], check=True, timeout=HANG)

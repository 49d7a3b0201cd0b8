#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""compare_formats.py DUMP_VOLUME CONUS [SHARED_DATA]: one atlas in every format whose header is text, against the NIfTI
that it was made of.

The middle of AAL is written here with numpy, from what nibabel reads: NRRD, MetaImage and AFNI. teem's unu writes the
NRRD again in other encodings, byte orders and types; nibabel reads the AFNI files, too, and those of the shared data.
Voxels, affine (1e-6) and all rows of a query with all layers must be those of the NIfTI."""
import glob
import gzip
import os
import shutil
import subprocess
import sys
import tempfile
import zlib

try:
    import nibabel
    import numpy
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

AAL = "/usr/share/mricron/templates/aal.nii.gz"
NAMES = "/usr/share/mricron/templates/aal.nii.txt"
POSE = ["--origin=-90,20,20", "--toward=0,-10,10", "--angle", "20", "--layers", "all", "--format", "tsv", "-q"]


def numbers(values):
    return " ".join(repr(float(value)) for value in values)


def points(columns):
    return " ".join("(" + ",".join(repr(float(value)) for value in column) + ")" for column in columns)


# NRRD


def nrrd_header(voxels, affine, space, extra):
    """The header's text, and the affine in the space that it names."""
    signs = {"RAS": (1, 1, 1), "left-anterior-superior": (-1, 1, 1), "left-posterior-superior": (-1, -1, 1)}[space]
    placed = numpy.diag(signs + (1,)) @ affine
    order = "big" if voxels.dtype.byteorder == ">" else "little"
    return (f"NRRD0005\ntype: {voxels.dtype.name}\ndimension: 3\nspace: {space}\n"
            f"sizes: {' '.join(str(n) for n in voxels.shape)}\nspace directions: {points(placed[:3, :3].T)}\n"
            f"kinds: domain domain domain\nendian: {order}\nspace origin: {points([placed[:3, 3]])}\n{extra}")


def write_nrrd(folder, voxels, affine):
    raw = voxels.tobytes(order="F")
    wide = voxels.astype(">u4")
    ras = nrrd_header(voxels, affine, "RAS", "encoding: raw\n\n").encode() + raw
    las = nrrd_header(wide, affine, "left-anterior-superior", "encoding: gzip\n\n").encode()
    lps = nrrd_header(voxels, affine, "left-posterior-superior", "encoding: raw\ndata file: lps.raw\nbyte skip: -1\n")
    yield write(folder, "ras.nrrd", ras)
    yield write(folder, "las.nrrd", las + gzip.compress(wide.tobytes(order="F"), 1))
    write(folder, "lps.raw", b"something else first" + raw)
    yield write(folder, "lps.nhdr", lps.encode())
    yield from unu(folder, os.path.join(folder, "ras.nrrd"))


def unu(folder, source):
    """The same, written by another program."""
    if not shutil.which("teem-unu"):
        print("no teem-unu (teem-apps): NRRD is compared with what is written here only")
        return
    for name, convert, save in (("big.nrrd", "short", "-e raw -en big"), ("packed.nrrd", "uint", "-e gzip"),
                                ("text.nrrd", "ushort", "-e ascii"), ("hex.nrrd", "int", "-e hex"),
                                ("split.nhdr", "float", "-e gzip")):
        path = os.path.join(folder, name)
        subprocess.run(f"teem-unu convert -i {source} -t {convert} | teem-unu save -f nrrd {save} -o {path}", shell=True, check=True)
        yield path


# MetaImage


def metaimage_header(voxels, affine, kind, extra, source):
    """ITK's: LPS, directions axis by axis."""
    lps = numpy.diag((-1, -1, 1, 1)) @ affine
    spacing = numpy.linalg.norm(lps[:3, :3], axis=0)
    return (f"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = {voxels.dtype.byteorder == '>'}\n"
            f"{extra}TransformMatrix = {numbers((lps[:3, :3] / spacing).T.ravel())}\nOffset = {numbers(lps[:3, 3])}\n"
            f"CenterOfRotation = 0 0 0\nElementSpacing = {numbers(spacing)}\n"
            f"DimSize = {' '.join(str(n) for n in voxels.shape)}\nElementType = {kind}\nElementDataFile = {source}\n"
            ).encode()


def write_metaimage(folder, voxels, affine):
    raw = voxels.tobytes(order="F")
    packed = zlib.compress(raw, 1)
    wide = voxels.astype(">i2")
    sized = f"CompressedData = True\nCompressedDataSize = {len(packed)}\n"
    yield write(folder, "a.mha", metaimage_header(voxels, affine, "MET_UCHAR", "", "LOCAL") + raw)
    yield write(folder, "packed.mha", metaimage_header(voxels, affine, "MET_UCHAR", sized, "LOCAL") + packed)
    write(folder, "big.raw", wide.tobytes(order="F"))
    yield write(folder, "big.mhd", metaimage_header(wide, affine, "MET_SHORT", "", "big.raw"))


# AFNI


def attribute(kind, name, values):
    count, text = (len(values) + 1, f"'{values}~") if kind == "string" else (len(values), " " + numbers(values))
    if kind == "integer":
        text = " " + " ".join(str(int(value)) for value in values)
    return f"\ntype = {kind}-attribute\nname = {name}\ncount = {count}\n{text}\n"


def afni_header(voxels, affine, code, real):
    """DICOM order is LPS; the plumb axes are those of AAL, which grow to the right, the front and above."""
    lps = numpy.diag((-1, -1, 1, 1)) @ affine
    order = "MSB_FIRST" if voxels.dtype.byteorder == ">" else "LSB_FIRST"
    head = attribute("integer", "DATASET_RANK", (3, 1, 0)) + attribute("integer", "DATASET_DIMENSIONS", voxels.shape + (0, 0))
    head += attribute("integer", "BRICK_TYPES", (code,)) + attribute("float", "BRICK_FLOAT_FACS", (0,))
    head += attribute("string", "BYTEORDER_STRING", order) + attribute("integer", "SCENE_DATA", (2, 2, 0))
    head += attribute("integer", "ORIENT_SPECIFIC", (1, 2, 4)) + attribute("float", "ORIGIN", lps[:3, 3])
    head += attribute("float", "DELTA", (-1, -1, 1)) + attribute("string", "TYPESTRING", "3DIM_HEAD_FUNC")
    return (head + (attribute("float", "IJK_TO_DICOM_REAL", lps[:3].ravel()) if real else "")).encode()


def write_afni(folder, voxels, affine):
    plumb = bool((affine[:3, :3] == numpy.eye(3)).all())
    wide = voxels.astype(">i2")
    names = ["real+tlrc", "big+tlrc"] + ["plumb+tlrc"] * plumb
    for name in names:
        chosen, code = (wide, 1) if name.startswith("big") else (voxels, 0)
        write(folder, name + ".HEAD", afni_header(chosen, affine, code, not name.startswith("plumb")))
        raw = chosen.tobytes(order="F")
        if name.startswith("real"):
            yield write(folder, name + ".BRIK.gz", gzip.compress(raw, 1))
        else:
            write(folder, name + ".BRIK", raw)
            yield os.path.join(folder, name + ".HEAD")
        if not name.startswith("plumb"):  # whose matrix nibabel needs
            image = nibabel.load(os.path.join(folder, name + ".HEAD"))
            assert (numpy.asarray(image.dataobj).reshape(voxels.shape) == voxels).all(), name
            assert numpy.allclose(image.affine, affine, rtol=0, atol=1e-6), name


def compare_shared(program, shared, folder):
    """Data sets at hand against nibabel: values and affine."""
    faults = []
    for path in sorted(glob.glob(os.path.join(shared, "hostile", "nibabel", "*.BRIK*"))):
        outputs = [os.path.join(folder, name) for name in ("values", "labels")]
        facts = subprocess.run([program, path] + outputs, capture_output=True, text=True, check=True).stdout
        facts = dict(line.partition(" ")[::2] for line in facts.splitlines())
        image = nibabel.load(path)
        found = numpy.fromfile(outputs[0], numpy.float32)
        wanted = numpy.asarray(image.dataobj).ravel(order="F")
        placed = numpy.array([float(n) for n in facts["affine"].split()]).reshape(4, 4)
        same = found.shape == wanted.shape and numpy.allclose(found, wanted, rtol=2e-7, atol=0)
        same = same and numpy.allclose(placed, image.affine, rtol=1e-6)
        print(f"{path}: {'equal' if same else 'DIFFERENT'}")
        faults += [] if same else [path]
    return len(faults)


# The comparison


def write(folder, name, data):
    path = os.path.join(folder, name)
    with open(path, "wb") as stream:
        stream.write(data)
    return path


def dump(program, path, folder):
    """Voxels and affine."""
    outputs = [os.path.join(folder, name) for name in ("values", "labels")]
    run = subprocess.run([program, path] + outputs, capture_output=True, text=True, check=False)
    if run.returncode:
        return run.stderr.strip(), None
    facts = dict(line.partition(" ")[::2] for line in run.stdout.splitlines())
    dim = [int(n) for n in facts["dim"].split()]
    affine = numpy.array([float(n) for n in facts["affine"].split()]).reshape(4, 4)
    return numpy.fromfile(outputs[1], numpy.uint32).reshape(dim, order="F"), affine


def ask(program, path):
    run = subprocess.run([program, "query", path, "--labels", NAMES] + POSE, capture_output=True, text=True, check=False)
    return run.stdout if run.returncode == 0 else run.stderr


def compare(programs, path, folder, voxels, affine, rows):
    found, placed = dump(programs[0], path, folder)
    if placed is None:
        return [found]
    faults = [] if found.shape == voxels.shape and (found == voxels).all() else ["voxels differ"]
    if not numpy.allclose(placed, affine, rtol=0, atol=1e-6):
        faults.append(f"affine {placed.ravel()}, of the NIfTI {affine.ravel()}")
    return faults if ask(programs[1], path) == rows else faults + ["rows differ: " + ask(programs[1], path)]


def main():
    programs = sys.argv[1:3]
    if not os.path.exists(AAL):
        print("skipped: no mricron-data")
        return 77
    image = nibabel.load(AAL)
    turn = numpy.array([[0.96, -0.28, 0, 3], [0.28, 0.96, 0, -5], [0, 0, 1, 7], [0, 0, 0, 1]])
    voxels = numpy.asarray(image.dataobj)[:, 60:150, 60:120]
    cropped = image.affine @ nibabel.affines.from_matvec(numpy.eye(3), [0, 60, 60])
    bad = total = 0
    with tempfile.TemporaryDirectory() as folder:
        for affine in (cropped, turn @ cropped):
            nifti = os.path.join(folder, "aal.nii")
            nibabel.save(nibabel.Nifti1Image(voxels, affine), nifti)
            placed = nibabel.load(nifti).affine
            rows = ask(programs[1], nifti)
            assert len(rows.splitlines()) > 5, rows
            for path in (path for writer in WRITERS for path in writer(folder, voxels, placed)):
                faults = compare(programs, path, folder, voxels, placed, rows)
                total += 1
                bad += bool(faults)
                name = os.path.basename(path)
                print(*(f"DIFFERENT {name}: {fault}" for fault in faults) if faults else [f"{name}: equal"], sep="\n")
        if len(sys.argv) > 3:
            bad += compare_shared(programs[0], os.environ.get("CONUS_SHARED_DATA", sys.argv[3]), folder)
    print(f"{total} volumes, {bad} different")
    return 1 if bad else 0


WRITERS = [write_nrrd, write_metaimage, write_afni]

if __name__ == "__main__":
    sys.exit(main())

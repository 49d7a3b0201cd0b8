#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""compare_volumes.py DUMP_VOLUME SHARED_DATA: conus's volume readers against nibabel.

Every volume of mricron-data and of the shared data that is at hand, and files that nibabel writes here in every datatype,
byte order and kind of transform: same grid, same affine (1e-6), same voxels. Where not both read a file, REFUSALS says
which of the two refuses it, and why; anything else fails. Of the files above 20 kB every sixth is compared, and of
those written in every datatype every seventh, all in scripts/test --long."""
import glob
import gzip
import itertools
import os
import struct
import subprocess
import sys
import tempfile
import warnings

try:
    import nibabel
    import numpy
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

from sample import every

MRICRON = "/usr/share/mricron/templates"
TYPES = ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8")

# End of the path: the reader that refuses it (conus, nibabel, both), and words of the message.
REFUSALS = {
    # Neither reader can know where these voxels are.
    "analyze.hdr": ("both", "ANALYZE 7.5"),
    "row_major.dconn.nii": ("both", "CIFTI matrix"),
    # Halves of pairs without the other half.
    "nibabel/nifti1.hdr": ("both", "the other half of the pair is missing"),
    "nibabel/nifti2.hdr": ("both", "the other half of the pair is missing"),
    "avg152T1_LR_nifti.hdr.gz": ("both", "the other half of the pair is missing"),
    # The other half is there, but packed: nibabel wants both packed or none.
    "minimal2.hdr": ("nibabel", "No such file"),
    "minimal2.img.gz": ("nibabel", "Cannot work out file type"),
    # No real number per voxel.
    "complex32.nii": ("both", "datatype: found 32 (complex64)"),
    "complex64.nii": ("both", "datatype: found 1792 (complex128)"),
    "rgb/3D.nii": ("both", "datatype: found 128 (RGB24)"),
    "rgb/4D.nii": ("both", "datatype: found 128 (RGB24)"),
    "rgba/4D.nii": ("both", "datatype: found 2304 (RGBA32)"),
    # Not volumes at all.
    "not-nifti.nii": ("both", "content: found"),
    "crash-1.nii": ("both", "content: found"),
    "crash-ed7d46344d7efb3b9f0c374d66d2e02f66cc447d.nii": ("both", "content: found"),
    # Written here, see bent_files(). Both refuse:
    "bent-datatype.nii": ("both", "datatype: found 999"),
    "bent-zero-dim.nii": ("both", "dim[1]: found 0"),
    "bent-negative-dim.nii": ("both", "dim[2]: found -4"),
    "bent-dims.nii": ("both", "dim[0]: found 9"),
    "bent-offset-nan.nii": ("both", "vox_offset: found nan"),
    "bent-offset-100.nii": ("both", "vox_offset: found 100"),
    "bent-offset-negative.nii": ("both", "vox_offset: found -100"),
    "bent-offset-huge.nii": ("both", "vox_offset: found 1.0"),
    "bent-quaternion.nii": ("both", "quatern_b, c, d: found 1.5"),
    "bent-magic.nii": ("both", "magic: found \"abcd\""),
    "bent-esize7.nii": ("both", "found esize 7"),
    "bent-esize-16.nii": ("both", "found esize -16"),
    "bent-esize1073741824.nii": ("both", "found esize 1073741824"),
    "bent-esize0.nii": ("both", "found esize 0"),
    "bent-cut.nii": ("both", "voxels: the file has"),
    "bent-cut.nii.gz": ("both", "gzip: cut off"),
    # nibabel repairs the header or ignores the fault; a wrong guess here moves or drops areas, so conus refuses.
    "bent-bitpix.nii": ("conus", "bitpix: found 64, datatype int16 needs 16"),
    "bent-slope-inf.nii": ("conus", "scl_slope: found inf"),
    "bent-sform-nan.nii": ("conus", "the matrix is singular or not finite"),
    "bent-sform-flat.nii": ("conus", "the matrix is singular or not finite"),
    "bent-pixdim-zero.nii": ("conus", "pixdim[1]: found 0"),
    "bent-pixdim-negative.nii": ("conus", "pixdim[1]: found -2"),
    "bent-pixdim-nan.nii": ("conus", "pixdim[1]: found nan"),
    "bent-half.nii": ("conus", "the name does not end in .hdr"),
    "bent-size.nii": ("conus", "content: found"),
    # nibabel does not reach the checksum, and returns a wrong voxel.
    "bent-checksum.nii.gz": ("conus", "gzip: damaged"),
    "bent-voxel.nii.gz": ("conus", "gzip: damaged"),
    # Harmless: gzip itself unpacks these; the content, not the name, decides whether a file is packed.
    "bent-plain.nii.gz": ("nibabel", "not a gzip file"),
    "bent-packed.nii": ("nibabel", "Cannot work out file type"),
}

# End of the path: the reason for which nibabel's affine is not used for the comparison.
OTHER_AFFINE = {
    "no-ras.mgh": "FreeSurfer's default directions are transposed in nibabel",
    "tiny.mgh": "goodRASFlag is -1, which FreeSurfer takes as not set and nibabel as set: its matrix is all zeros",
}


# Files at hand


def files_at_hand(shared):
    folders = [MRICRON] + [os.path.join(shared, name) for name in ("hostile", "labelvol", "prob", "bonsai", "meshes")]
    for folder in folders:
        for path in sorted(glob.glob(folder + "/**/*", recursive=True)):
            name = path[:-3] if path.endswith(".gz") else path
            if name.endswith((".nii", ".hdr", ".img", ".mgh", ".mgz")):
                yield path


# Files written here


def random_rotation(random):
    q, r = numpy.linalg.qr(random.normal(size=(3, 3)))
    return q * numpy.sign(numpy.diag(r))


def random_affine(random, shear=0.0):
    affine = numpy.eye(4)
    affine[:3, :3] = random_rotation(random) @ numpy.diag(random.uniform(0.2, 5, 3)) + shear * random.normal(size=(3, 3))
    affine[:3, 3] = random.uniform(-200, 200, 3)
    return affine


def random_voxels(random, kind, shape):
    if kind[0] == "f":
        return (random.normal(size=shape) * 100).astype(kind)
    limits = numpy.iinfo(kind)
    high = min(limits.max, 2**32 + 2 if random.integers(2) else 2**32 - 1)
    low = max(limits.min, -3 if random.integers(2) else 0)
    return random.integers(low, high, size=shape, dtype=kind, endpoint=True)


def written_nifti(folder, random):
    """Every datatype x byte order x version x transform, with and without scaling."""
    transforms = ("sform", "qform", "both", "none")
    for number, (kind, order, version, transform) in every(7, enumerate(itertools.product(TYPES, "<>", (1, 2), transforms))):
        shape = tuple(random.integers(1, 7, 3 + number % 2))
        voxels = random_voxels(random, kind, shape)
        header = (nibabel.Nifti1Header if version == 1 else nibabel.Nifti2Header)(endianness=order)
        header.set_data_dtype(order + kind)
        header.set_data_shape(shape)
        header.set_zooms(tuple(random.uniform(0.2, 5, len(shape))))
        if transform in ("sform", "both"):
            header.set_sform(random_affine(random, 0.1), int(random.integers(1, 6)))
        if transform in ("qform", "both"):
            header.set_qform(random_affine(random), int(random.integers(1, 6)))
        header["magic"] = b"n+1" if version == 1 else b"n+2"
        header["vox_offset"] = 352 if version == 1 else 544
        header["xyzt_units"] = random.choice([0, 1, 2, 3, 10])
        if number % 3 == 0:
            header["scl_slope"], header["scl_inter"] = random.uniform(-3, 3), random.uniform(-100, 100)
        data = header.binaryblock + bytes(4) + voxels.astype(order + kind).tobytes(order="F")
        path = os.path.join(folder, f"{kind}-{'little' if order == '<' else 'big'}-{version}-{transform}.nii.gz")
        with gzip.open(path, "wb", 1) as stream:
            stream.write(data)
        yield path


def written_mgh(folder, random):
    for kind, frames in itertools.product(("u1", "i2", "i4", "f4"), (1, 3)):
        shape = tuple(random.integers(1, 7, 3)) + ((frames,) if frames > 1 else ())
        path = os.path.join(folder, f"{kind}-{frames}.mgz")
        nibabel.save(nibabel.MGHImage(random_voxels(random, kind, shape), random_affine(random)), path)
        yield path
    data = bytearray(nibabel.MGHImage(numpy.ones((3, 4, 5), "u1"), random_affine(random)).to_bytes())
    struct.pack_into(">h", data, 28, 0)
    yield write(folder, "no-ras.mgh", data)


def write(folder, name, data):
    path = os.path.join(folder, name)
    with open(path, "wb") as stream:
        stream.write(data)
    return path


def bent_files(folder):
    """A good file with one thing wrong; names are keys of REFUSALS."""
    good = nibabel.Nifti1Image(numpy.arange(60, dtype="<i2").reshape(3, 4, 5), numpy.diag([2, 2, 2, 1])).to_bytes()
    qform = bytearray(good)
    struct.pack_into("<hh", qform, 252, 1, 0)
    fields = {
        "bitpix": (good, "<h", 72, 64),
        "datatype": (good, "<h", 70, 999),
        "zero-dim": (good, "<h", 42, 0),
        "negative-dim": (good, "<h", 44, -4),
        "dims": (good, "<h", 40, 9),
        "offset-nan": (good, "<f", 108, float("nan")),
        "offset-100": (good, "<f", 108, 100.0),
        "offset-negative": (good, "<f", 108, -100.0),
        "offset-huge": (good, "<f", 108, 1e30),
        "slope-inf": (good, "<f", 112, float("inf")),
        "slope-nan": (good, "<f", 112, float("nan")),
        "sform-nan": (good, "<f", 280, float("nan")),
        "sform-flat": (good, "<f", 280, 0.0),
        "quaternion": (qform, "<f", 256, 1.5),
        "pixdim-zero": (qform, "<f", 80, 0.0),
        "pixdim-negative": (qform, "<f", 80, -2.0),
        "pixdim-nan": (qform, "<f", 80, float("nan")),
        "magic": (good, "<4s", 344, b"abcd"),
        "half": (good, "<4s", 344, b"ni1\0"),
        "size": (good, "<i", 0, 1234),
    }
    for name, (base, kind, offset, value) in fields.items():
        data = bytearray(base)
        struct.pack_into(kind, data, offset, value)
        yield write(folder, f"bent-{name}.nii", data)
    for esize in (7, -16, 1 << 30, 0):
        data = bytearray(good)
        struct.pack_into("<f", data, 108, 352.0 + 32)
        data[348] = 1
        data[352:352] = struct.pack("<ii24s", esize, 4, b"labels")
        yield write(folder, f"bent-esize{esize}.nii", data)
    yield write(folder, "bent-cut.nii", good[:-1])
    yield write(folder, "bent-plain.nii.gz", good)
    yield write(folder, "bent-packed.nii", gzip.compress(good))


def bent_packings(folder):
    """The same for gzip, big enough that nibabel does not see the end of the file when it opens it."""
    voxels = numpy.arange(40**3, dtype="<u2").reshape(40, 40, 40)
    good = nibabel.Nifti1Image(voxels, numpy.diag([2, 2, 2, 1])).to_bytes()
    packed = bytearray(gzip.compress(good, 0))  # stored, so that the voxels can be reached
    yield write(folder, "bent-cut.nii.gz", packed[:-9])
    yield write(folder, "bent-junk.nii.gz", packed + b"junk")
    yield write(folder, "bent-two-members.nii.gz", gzip.compress(good[:20000]) + gzip.compress(good[20000:]))
    packed[-6] ^= 1
    yield write(folder, "bent-checksum.nii.gz", packed)
    packed[-6] ^= 1
    packed[50000] ^= 1
    yield write(folder, "bent-voxel.nii.gz", packed)


# The comparison


def conus(program, path, folder):
    """(facts, values, labels or None), or the message."""
    outputs = [os.path.join(folder, name) for name in ("values", "labels")]
    run = subprocess.run([program, path] + outputs, capture_output=True, text=True, check=False)
    if run.returncode == 1 and len(run.stderr.splitlines()) == 1:
        return run.stderr.strip()
    if run.returncode:
        raise RuntimeError(f"{path}: dump_volume ended with {run.returncode}: {run.stderr}")
    facts = dict(line.partition(" ")[::2] for line in run.stdout.splitlines())
    dim = [int(n) for n in facts["dim"].split()]
    values = numpy.fromfile(outputs[0], numpy.float32).reshape(dim, order="F")
    labels = None
    if "unlabelled" not in facts:
        labels = numpy.fromfile(outputs[1], numpy.uint32).reshape(dim, order="F")
    return facts, values, labels


def millimetres(header):
    """What nibabel leaves out: the unit of the affine."""
    code = int(header["xyzt_units"]) & 7 if "xyzt_units" in header else 2
    return {1: 1000.0, 3: 0.001}.get(code, 1.0)


def oracle(path):
    """nibabel's voxels (i, j, k, volume) and affine, or the message."""
    try:
        image = nibabel.load(path)
        if type(image).__name__ not in ("Nifti1Image", "Nifti2Image", "Nifti1Pair", "Nifti2Pair", "MGHImage"):
            return f"read as {type(image).__name__}, which has no orientation or no grid"
        voxels = numpy.asarray(image.dataobj)
        affine = image.affine.copy()
    except Exception as error:  # nibabel raises almost anything
        return f"{type(error).__name__}: {error}"
    if voxels.dtype.kind not in "iuf" or voxels.dtype.itemsize > 8:
        return f"voxels are {voxels.dtype}"
    affine[:3] *= millimetres(image.header)
    if not voxels.size:
        return f"no voxels in {image.shape}"
    shape = tuple(image.shape) + (1,) * (3 - len(image.shape))
    return voxels.reshape(shape[:3] + (-1,), order="F"), affine


def compare(ours, voxels, affine, compare_affine):
    """Differences in words."""
    facts, values, labels = ours
    if values.shape != voxels.shape:
        return [f"grid {values.shape}, nibabel {voxels.shape}"]
    faults = []
    affine_ours = numpy.array([float(n) for n in facts["affine"].split()]).reshape(4, 4)
    same = numpy.allclose(affine_ours, affine, rtol=1e-6, atol=1e-6 * abs(affine[:3]).max())
    if same != compare_affine:
        faults.append(f"affine {facts['affine']}, nibabel {' '.join(str(number) for number in affine.ravel())}")
    finite = numpy.where(numpy.isfinite(voxels), voxels, 0)
    if not numpy.allclose(values, finite, rtol=2e-7, atol=2e-7 * abs(finite.astype(float)).max()):
        faults.append(f"values of {numpy.count_nonzero(values != finite)} voxels differ")
    are_labels = (finite == voxels).all() and (numpy.floor(finite) == finite).all()
    are_labels = bool(are_labels and finite.min() >= 0 and finite.max() < 2**32)
    if (labels is not None) != are_labels:
        faults.append(f"labels {'refused' if are_labels else 'accepted'}: {facts.get('unlabelled')}")
    elif are_labels and not (labels == voxels).all():
        faults.append("labels differ")
    return faults


def check(program, path, folder):
    """(faults, what was found in words)."""
    theirs = oracle(path)
    count = 1 if isinstance(theirs, str) else theirs[0].shape[3]
    ours = conus(program, path + (",volume=0" if count > 1 else ""), folder)
    refused = {(False, False): "none", (True, False): "conus", (False, True): "nibabel", (True, True): "both"}[
        (isinstance(ours, str), isinstance(theirs, str))]
    expected, words = next((r for end, r in REFUSALS.items() if path.endswith("/" + end)), ("none", ""))
    messages = "; ".join(m for m in (ours, theirs) if isinstance(m, str))
    if refused != expected or words not in messages:
        return [f"refused by {refused} ({messages}), expected: {expected} ({words})"], ""
    if refused != "none":
        return [], f"refused by {refused}: {messages}"
    faults = []
    compare_affine = not path.endswith(tuple("/" + end for end in OTHER_AFFINE))
    for k in sorted({0, count // 2, count - 1}):
        if k:
            ours = conus(program, f"{path},volume={k}", folder)
        faults += [ours] if isinstance(ours, str) else compare(ours, theirs[0][..., k], theirs[1], compare_affine)
    return faults, f"equal: {theirs[0].shape[:3]}, volumes {count}, {theirs[0].dtype}"


def main():
    program = sys.argv[1]
    shared = os.environ.get("CONUS_SHARED_DATA", sys.argv[2])
    warnings.simplefilter("ignore")
    numpy.seterr(all="ignore")
    nibabel.imageglobals.logger.setLevel(60)
    at_hand = list(files_at_hand(shared))
    large = [path for path in at_hand if os.path.getsize(path) > 20_000]
    at_hand = sorted(set(at_hand) - set(large)) + every(6, large)
    if not at_hand:
        print("no mricron-data and no shared data: only files written here are compared")
    bad = 0
    total = 0
    with tempfile.TemporaryDirectory() as folder:
        random = numpy.random.default_rng(1)
        written = (written_nifti(folder, random), written_mgh(folder, random), bent_files(folder),
                   bent_packings(folder))
        for path in itertools.chain(at_hand, *written):
            faults, words = check(program, path, folder)
            total += 1
            bad += bool(faults)
            print(*(f"DIFFERENT {path}: {fault}" for fault in faults) if faults else [f"{path}: {words}"], sep="\n")
    print(f"{total} volumes, {bad} different")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus query --probe of recordings against probeinterface's readers: sites chosen at random on every part number that
it knows, as SpikeGLX's .imro, as .ap.meta with and without ~snsGeomMap, of all and of some channels, and as
settings.xml of Open Ephys, whose x count from the shank's edge or from elsewhere. Places are equal, but for where x is
0: probeinterface counts it from the first column of odd rows. The tip is that of its table, below the lowest row.

usage: compare_recordings.py CONUS; exit 77 = skipped."""

import csv
import io
import json
import os
import random
import re
import subprocess
import sys
import tempfile
import warnings

try:
    import numpy as np
    import probeinterface
except ImportError:
    print("skipped: probeinterface is needed")
    sys.exit(77)

warnings.simplefilter("ignore")
TABLE = os.path.join(os.path.dirname(probeinterface.__file__), "resources", "neuropixels_probe_features.json")
PROBES = json.load(open(TABLE, encoding="utf-8"))["neuropixels_probes"]
BY_MAP = {"NP1100", "NP1110", "NP1120", "NP1121", "NP1122", "NP1123", "NP1200", "NP1210", "NP3000"}


def number(part, key):
    return float(PROBES[part][key])


def sites(part, rng):
    """(channel, bank, shank, electrode) of all channels. Where there are more than a bank has, shanks are in order."""
    each, shanks = int(number(part, "electrodes_per_shank")), int(number(part, "num_shanks"))
    count = min(int(number(part, "num_readout_channels")), each * shanks)
    for channel in range(count):
        group, low = divmod(channel, 384)
        shank = rng.randrange(shanks) if count <= 384 else group % shanks
        bank = group if count > 384 and shanks == 1 else rng.randrange((each - low + 383) // 384)
        yield channel, bank, shank, low + 384 * bank


def imro(part, chosen):
    form, shanks = PROBES[part]["imro_table_format_type"], int(number(part, "num_shanks"))
    entries = [f"({c} {b} 0 500 250 1)" if form == "imro_np1000" else
               f"({c} {s} {b} 0 {e})" if shanks > 1 else f"({c} 1 0 {e})" for c, b, s, e in chosen]
    return f"({part},{len(entries)})" + "".join(entries)


def place(part, shank, electrode):
    row, column = divmod(electrode, int(number(part, "cols_per_shank")))
    offset = number(part, f"{'odd' if row % 2 else 'even'}_row_horz_offset_left_edge_to_leftmost_electrode_center_um")
    return (shank * number(part, "shank_pitch_um") + offset + column * number(part, "electrode_pitch_horz_um"),
            row * number(part, "electrode_pitch_vert_um"))


def meta(part, chosen, some, with_map, rng):
    count = len(chosen)
    saved = sorted(rng.sample(range(count), count // 3)) if some else list(range(count))
    lines = [f"acqApLfSy={count},{count},1", f"imDatPrb_pn={part}", f"nSavedChans={len(saved) + 1}",
             f"snsApLfSy={len(saved)},0,1", "snsSaveChanSubset=" + ",".join(map(str, [*saved, 2 * count])),
             "~imroTbl=" + imro(part, chosen)]
    if with_map:
        pitch = number(part, "shank_pitch_um")
        places = [(chosen[c][2], *place(part, *chosen[c][2:])) for c in saved]
        lines.append(f"~snsGeomMap=({part},{PROBES[part]['num_shanks']},{pitch},{PROBES[part]['shank_width_um']})"
                     + "".join(f"({s}:{x - s * pitch:.10g}:{y:.10g}:1)" for s, x, y in places))
    return "\n".join(lines) + "\n"


def settings(part, chosen, shift, rng):
    rows = rng.sample(chosen, len(chosen))
    several = int(number(part, "num_shanks")) > 1
    lists = [" ".join(f'CH{c}="{b}:{s}"' if several else f'CH{c}="{b}"' for c, b, s, _ in rows)]
    lists += [" ".join(f'CH{c}="{place(part, s, e)[k] + (shift if k == 0 else 0):.10g}"' for c, _, s, e in rows)
              for k in (0, 1)]
    return ('<?xml version="1.0" encoding="UTF-8"?>\n<SETTINGS><INFO><VERSION>0.6.7</VERSION></INFO><SIGNALCHAIN>'
            '<PROCESSOR name="Neuropix-PXI" pluginName="Neuropix-PXI" libraryVersion="0.6.6" nodeId="100">'
            '<STREAM name="ProbeA" channel_count="384"/><EDITOR><NEUROPIXELS_EDITOR><BASESTATION/><CUSTOM_PROBE_NAMES/>'
            '</NEUROPIXELS_EDITOR><NP_PROBE slot="2" port="1" dock="1" probe_serial_number="1" '
            f'probe_part_number="{part}" custom_probe_name="ProbeA"><CHANNELS {lists[0]}/>'
            f'<ELECTRODE_XPOS {lists[1]}/><ELECTRODE_YPOS {lists[2]}/>'
            "</NP_PROBE></EDITOR></PROCESSOR></SIGNALCHAIN></SETTINGS>\n")


def compare(program, name, text, read):
    with open(name, "w", encoding="utf-8") as out:
        out.write(text)
    words = ["query", "sphere.nii.gz", "--probe", name, "--origin", "0,0,-17", "--direction", "0,0,1"]
    asked = subprocess.run([program, *words, "--format", "bep032"], capture_output=True, text=True, check=False)
    assert asked.returncode == 0, (name, asked.stderr)
    rows = list(csv.DictReader(io.StringIO(asked.stdout), delimiter="\t"))
    theirs = read(name)
    wired = theirs.device_channel_indices
    order = np.argsort(wired) if wired is not None else np.arange(len(rows))
    if name.endswith(".xml"):
        rows.sort(key=lambda row: int(row["name"][2:]))
    off = np.array([[float(row["x"]), float(row["y"])] for row in rows]) - theirs.contact_positions[order]
    tip = re.search(r"the tip is at x (\S+), y (\S+) um", asked.stderr)
    return off, (float(tip.group(1)), float(tip.group(2)))


def main():
    program, rng, count = os.path.abspath(sys.argv[1]), random.Random(5), 0
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        subprocess.run([program, "phantom", "sphere", "-o", "."], check=True, capture_output=True)
        for part in PROBES:
            if part == "NP1110":  # its table is of groups
                continue
            chosen = list(sites(part, rng))
            ways = [(some, mapped) for some in (0, 1) for mapped in (1, 0) if mapped or part not in BY_MAP]
            files = [("a.ap.meta", meta(part, chosen, *way, rng), probeinterface.read_spikeglx) for way in ways]
            if part not in BY_MAP:
                files.append(("a.imro", imro(part, chosen), probeinterface.read_imro))
            for shift in (0, -19) if part not in BY_MAP and len(chosen) <= 384 else ():
                files.append(("a.xml", settings(part, chosen, shift, rng), probeinterface.read_openephys))
            for name, text, read in files:
                off, tip = compare(program, name, text, read)
                odd = number(part, "odd_row_horz_offset_left_edge_to_leftmost_electrode_center_um")
                wanted = off[0] if name == "a.xml" else np.array([odd, 0])
                assert np.abs(off - wanted).max() < 1e-6 and abs(off[0, 1]) < 1e-6, (part, name, off)
                assert tip == (number(part, "shank_width_um") / 2, -number(part, "tip_length_um")), (part, name, tip)
                count += 1
    print(f"{count} recordings of {len(PROBES) - 1} part numbers: places and tips are equal")
    return 0


if __name__ == "__main__":
    sys.exit(main())

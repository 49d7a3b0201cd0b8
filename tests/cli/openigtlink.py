# SPDX-License-Identifier: BSD-3-Clause
"""Messages of OpenIGTLink, version 1, for the tests that are a tracker (PYTHONPATH="$BATS_TEST_DIRNAME")."""
import struct


def crc(data):
    value = 0
    for byte in data:
        value ^= byte << 56
        for _ in range(8):
            value = (value << 1 ^ 0x42F0E1EBA9EA3693 if value >> 63 else value << 1) & 0xFFFFFFFFFFFFFFFF
    return value


def transform(device, *place):
    """The TRANSFORM message of an upright tool at `place`, mm."""
    body = struct.pack(">12f", 1, 0, 0, 0, 1, 0, 0, 0, 1, *place)
    return struct.pack(">H12s20sIIQQ", 1, b"TRANSFORM", device, 0, 0, len(body), crc(body)) + body

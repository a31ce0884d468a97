#!/usr/bin/env python3
"""Decodes a horizon tile from its specification alone (src/horizon/FORMAT.md), with Python's standard library.

    decode.py TILE.tif                  prints the header
    decode.py TILE.tif X Y AZIMUTH      prints elevation and bound in degrees at node X, Y (from the bottom left; fractions
                                        interpolate) towards a map azimuth in degrees
    decode.py TILE.tif EXPECTED.csv     compares with x, y, azimuth_deg, elevation_rad, bound_rad; exit code 1 where they differ
"""

import csv
import json
import math
import struct
import sys
import zlib

TOLERANCE_RAD = 1e-7


def directories(data):
    """The tags of each page: numbers as tuples, text as bytes."""
    assert data[:4] == b"II*\0", "a little-endian TIFF"
    (at,) = struct.unpack_from("<I", data, 4)
    formats = {1: "B", 2: "s", 3: "H", 4: "I", 5: "II", 12: "d"}
    while at:
        tags = {}
        (count,) = struct.unpack_from("<H", data, at)
        for entry in range(at + 2, at + 2 + 12 * count, 12):
            tag, kind, number = struct.unpack_from("<HHI", data, entry)
            form = f"<{number}s" if kind == 2 else "<" + formats[kind] * number
            inline = struct.calcsize(form) <= 4
            place = entry + 8 if inline else struct.unpack_from("<I", data, entry + 8)[0]
            values = struct.unpack_from(form, data, place)
            tags[tag] = values[0] if kind == 2 else values
        yield tags
        (at,) = struct.unpack_from("<I", data, at + 2 + 12 * count)


def rows_up(data, tags):
    """The whole numbers of a page, first row at the bottom of the map."""
    assert tags[259] == (8,), "deflate"
    is_predicted = tags.get(317, (1,)) == (2,)
    width, bits = tags[256][0], tags[258][0]
    packed = b"".join(zlib.decompress(data[o : o + n]) for o, n in zip(tags[273], tags[279]))
    numbers = struct.unpack(f"<{len(packed) * 8 // bits}{ {8: 'B', 16: 'H'}[bits] }", packed)
    rows = []
    for start in range(0, len(numbers), width):
        row, value = [], 0
        for number in numbers[start : start + width]:
            value = (is_predicted * value + number) % (1 << bits)
            row.append(value)
        rows.append(row)
    return rows[::-1]


def half(number):
    """The half float that an ordered number stands for."""
    bits = number if number >= 0 else number ^ 0x7FFF
    return struct.unpack("<e", struct.pack("<H", bits & 0xFFFF))[0]


class Tile:
    def __init__(self, path):
        data = open(path, "rb").read()
        pages = list(directories(data))
        self.header = json.loads(pages[0][270].rstrip(b"\0"))
        assert self.header["format"] == "perilune horizon tile"
        assert self.header["format_version"] == 4
        pages = [(page, rows_up(data, tags)) for page, tags in zip(self.header["pages"], pages)]
        self.gains = {page["scale"]: (page["least"], rows) for page, rows in pages if page["name"] == "gain"}
        self.pages = [(page, rows) for page, rows in pages if page["name"] != "gain"]

    def value(self, page, number, row, column):
        number += page["least"]
        field = page.get("field")
        if field is None:
            return half(number)
        least, codes = self.gains.get(page["scale"], (0, None))
        gain = 2 ** (least + codes[row][column]) if codes else 1
        return field["offset_rad"] + gain * field["step_rad"] * (number + field["bias"])

    def interpolated(self, page, rows, x, y):
        """Bilinear between texel centres, the outermost reaching to the edge."""

        def around(at, count):
            at = min(max((at + 0.5) / page["scale"] - 0.5, 0), count - 1)
            low = math.floor(at)
            return [(low, 1 - (at - low)), (min(low + 1, count - 1), at - low)]

        columns = around(x, page["columns"])
        return sum(
            p * q * self.value(page, rows[row][column], row, column)
            for row, p in around(y, page["rows"])
            for column, q in columns
        )

    def weight(self, page, azimuth_rad):
        """What a page's coefficient counts for in an azimuth."""
        kind, index = page["name"].split()
        k = int(index)
        if kind in ("re", "a"):
            return math.cos(k * azimuth_rad)
        if kind == "im":
            return -math.sin(k * azimuth_rad)
        if kind == "b":
            return math.sin(k * azimuth_rad)
        assert kind == "h"
        count = sum(page["name"].startswith("h ") for page, _ in self.pages)
        distance = (azimuth_rad / math.tau * count - k) % count
        return max(0, 1 - min(distance, count - distance))

    def elevation_rad(self, x, y, azimuth_rad):
        terms = ((page, rows, self.weight(page, azimuth_rad)) for page, rows in self.pages[:-1])
        g = sum(weight * self.interpolated(page, rows, x, y) for page, rows, weight in terms if weight)
        return g + self.header.get("growth", 0) * g**3

    def bound_rad(self, x, y):
        page, rows = self.pages[-1]
        assert page["name"] == "bound"
        nodes = [(r, c) for r in (math.floor(y), math.ceil(y)) for c in (math.floor(x), math.ceil(x))]
        code = max(rows[r][c] + page["least"] for r, c in nodes)
        return None if code == 255 else 2 ** (code / 16 - 15)


def compare(tile, path):
    worst = 0
    for row in csv.DictReader(open(path)):
        x, y = float(row["x"]), float(row["y"])
        elevation = tile.elevation_rad(x, y, math.radians(float(row["azimuth_deg"])))
        bound = tile.bound_rad(x, y)
        expected = float(row["bound_rad"]) if row["bound_rad"] else None
        error = abs(elevation - float(row["elevation_rad"]))
        if not error <= TOLERANCE_RAD:
            sys.exit(f"{path}: {row} but the tile decodes to {elevation}")
        if (bound is None) != (expected is None) or (bound and abs(bound / expected - 1) > 1e-9):
            sys.exit(f"{path}: {row} but the tile's bound is {bound}")
        worst = max(worst, error)
    print(f"{path}: all within {worst:.1e} rad")


if __name__ == "__main__":
    tile, *rest = Tile(sys.argv[1]), *sys.argv[2:]
    if not rest:
        print(json.dumps(tile.header, indent=1))
    elif len(rest) == 1:
        compare(tile, rest[0])
    else:
        x, y, azimuth = map(float, rest)
        bound = tile.bound_rad(x, y)
        print(math.degrees(tile.elevation_rad(x, y, math.radians(azimuth))), bound and math.degrees(bound))

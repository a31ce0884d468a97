"""A dataset of `sim run` in Python, and as a PyTorch `Dataset`: copy the class. python dataset.py DIRECTORY [PART]"""

import json
import sys
from pathlib import Path

import numpy
import OpenEXR


class Perilune:
    """Images of a part ("train", "validation", "test"; None: all). `torch.utils.data.DataLoader` takes it as it is."""

    def __init__(self, folder, part=None, planes=("RADIANCE", "DEPTH")):
        self.folder, self.planes = Path(folder), planes
        exposures = json.loads((self.folder / "manifest.json").read_text())["exposures"]
        self.indices = [exposure["index"] for exposure in exposures if part in (None, exposure.get("split"))]

    def __len__(self):
        return len(self.indices)

    def __getitem__(self, item):
        stem = f"exposure_{self.indices[item]:04}"
        record = json.loads((self.folder / f"{stem}.json").read_text())
        with OpenEXR.File(str(self.folder / f"{stem}.exr"), separate_channels=True) as file:
            channels = file.channels()
            values = numpy.stack([channels[name].pixels for name in self.planes])
        w, x, y, z = record["pose"]["q_wxyz"]  # turns body-fixed components into camera components
        rotation = numpy.array([
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ])
        position = numpy.array(record["pose"]["r_body_fixed_m"])
        return {
            "planes": numpy.nan_to_num(values),  # (planes, rows, columns) float32
            "valid": numpy.isfinite(values),  # a pixel without a value is NaN
            "K": numpy.array(record["camera"]["K"]),
            "camera_from_body": numpy.column_stack([rotation, -rotation @ position]),  # 3 x 4, metres
        }


def latitude_error_deg(sample):
    """Largest difference between LATITUDE and that of the point at DEPTH along each pixel's ray, on a sphere."""
    (depth, latitude), valid = sample["planes"], sample["valid"].all(axis=0)
    rows, columns = numpy.nonzero(valid)
    pixels = numpy.stack([columns, rows, numpy.ones_like(rows)])
    in_camera = numpy.linalg.inv(sample["K"]) @ pixels * depth[rows, columns]
    rotation, offset = sample["camera_from_body"][:, :3], sample["camera_from_body"][:, 3:]
    x, y, z = rotation.T @ (in_camera - offset)
    return float(abs(numpy.degrees(numpy.arctan2(z, numpy.hypot(x, y))) - latitude[rows, columns]).max())


if __name__ == "__main__":
    images = Perilune(sys.argv[1], *sys.argv[2:3], planes=("DEPTH", "LATITUDE"))
    told = {"images": len(images), "shape": list(images[0]["planes"].shape), "latitude_error_deg": latitude_error_deg(images[0])}
    try:
        from torch.utils.data import DataLoader
    except ImportError:
        DataLoader = None
    if DataLoader:
        told["batch"] = list(next(iter(DataLoader(images, batch_size=2)))["planes"].shape)
    print(json.dumps(told))

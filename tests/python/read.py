"""Reads one value of a dataset with somebody else's reader and prints it: python read.py FORMAT DIRECTORY.

The values are printed as JSON; tests/readers holds them against what was rendered.
"""

import json
import sys
from pathlib import Path

ROW, COLUMN = 20, 41


def exr(folder):
    import OpenEXR

    with OpenEXR.File(str(folder / "exposure_0001.exr"), separate_channels=True) as file:
        header, channels = file.header(), file.channels()
        return {
            "depth_m": float(channels["DEPTH"].pixels[ROW, COLUMN]),
            "channels": sorted(channels),
            "frame_id": json.loads(header["perilune"])["facts"]["frame_id"],
        }


def png(folder):
    import rasterio

    with rasterio.open(folder / "exposure_0001.linear.png") as file:
        return {"dtype": file.dtypes[0], "dn": int(file.read(1)[ROW, COLUMN])}


def fits(folder):
    from astropy.io import fits
    from astropy.time import Time
    from astropy.units import Unit

    with fits.open(folder / "exposure_0001.fits") as file:
        file.verify("exception")
        primary, depth = file[0].header, file["DEPTH"]
        return {
            "depth_m": float(depth.data[ROW, COLUMN]),
            "unit": depth.header["BUNIT"],
            "radiance_unit": Unit(file["RADIANCE"].header["BUNIT"]).to_string(),
            "mjd_utc": Time(primary["DATE-OBS"], format="isot", scale="utc").mjd,
            "exposure_s": primary["EXPTIME"],
            "run_key": primary["RUNKEY"],
            "kernels": [primary[key] for key in primary if key.startswith("KERNEL")],
        }


def npz(folder):
    import numpy

    with numpy.load(folder / "exposure_0001.npz") as file:
        return {
            "depth_m": float(file["DEPTH"][ROW, COLUMN]),
            "dtype": str(file["DEPTH"].dtype),
            "k": file["K"].tolist(),
            "q_wxyz": file["q_wxyz"].tolist(),
            "r_body_fixed_m": file["r_body_fixed_m"].tolist(),
            "tdb_s": float(file["tdb_s_past_j2000"]),
        }


def geotiff(folder):
    """Value and place, by GDAL, of the cell below the camera of exposure 1, which looks straight down."""
    import rasterio
    from rasterio.crs import CRS
    from rasterio.warp import transform

    pose = json.loads((folder / "exposure_0001.json").read_text())["pose"]
    with rasterio.open(folder / "exposure_0001.ortho.tif") as file:
        sphere = CRS.from_proj4("+proj=longlat +R=1737400 +no_defs")
        (x,), (y,) = transform(sphere, file.crs, [pose["longitude_east_deg"]], [pose["latitude_deg"]])
        row, column = file.index(x, y)
        bands = dict(zip(file.descriptions, range(1, file.count + 1)))
        value = lambda name: float(file.read(bands[name])[row, column])
        return {"latitude_deg": value("LATITUDE"), "depth_m": value("DEPTH"), "cell_m": file.res[0], "bands": sorted(bands)}


def poses(folder):
    import numpy

    return {
        "kitti": numpy.loadtxt(folder / "sequence_0000.kitti.txt").reshape(-1, 3, 4).tolist(),
        "tum": numpy.loadtxt(folder / "sequence_0000.tum.txt").tolist(),
        "times_s": numpy.loadtxt(folder / "sequence_0000.times.txt").tolist(),
    }


def oem(folder):
    from oem import OrbitEphemerisMessage

    message = OrbitEphemerisMessage.open(folder / "sequence_0000.oem")
    state = message.states[1]
    return {
        "center": message.segments[0].metadata["CENTER_NAME"],
        "scale": message.segments[0].metadata["TIME_SYSTEM"],
        "tdb_s": (state.epoch.tdb.jd1 - 2451545.0 + state.epoch.tdb.jd2) * 86400.0,
        "position_km": state.position.tolist(),
        "velocity_km_s": state.velocity.tolist(),
    }


def aem(folder):
    from ccsds_ndm.ndm_io import NdmIo

    segment = NdmIo().from_path(folder / "sequence_0000.aem").body.segment[0]
    state = segment.data.attitude_state[1].quaternion_state
    q = state.quaternion
    return {
        "from": segment.metadata.ref_frame_a,
        "to": segment.metadata.ref_frame_b,
        "direction": segment.metadata.attitude_dir.value,
        "epoch": state.epoch,
        "q_wxyz": [q.qc, q.q1, q.q2, q.q3],
    }


def coco(folder):
    """Masks, boxes and ellipses of all craters by pycocotools, which knows nothing of ellipses."""
    import contextlib
    import io

    import numpy
    from pycocotools import mask
    from pycocotools.coco import COCO

    with contextlib.redirect_stdout(io.StringIO()):
        file = COCO(str(folder / "annotations.coco.json"))
    craters = []
    for annotation in file.loadAnns(file.getAnnIds()):
        inside = file.annToMask(annotation)
        rows, columns = numpy.nonzero(inside)
        craters.append({
            "image": file.loadImgs(annotation["image_id"])[0]["file_name"],
            "area": int(mask.area(file.annToRLE(annotation))),
            "stated_area": annotation["area"],
            "box": mask.toBbox(file.annToRLE(annotation)).tolist(),
            "centroid": [float(columns.mean()), float(rows.mean())],
            **{key: annotation[key] for key in ("bbox", "ellipse", "truncated")},
        })
    return craters


if __name__ == "__main__":
    print(json.dumps(globals()[sys.argv[1]](Path(sys.argv[2]))))

"""Write data/asperity-gaps.csv and data/gap-map.csv: the measured interface of the beam, for the two studies.

The measurement is not part of this repository. It is brb_surface_data.mat of github tmd-lab/tmdsimpy
(examples/structures/data, MIT), published with Porter and Brake 2023, doi:10.1016/j.ymssp.2023.110210. This script
looks for it in FAYING_DATA/brake-reuss-beam, or where the first argument says.
"""

import os
import sys
from pathlib import Path

import numpy as np
from scipy.io import loadmat

HERE = Path(__file__).parent
USUAL = HERE.parent.parent.parent / "shared" / "data"
NAME = "brb_surface_data.mat"


def source(arguments: list[str]) -> Path:
    """Return the file of the measurement, or end with a sentence that says where to get it."""
    folder = Path(os.environ.get("FAYING_DATA", USUAL)) / "brake-reuss-beam"
    path = Path(arguments[0]) if arguments else folder / NAME
    if not path.is_file():
        sys.exit(
            f"no file {path}: get {NAME} from https://github.com/tmd-lab/tmdsimpy (examples/structures/data), then "
            f"run: python {Path(__file__).name} PATH/{NAME}"
        )
    return path


def write(path: Path, folder: Path) -> None:
    """Write both tables."""
    data = loadmat(path)
    folder.mkdir(exist_ok=True)
    gaps = data["normzinterp"].ravel() * float(data["z_max"].item())
    table = np.column_stack([gaps * 1e6, data["pzinterp"].ravel()])
    head = f"asperity radius {data['Re'].item():.6g} m, density {data['area_density'].item():.7g} 1/m2\n"
    np.savetxt(
        folder / "asperity-gaps.csv", table, fmt="%.6f", delimiter=",", header=head + "gap [um],probability density"
    )
    places = data["mesoscale_xygap"] * [1e3, 1e3, 1e6]
    np.savetxt(folder / "gap-map.csv", places, fmt="%.5f", delimiter=",", header="x [mm],y [mm],gap [um]")


if __name__ == "__main__":
    write(source(sys.argv[1:]), HERE / "data")

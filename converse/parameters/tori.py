"""Tori that are proved at points of a plane: the frontier of its map from the other side.

A certificate proves a torus at its own amplitudes (a, b, c), and nothing at smaller amplitudes.
"""

import os
from fractions import Fraction
from typing import Dict, List, Tuple

from ..model.map import THESIS
from ..storage.files import ConverseError, Path

ENDING = ".torus"                       # of the name of a certificate

Point = Tuple[Fraction, Fraction, Fraction]


def proved_points(directory: Path) -> List[Tuple[Point, str]]:
    """The (a, b, c) of the certificates in a directory, and the rotation vectors' names.

    The certificates are read and not checked: converse-check checks them.  ConverseError: the
    directory or a certificate cannot be read, or has other waves, or a range."""
    from ..tori.certificate import read

    try:
        names = sorted(name for name in os.listdir(directory) if name.endswith(ENDING))
    except OSError as error:
        raise ConverseError("%s: cannot be read (%s); name the directory of --tori"
                            % (os.fspath(directory), error.strerror)) from None
    points = []
    for name in names:
        path = os.path.join(directory, name)
        certificate = read(path)
        torus = certificate.tori[0]
        amplitude: Dict[tuple, Fraction] = dict(zip(torus.potential.waves,
                                                    torus.potential.amplitude))
        if torus.part is not None or not set(amplitude) <= {(*k, Fraction(0)) for k in THESIS}:
            raise ConverseError("%s: is not a torus at one (a, b, c); remove it" % path)
        a, b, c = (amplitude.get((*k, Fraction(0)), Fraction(0)) for k in THESIS)
        points.append(((a, b, c), torus.rotation.name))
    return points

"""Design and simulation of dielectric elastomer actuators.

    import dea

    design = dea.Design("my.yaml")
    design["film.thickness"] = "80 um"
    result = dea.run(design, models="3d", studies="sweep")
    result["3d/sweep/centre_z_m"]          # a numpy array with .unit
    result.figure("displacement").save("displacement.svg")

Solid is the 3D engine with a mesh of one's own.

Numbers are SI and say so in their names; texts have any unit. Errors are exceptions: see DeaError.
Docs: docs/python.md.
"""

from ._api import (
    ArgumentError,
    DeaError,
    DesignError,
    FileError,
    Finding,
    SolverError,
    UnsupportedError,
    version,
)
from ._design import Design, Model, Study, Value, models, studies
from ._recording import write_recording
from ._result import Actuator, Array, Field, Mesh, Result, Svg, load, run
from ._solid import Body, Fill, Law, Part, Setting, Solid, laws

__version__ = version()
__all__ = [
    "Actuator", "ArgumentError", "Array", "Body", "DeaError", "Design", "DesignError", "Field",
    "FileError", "Fill", "Finding", "Law", "Mesh", "Model", "Part", "Result", "Setting", "Solid",
    "SolverError", "Study", "Svg", "UnsupportedError", "Value", "laws", "load", "models", "run",
    "studies", "version", "write_recording",
]

"""Client of a Meshwright service: transmission error and mesh stiffness of gear pairs with holes."""

from .client import AsyncClient, Client
from .contact_pattern import ContactPattern
from .force_table import ForceTable
from .look_up import LookUpTable
from .problem import FieldError, ProblemError
from .results import Curve, Results
from .study import PopulationTable, StudyTable

__all__ = ["AsyncClient", "Client", "ContactPattern", "Curve", "FieldError", "ForceTable", "LookUpTable", "PopulationTable", "ProblemError", "Results", "StudyTable"]

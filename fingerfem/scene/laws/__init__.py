"""Laws of the rubber, a file each: constants, moduli, energy. `registered` makes scenes accept a law."""

from fingerfem.scene.laws.formula import NUMPY, Invariants, Maths
from fingerfem.scene.laws.law import NEARLY_INCOMPRESSIBLE, REGISTERED, Law, NamedLaw, registered
from fingerfem.scene.laws.mooney_rivlin import MooneyRivlin
from fingerfem.scene.laws.neo_hookean import STEEL, NeoHookean, neo_hookean_from, plate_law
from fingerfem.scene.laws.ogden import Ogden
from fingerfem.scene.laws.saint_venant_kirchhoff import SaintVenantKirchhoff
from fingerfem.scene.laws.yeoh import Yeoh

__all__ = [
    "NEARLY_INCOMPRESSIBLE",
    "NUMPY",
    "REGISTERED",
    "STEEL",
    "Invariants",
    "Law",
    "Maths",
    "MooneyRivlin",
    "NamedLaw",
    "NeoHookean",
    "Ogden",
    "SaintVenantKirchhoff",
    "Yeoh",
    "neo_hookean_from",
    "plate_law",
    "registered",
]

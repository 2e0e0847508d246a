"""Constants by Young's modulus and Poisson's ratio, or by Shore's hardness A, which estimates the modulus."""

import warnings
from collections.abc import Callable
from typing import Any

SHORE_A = (20.0, 80.0)  # usual range of the estimate
YOUNG, MOST_POISSON = (1e3, 1e11), 0.49999  # [Pa], [-]
RUBBER = 0.499  # Poisson's ratio of a rubber that is given by its hardness alone [-]
# Young's modulus in tension of seven silicones of 20 to 44 Shore A over the estimate [-]: laws fitted by fit-material
# to the Soft Robotics Materials Database (Marechal et al., Soft Robotics 8, 2021, doi:10.1089/soro.2019.0115) up to a
# stretch of 2. Its strains are those of the machine's head, which makes them somewhat too soft.
MEASURED = (0.30, 0.51)


def modulus_of_shore_a(hardness: float) -> float:
    """Young's modulus of a hardness Shore A [Pa].

    E = 0.0981 (56 + 7.62336 S) / (0.137505 (254 - 2.54 S)) MPa: Gent, Rubber Chem. Technol. 31, 1958,
    doi:10.5254/1.3542351, from the indentation of an elastic half-space.

    Raises:
        ValueError: outside SHORE_A.
    """
    low, high = SHORE_A
    if not low <= hardness <= high:
        raise ValueError(f"shore_A must be from {low:g} to {high:g}, got {hardness}; measure E, or fit-material")
    return 0.0981e6 * (56 + 7.62336 * hardness) / (0.137505 * (254 - 2.54 * hardness))


def with_modulus(table: dict[str, Any], constants: Callable[[float, float, dict[str, Any]], dict[str, Any]]) -> Any:
    """A law's table with the constants that E and nu, or shore_A, stand for; unchanged if it gives neither.

    Raises:
        ValueError: both, one without the other, or constants beside them.
    """
    names = [name for name in ("E", "shore_A") if name in table]
    if not names:
        return table
    rest = {key: value for key, value in table.items() if key not in ("E", "shore_A", "nu")}
    if len(names) > 1:
        raise ValueError(f"E must be left out beside shore_A, got {table['E']}")
    if any(type(table.get(name, 0.0)) not in (int, float) for name in (*names, "nu")):
        raise ValueError(f"{names[0]} and nu must be numbers, got {table[names[0]]!r} and {table.get('nu')!r}")
    if names == ["E"]:
        young, nu = table["E"], table.get("nu")
        if nu is None:
            raise ValueError(f"nu must be given beside E, got E = {young}")
    else:
        young, nu = modulus_of_shore_a(table["shore_A"]), table.get("nu", RUBBER)
        low, high = MEASURED
        warnings.warn(
            f"material.shore_A = {table['shore_A']:g} gives E = {young / 1e6:.3g} MPa; tension tests of silicones gave "
            f"{low:g} to {high:g} of such estimates: python3 -m fingerfem fit-material fits a law to a test",
            stacklevel=2,
        )
    if not YOUNG[0] <= young <= YOUNG[1]:
        low, high = YOUNG
        raise ValueError(f"E must be from {low:g} to {high:g} Pa, got {young:g}")
    if not 0 <= nu <= MOST_POISSON:
        raise ValueError(f"nu must be from 0 to {MOST_POISSON}, such as {RUBBER} of most rubbers, got {nu:g}")
    moduli = constants(young / (2 + 2 * nu), young / (3 - 6 * nu), rest)
    if double := moduli.keys() & rest.keys():
        raise ValueError(f"{min(double)} must be left out beside {names[0]}, got {rest[min(double)]}")
    return rest | moduli

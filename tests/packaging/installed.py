"""Test of an installed environment: every module, every command's help, a model, a controller and a simulation.

python3 installed.py, outside the checkout. Prints the modules that were imported, as JSON.
"""

import json
import subprocess
import sys
import tempfile
from importlib import import_module
from pathlib import Path

from rom.console.packages import explained

PROGRAMS = ("fingerfem", "rom", "control")


def imported() -> dict[str, str]:
    """By module, nothing or which package is missing that it needs."""
    found = {}
    for program in PROGRAMS:
        for name in modules_of(Path(import_module(program).__file__).parent):
            try:
                import_module(name)
                found[name] = ""
            except ImportError as error:
                reason = explained(error)
                assert reason is not None, f"{name}: {error}"
                found[name] = reason.split()[0]
    return found


def modules_of(program: Path) -> list[str]:
    """Modules of a program by their files: of a package that cannot be imported, too."""
    found = []
    for file in sorted(program.rglob("*.py")):
        parts = file.relative_to(program.parent).with_suffix("").parts
        folders = [program.parent.joinpath(*parts[:k]) for k in range(1, len(parts))]
        name = ".".join(parts).removesuffix(".__init__")
        if name != program.name and all((folder / "__init__.py").exists() for folder in folders):
            found.append(name)
    return found


def helped() -> None:
    """Ask every command for its help."""
    import typer

    for program in PROGRAMS:
        commands = typer.main.get_command(import_module(f"{program}.__main__").app).commands
        for words in ([], *([name] for name in commands)):
            line = [sys.executable, "-m", program, *words, "--help"]
            done = subprocess.run(line, capture_output=True, text=True)
            assert done.returncode == 0 and "Usage:" in done.stdout and done.stderr == "", done.stderr


def worked() -> None:
    """The bundled finger is saved and read, a force is held."""
    import rom
    from control import Finger

    with tempfile.TemporaryDirectory() as folder:
        finger = rom.load()
        finger.rod.save(Path(folder) / "copy.h5")
        force = rom.load(Path(folder) / "copy.h5").evaluate([60.0, 20.0, 0.012]).contact_force
        assert force == finger.evaluate([60.0, 20.0, 0.012]).contact_force > 0
    assert Finger(finger).hold(1.0, 0.010).converged


def simulated() -> None:
    """A step in both environments."""
    import gymnasium

    import control.mujoco.environment  # registers the second one
    import rom
    from control.environment import HoldEnvironment

    for environment in (HoldEnvironment(rom.load()), gymnasium.make(control.mujoco.environment.NAME)):
        environment.reset(seed=1)
        observation, reward, *_ = environment.step(environment.action_space.sample())
        assert environment.observation_space.contains(observation) and -1 <= reward <= 1


if __name__ == "__main__":
    modules = imported()
    helped()
    worked()
    if "simulated" in sys.argv[1:]:
        simulated()
    print(json.dumps(modules))

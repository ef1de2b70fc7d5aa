"""Importing every submodule hides no public name behind a folder or a file of the same name."""

import subprocess
import sys

SCRIPT = """
import importlib, inspect, pkgutil
import seatrial

names = getattr(seatrial, "__all__", ())
before = {name: getattr(seatrial, name) for name in names}
for module in pkgutil.walk_packages(seatrial.__path__, "seatrial."):
    importlib.import_module(module.name)
for name in names:
    assert getattr(seatrial, name) is before[name], f"seatrial.{name} is hidden by a module of that name"
    if not inspect.ismodule(before[name]):
        assert callable(before[name]), f"seatrial.{name} is neither a function, a class nor a subpackage"
print(len(names))
"""


def test_no_submodule_hides_a_public_name() -> None:
    done = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    assert int(done.stdout) == 0 or int(done.stdout) >= 40, "the public names of seatrial"

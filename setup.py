"""What pyproject.toml cannot say: CMake builds the modules, and knows the version. FRONTLUX_BUILD_PLANNER=ON in the
environment asks for frontlux.planner, too."""
import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

SOURCE = pathlib.Path(__file__).resolve().parent
PLANNER = os.environ.get("FRONTLUX_BUILD_PLANNER", "OFF").upper() in ("ON", "1", "YES", "TRUE")
PACKAGES = {"frontlux": "engine/python/frontlux"} | ({"frontlux.planner": "planner/python/planner"} if PLANNER else {})


class CMakeBuild(build_ext):
    """One build by CMake for all extensions, which leaves them where the first one belongs."""

    def run(self):
        package = pathlib.Path(self.get_ext_fullpath(self.extensions[0].name)).resolve().parent
        build = pathlib.Path(self.build_temp).resolve()
        for left in [package / "planner", *package.glob("libfrontlux_*")] if not PLANNER else []:
            shutil.rmtree(left) if left.is_dir() else left.unlink(missing_ok=True)  # by a build with the planner
        options = {"CMAKE_BUILD_TYPE": "Release", "FRONTLUX_BUILD_PYTHON": "ON",
                   "FRONTLUX_BUILD_PLANNER": "ON" if PLANNER else "OFF", "FRONTLUX_BUILD_COMMAND": "OFF",
                   "FRONTLUX_BUILD_TESTS": "OFF", "FRONTLUX_BUILD_BENCH": "OFF", "FRONTLUX_INSTALL": "OFF",
                   "FRONTLUX_PYTHON_OUTPUT": package, "Python3_EXECUTABLE": sys.executable}
        try:
            import pybind11  # pip's own, where CMake does not look
            options["pybind11_DIR"] = pybind11.get_cmake_dir()
        except ImportError:
            pass  # the system's
        new = not (build / "CMakeCache.txt").exists()  # what is configured keeps its generator
        ninja = ["-G", "Ninja"] if new and "CMAKE_GENERATOR" not in os.environ and shutil.which("ninja") else []
        subprocess.run(["cmake", "-S", SOURCE, "-B", build, *ninja,
                        *(f"-D{key}={value}" for key, value in options.items())], check=True)
        targets = ["frontlux_python"] + (["frontlux_python_planner"] if PLANNER else [])
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL") or str(os.cpu_count())  # make alone starts all at once
        subprocess.run(["cmake", "--build", build, "--config", "Release", "--parallel", jobs, "--target", *targets], check=True)


version = re.search(r"project\(frontlux VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text())[1]
setup(version=version, packages=list(PACKAGES), package_dir=PACKAGES, cmdclass={"build_ext": CMakeBuild},
      package_data={"frontlux": ["*.pyi", "py.typed"], "frontlux.planner": ["*.pyi"]},
      ext_modules=[Extension(f"{name}._{path}", []) for name, path in
                   zip(PACKAGES, ("engine", "planner"))])

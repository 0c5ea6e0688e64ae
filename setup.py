"""What pyproject.toml cannot say: CMake builds the module, and knows the version."""
import pathlib
import re
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

SOURCE = pathlib.Path(__file__).resolve().parent


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        module = pathlib.Path(self.get_ext_fullpath(extension.name)).resolve()
        build = pathlib.Path(self.build_temp).resolve()
        options = {"CMAKE_BUILD_TYPE": "Release", "FRONTLUX_BUILD_PYTHON": "ON", "FRONTLUX_BUILD_PLANNER": "OFF",
                   "FRONTLUX_BUILD_TESTS": "OFF", "FRONTLUX_BUILD_BENCH": "OFF", "FRONTLUX_INSTALL": "OFF",
                   "FRONTLUX_PYTHON_OUTPUT": module.parent, "Python3_EXECUTABLE": sys.executable}
        subprocess.run(["cmake", "-S", SOURCE, "-B", build, *(f"-D{key}={value}" for key, value in options.items())],
                       check=True)
        subprocess.run(["cmake", "--build", build, "--target", "frontlux_python", "--parallel"], check=True)


version = re.search(r"project\(frontlux VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text())[1]
setup(version=version, ext_modules=[Extension("frontlux._engine", [])], cmdclass={"build_ext": CMakeBuild})

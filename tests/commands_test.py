#!/usr/bin/env python3
"""The commands in README.md and docs/ work: commands_test.py SOURCE_FOLDER FRONTLUX WORK_FOLDER runs those of
`frontlux` as they stand there, page by page, in a folder that holds what they name; but explorations end after a few
steps, and in the place of another page's.
Of ./dev it checks that there is such a command and option; of all others that a test is named here that does the same.
Then it looks for options in running text that `frontlux` does not have."""
import pathlib
import re
import shutil
import struct
import subprocess
import sys

PAGES = ["README.md", "SECURITY.md", "data/README.md", "docs/*.md", "docs/examples/ros2/README.md"]
COMMAND = re.compile(r"(build/release/bin/)?frontlux (?!recording)|\./dev |(build/release/)?bin/\w+ |bench/\w+\.py |python3 |venv/bin/|cmake |c\+\+ |apt-get "
                     r"|FRONTLUX_\w+=|dask-|ssh |sbatch |source |man |cp |cd |ros2 |git ")
# What runs the others: a test of these, or, where there is none, why not.
ELSEWHERE = {
    r"cmake --(preset|install)|c\+\+ -std": "consumer.install",
    r"bench_scaling|bench/plot_scaling.py": "bench.scaling_smoke",
    "bench_tours": "bench.tours_smoke",
    r"bench_rays --help|bench_planner --help|bench_view_error|bench/plot_view_error.py|make_maps": "benchmarks are run by hand",
    r"dask-|ssh HOST|sbatch": "bench.reproduce_cluster",
    r"venv|pip install|apt-get|git clone": "installs packages: tests/package and the continuous integration do",
    r"^cp -r docs/examples/ros2|colcon|ros2 run": "needs ROS: examples.Explorer tests what the node calls",
}


def commands_of(page):
    """The indented lines that are commands, without the comments behind them."""
    for number, line in enumerate(page.read_text(encoding="utf-8").split("\n"), 1):
        if line.startswith("    ") and COMMAND.match(line.strip()):
            yield number, re.sub(r"\s+# .*", "", line.strip())


def write_graph(file):
    """A scan graph of one scan of a wall."""
    points = [(2.0, 0.1 * i, 0.1 * j) for i in range(-10, 11) for j in range(-5, 6)]
    pose = struct.pack("<I3dI4d", 3, 0, 0, 0, 4, 1, 0, 0, 0)
    cloud = struct.pack("<I", len(points)) + b"".join(struct.pack("<I3d", 3, *point) for point in points)
    file.write_bytes(struct.pack("<I", 1) + cloud + pose + struct.pack("<2I", 0, 0))


class Test:
    def __init__(self, root, frontlux, work):
        self.root, self.frontlux, self.work, self.complaints = root, frontlux, work, []
        self.dev = subprocess.run([root / "dev", "help"], capture_output=True, text=True, check=True).stdout
        self.help = {}

    def run(self, command):
        shell = f'frontlux() {{ "{self.frontlux}" "$@"; }}\nset -o pipefail\n{command}'
        return subprocess.run(["bash", "-c", shell], cwd=self.work, capture_output=True, text=True, stdin=subprocess.DEVNULL)

    def prepare(self):
        shutil.rmtree(self.work, ignore_errors=True)
        self.work.mkdir(parents=True)
        for folder in ("data", "docs"):
            (self.work / folder).symlink_to(self.root / folder)
        write_graph(self.work / "recording.graph")
        (self.work / "poses.csv").write_text("x,y,z,yaw\n2,2,1,0\n2.5,2,1,0.5\n")
        for line in ["frontlux world room -o house.ply", "frontlux scan room --sweep 8 -o hall.bt",
                     *[f"mkdir -p runs && frontlux explore room --lockstep --max-steps 2 --quiet -o {folder}" for folder in ("runs/team", "runs/uav_alone")]]:
            done = self.run(line)
            if done.returncode:
                sys.exit(f"{line}: {done.stderr}")

    def options_of(self, command):
        if command not in self.help:
            self.help[command] = self.run(f"frontlux {command} --help-all").stdout
        return self.help[command]

    def check_options(self, where, words):
        """That a command of frontlux has the options that are named."""
        command = words[1] if len(words) > 1 and not words[1].startswith("-") else ""
        text = self.options_of("" if command == "help" else command)
        if "Usage:" not in text:
            self.complaints.append(f"{where}: there is no command {command}")
        for option in re.findall(r"(?<![\w-])--?[a-zA-Z][\w-]*", " ".join(words)):
            if option not in ("--help", "-o", "-V") and not re.search(rf"(?<![\w-]){option}(?![\w-])", text):
                self.complaints.append(f"{where}: frontlux {command} has no {option}")

    def try_frontlux(self, where, command):
        command = command.replace("build/release/bin/frontlux", "frontlux")
        command = re.sub(" --gif| --video", "", command)  # ReportCommandTest makes films
        if re.search(r"[A-Z]+\.\.\.|<\w+>|\[-", command):
            return self.check_options(where, command.split())
        if " explore " in command and "--help" not in command:
            command, given = re.subn(r"--max-steps \d+", "--max-steps 6", command)
            limits = [] if given else ["--max-steps 3"]
            limits += [] if "--resume" in command else ["--force"]
            command = command.replace(" explore ", f" explore {' '.join(limits)} ", 1)
        if " scan " in command and "--help" not in command and "--poses" not in command:  # from fewer places
            command, given = re.subn(r"--sweep [0-9.]+ ", "--sweep 8 ", command)
            command = command if given else command.replace(" scan ", " scan --sweep 8 ", 1)
        done = self.run(command)
        badly = "sys.exit(bool" in command and done.returncode == 1  # a warning: this machine was too slow for its latency
        if done.returncode and not badly:
            self.complaints.append(f"{where}: {command}\n{done.stderr}")
        return None

    def try_dev(self, where, command):
        words = command.split()
        if not re.search(rf"^  {words[1]}\b", self.dev, re.MULTILINE):
            self.complaints.append(f"{where}: ./dev help does not name {words[1]}")
        self.complaints += [f"{where}: ./dev help does not name {word}" for word in words if word.startswith("--") and word not in self.dev]

    def try_line(self, where, command):
        if command.startswith(("frontlux ", "build/release/bin/frontlux ")):
            return self.try_frontlux(where, command)
        if command.startswith("./dev "):
            return self.try_dev(where, command)
        if command.startswith("man ") and not shutil.which("man"):
            return None
        if not any(re.search(pattern, command) for pattern in ELSEWHERE):
            done = self.run(command)
            if done.returncode:
                self.complaints.append(f"{where}: {command}\n{done.stderr}")
        return None

    def check_text(self, page):
        """Commands of frontlux and ./dev in running text."""
        for quote in re.findall(r"`([^`\n]+)`", page.read_text(encoding="utf-8")):
            words = quote.split()
            if words[:1] == ["frontlux"] and words[1:2] and re.fullmatch(r"[a-z]+|-.*", words[1]):
                self.check_options(f"{page.name}: `{quote}`", words)
            elif words[:1] == ["./dev"] and words[1:]:
                self.try_dev(f"{page.name}: `{quote}`", quote)


def main():
    root, frontlux, work = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
    test, count = Test(root, frontlux, work), 0
    tests = "".join(file.read_text(encoding="utf-8") for file in root.glob("tests/**/CMakeLists.txt"))
    test.complaints += [f"there is no test {name}" for name in ELSEWHERE.values() if re.fullmatch(r"[a-z]+\.\w+", name) and name not in tests]
    test.prepare()
    for page in [file for pattern in PAGES for file in sorted(root.glob(pattern))]:
        for number, command in commands_of(page):
            count += 1
            test.try_line(f"{page.relative_to(root)}:{number}", command)
        test.check_text(page)
    if test.complaints or count < 60:
        sys.exit("\n".join(test.complaints) or f"only {count} commands")
    shutil.rmtree(work)
    print(f"{count} commands work")


if __name__ == "__main__":
    main()

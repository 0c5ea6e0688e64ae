#!/usr/bin/env python3
"""Guards the walls between the rooms: walls_test.py SOURCE_FOLDER prints every include that breaks one, and fails.

What may include what is written down here once; docs/architecture.md says why."""

import collections
import os
import re
import sys

# A target: where its headers lie, and whose public headers it may include beside its own.
TARGETS = {
    "engine": {"public": "engine/include", "private": "engine/src", "knows": []},
    "python": {"public": "engine/python/include", "private": "engine/python/src", "knows": ["engine"]},
    "planner": {"public": "planner/include", "private": "planner/src", "knows": ["engine"]},
    "io": {"public": "planner/io/include", "private": "planner/io/src", "knows": ["engine", "planner"]},
    "planner_python": {"public": None, "private": "planner/python/src", "knows": ["engine", "planner", "io", "python"]},
    "sim": {"public": "planner/sim/include", "private": "planner/sim/src", "knows": ["engine", "planner", "io"]},
    "report": {"public": "planner/report/include", "private": "planner/report/src", "knows": ["engine", "planner"]},
    "app": {"public": None, "private": "planner/app", "knows": ["engine", "planner", "io", "sim", "report"]},
}

# Folders in the order of the flow of data: each includes itself and those before it.
FLOW = {
    "engine": ["file", "isa", "voxel", "parallel", "walk", "packet", "embree", "fast", "octomap", "frontier", "view"],
    "planner": ["casting", "mapping", "frontier", "corridor", "path", "motion", "assignment", "goal", "routing", "tour",
                "view_path", "exploration", "recording"],
}

# In one place, where the thread sanitizer does not look into their templates (engine/CMakeLists.txt). The linker takes
# one copy of those for all, so tests and benchmarks do not include them either.
TBB_LOOPS = r"(oneapi/)?tbb/parallel_"

# Libraries, and the files that may include them; all others may not.
LIBRARIES = [
    (r"embree[34]/", r"engine/src/embree/|planner/sim/src/sensing/surface\.cpp"),
    (r"octomap/|octomath/", r"engine/src/octomap/|engine/python/src/bind_live_map\.cpp|planner/src/mapping/|planner/app/.*\.cpp"),
    (r"Ip[A-Z]\w+\.hpp", r"planner/src/view_path/gain_ascent\.cpp"),
    (r"ompl/", r"planner/src/path/.*"),
    (r"assimp/", r"planner/sim/src/mesh/mesh_import\.cpp"),
    (r"nlohmann/json_fwd\.hpp", r"planner/(app|io/src|report/src)/"),
    (r"nlohmann/", r"planner/(app|io/src|report/src)/.*\.cpp"),
    (r"CLI/", r"planner/app/"),
    (r"pybind11/", r"(engine|planner)/python/"),
    (r"cairo.*\.h", r"planner/app/draw/picture\.cpp"),
    (r"zlib\.h", r"planner/src/recording/.*\.cpp|planner/report/src/report\.cpp"),
    (TBB_LOOPS, r"engine/src/parallel/"),
    (r"(oneapi/)?tbb/", r"(engine|planner)/.*src/|planner/app/"),
]
MOST_FILES = 25


def target_of(file):
    fits = [name for name, t in TARGETS.items() for folder in (t["public"], t["private"])
            if folder and file.startswith(folder + "/")]
    return max(fits, key=lambda name: len(TARGETS[name]["private"]))


def folder_in(target, file):
    return os.path.relpath(file, TARGETS[target]["private"]).split("/")[0]


def sources_in(root, top):
    return sorted(os.path.relpath(os.path.join(at, name), root)
                  for at, _, names in os.walk(os.path.join(root, top)) for name in names
                  if name.endswith((".cpp", ".hpp", ".inl")))


def loops_elsewhere(root):
    """Complaints of tests and benchmarks that include TBB's loops."""
    complaints = []
    for file in sources_in(root, "tests") + sources_in(root, "bench"):
        with open(os.path.join(root, file), encoding="utf-8") as text:
            if re.search(rf"#\s*include\s*<{TBB_LOOPS}", text.read()):
                complaints.append(f"{file}: tests and benchmarks include no loops of TBB")
    return complaints


def check(root):
    """All complaints, the number of files, and the includes of ours that each file has."""
    files = sources_in(root, "engine") + sources_in(root, "planner")
    complaints, graph = [], collections.defaultdict(list)
    for file in files:
        target = target_of(file)
        public = TARGETS[target]["public"] and file.startswith(TARGETS[target]["public"] + "/")
        with open(os.path.join(root, file), encoding="utf-8") as text:
            lines = text.read().split("\n")
        for number, line in enumerate(lines, 1):
            include = re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)
            if not include:
                continue
            def complain(reason):
                complaints.append(f"{file}:{number}: {line.strip()}: {reason}")
            quoted, header = include[1] == '"', include[2]
            if quoted:
                path = f"{TARGETS[target]['private']}/{header}"
                if public:
                    complain("a public header includes no private one")
                elif path not in files:
                    complain(f"no header of {TARGETS[target]['private']}, named by its path from there")
                else:
                    graph[file].append(path)
                    flow = FLOW.get(target)
                    if flow:
                        here, there = folder_in(target, file), folder_in(target, path)
                        if here not in flow or there not in flow:
                            complain(f"the folders of {target} are {', '.join(flow)}")
                        elif flow.index(there) > flow.index(here):
                            complain(f"{here}/ comes before {there}/")
            elif header.startswith("frontlux/"):
                paths = [f"{TARGETS[t]['public']}/{header}" for t in [target, *TARGETS[target]["knows"]]
                         if TARGETS[t]["public"]]
                found = [path for path in paths if path in files]
                if found:
                    graph[file].append(found[0])
                else:
                    complain(f"{target} knows {', '.join(TARGETS[target]['knows']) or 'itself'} only")
            elif "/" in header or header.endswith(".h"):
                allowed = next((where for library, where in LIBRARIES if re.match(library, header)), None)
                if public and not header.startswith("Eigen/") and not (allowed and re.match(allowed, file)):
                    complain("a public header includes the standard library, Eigen and <frontlux/...> only")
                elif allowed and not re.match(allowed, file):
                    complain(f"allowed in {allowed} only")
    return complaints, files, graph


def circle(graph):
    """The files of a circle of includes, or nothing."""
    state = {}

    def visit(file, path):
        state[file] = "open"
        for other in graph.get(file, []):
            if state.get(other) == "open":
                return path[path.index(other):] + [other]
            if other not in state and (found := visit(other, path + [other])):
                return found
        state[file] = "done"
        return None

    for file in list(graph):
        if file not in state and (found := visit(file, [file])):
            return found
    return None


def main():
    complaints, files, graph = check(sys.argv[1])
    if not files:
        sys.exit(f"no sources below {sys.argv[1]}")
    complaints += loops_elsewhere(sys.argv[1])
    if found := circle(graph):
        complaints.append("a circle of includes: " + " -> ".join(found))
    for folder, count in collections.Counter(os.path.dirname(file) for file in files).items():
        if count > MOST_FILES:
            complaints.append(f"{folder}: {count} files, more than {MOST_FILES}")
    if complaints:
        sys.exit("\n".join(complaints) + f"\n{len(complaints)} broken walls in {len(files)} files")
    print(f"{len(files)} files keep the walls")


if __name__ == "__main__":
    main()
